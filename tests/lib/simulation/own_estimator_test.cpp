// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "matrix_near.hpp"
#include "numbers.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/uquad_filter.hpp"
#include "quadtune/simulation/flight.hpp"
#include "quadtune/simulation/flight_estimator.hpp"
#include "same_bits.hpp"
#include "same_flight.hpp"

namespace quadtune {
namespace {

using testing::first_difference;
using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::ThrowsMessage;

using testing::kNaN;

using Update = std::function<Estimate<double>(const EstimatorInput&)>;

/// An estimator that is one function.
class Own : public FlightEstimator {
 public:
  explicit Own(Update update) : update_(std::move(update)) {}
  Estimate<double> update(const EstimatorInput& input) override { return update_(input); }

 private:
  Update update_;
};

OwnEstimator own(const Update& update) {
  return {"mine", [update](const EstimatorStart&) { return std::make_unique<Own>(update); }};
}

Estimate<double> truth(const EstimatorInput& input) {
  Estimate<double> estimate;
  estimate.x = input.true_state;
  return estimate;
}

FlightSetup estimated_flight(EstimatorKind estimator) {
  FlightSetup setup;
  setup.vehicle = load_vehicle("mambo");
  setup.mission = load_mission("take-off-and-land");
  setup.controller = CascadeController{setup.vehicle.published_cascade->gains};
  setup.estimator = estimator;
  setup.environment.wind.mean = {0.5, 0, 0};
  setup.log = true;
  return setup;
}

TEST(OwnEstimator, ThatReturnsTheTrueStateFliesAsTruthDoes) {
  FlightSetup setup = estimated_flight(EstimatorKind::own);
  setup.own_estimator = own(truth);
  FlightResult expected = fly(estimated_flight(EstimatorKind::truth)), found = fly(setup);
  ASSERT_EQ(expected.end, FlightEnd::completed);
  EXPECT_THAT(found.log.about,
              ::testing::Contains(std::pair<std::string, std::string>("estimator", "mine")));
  EXPECT_STREQ(first_difference(found, expected), "");
  // Among others it flies alone, with the same result.
  const std::vector<FlightSetup> many = {setup, estimated_flight(EstimatorKind::truth), setup};
  const std::vector<FlightResult> all = fly_all(many, 1);
  EXPECT_EQ(all[0].final_state, all[1].final_state);
  EXPECT_EQ(all[2].final_state, all[1].final_state);
}

/// The Mambo's own estimator behind the interface: it reads every sensor that the vehicle has.
class OwnMambo : public FlightEstimator {
 public:
  OwnMambo(const MamboEstimatorSettings<double>& settings, const EstimatorStart& start)
      : settings_(settings), state_(mambo_estimator_start(settings_, start.state)) {}
  Estimate<double> update(const EstimatorInput& input) override {
    return step(settings_, state_, input.sensors);
  }

 private:
  MamboEstimatorSettings<double> settings_;
  MamboEstimatorState<double> state_;
};

// Up to rounding: fly() has sines of its own, for several flights at once.
TEST(OwnEstimator, ThatIsTheMambosFliesTheSameFlight) {
  FlightSetup setup = estimated_flight(EstimatorKind::own);
  setup.own_estimator = {"mine", [&](const EstimatorStart& start) {
                           MamboEstimatorSettings<double> settings = setup.mambo_estimator;
                           settings.dt = start.dt;
                           settings.gravity = start.vehicle.gravity;
                           settings.calibration_time = setup.mission.start.start_up;
                           return std::make_unique<OwnMambo>(settings, start);
                         }};
  const FlightResult expected = fly(estimated_flight(EstimatorKind::mambo)), found = fly(setup);
  EXPECT_EQ(found.end, expected.end);
  EXPECT_EQ(found.end_time, expected.end_time);
  EXPECT_THAT(found.final_state, MatrixNear(expected.final_state, 1e-6));
  EXPECT_THAT(found.final_estimate, MatrixNear(expected.final_estimate, 1e-6));
}

TEST(OwnEstimator, KnowsWhetherItStandsAndWhatTheMotorsWereTold) {
  FlightSetup setup = estimated_flight(EstimatorKind::own);
  const double start_up = setup.mission.start.start_up;
  double stood = 0, turned = -1;
  setup.own_estimator = own([&](const EstimatorInput& input) {
    if (input.on_ground && input.time < 2) stood = input.time;
    if (turned < 0 && input.speeds.minCoeff() > 0) turned = input.time;
    return truth(input);
  });
  (void)fly(setup);
  EXPECT_NEAR(stood, start_up, 0.0051);
  EXPECT_GE(turned, 0.005);
}

TEST(OwnEstimator, EndsTheFlightWhenItsEstimateIsNotFinite) {
  const auto fails = [](const std::function<void(Estimate<double>&)>& spoil) {
    FlightSetup setup = estimated_flight(EstimatorKind::own);
    setup.own_estimator = own([spoil](const EstimatorInput& input) {
      Estimate<double> estimate = truth(input);
      if (input.time >= 3) spoil(estimate);
      return estimate;
    });
    return fly(setup);
  };
  const std::pair<std::function<void(Estimate<double>&)>, std::string> cases[] = {
      {[](Estimate<double>& e) { e.x(2) = kNaN; }, "estimator 'mine': pz is nan"},
      {[](Estimate<double>& e) { e.finite = false; },
       "estimator 'mine' reports that its state is not finite"}};
  for (const auto& [spoil, words] : cases) {
    const FlightResult result = fails(spoil);
    EXPECT_EQ(result.end, FlightEnd::safety_exit);
    EXPECT_EQ(result.culprit, words);
    EXPECT_EQ(result.events.back().name, "estimator");
    EXPECT_NEAR(result.end_time, 3, 1e-9);
    EXPECT_TRUE(result.final_state.allFinite());
    EXPECT_TRUE(result.final_estimate.allFinite());
  }
}

TEST(OwnEstimator, RefusesAnEmptyOne) {
  FlightSetup setup = estimated_flight(EstimatorKind::own);
  EXPECT_THAT([&] { (void)fly(setup); },
              ThrowsMessage<InvalidInput>(HasSubstr("own_estimator.make is empty")));
  setup.own_estimator = {"mine",
                         [](const EstimatorStart&) { return std::unique_ptr<FlightEstimator>(); }};
  EXPECT_THAT([&] { (void)fly(setup); },
              ThrowsMessage<InvalidInput>(
                  HasSubstr("estimator mine: make() returned null, expected an estimator")));
}

}  // namespace
}  // namespace quadtune
