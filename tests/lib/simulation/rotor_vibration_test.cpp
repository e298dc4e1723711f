// SPDX-License-Identifier: Apache-2.0
#include "simulation/loop/rotor_vibration.hpp"

#include <gmock/gmock.h>

#include <Eigen/QR>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "quadtune/simulation/flight.hpp"

namespace quadtune {
namespace {

using Eigen::Vector3d;
using internal::RotorPhases;
using internal::RotorVibration;
using P = Pack<1>;

// A |H| w² with H of the second-order response.
TEST(RotorVibration, HasItsClosedForm) {
  SensorFaults faults;
  faults.natural_frequency = 190;
  faults.damping = 0.6;
  faults.vibration = {1e-6, 2e-6, 3e-6};
  const RotorVibration<1> shake({faults});
  ASSERT_TRUE(shake.present());
  const double w = 700, angle = 0.4;
  RotorPhases<1>::Angles angles{};
  angles[0] = P(angle);
  const Vector3<P> at = shake.at(angles, RotorSpeeds<P>::Constant(1, P(w)));
  const std::complex<double> s(0, w);
  const double gain = std::abs(190.0 * 190 / (s * s + 2 * 0.6 * 190 * s + 190.0 * 190));
  EXPECT_NEAR(lane(at(0), 0), 1e-6 * gain * w * w * std::cos(angle), 1e-12);
  EXPECT_NEAR(lane(at(1), 0), 2e-6 * gain * w * w * std::sin(angle), 1e-12);
  EXPECT_NEAR(lane(at(2), 0), 3e-6 * gain * w * w * std::sin(angle), 1e-12);
  EXPECT_FALSE(RotorVibration<1>({SensorFaults{}}).present());
}

TEST(RotorVibration, PhasesAreTheIntegralOfTheSpeed) {
  RotorPhases<1> phases;
  EXPECT_FALSE(phases.present());
  phases.start(1, {5, {2}}, 80);
  EXPECT_TRUE(phases.present());
  const auto speeds = [](double w) { return RotorSpeeds<P>::Constant(1, P(w)); };
  const double start = lane(phases.at(speeds(0), 0)[0], 0);
  double angle = start, w = 200;
  for (int k = 0; k < 50; ++k) {  // 200 rad/s and 1000 rad/s² more
    phases.keep(speeds(w));
    const double inside = angle + 0.002 * (w + 1);
    EXPECT_NEAR(
        std::remainder(lane(phases.at(speeds(w + 2), 0.002)[0], 0) - inside, 2 * std::numbers::pi),
        0, 1e-9);
    angle += 0.005 * (w + 2.5);
    w += 5;
    phases.advance(speeds(w), 0.005);
  }
  EXPECT_NEAR(angle - start, 200 * 0.25 + 0.5 * 1000 * 0.25 * 0.25, 1e-9);
}

// A motor at an even speed on the ground: the accelerometer's samples are a sinusoid at the rotor's
// frequency, seen through a clock of 200 Hz that is too slow for it.
TEST(RotorVibration, IsFoldedByTheSampleClock) {
  FlightSetup setup;
  setup.vehicle = load_vehicle("mambo");
  setup.controller = CascadeController{setup.vehicle.published_cascade->gains};
  setup.mission = parse_mission(
      "name = \"one\"\nduration_s = 3\n[[motors]]\nat_s = 0.1\nfor_s = 2.8\nmotors = [2]\n"
      "share = 0\n",
      "one.toml");
  setup.log = true;
  const double w = std::sqrt(13840.8 * 10), amplitude = 2e-6;
  ASSERT_GT(w / (2 * std::numbers::pi), 100 / 2);  // beyond a tenth of what 200 Hz can show
  for (const bool gyroscope : {false, true}) {
    setup.vehicle.sensors = {};
    SensorFaults faults;
    faults.rate = 20;  // far too slow: 59 Hz appear at 0.8 Hz
    faults.vibration = {amplitude, 0, 0};
    setup.vehicle.sensors.accelerometer = setup.vehicle.sensors.gyroscope = faults;
    (gyroscope ? setup.vehicle.sensors.accelerometer : setup.vehicle.sensors.gyroscope)
        ->vibration.setZero();
    setup.estimator = EstimatorKind::truth;
    const FlightResult result = fly(setup);
    const std::vector<double>& x =
        result.log.find(gyroscope ? "gyroscope.x" : "accelerometer.x")->values;
    const std::vector<double>& t = result.log.find("t")->values;
    std::vector<std::size_t> rows;
    for (std::size_t k = 0; k < t.size(); ++k)
      if (std::isfinite(x[k]) && t[k] > 0.2 && t[k] < 2.8) rows.push_back(k);
    ASSERT_GT(rows.size(), 40u);
    Eigen::MatrixXd M(rows.size(), 3);
    Eigen::VectorXd y(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      M.row(row) << std::cos(w * t[rows[i]]), std::sin(w * t[rows[i]]), 1;  // and what it leans
      y(row) = x[rows[i]];
    }
    const Eigen::VectorXd c = M.colPivHouseholderQr().solve(y);
    EXPECT_NEAR(c.head<2>().norm(), amplitude * w * w, 0.01 * amplitude * w * w) << gyroscope;
    EXPECT_LT((M * c - y).norm(), 0.02 * y.norm()) << gyroscope;
  }
}

// At rest the accelerometer feels -g along z, and the gyroscope shows that times its sensitivity.
TEST(RotorVibration, GyroscopesShowSpecificForce) {
  FlightSetup setup;
  setup.vehicle = load_vehicle("mambo");
  setup.controller = CascadeController{setup.vehicle.published_cascade->gains};
  setup.mission = load_mission("motor-test");
  setup.duration = 0.5;
  setup.estimator = EstimatorKind::truth;
  setup.log = true;
  SensorFaults faults;
  faults.rate = 200;
  setup.vehicle.sensors.gyroscope = faults;
  setup.vehicle.sensors.g_sensitivity = {1e-3, 2e-3, -3e-3};
  const FlightResult result = fly(setup);
  EXPECT_NEAR(result.log.find("gyroscope.x")->values[50], 0, 1e-9);
  EXPECT_NEAR(result.log.find("gyroscope.z")->values[50], 3e-3 * 9.81, 1e-6);
  setup.real_sensors = false;
  EXPECT_NEAR(fly(setup).log.find("gyroscope.z")->values[50], 0, 1e-9);
}

}  // namespace
}  // namespace quadtune
