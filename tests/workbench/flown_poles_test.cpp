// SPDX-License-Identifier: Apache-2.0
// The poles of the flown loop compared with the nonlinear simulation: the set point of a hover
// moves by a millimetre, and decays are fitted to the difference from a flight without this step.
#include <gmock/gmock.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <string>
#include <vector>

#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/design/lqi_report.hpp"
#include "quadtune/workbench/flown/flown_lqi.hpp"
#include "sanitized.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

/// A sensor without random errors: its clock, delay, response and scale are kept.
void quiet(SensorFaults& faults) {
  const SensorFaults before = faults;
  faults = SensorFaults();
  faults.rate = before.rate;
  faults.delay = before.delay;
  faults.scale = before.scale;
  faults.natural_frequency = before.natural_frequency;
  faults.damping = before.damping;
}

Sensors quiet(Sensors sensors) {
  for (std::optional<SensorFaults>* one :
       {&sensors.accelerometer, &sensors.gyroscope, &sensors.magnetometer, &sensors.vision})
    if (*one) quiet(**one);
  if (sensors.barometer) quiet(sensors.barometer->faults);
  if (sensors.sonar) quiet(sensors.sonar->faults);
  if (sensors.flow) {
    quiet(sensors.flow->faults);
    sensors.flow->noise_per_height = 0;
  }
  if (sensors.gps) {
    quiet(sensors.gps->position);
    sensors.gps->velocity_noise.setZero();
  }
  return sensors;
}

/// Time at which the set point moves; the filter has converged [s].
constexpr double kSettled = 60;

/// A hover in the air whose set point moves once, with noise-free sensors, and the filter that
/// belongs to noisy ones.
/// @param step  of a reference, e.g. "north_m = 0.001"
PlannedFlight quiet_hover(const Vehicle& vehicle, const Gains& gains, const std::string& step) {
  PlannedFlight plan = hover_under(vehicle, gains);
  FlightSetup& setup = plan.setup;
  setup.general_filter = general_filter_settings(setup);
  setup.flown = vehicle;
  setup.flown->sensors = quiet(vehicle.sensors);
  setup.mission = parse_mission(
      "name = 'step'\nduration_s = 72\n[start]\nat = 'air'\n"
      "height_m = 1.1\n[[references]]\nat_s = 0\nheight_m = 1.1\n"
      "[[references]]\nat_s = 60\n" +
          step + "\n",
      "step.toml");
  setup.log = true;
  return plan;
}

std::vector<double> flown(const PlannedFlight& plan, const char* state) {
  const FlightResult result = fly(plan.setup);
  EXPECT_EQ(result.end, FlightEnd::completed);
  return result.log.find(std::string("x.") + state)->values;
}

/// The share of a signal that is not a sum of e^(αst) over the poles s.
double unexplained(const VectorXd& signal, double step,
                   const std::vector<std::complex<double>>& poles, double alpha) {
  MatrixXd decays(signal.size(), 0);
  for (const std::complex<double>& pole : poles) {
    if (pole.imag() < 0) continue;  // its partner has both parts
    for (const bool sine : {false, true}) {
      if (sine && std::abs(pole.imag()) < 1e-9) continue;
      decays.conservativeResize(Eigen::NoChange, decays.cols() + 1);
      for (Index i = 0; i < signal.size(); ++i) {
        const std::complex<double> e = std::exp(alpha * pole * (step * static_cast<double>(i)));
        decays(i, decays.cols() - 1) = sine ? e.imag() : e.real();
      }
    }
  }
  const VectorXd shares = decays.colPivHouseholderQr().solve(signal);
  return (signal - decays * shares).norm() / signal.norm();
}

/// The factor on all poles with which they fit a signal best.
double best_factor(const VectorXd& signal, double step,
                   const std::vector<std::complex<double>>& poles) {
  double best = 0, min = std::numeric_limits<double>::infinity();
  for (int i = -300; i <= 300; ++i) {
    const double alpha = 1 + 0.0005 * i;
    const double rest = unexplained(signal, step, poles, alpha);
    if (rest >= min) continue;
    min = rest;
    best = alpha;
  }
  return best;
}

/// Of the loop of one group of axes [1/s].
std::vector<std::complex<double>> poles_of(const FlownPlant& plant, const DiscreteLti& law,
                                           FlownAxis axis) {
  const VectorXcd z = periodic_poles(closed(axis_loop(plant, axis, law)));
  std::vector<std::complex<double>> poles;
  for (const std::complex<double>& one : z)
    if (std::abs(one) > 1e-6) poles.push_back(std::log(one) / law.dt);
  return poles;
}

struct Disturbed {
  FlownAxis axis;
  const char* state;
  const char* step;  ///< of the reference
  double size;       ///< of the state
};

class FlownPoles : public ::testing::TestWithParam<const char*> {};

TEST_P(FlownPoles, AreWhatADisturbedHoverShows) {
  if (testing::kSanitized) GTEST_SKIP() << "minutes of what other tests run too";
  const Vehicle vehicle = load_vehicle(GetParam());
  const FlownLqi design = flown_lqi(vehicle);
  const Gains& gains = design.lqi.gains;
  const DiscreteLti law = flown_law(vehicle, gains, gains.dt);
  for (const Disturbed& one : {Disturbed{FlownAxis::north, "px", "north_m = 0.001", 1e-3},
                               Disturbed{FlownAxis::east, "py", "east_m = 0.001", 1e-3},
                               Disturbed{FlownAxis::altitude, "pz", "height_m = 1.101", -1e-3},
                               Disturbed{FlownAxis::yaw, "yaw", "yaw_rad = 0.001", 1e-3}}) {
    const PlannedFlight plan = quiet_hover(vehicle, gains, "height_m = 1.1");
    const PlannedFlight moved = quiet_hover(vehicle, gains, one.step);
    const std::vector<double> still = flown(plan, one.state), other = flown(moved, one.state);
    // From 0.5 s on: the fastest modes have decayed.
    const auto every = static_cast<std::size_t>(std::lround(0.1 / gains.dt));
    std::vector<double> difference;
    for (std::size_t i = static_cast<std::size_t>(std::lround((kSettled + 0.5) / gains.dt));
         i < std::min(still.size(), other.size()); i += every)
      difference.push_back(other[i] - still[i] - one.size);
    const VectorXd signal = Eigen::Map<const VectorXd>(difference.data(), std::ssize(difference));
    // The modes that are still visible after 0.5 s.
    std::vector<std::complex<double>> poles = poles_of(design.family.front().plant, law, one.axis);
    std::sort(poles.begin(), poles.end(),
              [](const auto& a, const auto& b) { return std::abs(a) < std::abs(b); });
    std::erase_if(poles, [](const auto& pole) { return std::abs(pole) > 12; });
    const double factor = best_factor(signal, 0.1, poles);
    EXPECT_NEAR(factor, 1, 0.01) << one.state;
    EXPECT_LT(unexplained(signal, 0.1, poles, 1), 0.01) << one.state;
  }
}

INSTANTIATE_TEST_SUITE_P(Vehicles, FlownPoles, ::testing::Values("mambo", "crazyflie"));

}  // namespace
}  // namespace quadtune
