// SPDX-License-Identifier: Apache-2.0
// The general filter over simulated flights: its errors and its innovations are as large as it
// says.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "plants/designed_mambo.hpp"
#include "quadtune/estimation/general_filter.hpp"
#include "quadtune/simulation/flight.hpp"
#include "sanitized.hpp"

namespace quadtune {
namespace {

using Eigen::Vector3d;

// --- flights ---

/// The Mambo with a suite of sensors. Its law has the true state, so that the flight does not
/// depend on the filter.
FlightSetup flight_of(const Sensors& sensors, const char* mission) {
  FlightSetup setup;
  setup.vehicle = load_vehicle("mambo");
  setup.vehicle.sensors = sensors;
  setup.mission = load_mission(mission);
  setup.mission.start.in_air = true;
  setup.mission.start.position = {0, 0, -1.1};
  setup.estimator = EstimatorKind::truth;
  setup.duration = 8;
  setup.controller = testing::designed_mambo_cascade();
  setup.log = true;
  // The simulated sensors have no other noise than their file's, and constant offsets.
  GeneralFilterNoise& noise = setup.general_noise;
  noise.omitted_rate = noise.omitted_acceleration = 0;
  noise.gyro_walk = noise.force_walk = noise.pressure_walk = 0;
  return setup;
}

/// A column of a log by its name.
const std::vector<double>& column(const LogTable& log, const std::string& name) {
  for (const LogColumn& one : log.columns)
    if (one.name == name) return one.values;
  throw std::runtime_error("no column " + name);
}

/// What the sensors said in row k of a log.
class Frames {
 public:
  Frames(const LogTable& log, const Sensors& sensors) : log_(log), sensors_(sensors) {}

  [[nodiscard]] SensorFrame<double> at(std::size_t k, double t) const {
    SensorFrame<double> frame;
    vector(frame.specific_force, "accelerometer", {"x", "y", "z"}, *sensors_.accelerometer, k, t);
    vector(frame.rates, "gyroscope", {"x", "y", "z"}, *sensors_.gyroscope, k, t);
    if (sensors_.magnetometer)
      vector(frame.magnetic_field, "magnetometer", {"x", "y", "z"}, *sensors_.magnetometer, k, t);
    if (sensors_.barometer) scalar(frame.pressure, "barometer", sensors_.barometer->faults, k, t);
    if (sensors_.sonar) scalar(frame.sonar, "sonar", sensors_.sonar->faults, k, t);
    if (sensors_.flow) vector(frame.flow, "flow", {"x", "y"}, sensors_.flow->faults, k, t);
    if (sensors_.gps) {
      vector(frame.gps_position, "gps", {"px", "py", "pz"}, sensors_.gps->position, k, t);
      vector(frame.gps_velocity, "gps", {"vx", "vy", "vz"}, sensors_.gps->position, k, t);
    }
    if (sensors_.vision) vector(frame.vision, "vision", {"px", "py", "pz"}, *sensors_.vision, k, t);
    return frame;
  }

 private:
  static double age(const SensorFaults& faults, double t) {
    return t - std::floor((t - faults.delay + 1e-9) * faults.rate) / faults.rate;
  }
  template <class Value>
  void vector(Sample<Value, double>& sample, const std::string& group,
              const std::vector<std::string>& axes, const SensorFaults& faults, std::size_t k,
              double t) const {
    for (std::size_t i = 0; i < axes.size(); ++i)
      sample.value(static_cast<Eigen::Index>(i)) = column(log_, group + "." + axes[i])[k];
    sample.fresh = !std::isnan(sample.value(0));
    sample.age = age(faults, t);
  }
  void scalar(Sample<double, double>& sample, const std::string& name, const SensorFaults& faults,
              std::size_t k, double t) const {
    sample.value = column(log_, name)[k];
    sample.fresh = !std::isnan(sample.value);
    sample.age = age(faults, t);
  }

  const LogTable& log_;
  const Sensors& sensors_;
};

struct Truth {
  Vector3d position, velocity;
  Eigen::Quaterniond attitude;
};

Truth truth(const LogTable& log, std::size_t k) {
  const auto x = [&](const char* name) { return column(log, std::string("x.") + name)[k]; };
  Truth result;
  result.attitude = Eigen::Quaterniond(x("qw"), x("qx"), x("qy"), x("qz"));
  result.position = {x("px"), x("py"), x("pz")};
  result.velocity = result.attitude * Vector3d(x("u"), x("v"), x("w"));
  return result;
}

/// Position, velocity and turn: true less believed.
Eigen::Matrix<double, 9, 1> error(const Truth& truth, const Motion9<double>& believed) {
  const Eigen::Quaterniond q(believed.attitude(0), believed.attitude(1), believed.attitude(2),
                             believed.attitude(3));
  Eigen::Quaterniond turn = truth.attitude * q.conjugate();
  if (turn.w() < 0) turn.coeffs() *= -1;
  Eigen::Matrix<double, 9, 1> e;
  e << truth.position - believed.position, truth.velocity - believed.velocity, 2 * turn.vec();
  return e;
}

struct Consistency {
  double nees = 0;  ///< mean over the flights, of nine errors at the end
  double nis = 0;   ///< sum of e²/S over all flights, over their number
  std::size_t flights = 0;
  double scalars = 0;
};

/// Flights whose offsets and start errors are drawn from what the filter assumes.
Consistency consistency(const FlightSetup& common, std::size_t flights) {
  Consistency result;
  std::mt19937_64 random(20261124);
  std::normal_distribution<double> normal;
  const auto draw = [&](double deviation) -> Vector3d {
    return Vector3d(normal(random), normal(random), normal(random)) * deviation;
  };
  GeneralFilterSettings settings = general_filter_settings(
      common.vehicle.sensors, control_period(common), common.vehicle.gravity,
      common.environment.magnetic_field, common.general_noise);
  settings.start = {0.05, 0.05, 0.01, 0.02, 2e-3, 0.05, 0.1};
  const StartDeviations& s = settings.start;
  const int horizon = horizon_periods(settings);
  constexpr std::size_t kBatch = 40;
  for (std::size_t begin = 0; begin < flights; begin += kBatch) {
    std::vector<FlightSetup> setups(std::min(kBatch, flights - begin), common);
    for (std::size_t i = 0; i < setups.size(); ++i) {
      FlightSetup& setup = setups[i];
      setup.flight = static_cast<std::uint32_t>(begin + i);
      setup.flown = setup.vehicle;
      setup.flown->sensors.gyroscope->bias += draw(s.gyro_bias);
      setup.flown->sensors.accelerometer->bias += draw(s.force_bias);
      if (settings.pressure)
        setup.flown->sensors.barometer->faults.bias(0) +=
            draw(s.pressure_height).x() * settings.pressure->slope();
    }
    for (const FlightResult& flight : fly_all(setups, 1)) {
      EXPECT_EQ(to_string(flight.end), "completed");
      const LogTable& log = flight.log;
      const std::vector<double>& t = column(log, "t");
      const Truth first = truth(log, 0);
      StateVector<double> x = StateVector<double>::Zero();
      x.head<3>() = first.position;
      GeneralFilterState<double> state = general_filter_start(settings, x);
      state.motion.position -= draw(s.position);
      state.motion.velocity -= draw(s.velocity);
      Vector3d turn = draw(s.tilt);
      turn.z() *= s.yaw / s.tilt;
      state.motion.attitude << 1, -0.5 * turn;
      state.motion.attitude.normalize();
      set_biases<double>(state, common.vehicle.sensors.gyroscope->bias,
                         common.vehicle.sensors.accelerometer->bias);
      const Frames frames(log, common.vehicle.sensors);
      for (std::size_t k = 0; k < t.size(); ++k) {
        const Estimate<double> estimate = step(settings, state, frames.at(k, t[k]), false);
        result.nis += estimate.innovation_square;
        result.scalars += estimate.innovation_freedom;
      }
      const Eigen::Matrix<double, 9, 1> e =
          error(truth(log, t.size() - 1 - static_cast<std::size_t>(horizon)), state.motion);
      Eigen::Matrix<double, 9, 9> P;
      for (int i = 0; i < 9; ++i)
        for (int j = 0; j < 9; ++j) P(i, j) = state.P(i, j);
      result.nees += e.dot(P.llt().solve(e));
      ++result.flights;
    }
  }
  result.nees /= static_cast<double>(result.flights);
  result.nis /= result.scalars;
  return result;
}

/// The mean of `flights` sums of `freedom` squares lies within the band of 95 %.
void expect_within_the_band(double mean, double freedom, std::size_t flights,
                            const std::string& what) {
  const double all = freedom * static_cast<double>(flights);
  const boost::math::chi_squared distribution(all);
  const double low = quantile(distribution, 0.025) / static_cast<double>(flights);
  const double high = quantile(distribution, 0.975) / static_cast<double>(flights);
  EXPECT_GE(mean, low) << what;
  EXPECT_LE(mean, high) << what;
}

void expect_consistent(const FlightSetup& setup, const std::string& what) {
  constexpr std::size_t kFlights = 500;
  const Consistency c = consistency(setup, kFlights);
  ::testing::Test::RecordProperty(what + " NEES", std::to_string(c.nees));
  ::testing::Test::RecordProperty(what + " NIS", std::to_string(c.nis));
  expect_within_the_band(c.nees, 9, c.flights, what + ": errors");
  expect_within_the_band(c.nis, 1, static_cast<std::size_t>(c.scalars), what + ": innovations");
}

/// The Mambo's sensors, with noise where its file states none.
Sensors noisy_mambo() {
  Sensors sensors = load_vehicle("mambo").sensors;
  sensors.flow->faults.noise.setConstant(0.02);
  sensors.barometer->faults.noise.setConstant(3);
  return sensors;
}

TEST(GeneralFilterFlights, KnowsHowWrongItIsByFlow) {
  if (testing::kSanitized) GTEST_SKIP() << "hundreds of flights, as FlyAll flies some";
  for (const char* mission : {"hover", "step-north"})
    expect_consistent(flight_of(noisy_mambo(), mission), std::string("flow, ") + mission);
}

TEST(GeneralFilterFlights, KnowsHowWrongItIsByGps) {
  if (testing::kSanitized) GTEST_SKIP() << "hundreds of flights, as FlyAll flies some";
  for (const char* mission : {"hover", "step-north"})
    expect_consistent(flight_of(load_vehicle("uquad").sensors, mission),
                      std::string("GPS, ") + mission);
}

TEST(GeneralFilterFlights, KnowsHowWrongItIsByImages) {
  if (testing::kSanitized) GTEST_SKIP() << "hundreds of flights, as FlyAll flies some";
  Sensors sensors;
  sensors.accelerometer = typical_sensors().accelerometer;
  sensors.gyroscope = typical_sensors().gyroscope;
  SensorFaults images;
  images.rate = 20;
  images.delay = 0.06;
  images.noise.setConstant(0.01);
  sensors.vision = images;
  for (const char* mission : {"hover", "step-north"})
    expect_consistent(flight_of(sensors, mission), std::string("images, ") + mission);
}

}  // namespace
}  // namespace quadtune
