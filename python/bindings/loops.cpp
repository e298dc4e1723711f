// SPDX-License-Identifier: Apache-2.0
/// Margins of loops, and their curves as arrays.
#include "report/loops/loops.hpp"

#include <fmt/format.h>

#include <cmath>
#include <variant>

#include "arguments.hpp"
#include "interrupts.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/matrix_checks.hpp"
#include "quadtune/synthesis/step_response.hpp"
#include "quadtune/transfer_function.hpp"
#include "quadtune/workbench/design/named_loop.hpp"
#include "quadtune/workbench/flown/plant_word.hpp"
#include "real.hpp"
#include "report/plots/loop_panels.hpp"
#include "results.hpp"
#include "topics.hpp"

namespace quadtune::python {
namespace {

namespace py = pybind11;
using namespace py::literals;
using report::LoopCurves;
using Matrix = Eigen::MatrixXd;

/// A channel by its number or its name.
using Channel = std::variant<Eigen::Index, std::string>;

Eigen::Index index_of(const LoopReport& report, const Channel& channel) {
  const std::vector<std::string>& names = report.ideal.names;
  const auto count = static_cast<Eigen::Index>(names.size());
  if (const auto* index = std::get_if<Eigen::Index>(&channel)) {
    if (*index < 0 || *index >= count)
      throw OptionError("channel",
                        fmt::format("channel is {}, expected 0 to {}", *index, count - 1));
    return *index;
  }
  const std::string& name = std::get<std::string>(channel);
  for (Eigen::Index i = 0; i < count; ++i)
    if (names[static_cast<std::size_t>(i)] == name) return i;
  throw OptionError(
      "channel", fmt::format("channel is '{}', expected one of {}", name, fmt::join(names, ", ")));
}

LoopCurves bode(const LoopReport& report, const Channel& channel) {
  const Eigen::Index i = index_of(report, channel);
  const auto k = static_cast<std::size_t>(i);
  return long_call([&](const Stop&) {
    return report::loop_curves(report.loop.loop.channel(i), report.ideal.loops[k],
                               report.ideal.names[k]);
  });
}

StepResponse step(const LoopReport& report, const Channel& channel, double duration) {
  const Eigen::Index i = index_of(report, channel);
  return long_call([&](const Stop&) { return step_response(report.loop.loop, i, duration); });
}

/// L at frequencies of the caller's, of one channel with the others closed.
Eigen::VectorXcd response(const LoopReport& report, const Eigen::VectorXd& w,
                          const Channel& channel) {
  const OpenLoop loop = report.loop.loop.channel(index_of(report, channel));
  Eigen::VectorXcd values(w.size());
  for (Eigen::Index k = 0; k < w.size(); ++k) values(k) = loop.at(w(k))(0, 0);
  return values;
}

NamedLoop of_fraction(const Numbers& num, const Numbers& den, double delay,
                      std::optional<double> dt) {
  require_not_negative(delay, "delay");
  if (dt) {
    require_positive(*dt, "dt", "seconds");
    const DiscreteTransferFunction g{num.values, den.values, *dt, whole_samples(delay, *dt)};
    validate(g, "num, den");
    return {OpenLoop(g)};
  }
  const ContinuousTransferFunction g{num.values, den.values, delay};
  validate(g, "num, den");
  return {OpenLoop(g)};
}

NamedLoop of_gain(Matrix A, Matrix B, const Matrix& K, const std::string& cut, double delay,
                  std::optional<double> dt, std::optional<double> sampled) {
  require_not_negative(delay, "delay");
  if (dt && sampled) throw OptionError("sampled", "sampled came with dt, expected one of them");
  if (dt) require_positive(*dt, "dt", "seconds");
  if (sampled) require_positive(*sampled, "sampled", "seconds");
  if (cut != "inputs" && cut != "states")
    throw OptionError("cut", fmt::format("cut is '{}', expected inputs or states", cut));
  GainLoopOptions options;
  options.time = sampled ? MatrixTime::sampled : dt ? MatrixTime::discrete : MatrixTime::continuous;
  options.dt = sampled.value_or(dt.value_or(0));
  options.delay = delay;
  options.declared = sampled.has_value();
  options.at_states = cut == "states";
  require_shape(K, B.cols(), A.rows(), "K", "K", "one row per input, one column per state");
  require_finite(K, "K", "K");
  const ContinuousLti plant{std::move(A), std::move(B), {}, {}, {}, {}, {}};
  validate(plant, "A, B");
  return gain_loop(plant, K, options);
}

LoopReport of_vehicle(const VehicleWord& vehicle, const Path& gains, const std::string& plant,
                      const std::string& estimator, const std::string& sensors, double height,
                      double delay) {
  const bool flown = asks_for_flown_plant(plant);
  require_positive(height, "height", "metres");
  require_not_negative(delay, "delay");
  FlightOptions flight;
  flight.vehicle = vehicle.text;
  flight.gains = gains.text;
  flight.estimator = estimator;
  flight.sensors = sensors;
  FlownLoopOptions at;
  at.height = height;
  at.command_delay = delay;
  return long_call([&](const Stop&) { return loop_report(flight, at, flown); });
}

void add_curves(py::module_& module) {
  py::class_<LoopCurves>(module, "LoopCurves",
                         "The frequency response of a loop: what Bode and Nyquist plots show.")
      .def_readonly("name", &LoopCurves::name, "Name of the channel.")
      .def_property_readonly(
          "w", [](py::object self) { return view(self.cast<const LoopCurves&>().w, self); },
          "Frequencies [rad/s], increasing.")
      .def_property_readonly(
          "L", [](py::object self) { return view(self.cast<const LoopCurves&>().L, self); },
          "L(jw), complex: the Nyquist curve.")
      .def_property_readonly(
          "S", [](py::object self) { return view(self.cast<const LoopCurves&>().S, self); },
          "1/(1 + L), complex.")
      .def_property_readonly(
          "magnitude_db",
          [](const LoopCurves& curves) {
            Eigen::VectorXd db(static_cast<Eigen::Index>(curves.L.size()));
            for (std::size_t i = 0; i < curves.L.size(); ++i)
              db(static_cast<Eigen::Index>(i)) = 20 * std::log10(std::abs(curves.L[i]));
            return db;
          },
          "20 log10 |L|.")
      .def_property_readonly(
          "phase_deg",
          [](py::object self) { return view(self.cast<const LoopCurves&>().phase, self); },
          "Phase of L [deg], without jumps.");
  py::class_<StepResponse>(module, "Step", "The answer of a closed loop to a step.")
      .def_property_readonly(
          "t", [](py::object self) { return view(self.cast<const StepResponse&>().t, self); },
          "Times [s].")
      .def_property_readonly(
          "y", [](py::object self) { return view(self.cast<const StepResponse&>().y, self); },
          "Output per unit of the set point.");
}

void add_loop(py::module_& module) {
  py::class_<LoopReport> type(module, "Loop", "A loop under negative feedback with its margins.");
  const auto matrix = [&](const char* name, const Matrix& (OpenLoop::*member)() const,
                          const char* doc) {
    type.def_property_readonly(
        name,
        [member](const LoopReport& report) -> const Matrix& {
          return (report.loop.loop.*member)();
        },
        py::return_value_policy::reference_internal, doc);
  };
  matrix("A", &OpenLoop::A, "Of the open loop (nx, nx), the delay left out.");
  matrix("B", &OpenLoop::B, "(nx, n)");
  matrix("C", &OpenLoop::C, "(n, nx)");
  matrix("D", &OpenLoop::D, "(n, n)");
  type.def_property_readonly(
          "dt", [](const LoopReport& report) { return report.loop.loop.dt(); },
          "Sample period [s]; 0 of a continuous loop.")
      .def_property_readonly(
          "delay", [](const LoopReport& report) { return report.loop.loop.delay(); },
          "Delay of a continuous loop [s].")
      .def_property_readonly(
          "poles", [](const LoopReport& report) { return report.loop.loop.closed_loop_poles(); },
          "Of the closed loop, the delay left out.")
      .def_property_readonly(
          "names", [](const LoopReport& report) { return report.ideal.names; },
          "Names of the channels.")
      .def_property_readonly("margins", &LoopReport::margins,
                             py::return_value_policy::reference_internal,
                             "Of the flown loop where there is one, otherwise of this loop.")
      .def_readonly("ideal", &LoopReport::ideal, "Margins of this loop.")
      .def_readonly("flown", &LoopReport::flown, "FlownLoop of a vehicle, or None.")
      .def_property_readonly(
          "taken_as", [](const LoopReport& report) { return report.loop.taken_as; },
          "A doubt about what the matrices are; empty for none.")
      .def("bode", &bode, "channel"_a = 0,
           "The frequency response of a channel, by its number or name, with all others closed:\n"
           "of the ideal loop of a vehicle, as `quadtune margins --plot` draws it.")
      .def("nyquist", &bode, "channel"_a = 0, "The same as bode(): L is the Nyquist curve.")
      .def("step", &step, "channel"_a = 0, "duration"_a = 0.0,
           "The output of a channel after a step of its set point. duration [s]; 0 chooses one.")
      .def("response", &response, "w"_a, "channel"_a = 0,
           "L at given frequencies [rad/s], complex.");
  add_report(
      type, "quadtune margins", [](const LoopReport& report) { return report::to_json(report); },
      [](const LoopReport& report) { return report::to_text(report); });
  module.def(
      "margins",
      [](const Numbers& num, const Numbers& den, Real delay, std::optional<Real> dt) {
        return long_call(
            [&](const Stop&) { return loop_report(of_fraction(num, den, delay, dt)); });
      },
      py::kw_only(), "num"_a, "den"_a, "delay"_a = 0.0, "dt"_a = py::none(),
      "Margins of a transfer function under negative feedback.\n\n"
      "num, den: coefficients in descending powers of s, or of z with dt [s]. delay [s].");
  module.def(
      "margins",
      [](Matrix A, Matrix B, const Matrix& K, const std::string& cut, double delay,
         std::optional<double> dt, std::optional<double> sampled) {
        return long_call([&](const Stop&) {
          return loop_report(of_gain(std::move(A), std::move(B), K, cut, delay, dt, sampled));
        });
      },
      "A"_a, "B"_a, "K"_a, py::kw_only(), "cut"_a = "inputs", "delay"_a = 0.0, "dt"_a = py::none(),
      "sampled"_a = py::none(),
      "Margins of u = -K x.\n\n"
      "A and B are continuous; with dt they are discrete; with sampled they are continuous and\n"
      "the input is held for so many seconds. cut: \"inputs\" or \"states\".");
  module.def("margins", &of_vehicle, "vehicle"_a, "gains"_a, py::kw_only(), "plant"_a = "flown",
             "estimator"_a = "", "sensors"_a = "", "height"_a = FlownLoopOptions().height,
             "delay"_a = 0.0, py::prepend(),
             "Margins of a vehicle with gains: an export, a file of gains or a design file.\n\n"
             "plant: \"flown\" with motor lag, sensors and estimator, or \"ideal\". estimator and\n"
             "sensors as fly(). height of the hover [m]; delay of the commands [s].");
}

}  // namespace

void add_loops(py::module_& module) {
  add_curves(module);
  add_loop(module);
}

}  // namespace quadtune::python
