// SPDX-License-Identifier: Apache-2.0
/// The covariance of the flown loop, against flights and against what is known of it.
#include "quadtune/workbench/predicted_rms.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/simulation/flight.hpp"
#include "quadtune/workbench/flown_lqi.hpp"
#include "quadtune/workbench/lqi_report.hpp"
#include "sanitized.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// What the model leaves out: biases from the start on, vibration, lost samples.
Vehicle without_omitted_errors(const std::string& name) {
  Vehicle vehicle = load_vehicle(name);
  const auto clean = [](auto& faults) {
    if (!faults) return;
    faults->turn_on_bias.setZero();
    faults->bias.setZero();
    faults->vibration.setZero();
    faults->dropout = 0;
  };
  Sensors& sensors = vehicle.sensors;
  clean(sensors.accelerometer);
  clean(sensors.gyroscope);
  clean(sensors.magnetometer);
  clean(sensors.vision);
  const auto clean_one = [](SensorFaults& faults) {
    faults.turn_on_bias.setZero();
    faults.bias.setZero();
    faults.dropout = 0;
  };
  if (sensors.barometer) clean_one(sensors.barometer->faults);
  if (sensors.sonar) clean_one(sensors.sonar->faults);
  if (sensors.flow) clean_one(sensors.flow->faults);
  if (sensors.gps) clean_one(sensors.gps->position);
  return vehicle;
}

PlannedFlight hover_under(const Vehicle& vehicle) {
  return quadtune::hover_under(vehicle, flown_lqi(vehicle).lqi.gains);
}

/// The final states, true and estimated minus true, of flights of so long.
struct Seen {
  Eigen::MatrixXd state, error;  ///< (12 × flights)
};

/// @param first  number of the first flight, for its random numbers
Seen seen_after(PlannedFlight plan, int first, int flights, double duration) {
  plan.setup.duration = duration;
  std::vector<FlightSetup> setups(static_cast<std::size_t>(flights), plan.setup);
  for (std::size_t i = 0; i < setups.size(); ++i)
    setups[i].flight = static_cast<std::uint32_t>(first) + static_cast<std::uint32_t>(i);
  const std::vector<FlightResult> results = fly_all(setups);
  Seen seen{Eigen::MatrixXd(12, flights), Eigen::MatrixXd(12, flights)};
  for (int i = 0; i < flights; ++i) {
    const FlightResult& result = results[static_cast<std::size_t>(i)];
    EXPECT_EQ(result.end, FlightEnd::completed);
    seen.state.col(i) = result.final_state;
    seen.error.col(i) = result.final_estimate - result.final_state;
  }
  return seen;
}

/// Mean squares of the rows about their means.
VectorXd variances(Eigen::MatrixXd values) {
  const VectorXd mean = values.rowwise().mean();
  values.colwise() -= mean;
  return values.cwiseAbs2().rowwise().sum() / (static_cast<double>(values.cols()) - 1);
}

class Predicted : public ::testing::TestWithParam<const char*> {};

/// What drifts is compared by what it gains in 40 s, the rest as it is, at five instants of the
/// sample clocks. 400 flights know a standard deviation to 3.5 %.
TEST_P(Predicted, IsWhatFlightsShow) {
  if (testing::kSanitized) GTEST_SKIP() << "minutes of flights";
  PlannedFlight plan = hover_under(without_omitted_errors(GetParam()));
  Mission& mission = plan.setup.mission;
  mission.start.in_air = true;
  mission.start.position = std::get<Hover>(mission.kind).position;
  constexpr double kSettled = 60, kTime = 40;
  constexpr int kFlights = 80;
  const PredictedRms predicted = predicted_rms(plan, kTime);
  VectorXd state = VectorXd::Zero(12), gained = state, error = state, error_gained = state;
  const std::vector<double> instants = {0.13, 0.37, 0.61, 0.79, 0.95};
  const auto count = static_cast<double>(instants.size());
  for (std::size_t j = 0; j < instants.size(); ++j) {
    const int number = static_cast<int>(j) * kFlights;
    const Seen first = seen_after(plan, number, kFlights, kSettled + instants[j]);
    const Seen later = seen_after(plan, number, kFlights, kSettled + kTime + instants[j]);
    state += variances(later.state) / count;
    gained += variances(later.state - first.state) / count;
    error += variances(later.error) / count;
    error_gained += variances(later.error - first.error) / count;
  }
  const std::vector<Signal> drifts = flown_loop(plan).drifts;
  const std::vector<Signal>& states = ned_convention().states;
  for (Index i = 0; i < 12; ++i) {
    const Signal& name = states[static_cast<std::size_t>(i)];
    const bool drift = std::find(drifts.begin(), drifts.end(), name) != drifts.end();
    EXPECT_NEAR(predicted.state(i) / std::sqrt(drift ? gained(i) : state(i)), 1, 0.1) << name.name;
    EXPECT_NEAR(predicted.error(i) / std::sqrt(drift ? error_gained(i) : error(i)), 1, 0.1)
        << name.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Vehicles, Predicted, ::testing::Values("crazyflie", "rolling-spider"));

/// Linear: noise of twice the deviation, for the same filter, gives deviations of twice the size.
TEST(PredictedRms, IsProportionalToTheNoise) {
  if (testing::kSanitized) GTEST_SKIP() << "minutes of what other tests run too";
  Vehicle vehicle = without_omitted_errors("crazyflie");
  const PlannedFlight plan = hover_under(vehicle);
  PlannedFlight doubled = plan;
  doubled.setup.general_filter = general_filter_settings(plan.setup);
  doubled.setup.flown = vehicle;
  Sensors& sensors = doubled.setup.flown->sensors;
  for (SensorFaults* faults :
       {&*sensors.accelerometer, &*sensors.gyroscope, &*sensors.magnetometer,
        &sensors.barometer->faults, &sensors.sonar->faults, &sensors.flow->faults}) {
    faults->noise *= 2;
    faults->bias_walk *= 2;
    faults->correlated_noise *= 2;
    faults->quantum *= 2;
  }
  sensors.flow->noise_per_height *= 2;
  const PredictedRms once = predicted_rms(plan, 20), twice = predicted_rms(doubled, 20);
  EXPECT_THAT(twice.state, testing::MatrixRelativelyNear(2 * once.state, 1e-9));
  EXPECT_THAT(twice.error, testing::MatrixRelativelyNear(2 * once.error, 1e-9));
  EXPECT_THAT(twice.command, testing::MatrixRelativelyNear(2 * once.command, 1e-9));
}

/// True states without noise stay where they are.
TEST(PredictedRms, IsZeroWithIdealSensors) {
  FlightOptions ideal;
  ideal.sensors = "ideal";
  const Vehicle vehicle = load_vehicle("crazyflie");
  const PredictedRms rms =
      predicted_rms(quadtune::hover_under(vehicle, flown_lqi(vehicle).lqi.gains, ideal), 60);
  EXPECT_EQ(rms.state.maxCoeff(), 0);
  EXPECT_EQ(rms.error.maxCoeff(), 0);
}

/// No deviation is predicted of a loop that grows.
TEST(PredictedRms, IsInfiniteOfAnUnstableLoop) {
  const Vehicle vehicle = load_vehicle("crazyflie");
  Gains gains = flown_lqi(vehicle).lqi.gains;
  gains.K *= 30;
  const PredictedRms rms = predicted_rms(quadtune::hover_under(vehicle, gains, {}), 1);
  EXPECT_TRUE(std::isinf(rms.state.minCoeff()));
  EXPECT_TRUE(std::isinf(rms.command.minCoeff()));
}

TEST(PredictedRms, RefusesATimeThatIsNone) {
  const PlannedFlight plan = hover_under(load_vehicle("crazyflie"));
  for (const double time : {0.0, -1.0, std::nan("")})
    EXPECT_THAT([&] { (void)predicted_rms(plan, time); },
                ThrowsMessage<InvalidInput>(HasSubstr("expected a positive number")));
}

}  // namespace
}  // namespace quadtune
