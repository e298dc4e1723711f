// SPDX-License-Identifier: Apache-2.0
// The experiments of the Mambo thesis, flown again: what theory predicts, what comes out, and
// docs/experiments.md with both beside the thesis's own figures.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "golden.hpp"
#include "quadtune/control/cascaded_pid.hpp"
#include "quadtune/simulation/carried_motion.hpp"
#include "quadtune/simulation/flight.hpp"

namespace quadtune {
namespace {

using testing::matches_document;

constexpr double kPeriod = 0.005;        // of control [s]
constexpr double kFactor = 1.15;         // of the thesis's estimator
constexpr double kCarriedHeight = 0.6;   // [m]

enum class Estimator { original, calibrated, raw };

// What `quadtune compare` flies where nothing else is said.
FlightSetup mambo(const char* mission, Estimator estimator) {
  FlightSetup setup;
  setup.vehicle = load_vehicle("mambo");
  setup.mission = load_mission(mission);
  setup.controller = CascadeController{setup.vehicle.published_cascade->gains};
  setup.real_sensors = false;
  setup.log = true;
  if (estimator != Estimator::original) calibrate_flow(setup);
  if (estimator == Estimator::raw) setup.mambo_estimator.position = MamboPosition::flow_velocity;
  return setup;
}

// As `quadtune pid mambo` designs it, rounded.
CascadeController designed() {
  CascadeController controller{load_vehicle("mambo").published_cascade->gains};
  for (PidLoop& loop : controller.gains.loops) {
    const auto set = [&](const char* name, double Kp, double Ki, double Kd) {
      if (loop.name != name) return;
      loop.Kp = Kp;
      loop.Ki = Ki;
      loop.Kd = Kd;
    };
    set("roll", 0.01078, 0.02777, -0.001508);
    set("pitch", 0.01324, 0.03435, -0.001623);
    set("yaw", 0.004025, 0.004904, -0.001079);
    set("altitude", 0.8048, 0.5537, -0.3858);
    set("y", 0.1834, 0.03979, -0.1684);
    set("x", -0.2237, -0.05286, 0.1841);
  }
  controller.back_calculation = 2;
  return controller;
}

const std::vector<double>& column(const FlightResult& flight, const char* name) {
  return flight.log.find(name)->values;
}

double mean_square(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return sum / static_cast<double>(values.size());
}

// --- Euler against Tustin ---

constexpr std::array<const char*, 3> kCommands = {"command.T", "command.tau_x", "command.tau_y"};
constexpr std::array<CascadeAxis, 3> kAxes = {CascadeAxis::altitude, CascadeAxis::roll,
                                              CascadeAxis::pitch};

struct Methods {
  std::array<double, 3> flown{};      // mean squared difference of two flights [N², (N m)²]
  std::array<double, 3> predicted{};  // (Ki Ts/2)² times the mean square of the error
  std::array<double, 3> error{};      // its root [m, rad, rad]
  double law_differs = 0;  // greatest share by which two laws on one flight differ from Ki Ts e/2
};

// The law of a flight once more, over what it saw.
struct Replay {
  Replay(const FlightSetup& setup, PidMethod method) {
    const auto& c = std::get<CascadeController>(setup.controller);
    settings = cascaded_pid_settings(setup.vehicle, c.gains, method, c.attitude_limit,
                                     c.integrator_limit, c.back_calculation);
  }
  Eigen::Vector4d at(const FlightResult& flight, std::size_t row) {
    static constexpr std::array<const char*, 12> kEstimate = {
        "estimate.px", "estimate.py", "estimate.pz", "estimate.roll", "estimate.pitch",
        "estimate.yaw", "estimate.u", "estimate.v", "estimate.w", "estimate.p", "estimate.q",
        "estimate.r"};
    Estimate<double> estimate;
    for (int i = 0; i < 12; ++i)
      estimate.x(i) = column(flight, kEstimate[static_cast<std::size_t>(i)])[row];
    Reference<double> reference;
    reference.position = {column(flight, "reference.px")[row], column(flight, "reference.py")[row],
                          column(flight, "reference.pz")[row]};
    reference.yaw = column(flight, "reference.yaw")[row];
    reference.phase = static_cast<FlightPhase>(column(flight, "reference.phase")[row]);
    return step(settings, state, estimate, reference);
  }
  CascadedPidSettings<double> settings;
  CascadedPidState<double> state;
};

Methods methods(FlightSetup setup) {
  auto& law = std::get<CascadeController>(setup.controller);
  law.method = PidMethod::forward_euler;
  const FlightResult euler = fly(setup);
  law.method = PidMethod::tustin;
  const FlightResult tustin = fly(setup);
  Methods result;
  const std::size_t rows = std::min(euler.log.rows(), tustin.log.rows());
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < rows; ++k)
      result.flown[i] +=
          std::pow(column(euler, kCommands[i])[k] - column(tustin, kCommands[i])[k], 2) /
          static_cast<double>(rows);
  Replay by_euler(setup, PidMethod::forward_euler), by_tustin(setup, PidMethod::tustin);
  std::array<double, 3> Ki{};
  for (std::size_t i = 0; i < 3; ++i) Ki[i] = by_euler.settings.loops[index_of(kAxes[i])].Ki;
  for (std::size_t k = 0; k < rows; ++k) {
    const auto phase = static_cast<FlightPhase>(column(euler, "reference.phase")[k]);
    if (phase != FlightPhase::flying && phase != FlightPhase::take_off) continue;
    const Eigen::Vector4d a = by_euler.at(euler, k), b = by_tustin.at(euler, k);
    const std::array<double, 3> e = {
        phase == FlightPhase::flying
            ? column(euler, "reference.pz")[k] - column(euler, "estimate.pz")[k]
            : 0,
        by_euler.state.roll_reference - column(euler, "estimate.roll")[k],
        by_euler.state.pitch_reference - column(euler, "estimate.pitch")[k]};
    const std::array<double, 3> difference = {a(0) - b(0), b(1) - a(1), b(2) - a(2)};
    for (std::size_t i = 0; i < 3; ++i) {
      result.error[i] += e[i] * e[i] / static_cast<double>(rows);
      const double expected = Ki[i] * kPeriod * e[i] / 2;
      if (std::abs(expected) > 1e-10)
        result.law_differs =
            std::max(result.law_differs, std::abs(difference[i] / expected - 1));
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    result.predicted[i] = std::pow(Ki[i] * kPeriod / 2, 2) * result.error[i];
    result.error[i] = std::sqrt(result.error[i]);
  }
  return result;
}

TEST(Experiments, Explore) {
  {
    FlightSetup setup = mambo("hover", Estimator::calibrated);
    const Methods ideal = methods(setup);
    setup.controller = designed();
    setup.real_sensors = true;
    calibrate_flow(setup);
    const Methods real = methods(setup);
    for (const Methods& m : {ideal, real}) {
      fmt::print("law differs {}\n", m.law_differs);
      for (std::size_t i = 0; i < 3; ++i)
        fmt::print("{} flown {:.3e} predicted {:.3e} error {:.3e}\n", kCommands[i], m.flown[i],
                   m.predicted[i], m.error[i]);
    }
  }
  for (const bool real : {false, true})
    for (const bool design : {false, true})
      for (const Estimator estimator : {Estimator::original, Estimator::calibrated})
        for (const FlowModel flow : {FlowModel::simplified, FlowModel::full}) {
          FlightSetup setup = mambo("hover", estimator);
          setup.flow = flow;
          setup.real_sensors = real;
          if (estimator == Estimator::calibrated) calibrate_flow(setup);
          if (design) setup.controller = designed();
          const FlightResult r = fly(setup);
          double tau = 0;
          const auto& t = column(r, "t");
          const auto& y = column(r, "command.tau_y");
          for (std::size_t k = 0; k < t.size(); ++k)
            if (t[k] > 80) tau = std::max(tau, std::abs(y[k]));
          fmt::print("hover real {} designed {} est {} flow {}: {} {:.2f} s, drift {:.3g} greatest {:.3g} rms {:.3g} tracking {:.3g} tau_y>80 {:.3g}\n",
                     real, design, static_cast<int>(estimator), to_string(flow), to_string(r.end), r.end_time,
                     r.metrics[Metric::position_drift], r.metrics[Metric::estimate_max],
                     r.metrics[Metric::estimate_rms], r.metrics[Metric::tracking_rms], tau);
        }
  for (const bool real : {false, true})
    for (const double rate : {60.0, 200.0})
      for (const Estimator estimator : {Estimator::original, Estimator::calibrated, Estimator::raw})
        for (const FlowModel flow : {FlowModel::simplified, FlowModel::full}) {
          FlightSetup setup = mambo("lemniscate-carried", estimator);
          setup.flow = flow;
          setup.flow_rate = rate;
          setup.real_sensors = real;
          if (estimator != Estimator::original) calibrate_flow(setup);
          const FlightResult r = fly(setup);
          double mean = 0, reach = 0;
          const auto &px = column(r, "x.px"), &py = column(r, "x.py"), &ex = column(r, "estimate.px"), &ey = column(r, "estimate.py");
          for (std::size_t k = 0; k < px.size(); ++k) {
            mean += std::hypot(ex[k] - px[k], ey[k] - py[k]) / static_cast<double>(px.size());
            reach += std::hypot(px[k] - px[0], py[k] - py[0]) / static_cast<double>(px.size());
          }
          const auto minimum = [&](const std::vector<double>& x) {
            for (std::size_t k = 450; k + 1 < x.size(); ++k)
              if (x[k] < x[k - 1] && x[k] <= x[k + 1] && x[k] < x[k-40] && x[k] < x[k+40]) return std::pair(column(r, "t")[k], x[k]);
            return std::pair(0.0, 0.0);
          };
          fmt::print("arm real {} rate {} est {} flow {}: mean {:.4g} max {:.4g} of reach {:.4g}; min true {:.3f} s {:.4f} believed {:.3f} s {:.4f}\n", real, rate,
                     static_cast<int>(estimator), to_string(flow), mean, r.metrics[Metric::estimate_max], reach, minimum(px).first, minimum(px).second, minimum(ex).first, minimum(ex).second);
        }
}

}  // namespace
}  // namespace quadtune
