// SPDX-License-Identifier: Apache-2.0
/// PID gains, of a transfer function, from the limit of stability, or of a vehicle's cascade.
#include "quadtune/control/pid.hpp"

#include <fmt/format.h>

#include "controllers.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/synthesis/pid/ultimate_rules.hpp"
#include "quadtune/workbench/design/vehicle_cascade.hpp"
#include "quadtune/workbench/systems/pid_report.hpp"
#include "report/loops/loops.hpp"
#include "report/loops/matrix_loops.hpp"
#include "report/text/print.hpp"
#include "support/arguments.hpp"
#include "support/interrupts.hpp"
#include "support/real.hpp"
#include "support/results.hpp"
#include "support/topics.hpp"

namespace quadtune::python {
namespace {

namespace py = pybind11;
using namespace py::literals;
using Number = std::optional<double>;

/// The sample period of a controller that a program runs.
struct Sampling {
  double dt = 0;  ///< [s]; 0: none was asked for
  PidMethod method = PidMethod::tustin;
};

/// @throws OptionError  for an integrator without period
Sampling sampling_of(const std::optional<Real>& dt, const std::optional<std::string>& integrator) {
  if (dt) require_positive(*dt, "dt", "seconds");
  if (integrator && !dt)
    throw OptionError("integrator", "integrator came without dt, expected both");
  return {dt.value_or(0), integrator_method(integrator.value_or("tustin"))};
}

DiscreteTransferFunction discrete(const PidGains& gains, const Sampling& sampling) {
  return pid_transfer_function(pid_settings(gains, sampling.dt, sampling.method),
                               PidChannel::error);
}

/// Gains for a transfer function.
struct PidOfPlant {
  PidReport report;
  Sampling sampling;

  [[nodiscard]] const PidGains& gains() const { return report.gains; }
  [[nodiscard]] internal::Json json() const {
    internal::Json all = report::to_json(report);
    if (sampling.dt > 0)
      all["discrete"] = report::discrete_pid_json(gains(), sampling.dt, sampling.method);
    return all;
  }
  [[nodiscard]] std::string text() const { return report::to_text(report); }
};

/// Gains without a plant.
struct PidAlone {
  PidGains numbers;
  std::string how;
  Sampling sampling;

  [[nodiscard]] const PidGains& gains() const { return numbers; }
  [[nodiscard]] internal::Json json() const {
    internal::Json all = {{"Kp", numbers.Kp},
                          {"Ki", numbers.Ki},
                          {"Kd", numbers.Kd},
                          {"Tf", numbers.Tf},
                          {"how", how}};
    if (sampling.dt > 0)
      all["discrete"] = report::discrete_pid_json(numbers, sampling.dt, sampling.method);
    return all;
  }
  [[nodiscard]] std::string text() const {
    using report::number;
    return report::section(
               "gains", fmt::format("Kp {}  Ki {} 1/s  Kd {} s  Tf {} s", number(numbers.Kp),
                                    number(numbers.Ki), number(numbers.Kd), number(numbers.Tf))) +
           report::section("by", how);
  }
};

PidOfPlant of_fraction(const Numbers& num, const Numbers& den, Real delay, const std::string& type,
                       std::optional<Real> crossover, std::optional<Real> phase_margin,
                       std::optional<Real> Tf, const std::optional<std::string>& rule,
                       std::optional<Real> tau_c, std::optional<Real> Ms_max,
                       std::optional<Real> Mt_max, std::optional<Real> noise_gain_max,
                       std::optional<Real> dt, const std::optional<std::string>& integrator) {
  require_not_negative(delay, "delay");
  require_not_negative(Tf.value_or(0), "Tf");
  const bool bounds = Ms_max || Mt_max || noise_gain_max;
  const bool requirement = crossover || phase_margin;
  if (int{requirement} + int{rule.has_value()} + int{bounds} != 1)
    throw OptionError(
        "crossover",
        "expected crossover and phase_margin, or rule, or at least one of Ms_max, Mt_max and "
        "noise_gain_max");
  if (requirement && !(crossover && phase_margin))
    throw OptionError(crossover ? "phase_margin" : "crossover",
                      "crossover and phase_margin belong together, expected both");
  if (rule && Tf)
    throw OptionError("Tf", "Tf came with rule, expected none because a rule has its own filter");
  const Sampling sampling = sampling_of(dt, integrator);
  PidRequest request;
  request.type = pid_type(type);
  request.Tf = Tf.value_or(0);
  if (crossover) {
    request.by = PidCrossover{*crossover, *phase_margin};
  } else if (rule) {
    request.by = PidRule{*rule, tau_c};
  } else {
    PidBounds within;
    within.Ms_max = Ms_max.value_or(within.Ms_max);
    within.Mt_max = Mt_max.value_or(within.Mt_max);
    within.noise_gain_max = noise_gain_max.value_or(within.noise_gain_max);
    request.by = within;
  }
  const ContinuousTransferFunction plant{num.values, den.values, delay};
  validate(plant, "num, den");
  PidReport report = long_call([&](const Stop&) { return pid_report(plant, request); });
  if (report.needs_filter)
    throw OptionError("Tf", "the derivative of this plant has no bound, expected a filter with Tf");
  if (sampling.dt > 0) (void)pid_settings(report.gains, sampling.dt, sampling.method);
  return {std::move(report), sampling};
}

/// Gains from the limit of stability.
PidAlone of_limit(Real Ku, Real Tu, const std::string& rule, const std::string& type,
                  std::optional<Real> dt, const std::optional<std::string>& integrator) {
  require_positive(Tu, "Tu", "seconds");
  const Sampling sampling = sampling_of(dt, integrator);
  const PidType kind = pid_type(type);
  try {
    const PidGains gains = ultimate_rule(rule, kind, Ku, Tu);
    if (sampling.dt > 0) (void)pid_settings(gains, sampling.dt, sampling.method);
    return {gains,
            fmt::format("{} by {} for an ultimate gain of {} and a period of {} s", type, rule,
                        report::number(Ku), report::number(Tu)),
            sampling};
  } catch (const InvalidInput& error) {
    throw OptionError("rule", "rule: " + error.message());
  }
}

PidAlone of_gains(const Numbers& gains, Real dt, const std::optional<std::string>& integrator) {
  const Sampling sampling = sampling_of(dt, integrator);
  const PidGains given = pid_gains_of(gains, "gains");
  (void)pid_settings(given, sampling.dt, sampling.method);
  return {given, "given", sampling};
}

VehicleCascade of_vehicle(const VehicleWord& word, const std::string& method,
                          const std::string& plant, Number dt,
                          const std::optional<std::string>& structure, Number Ms_max,
                          const std::optional<ByLoop>& bandwidth,
                          const std::optional<ByLoop>& sensor_delay, Number motor_lag,
                          Number tracking_max, const std::optional<Names>& integral,
                          const std::optional<std::string>& integrator, bool free,
                          const std::optional<std::string>& for_firmware,
                          const std::string& firmware, const std::string& setup, Number rate_lead) {
  const auto text = [](const std::optional<ByLoop>& by_loop) {
    return by_loop ? std::optional(by_loop->text) : std::nullopt;
  };
  CascadeOptions options;
  options.method = method;
  options.plant = plant;
  options.dt = dt;
  options.structure = structure;
  options.Ms_max = Ms_max;
  options.bandwidth = text(bandwidth);
  options.sensor_delay = text(sensor_delay);
  options.motor_lag = motor_lag;
  options.tracking_max = tracking_max;
  if (integral) options.integral = integral->list.empty() ? "none" : integral->joined();
  options.integrator = integrator;
  if (free) options.use_published = false;
  options.for_firmware = for_firmware;
  options.firmware.version = firmware;
  options.firmware.setup = setup;
  options.rate_lead = rate_lead;
  return long_call(
      [&](const Stop&) { return vehicle_cascade(load_vehicle(word.text), options, word.text); });
}

/// What gains with and without a plant have.
template <class Result>
void add_gains(py::class_<Result>& type) {
  const auto gain = [&](const char* name, double PidGains::*member, const char* doc) {
    type.def_property_readonly(
        name, [member](const Result& self) { return self.gains().*member; }, doc);
  };
  gain("Kp", &PidGains::Kp, "Proportional gain.");
  gain("Ki", &PidGains::Ki, "Integral gain [1/s].");
  gain("Kd", &PidGains::Kd, "Derivative gain [s].");
  gain("Tf", &PidGains::Tf, "Time constant of the filter of the derivative [s]; 0 for none.");
  const auto coefficients = [&](const char* name, Eigen::VectorXd DiscreteTransferFunction::*member,
                                const char* doc) {
    type.def_property_readonly(
        name,
        [member](const Result& self) -> std::optional<Eigen::VectorXd> {
          if (!(self.sampling.dt > 0)) return std::nullopt;
          return discrete(self.gains(), self.sampling).*member;
        },
        doc);
  };
  coefficients("num", &DiscreteTransferFunction::num,
               "Of the discrete controller, descending powers of z; None without dt.");
  coefficients("den", &DiscreteTransferFunction::den,
               "Of the discrete controller, descending powers of z; None without dt.");
  type.def_property_readonly(
          "dt", [](const Result& self) { return self.sampling.dt; },
          "Sample period of the discrete controller [s]; 0 without one.")
      .def_property_readonly(
          "controller",
          [](const Result& self) { return controller_of(self.gains(), self.sampling.method); },
          "The same as a Controller, for margins().");
  add_report(
      type, "quadtune pid", [](const Result& self) { return self.json(); },
      [](const Result& self) {
        return self.text() + (self.sampling.dt > 0
                                  ? report::section("discrete", report::discrete_pid_text(
                                                                    self.gains(), self.sampling.dt,
                                                                    self.sampling.method))
                                  : "");
      });
}

void add_transfer_function(py::module_& module) {
  py::class_<PidOfPlant> type(module, "Pid", "PID gains for a transfer function.");
  add_gains(type);
  type.def_property_readonly(
          "type", [](const PidOfPlant& self) { return to_string(self.report.type); },
          "\"P\", \"PI\", \"PD\" or \"PID\".")
      .def_property_readonly(
          "how", [](const PidOfPlant& self) { return self.report.how; },
          "How the gains were computed, in words.")
      .def_property_readonly(
          "margins",
          [](const PidOfPlant& self) -> const MarginsReport& { return self.report.margins; },
          py::return_value_policy::reference_internal, "Of the continuous loop.");
  py::class_<PidAlone> alone(module, "PidAlone", "PID gains without a plant.");
  add_gains(alone);
  alone.def_readonly("how", &PidAlone::how, "How the gains were computed, in words.");
  module.def(
      "pid", &of_fraction, py::kw_only(), "num"_a, "den"_a, "delay"_a = 0.0, "type"_a = "PID",
      "crossover"_a = py::none(), "phase_margin"_a = py::none(), "Tf"_a = py::none(),
      "rule"_a = py::none(), "tau_c"_a = py::none(), "Ms_max"_a = py::none(),
      "Mt_max"_a = py::none(), "noise_gain_max"_a = py::none(), "dt"_a = py::none(),
      "integrator"_a = py::none(),
      "PID gains for a transfer function, in one of three ways.\n\n"
      "num, den: coefficients in descending powers of s; delay >= 0 [s]. crossover > 0 [rad/s]\n"
      "with phase_margin, more than 0 and less than 180 [deg]; or rule \"amigo\", \"simc\",\n"
      "\"ziegler-nichols\", \"cohen-coon\" or \"lambda\" with tau_c > 0 [s] of the closed\n"
      "loop; or the largest integral gain with max |S| up to Ms_max > 1 and, if\n"
      "given, Mt_max and noise_gain_max. type: \"P\", \"PI\", \"PD\" or \"PID\". Tf >= 0 [s] of "
      "the\n"
      "filter of the derivative, unless a rule has its own. dt > 0 [s]: also discretize the\n"
      "gains by integrator, \"euler\", \"backward-euler\" or \"tustin\" (default). Raises\n"
      "NoSolution with the cause, InvalidInput for a wrong argument.");
  module.def(
      "pid", &of_limit, py::kw_only(), "Ku"_a, "Tu"_a, "rule"_a = "ziegler-nichols",
      "type"_a = "PID", "dt"_a = py::none(), "integrator"_a = py::none(),
      "PID gains from the limit of stability, without a plant.\n\n"
      "Ku: the gain, not 0, at which a proportional loop oscillates; Tu > 0: the period of\n"
      "that oscillation [s]. rule: \"ziegler-nichols\", \"pessen\", \"some-overshoot\",\n"
      "\"no-overshoot\" or \"tyreus-luyben\". type, dt and integrator as for a transfer\n"
      "function. Raises InvalidInput for a wrong argument, and for a rule that does not have\n"
      "the type.");
  module.def(
      "pid", &of_gains, py::kw_only(), "gains"_a, "dt"_a, "integrator"_a = py::none(),
      "Discretize given PID gains.\n\n"
      "gains: Kp, Ki [1/s], Kd [s] and Tf >= 0 [s], the last of which may be omitted. dt > 0\n"
      "[s] and integrator as for a transfer function. Raises InvalidInput for a wrong\n"
      "argument, and where the integrator makes the filter unstable.");
}

void add_cascade(py::module_& module) {
  py::class_<VehicleCascade> type(module, "Cascade",
                                  "The PID cascade of a vehicle, with the evidence of its loops.");
  type.def_property_readonly(
          "loops", [](const VehicleCascade& cascade) { return cascade.report.cascade.gains.loops; },
          "PidLoop of x, y, pitch, roll, yaw and altitude.")
      .def_property_readonly(
          "dt", [](const VehicleCascade& cascade) { return cascade.report.cascade.gains.dt; },
          "Sample period [s].")
      .def_property_readonly(
          "poles",
          [](const VehicleCascade& cascade) -> const Eigen::VectorXcd& {
            return cascade.report.cascade.poles;
          },
          py::return_value_policy::reference_internal, "Of all loops closed, on the ideal plant.")
      .def_property_readonly(
          "margins",
          [](const VehicleCascade& cascade) -> const MarginsReport& {
            return cascade.report.margins;
          },
          py::return_value_policy::reference_internal, "Of all loops, cut at the wrench.")
      .def_readonly("flown", &VehicleCascade::loop,
                    "FlownLoop about a hover, or None where it is not analysed.")
      .def_property_readonly("messages", &notes_of, "\"note: ...\" and \"warning: ...\".");
  add_report(
      type, "quadtune pid V",
      [](const VehicleCascade& cascade) { return report::to_json(cascade); },
      [](const VehicleCascade& cascade) { return report::to_text(cascade); });
  module.def(
      "pid", &of_vehicle, "vehicle"_a, py::kw_only(), "method"_a = "", "plant"_a = "",
      "dt"_a = py::none(), "structure"_a = py::none(), "Ms_max"_a = py::none(),
      "bandwidth"_a = py::none(), "sensor_delay"_a = py::none(), "motor_lag"_a = py::none(),
      "tracking_max"_a = py::none(), "integral"_a = py::none(), "integrator"_a = py::none(),
      "free"_a = false, "for_firmware"_a = py::none(), "firmware"_a = "", "setup"_a = "",
      "rate_lead"_a = py::none(), py::prepend(),
      "PID gains for a vehicle's cascade.\n\n"
      "method: \"flown\" (all gains at once on the flown plant) or \"loops\". plant: \"flown\"\n"
      "or \"ideal\", the textbook plant. dt > 0: control period [s], by default that of the\n"
      "published gains, or 0.005. structure: \"pid\" or \"p-pi\". Ms_max > 1: bound on max\n"
      "|S|. bandwidth > 0 [rad/s] and sensor_delay >= 0 [s]: a number for all loops, or a dict\n"
      "by loop. motor_lag >= 0: time constant [s], by default that of the vehicle.\n"
      "tracking_max > 1: bound on max |value / set point|. integral: loops that have one, by\n"
      "default all. integrator: \"euler\" (default), \"backward-euler\" or \"tustin\". free:\n"
      "without the bounds of the published gains. for_firmware: \"px4\", \"ardupilot\",\n"
      "\"betaflight\" or \"crazyflie\", whose loops must have margins as well, with its version\n"
      "firmware and, for a Crazyflie, its setup. rate_lead >= 0: lead of the rate in the roll\n"
      "and pitch loops [s], by default half the motor lag for PX4 and ArduPilot, otherwise 0.\n"
      "Raises NoSolution with the loop that cannot be had, InvalidInput for a wrong argument,\n"
      "FileError if the vehicle's file cannot be read.");
}

}  // namespace

void add_pid(py::module_& module) {
  add_transfer_function(module);
  add_cascade(module);
}

}  // namespace quadtune::python
