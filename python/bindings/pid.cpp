// SPDX-License-Identifier: Apache-2.0
/// PID gains, of a transfer function or of a vehicle's cascade.
#include <fmt/format.h>

#include "arguments.hpp"
#include "interrupts.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/design/pid_report.hpp"
#include "quadtune/workbench/design/vehicle_cascade.hpp"
#include "real.hpp"
#include "report/loops/loops.hpp"
#include "results.hpp"
#include "topics.hpp"

namespace quadtune::python {
namespace {

namespace py = pybind11;
using namespace py::literals;
using Number = std::optional<double>;

PidReport of_fraction(const Numbers& num, const Numbers& den, Real delay, const std::string& type,
                      std::optional<Real> crossover, std::optional<Real> phase_margin,
                      std::optional<Real> Tf, const std::optional<std::string>& rule,
                      std::optional<Real> tau_c, std::optional<Real> Ms_max,
                      std::optional<Real> Mt_max, std::optional<Real> noise_gain_max) {
  require_not_negative(delay, "delay");
  require_not_negative(Tf.value_or(0), "Tf");
  const bool bounds = Ms_max || Mt_max || noise_gain_max;
  const bool requirement = crossover || phase_margin;
  if (int{requirement} + int{rule.has_value()} + int{bounds} != 1)
    throw OptionError(
        "crossover",
        "expected one of crossover with phase_margin, rule, or Ms_max with Mt_max and "
        "noise_gain_max as wanted");
  if (requirement && !(crossover && phase_margin))
    throw OptionError(crossover ? "phase_margin" : "crossover",
                      "crossover and phase_margin belong together, expected both");
  if (rule && Tf)
    throw OptionError("Tf", "Tf came with rule, expected none because a rule has its own filter");
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
  return report;
}

VehicleCascade of_vehicle(const VehicleWord& word, const std::string& method,
                          const std::string& plant, Number dt,
                          const std::optional<std::string>& structure, Number Ms_max,
                          const std::optional<ByLoop>& bandwidth,
                          const std::optional<ByLoop>& sensor_delay, Number motor_lag,
                          Number tracking_max, const std::optional<Names>& integral,
                          const std::optional<std::string>& integrator, bool free) {
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
  return long_call(
      [&](const Stop&) { return vehicle_cascade(load_vehicle(word.text), options, word.text); });
}

void add_transfer_function(py::module_& module) {
  py::class_<PidReport> type(module, "Pid", "PID gains for a transfer function.");
  const auto gain = [&](const char* name, double PidGains::*member, const char* doc) {
    type.def_property_readonly(
        name, [member](const PidReport& report) { return report.gains.*member; }, doc);
  };
  gain("Kp", &PidGains::Kp, "Proportional gain.");
  gain("Ki", &PidGains::Ki, "Integral gain [1/s].");
  gain("Kd", &PidGains::Kd, "Derivative gain [s].");
  gain("Tf", &PidGains::Tf, "Time constant of the derivative's filter [s].");
  type.def_property_readonly(
          "type", [](const PidReport& report) { return to_string(report.type); },
          "\"P\", \"PI\", \"PD\" or \"PID\".")
      .def_readonly("how", &PidReport::how, "How the gains were computed, in words.")
      .def_readonly("margins", &PidReport::margins, "Of the loop.");
  add_report(
      type, "quadtune pid", [](const PidReport& report) { return report::to_json(report); },
      [](const PidReport& report) { return report::to_text(report); });
  module.def(
      "pid", &of_fraction, py::kw_only(), "num"_a, "den"_a, "delay"_a = 0.0, "type"_a = "PID",
      "crossover"_a = py::none(), "phase_margin"_a = py::none(), "Tf"_a = py::none(),
      "rule"_a = py::none(), "tau_c"_a = py::none(), "Ms_max"_a = py::none(),
      "Mt_max"_a = py::none(), "noise_gain_max"_a = py::none(),
      "PID gains for a transfer function, in one of three ways.\n\n"
      "crossover [rad/s] with phase_margin [deg]; or rule \"amigo\", \"simc\",\n"
      "\"ziegler-nichols\", \"cohen-coon\" or \"lambda\" with tau_c [s]; or the largest\n"
      "integral gain within Ms_max, Mt_max and noise_gain_max. type: \"P\", \"PI\", \"PD\" or\n"
      "\"PID\". Raises NoSolution with the cause.");
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
      "free"_a = false, py::prepend(),
      "PID gains for a vehicle's cascade.\n\n"
      "method: \"flown\" (all gains at once on the flown plant) or \"loops\". plant: \"flown\"\n"
      "or \"ideal\". dt: sample period [s]. structure: \"pid\" or \"p-pi\". bandwidth [rad/s]\n"
      "and sensor_delay [s]: a number or a dict by loop. integral: loops that have one.\n"
      "integrator: \"euler\", \"backward-euler\" or \"tustin\". free: without the bounds of the\n"
      "published gains. Raises NoSolution with the loop that cannot be had.");
}

}  // namespace

void add_pid(py::module_& module) {
  add_transfer_function(module);
  add_cascade(module);
}

}  // namespace quadtune::python
