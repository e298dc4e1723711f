// SPDX-License-Identifier: Apache-2.0
/// Margins of loops, and their curves as arrays.
#include "report/loops/loops.hpp"

#include <fmt/format.h>

#include <cmath>
#include <variant>

#include "controllers.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/matrix_checks.hpp"
#include "quadtune/synthesis/pid/step_response.hpp"
#include "quadtune/transfer_function.hpp"
#include "quadtune/workbench/design/named_loop.hpp"
#include "quadtune/workbench/flown/plant_word.hpp"
#include "quadtune/workbench/systems/matrix_loop.hpp"
#include "report/loops/matrix_loops.hpp"
#include "report/plots/loop_panels.hpp"
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
using report::LoopCurves;
using Matrix = Eigen::MatrixXd;

/// A loop with the skew of its disk margins, which its JSON states.
struct Loop {
  LoopReport report;
  double skew = 0;
};

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

LoopCurves bode(const Loop& loop, const Channel& channel) {
  const LoopReport& report = loop.report;
  const Eigen::Index i = index_of(report, channel);
  const auto k = static_cast<std::size_t>(i);
  return long_call([&](const Stop&) {
    return report::loop_curves(report.loop.loop.channel(i), report.ideal.loops[k],
                               report.ideal.names[k]);
  });
}

StepResponse step(const Loop& loop, const Channel& channel, double duration) {
  const LoopReport& report = loop.report;
  const Eigen::Index i = index_of(report, channel);
  return long_call([&](const Stop&) { return step_response(report.loop.loop, i, duration); });
}

/// L at frequencies of the caller's, of one channel with the others closed.
Eigen::VectorXcd response(const Loop& loop, const Eigen::VectorXd& w, const Channel& channel) {
  const LoopReport& report = loop.report;
  const OpenLoop open = report.loop.loop.channel(index_of(report, channel));
  Eigen::VectorXcd values(w.size());
  for (Eigen::Index k = 0; k < w.size(); ++k) values(k) = open.at(w(k))(0, 0);
  return values;
}

/// Whether a loop is cut at its other end: at the states, or at the outputs.
bool cut_at(const std::string& cut, const char* other) {
  if (cut == "inputs") return false;
  if (cut == other) return true;
  throw OptionError("cut", fmt::format("cut is '{}', expected inputs or {}", cut, other));
}

/// Period and time of a plant whose matrices are continuous unless one of both is given.
MatrixTime time_of(std::optional<double> dt, std::optional<double> sampled) {
  if (dt && sampled) throw OptionError("sampled", "sampled came with dt, expected one of them");
  if (dt) require_positive(*dt, "dt", "seconds");
  if (sampled) require_positive(*sampled, "sampled", "seconds");
  return sampled ? MatrixTime::sampled : dt ? MatrixTime::discrete : MatrixTime::continuous;
}

/// A loop with the skew of its disk margins.
Loop with_skew(LoopReport report, double skew) {
  if (skew != 0) set_skew(report.ideal, report.loop.loop, skew);
  return {std::move(report), skew};
}

/// The plant of a transfer function with a controller; the delay is one of the loop.
NamedLoop controlled_fraction(const Numbers& num, const Numbers& den,
                              const LoopController& controller, MatrixLoopOptions options) {
  if (options.time == MatrixTime::continuous) {
    const ContinuousTransferFunction g{num.values, den.values, 0};
    validate(g, "num, den");
    return matrix_loop(realize(g), controller, options);
  }
  const DiscreteTransferFunction g{num.values, den.values, options.dt, 0};
  validate(g, "num, den");
  const DiscreteLti plant = realize(g);
  return matrix_loop({plant.A, plant.B, plant.C, plant.D, {}, {}, {}}, controller, options);
}

NamedLoop fraction_alone(const Numbers& num, const Numbers& den, double delay,
                         std::optional<double> dt) {
  if (dt) {
    const DiscreteTransferFunction g{num.values, den.values, *dt, whole_samples(delay, *dt)};
    validate(g, "num, den");
    return {OpenLoop(g)};
  }
  const ContinuousTransferFunction g{num.values, den.values, delay};
  validate(g, "num, den");
  return {OpenLoop(g)};
}

Loop of_fraction(const Numbers& num, const Numbers& den, Real delay, std::optional<Real> dt,
                 const std::optional<LoopController>& controller,
                 const std::optional<std::string>& cut, Real skew) {
  require_not_negative(delay, "delay");
  if (cut && !controller) throw OptionError("cut", "cut came without a controller, expected both");
  MatrixLoopOptions options;
  options.time = time_of(dt, std::nullopt);
  options.dt = dt.value_or(0);
  options.delay = delay;
  options.at_outputs = cut_at(cut.value_or("inputs"), "outputs");
  return long_call([&](const Stop&) {
    return with_skew(loop_report(controller ? controlled_fraction(num, den, *controller, options)
                                            : fraction_alone(num, den, delay, dt)),
                     skew);
  });
}

Loop of_gain(Matrix A, Matrix B, const Matrix& K, const std::string& cut, double delay,
             std::optional<double> dt, std::optional<double> sampled, double skew) {
  require_not_negative(delay, "delay");
  GainLoopOptions options;
  options.time = time_of(dt, sampled);
  options.dt = sampled.value_or(dt.value_or(0));
  options.delay = delay;
  options.declared = sampled.has_value();
  options.at_states = cut_at(cut, "states");
  require_shape(K, B.cols(), A.rows(), "K", "K", "one row per input, one column per state");
  require_finite(K, "K", "K");
  const ContinuousLti plant{std::move(A), std::move(B), {}, {}, {}, {}, {}};
  validate(plant, "A, B");
  return long_call(
      [&](const Stop&) { return with_skew(loop_report(gain_loop(plant, K, options)), skew); });
}

Loop of_outputs(Matrix A, Matrix B, Matrix C, std::optional<Matrix> D,
                const std::optional<LoopController>& controller, const std::string& cut,
                double delay, std::optional<double> dt, std::optional<double> sampled,
                double skew) {
  require_not_negative(delay, "delay");
  MatrixLoopOptions options;
  options.time = time_of(dt, sampled);
  options.dt = sampled.value_or(dt.value_or(0));
  options.delay = delay;
  options.at_outputs = cut_at(cut, "outputs");
  const ContinuousLti plant{
      std::move(A), std::move(B), std::move(C), D.value_or(Matrix()), {}, {}, {}};
  validate(plant, "A, B, C, D");
  return long_call([&](const Stop&) {
    return with_skew(loop_report(matrix_loop(plant, controller, options)), skew);
  });
}

Loop of_vehicle(const VehicleWord& vehicle, const Path& gains, const std::string& plant,
                const std::string& estimator, const std::string& sensors, double height,
                double delay, double skew) {
  const bool flown = asks_for_flown_plant(plant);
  require_positive(height, "height", "metres");
  require_not_negative(delay, "delay");
  if (flown && skew != 0)
    throw OptionError("skew", "skew came with the flown plant, expected plant='ideal'");
  FlightOptions flight;
  flight.vehicle = vehicle.text;
  flight.gains = gains.text;
  flight.estimator = estimator;
  flight.sensors = sensors;
  FlownLoopOptions at;
  at.height = height;
  at.command_delay = delay;
  return long_call([&](const Stop&) { return with_skew(loop_report(flight, at, flown), skew); });
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
  py::class_<Loop> type(module, "Loop", "A loop under negative feedback with its margins.");
  const auto matrix = [&](const char* name, const Matrix& (OpenLoop::*member)() const,
                          const char* doc) {
    type.def_property_readonly(
        name,
        [member](const Loop& self) -> const Matrix& { return (self.report.loop.loop.*member)(); },
        py::return_value_policy::reference_internal, doc);
  };
  matrix("A", &OpenLoop::A, "(nx, nx) of the open loop L with n channels, its delay left out.");
  matrix("B", &OpenLoop::B, "(nx, n) of the open loop.");
  matrix("C", &OpenLoop::C, "(n, nx) of the open loop.");
  matrix("D", &OpenLoop::D, "(n, n) of the open loop.");
  type.def_property_readonly(
          "dt", [](const Loop& self) { return self.report.loop.loop.dt(); },
          "Sample period [s]; 0 of a continuous loop.")
      .def_property_readonly(
          "delay", [](const Loop& self) { return self.report.loop.loop.delay(); },
          "Delay of a continuous loop [s]; a discrete loop has states for it.")
      .def_property_readonly(
          "poles", [](const Loop& self) { return self.report.loop.loop.closed_loop_poles(); },
          "(nx) of the closed loop, the delay left out.")
      .def_property_readonly(
          "names", [](const Loop& self) { return self.report.ideal.names; },
          "Names of the n channels.")
      .def_property_readonly(
          "margins", [](const Loop& self) -> const MarginsReport& { return self.report.margins(); },
          py::return_value_policy::reference_internal,
          "Of the flown loop where there is one, otherwise of this loop.")
      .def_property_readonly(
          "ideal", [](const Loop& self) -> const MarginsReport& { return self.report.ideal; },
          py::return_value_policy::reference_internal, "Margins of this loop.")
      .def_property_readonly(
          "flown",
          [](const Loop& self) -> const std::optional<FlownLoop>& { return self.report.flown; },
          py::return_value_policy::reference_internal, "FlownLoop of a vehicle, or None.")
      .def_property_readonly(
          "taken_as", [](const Loop& self) { return self.report.loop.taken_as; },
          "A doubt about what the matrices are; empty for none.")
      .def_readonly("skew", &Loop::skew,
                    "Of the disk margins: 0 balances S and T, 1 is that of S, -1 that of T.")
      .def("bode", &bode, "channel"_a = 0,
           "The frequency response of a channel, with all other channels closed.\n\n"
           "channel: a number from 0, or a name. Of a vehicle it is the ideal loop, as\n"
           "`quadtune margins --plot` draws it. Raises InvalidInput for an unknown channel.")
      .def("nyquist", &bode, "channel"_a = 0,
           "The same as bode(): the values L are the Nyquist curve.")
      .def("step", &step, "channel"_a = 0, "duration"_a = 0.0,
           "The output of a channel after a unit step of its set point, all channels closed.\n\n"
           "channel: a number from 0, or a name. duration >= 0 [s]; 0 chooses one.")
      .def("response", &response, "w"_a, "channel"_a = 0,
           "L at the frequencies w (n) [rad/s], complex (n), with all other channels closed.");
  add_report(
      type, "quadtune margins",
      [](const Loop& self) {
        internal::Json json = report::to_json(self.report);
        json["skew"] = self.skew;
        return json;
      },
      [](const Loop& self) {
        const bool of_vehicle = !self.report.loop.controller.empty();
        return report::to_text(self.report) +
               (of_vehicle ? "" : report::section("peaks", report::peaks_text(self.report.ideal)));
      });
}

void add_margins_calls(py::module_& module) {
  module.def(
      "margins", &of_fraction, py::kw_only(), "num"_a, "den"_a, "delay"_a = 0.0,
      "dt"_a = py::none(), "controller"_a = py::none(), "cut"_a = py::none(), "skew"_a = 0.0,
      "Margins of a transfer function under negative feedback.\n\n"
      "num, den: coefficients in descending powers of s, or of z with dt > 0 [s]: the open\n"
      "loop, or with a controller the plant. delay >= 0 [s], a whole number of samples with\n"
      "dt. cut: with a controller, \"inputs\" (default) or \"outputs\" of the plant. skew of\n"
      "the disk margins: 0 balances S and T, 1 is that of S, -1 that of T. Raises InvalidInput\n"
      "for coefficients without a loop, and for numbers out of range.");
  module.def(
      "margins", &of_gain, "A"_a, "B"_a, "K"_a, py::kw_only(), "cut"_a = "inputs", "delay"_a = 0.0,
      "dt"_a = py::none(), "sampled"_a = py::none(), "skew"_a = 0.0,
      "Margins of u = -K x.\n\n"
      "A (nx, nx), B (nx, nu), K (nu, nx): continuous; with dt > 0 [s] discrete; with sampled\n"
      "> 0 [s] continuous, and the input is held for so long. cut: \"inputs\" or \"states\".\n"
      "delay >= 0 [s], a whole number of samples unless continuous. skew as for a transfer\n"
      "function. Raises InvalidInput for wrong shapes and numbers out of range.");
  module.def(
      "margins", &of_outputs, "A"_a, "B"_a, py::kw_only(), "C"_a, "D"_a = py::none(),
      "controller"_a = py::none(), "cut"_a = "inputs", "delay"_a = 0.0, "dt"_a = py::none(),
      "sampled"_a = py::none(), "skew"_a = 0.0,
      "Margins of a loop A, B, C, D, or of a controller times this plant.\n\n"
      "A (nx, nx), B (nx, nu), C (ny, nx), D (ny, nu) or None for zero; without a controller\n"
      "they are the open loop, with ny = nu. cut: with a controller, \"inputs\" or \"outputs\"\n"
      "of the plant. delay, dt, sampled and skew as for a gain; a PID controller of a sampled\n"
      "loop is discretized. Raises InvalidInput for wrong shapes and numbers out of range.");
  module.def(
      "margins", &of_vehicle, "vehicle"_a, "gains"_a, py::kw_only(), "plant"_a = "flown",
      "estimator"_a = "", "sensors"_a = "", "height"_a = FlownLoopOptions().height, "delay"_a = 0.0,
      "skew"_a = 0.0, py::prepend(),
      "Margins of a vehicle with gains.\n\n"
      "gains: an export, a file of gains or a design file. plant: \"flown\" with motor lag,\n"
      "sensors and estimator, or \"ideal\", the textbook plant with 12 states. estimator and\n"
      "sensors as fly(). height > 0 of the hover [m]. delay >= 0 of the commands [s]. skew: on\n"
      "the ideal plant alone. Raises InvalidInput for unknown words, numbers out of range and\n"
      "gains of another vehicle, NoSolution if a design file has none, FileError if a file\n"
      "cannot be read.");
}

}  // namespace

void add_loops(py::module_& module) {
  add_curves(module);
  add_loop(module);
  add_margins_calls(module);
}

}  // namespace quadtune::python
