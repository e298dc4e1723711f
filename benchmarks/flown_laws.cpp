// SPDX-License-Identifier: Apache-2.0
/// Number of flights that pass with the default designs of quadtune, and with common alternatives:
/// an LQR of the 12 textbook states, and the default gains of PX4 in the structure of PX4. The
/// vehicles, their sensors, the estimator, the missions and the seeds are the same. Prints a table
/// in Markdown, the source of the numbers in docs/benchmarks.md.
#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "quadtune/errors.hpp"
#include "quadtune/model/mixer.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/design/design.hpp"
#include "quadtune/workbench/design/near_hover.hpp"
#include "quadtune/workbench/design/standard_lqr.hpp"
#include "quadtune/workbench/flight/fly.hpp"

namespace quadtune {
namespace {

constexpr std::uint32_t kSeeds = 5;
const std::vector<std::string> kVehicles = {"mambo", "rolling-spider", "uquad", "crazyflie"};
const std::vector<std::string> kMissions = {
    "hover",       "take-off-and-land", "step-north", "step-east",
    "step-height", "step-yaw",          "waypoints",  "line",
    "circle",      "lemniscate",        "keys"};

/// The result of `control.lqr(A, B, Q, R)`: the continuous gain of 12 states, weights by Bryson's
/// rule.
/// @param bounded  with the bounds of the errors that quadtune adds to a state feedback
ChosenLaw textbook_lqr(const Vehicle& vehicle, bool bounded) {
  Gains gains = standard_gains(vehicle, "benchmark");
  if (bounded) keep_near_hover(vehicle, gains);
  return {feedback_controller(gains, kUsualPeriod), "LQR of 12 states"};
}

/// PX4's defaults (v1.15): rates P 0.15, I 0.2 and yaw 0.2, 0.1 on a torque from -1 to 1; angles P
/// 6.5 and yaw 2.8; velocity 1.8, 0.4, position 0.95; height 1, 4, 2. A torque of 1 is the torque
/// at the limit of PX4's normalized mixer. Two differences remain, because a cascade here has one
/// loop for angle and rate: the integral acts on the error of the angle instead of the rate, and
/// the derivative of the rate is omitted.
ChosenLaw px4_defaults(const Vehicle& vehicle) {
  double roll = 0, pitch = 0, yaw = 0;
  for (const Rotor& rotor : vehicle.rotors) {
    const double thrust = rotor_thrust(rotor, max_speed(vehicle));
    roll += std::numbers::sqrt2 / 2 * thrust * std::abs(rotor.position.y());
    pitch += std::numbers::sqrt2 / 2 * thrust * std::abs(rotor.position.x());
    yaw += rotor_torque(rotor, max_speed(vehicle));
  }
  const double g = vehicle.gravity, m = vehicle.mass;
  const auto loop = [](CascadeAxis axis, double Kp, double Ki, double Kd) {
    PidLoop pid = cascade_loop(axis);
    pid.Kp = Kp;
    pid.Ki = Ki;
    pid.Kd = Kd;
    return pid;
  };
  const double kp = 0.95 * 1.8 / g, ki = 0.95 * 0.4 / g, kd = 1.8 / g;
  CascadeGains gains;
  gains.dt = kUsualPeriod;
  // Signs as in CascadeDesign: north needs the nose down, the force of the height acts down.
  gains.loops = {loop(CascadeAxis::x, -kp, -ki, kd),
                 loop(CascadeAxis::y, kp, ki, -kd),
                 loop(CascadeAxis::pitch, 6.5 * 0.15 * pitch, 6.5 * 0.2 * pitch, -0.15 * pitch),
                 loop(CascadeAxis::roll, 6.5 * 0.15 * roll, 6.5 * 0.2 * roll, -0.15 * roll),
                 loop(CascadeAxis::yaw, 2.8 * 0.2 * yaw, 2.8 * 0.1 * yaw, -0.2 * yaw),
                 loop(CascadeAxis::altitude, 4 * m, 2 * m, -4 * m)};
  CascadeController controller{gains};
  controller.attitude_limit = kDesignedAttitudeLimit;
  controller.back_calculation = kDesignedBackCalculation;
  controller.conditional_integration = true;
  controller.velocity_feed_forward = true;
  return {controller, "PX4's defaults"};
}

ChosenLaw ours(const Vehicle& vehicle, const char* controller) {
  FlightOptions options;
  options.controller = controller;
  return choose_law(options, vehicle, "benchmark");
}

/// A matrix on 12 states and their integrals, optimized on the flown plants.
ChosenLaw matrix(const Vehicle& vehicle) {
  LqiDesign design;
  design.matrix = MatrixConvention{};
  return {feedback_controller(matrix_report(vehicle, design).gains, kUsualPeriod), "a matrix"};
}

struct Row {
  const char* name;
  std::function<ChosenLaw(const Vehicle&)> law;
};

int passed(const Vehicle& vehicle, const ChosenLaw& law) {
  int count = 0;
  for (const std::string& mission : kMissions)
    for (const FlownFlight& flight :
         fly_seeds(plan_flight({}, vehicle, load_mission(mission), law), kSeeds))
      count += flight.passed ? 1 : 0;
  return count;
}

/// Changes one parameter of the flown vehicle, so that it differs from the model of the law.
const std::vector<std::function<void(Vehicle&)>>& variations() {
  static const auto scale_lag = [](Vehicle& vehicle, double factor) {
    for (Rotor& rotor : vehicle.rotors) {
      rotor.lag *= factor;
      rotor.lag_down *= factor;
    }
  };
  static const std::vector<std::function<void(Vehicle&)>> all = {
      [](Vehicle& v) { v.mass *= 1.2, v.inertia *= 1.2; },
      [](Vehicle& v) { v.mass *= 0.8, v.inertia *= 0.8; },
      [](Vehicle& v) { scale_lag(v, 1.4); },
      [](Vehicle& v) { scale_lag(v, 0.6); },
      [](Vehicle& v) { v.sensors.gyroscope->delay += 0.005; },
      [](Vehicle& v) { v.rotors[0].thrust_a2 *= 0.9, v.rotors[0].thrust_a1 *= 0.9; }};
  return all;
}

int passed_with_variations(const Vehicle& vehicle, const ChosenLaw& law) {
  int count = 0;
  for (const char* mission : {"hover", "step-north", "take-off-and-land"}) {
    PlannedFlight plan = plan_flight({}, vehicle, load_mission(mission), law);
    for (const auto& change : variations()) {
      plan.setup.flown = vehicle;
      change(*plan.setup.flown);
      for (const FlownFlight& flight : fly_seeds(plan, kSeeds)) count += flight.passed ? 1 : 0;
    }
  }
  return count;
}

using Count = int (*)(const Vehicle&, const ChosenLaw&);

void print_table(const std::string& head, const std::vector<Row>& rows, Count count) {
  fmt::print("\n| {} |", head);
  for (const std::string& vehicle : kVehicles) fmt::print(" {} |", vehicle);
  fmt::print("\n|---|");
  for (std::size_t i = 0; i < kVehicles.size(); ++i) fmt::print("---|");
  for (const Row& row : rows) {
    fmt::print("\n| {} |", row.name);
    for (const std::string& name : kVehicles) {
      const Vehicle vehicle = load_vehicle(name);
      fmt::print(" {} |", count(vehicle, row.law(vehicle)));
      std::fflush(stdout);
    }
  }
  fmt::print("\n");
}

int run() {
  const std::vector<Row> rows = {
      {"quadtune, cascade", [](const Vehicle& v) { return ours(v, kCascadedPid); }},
      {"quadtune, state feedback", [](const Vehicle& v) { return ours(v, kStateFeedback); }},
      {"quadtune, a matrix of 12 states", matrix},
      {"LQR of 12 states, as `control.lqr`",
       [](const Vehicle& v) { return textbook_lqr(v, false); }},
      {"the same with bounded errors", [](const Vehicle& v) { return textbook_lqr(v, true); }},
      {"PX4's structure and defaults", px4_defaults},
  };
  print_table(fmt::format("flights that pass, of {}", kMissions.size() * kSeeds), rows, passed);
  print_table(fmt::format("flights of a vehicle that differs from its model that pass, of {}",
                          3 * variations().size() * kSeeds),
              rows, passed_with_variations);
  return 0;
}

}  // namespace
}  // namespace quadtune

int main() {
  try {
    return quadtune::run();
  } catch (const std::exception& error) {
    fmt::print(stderr, "flown_laws: {}\n", error.what());
    return 1;
  }
}
