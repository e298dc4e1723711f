// SPDX-License-Identifier: Apache-2.0
/// The covariance of the flown loop, compared with flights and known properties.
#include "quadtune/workbench/flight/predicted_rms.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/simulation/flight.hpp"
#include "quadtune/workbench/design/lqi_report.hpp"
#include "quadtune/workbench/flown/flown_lqi.hpp"
#include "sanitized.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// Disables what the model omits: biases from the start on, vibration, lost samples.
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

/// The final states, true and estimated minus true, of flights with this duration.
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

/// Variances of the rows.
VectorXd variances(Eigen::MatrixXd values) {
  const VectorXd mean = values.rowwise().mean();
  values.colwise() -= mean;
  return values.cwiseAbs2().rowwise().sum() / (static_cast<double>(values.cols()) - 1);
}

/// Scales the sensors' errors. The filter keeps its own numbers.
void scale_noise(Sensors& sensors, double factor) {
  const auto scale = [&](SensorFaults& faults) {
    faults.noise *= factor;
    faults.bias_walk *= factor;
    faults.correlated_noise *= factor;
    faults.quantum *= factor;
  };
  for (auto* faults : {&sensors.accelerometer, &sensors.gyroscope, &sensors.magnetometer})
    if (*faults) scale(**faults);
  if (sensors.barometer) scale(sensors.barometer->faults);
  if (sensors.sonar) scale(sensors.sonar->faults);
  if (sensors.flow) {
    scale(sensors.flow->faults);
    sensors.flow->noise_per_height *= factor;
  }
  if (sensors.gps) {
    scale(sensors.gps->position);
    sensors.gps->velocity_noise *= factor;
  }
}

/// Standard deviations from the prediction and from flights: of observed states directly, of
/// drifting ones as their growth in 40 s.
struct Compared {
  VectorXd state, error;            ///< predicted
  VectorXd seen_state, seen_error;  ///< of 800 flights, with an accuracy of 2.5 %
};

Compared compared(PlannedFlight plan) {
  Mission& mission = plan.setup.mission;
  mission.start.in_air = true;
  mission.start.position = std::get<Hover>(mission.kind).position;
  constexpr double kSettled = 60, kTime = 40;
  constexpr int kFlights = 40, kInstants = 20;
  VectorXd state = VectorXd::Zero(12), gained = state, error = state, error_gained = state;
  for (int j = 0; j < kInstants; ++j) {
    // Instants in and between the periods of all sensors, over the period of the slowest.
    const double instant = 0.05 * j + 0.005 * (j % 2);
    const Seen first = seen_after(plan, j * kFlights, kFlights, kSettled + instant);
    const Seen later = seen_after(plan, j * kFlights, kFlights, kSettled + kTime + instant);
    state += variances(later.state) / kInstants;
    gained += variances(later.state - first.state) / kInstants;
    error += variances(later.error) / kInstants;
    error_gained += variances(later.error - first.error) / kInstants;
  }
  const PredictedRms once = predicted_rms(plan, kTime), twice = predicted_rms(plan, 2 * kTime);
  Compared result = {once.state, once.error, state.cwiseSqrt(), error.cwiseSqrt()};
  // A drift D t about which the state fluctuates with a variance s is D t + s from rest, and gains
  // D t + 2 s between two instants.
  const auto gain = [](double t, double twice_t) {
    return std::sqrt(3 * t * t - twice_t * twice_t);
  };
  const std::vector<Signal> drifts = flown_loop(plan).drifts;
  const std::vector<Signal>& states = ned_convention().states;
  for (Index i = 0; i < 12; ++i) {
    if (std::find(drifts.begin(), drifts.end(), states[static_cast<std::size_t>(i)]) ==
        drifts.end())
      continue;
    result.state(i) = gain(once.state(i), twice.state(i));
    result.error(i) = gain(once.error(i), twice.error(i));
    result.seen_state(i) = std::sqrt(gained(i));
    result.seen_error(i) = std::sqrt(error_gained(i));
  }
  return result;
}

class Predicted : public ::testing::TestWithParam<const char*> {};

TEST_P(Predicted, IsWhatFlightsShow) {
  if (testing::kSanitized) GTEST_SKIP() << "minutes of flights";
  const std::string vehicle = GetParam();
  const Compared rms = compared(hover_under(without_omitted_errors(vehicle)));
  for (Index i = 0; i < 12; ++i) {
    const std::string& name = ned_convention().states[static_cast<std::size_t>(i)].name;
    EXPECT_NEAR(rms.state(i) / rms.seen_state(i), 1, 0.1) << name;
    EXPECT_NEAR(rms.error(i) / rms.seen_error(i), 1, 0.1) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Vehicles, Predicted,
                         ::testing::Values("crazyflie", "rolling-spider", "mambo", "uquad"));

/// With small noise the prediction holds for every state, also where second-order terms matter.
TEST(PredictedRms, IsThatOfSmallNoise) {
  if (testing::kSanitized) GTEST_SKIP() << "minutes of flights";
  const Vehicle vehicle = without_omitted_errors("uquad");
  PlannedFlight plan = hover_under(vehicle);
  plan.setup.general_filter = general_filter_settings(plan.setup);
  plan.setup.flown = vehicle;
  scale_noise(plan.setup.flown->sensors, 0.2);
  const Compared rms = compared(plan);
  for (Index i = 0; i < 12; ++i) {
    const std::string& name = ned_convention().states[static_cast<std::size_t>(i)].name;
    EXPECT_NEAR(rms.state(i) / rms.seen_state(i), 1, 0.1) << name;
    EXPECT_NEAR(rms.error(i) / rms.seen_error(i), 1, 0.1) << name;
  }
}

/// GPS noise makes the uquad sway by 0.03 rad: the product of pitch rate and roll turns it as much
/// as all effects of a linear model.
TEST(PredictedRms, HasTheTurnsOfASway) {
  if (testing::kSanitized) GTEST_SKIP() << "minutes of what other tests run too";
  const PredictedRms rms = predicted_rms(hover_under(without_omitted_errors("uquad")), 40);
  constexpr Index kYaw = 5, kR = 11;
  EXPECT_GT(rms.turned(kR), 0.6 * rms.state(kR));
  EXPECT_LT(rms.turned(kR), 0.8 * rms.state(kR));
  EXPECT_GT(rms.turned(kYaw), 0.3 * rms.state(kYaw));
  for (const Index other : {0, 1, 2, 3, 4, 6, 7, 8, 9, 10})
    EXPECT_LT(rms.turned(other), 1e-3 * rms.state(other)) << other;
}

/// Linear: twice the noise with the same filter gives twice the deviations, but four times the
/// rotation from the product of two states.
TEST(PredictedRms, IsProportionalToTheNoise) {
  if (testing::kSanitized) GTEST_SKIP() << "minutes of what other tests run too";
  Vehicle vehicle = without_omitted_errors("crazyflie");
  const PlannedFlight plan = hover_under(vehicle);
  PlannedFlight doubled = plan;
  doubled.setup.general_filter = general_filter_settings(plan.setup);
  doubled.setup.flown = vehicle;
  scale_noise(doubled.setup.flown->sensors, 2);
  const PredictedRms once = predicted_rms(plan, 20), twice = predicted_rms(doubled, 20);
  const auto linear = [](const PredictedRms& rms) {
    return VectorXd((rms.state.cwiseAbs2() - rms.turned.cwiseAbs2()).cwiseSqrt());
  };
  EXPECT_THAT(linear(twice), testing::MatrixRelativelyNear(2 * linear(once), 1e-9));
  EXPECT_THAT(twice.turned, testing::MatrixRelativelyNear(4 * once.turned, 1e-9));
  EXPECT_THAT(twice.error, testing::MatrixRelativelyNear(2 * once.error, 1e-9));
  EXPECT_THAT(twice.command.head(3), testing::MatrixRelativelyNear(2 * once.command.head(3), 1e-6));
}

/// True states without noise do not deviate.
TEST(PredictedRms, IsZeroWithIdealSensors) {
  FlightOptions ideal;
  ideal.sensors = "ideal";
  const Vehicle vehicle = load_vehicle("crazyflie");
  const PredictedRms rms =
      predicted_rms(quadtune::hover_under(vehicle, flown_lqi(vehicle).lqi.gains, ideal), 60);
  EXPECT_EQ(rms.state.maxCoeff(), 0);
  EXPECT_EQ(rms.error.maxCoeff(), 0);
}

/// For an unstable loop, no finite deviation is predicted.
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
