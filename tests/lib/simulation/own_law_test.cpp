// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "numbers.hpp"
#include "quadtune/control/cascade_law.hpp"
#include "quadtune/control/state_feedback_law.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/simulation/flight.hpp"
#include "quadtune/simulation/flight_law.hpp"
#include "same_bits.hpp"
#include "same_flight.hpp"

namespace quadtune {
namespace {

using testing::first_difference;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

using testing::kNaN;

/// State feedback to the wrench with an integral of height.
StateFeedbackController hover_feedback() {
  CascadeGains cascade = load_vehicle("mambo").published_cascade->gains;
  for (PidLoop& loop : cascade.loops) loop.Ki = 0;
  StateFeedbackController law;
  law.dt = cascade.dt;
  Gains& g = law.gains;
  g.convention = "ned";
  g.input_kind = InputKind::wrench;
  g.states = ned_convention().states;
  g.inputs = ned_convention().wrench;
  g.K = -cascade_law(cascade, PidMethod::forward_euler).D.rightCols(12);
  g.K_int = Eigen::MatrixXd::Zero(4, 1);
  g.K_int(0, 0) = -0.1;
  g.integrals = {{"pz", "m s"}};
  g.x0 = Eigen::VectorXd::Zero(12);
  g.u0 = Eigen::Vector4d(0.063 * 9.81, 0, 0, 0);
  g.dt = cascade.dt;
  return law;
}

/// The same law by the functions that a flight program would call.
class OwnFeedback : public FlightLaw {
 public:
  OwnFeedback(const Vehicle& vehicle, const StateFeedbackController& law)
      : settings_(state_feedback_settings(vehicle, law.gains, law.dt, law.guards)) {}

  Eigen::VectorXd command(const Estimate<double>& estimate,
                          const Reference<double>& reference) override {
    return step(settings_, state_, estimate, reference).head(settings_.inputs);
  }
  void on_realized(const Eigen::VectorXd& asked, const Eigen::VectorXd& made) override {
    quadtune::on_realized(settings_, state_, padded(asked), padded(made));
  }

 private:
  static Eigen::Matrix<double, kMaxRotors, 1> padded(const Eigen::VectorXd& inputs) {
    Eigen::Matrix<double, kMaxRotors, 1> all = Eigen::Matrix<double, kMaxRotors, 1>::Zero();
    all.head(inputs.size()) = inputs;
    return all;
  }

  StateFeedbackSettings<double> settings_;
  StateFeedbackState<double> state_;
};

/// Hover thrust, then at a time what a test says.
class Failing : public FlightLaw {
 public:
  Failing(double thrust, Eigen::VectorXd then) : thrust_(thrust), then_(std::move(then)) {}

  Eigen::VectorXd command(const Estimate<double>& /*estimate*/,
                          const Reference<double>& /*reference*/) override {
    if (++samples_ > 100) return then_;
    return Eigen::Vector4d(thrust_, 0, 0, 0);
  }

 private:
  int samples_ = 0;
  double thrust_;
  Eigen::VectorXd then_;
};

FlightSetup flight_of(Controller controller) {
  FlightSetup setup;
  setup.vehicle = load_vehicle("mambo");
  // With a reference at rest no sine rounds: fly() has its own, for several flights at once.
  setup.mission = load_mission("hover");
  setup.controller = std::move(controller);
  setup.estimator = EstimatorKind::truth;
  setup.duration = 8;
  setup.log = true;
  return setup;
}

OwnController own_controller(const StateFeedbackController& law) {
  return {"mine", law.dt, law.gains.input_kind,
          [law](const Vehicle& vehicle) { return std::make_unique<OwnFeedback>(vehicle, law); }};
}

FlightSetup failing_flight(const Eigen::VectorXd& then) {
  const double weight = load_vehicle("mambo").mass * 9.81;
  FlightSetup setup =
      flight_of(OwnController{"mine", 0.005, InputKind::wrench, [=](const Vehicle&) {
                                return std::make_unique<Failing>(weight, then);
                              }});
  setup.mission.start.in_air = true;
  setup.mission.start.position = {0, 0, -1.1};
  return setup;
}

TEST(OwnLaw, ThatIsTheBuiltInOneFliesTheSameFlight) {
  StateFeedbackController law = hover_feedback();
  for (const AllocationRule rule : {AllocationRule::clipped, AllocationRule::prioritized})
    for (const bool log : {true, false}) {
      law.gains.limits.conditional_integration = rule == AllocationRule::prioritized;
      FlightSetup built_in = flight_of(law), mine = flight_of(own_controller(law));
      built_in.log = mine.log = log;
      built_in.allocation = mine.allocation = rule;
      FlightResult expected = fly(built_in), found = fly(mine);
      ASSERT_EQ(expected.end, FlightEnd::completed);
      found.log.about = expected.log.about;  // which names the law
      EXPECT_STREQ(first_difference(found, expected), "");
      // Among others it flies alone, with the same result.
      const std::vector<FlightSetup> many = {mine, built_in, mine};
      const std::vector<FlightResult> all = fly_all(many, 1);
      EXPECT_EQ(all[0].final_state, found.final_state);
      EXPECT_EQ(all[1].final_state, found.final_state);
      EXPECT_EQ(all[2].final_state, found.final_state);
    }
}

TEST(OwnLaw, IsNamedInTheLog) {
  const FlightResult result = fly(flight_of(own_controller(hover_feedback())));
  EXPECT_THAT(result.log.about,
              ::testing::Contains(std::pair<std::string, std::string>("controller", "mine")));
}

TEST(OwnLaw, EndsTheFlightWhenItsOutputCannotBeFlown) {
  const std::pair<Eigen::VectorXd, std::string> cases[] = {
      {Eigen::Vector4d(1, 0, kNaN, 0), "law 'mine': tau_y is nan"},
      {Eigen::Vector4d(std::numeric_limits<double>::infinity(), 0, 0, 0), "law 'mine': T is inf"},
      {Eigen::Vector3d(1, 0, 0), "law 'mine': 3 inputs, expected 4"}};
  for (const auto& [output, words] : cases) {
    const FlightResult result = fly(failing_flight(output));
    EXPECT_EQ(result.end, FlightEnd::safety_exit);
    EXPECT_EQ(result.culprit, words);
    EXPECT_EQ(result.events.back().name, "law");
    EXPECT_EQ(result.events.back().detail, words);
    EXPECT_DOUBLE_EQ(result.end_time, 0.5);
    EXPECT_TRUE(result.final_state.allFinite());
    EXPECT_TRUE(result.final_estimate.allFinite());
  }
}

TEST(OwnLaw, RefusesWhatCannotBeFlown) {
  FlightSetup setup = failing_flight(Eigen::Vector4d::Zero());
  std::get<OwnController>(setup.controller).make = nullptr;
  EXPECT_THAT([&] { (void)fly(setup); },
              ThrowsMessage<InvalidInput>(HasSubstr("make of the law 'mine' is empty")));
  std::get<OwnController>(setup.controller).make = [](const Vehicle&) {
    return std::unique_ptr<FlightLaw>();
  };
  EXPECT_THAT([&] { (void)fly(setup); },
              ThrowsMessage<InvalidInput>(HasSubstr("law mine: make() returned null")));
  std::get<OwnController>(setup.controller).dt = 0;
  EXPECT_THAT([&] { (void)fly(setup); }, ThrowsMessage<InvalidInput>(HasSubstr("dt is 0 s")));
}

}  // namespace
}  // namespace quadtune
