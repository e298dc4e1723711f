// SPDX-License-Identifier: Apache-2.0
/// Margins of measured frequency responses.
#include <fmt/format.h>

#include "controllers.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/systems/matrix_loop.hpp"
#include "report/loops/matrix_loops.hpp"
#include "support/arguments.hpp"
#include "support/interrupts.hpp"
#include "support/real.hpp"
#include "support/results.hpp"
#include "support/topics.hpp"

namespace quadtune::python {
namespace {

namespace py = pybind11;
using namespace py::literals;

/// What the data do not say.
struct KnownOfLoop {
  std::string measured;
  const std::optional<LoopController>& controller;
  std::optional<double> dt;
  double delay = 0, skew = 0;
};

template <class Data>
FrequencyDataReport margins_of(Data data, const KnownOfLoop& known) {
  require_not_negative(known.delay, "delay");
  if (known.dt) require_positive(*known.dt, "dt", "seconds");
  const MeasuredResponse what = measured_response(known.measured);
  return long_call([&](const Stop&) {
    return frequency_data_report(data(), what, known.controller, known.dt.value_or(0), known.delay,
                                 known.skew);
  });
}

FrequencyDataReport of_arrays(const Numbers& w, const ComplexNumbers& G,
                              const std::string& measured,
                              const std::optional<LoopController>& controller,
                              std::optional<Real> dt, Real delay, Real skew) {
  if (w.values.size() != G.values.size())
    throw OptionError("G", fmt::format("G has {} entries, expected {}, as w has", G.values.size(),
                                       w.values.size()));
  FrequencyData data{w.values, G.values};
  validate(data, "w, G");
  return margins_of([&] { return data; }, {measured, controller, dt, delay, skew});
}

FrequencyDataReport of_file(const Path& frd, const std::string& measured,
                            const std::optional<LoopController>& controller, std::optional<Real> dt,
                            Real delay, Real skew) {
  return margins_of([&] { return read_frequency_data(frd.text); },
                    {measured, controller, dt, delay, skew});
}

}  // namespace

void add_measured(py::module_& module) {
  using Report = FrequencyDataReport;
  py::class_<Report> type(module, "MeasuredLoop",
                          "A loop that is known by its frequency response, with its margins.");
  type.def_readonly("margins", &Report::margins,
                    "Of the one loop; a margin that the data leave open is infinite.")
      .def_readonly("samples", &Report::samples, "Number of frequencies.")
      .def_readonly("w_min", &Report::w_min, "Lowest frequency [rad/s].")
      .def_readonly("w_max", &Report::w_max, "Highest frequency [rad/s].")
      .def_property_readonly(
          "crosses_gain", [](const Report& self) { return self.data.crosses_gain; },
          "Whether |L| passes 1 within the data.")
      .def_property_readonly(
          "crosses_phase", [](const Report& self) { return self.data.crosses_phase; },
          "Whether L passes the negative real axis within the data.")
      .def_property_readonly(
          "largest_phase_step", [](const Report& self) { return self.data.largest_phase_step; },
          "Between neighbours [rad]; above pi/2 the data are too coarse.")
      .def_readonly("notes", &Report::notes, "What is assumed, and what the data leave open.");
  add_report(
      type, "quadtune margins --frd FILE", [](const Report& self) { return report::to_json(self); },
      [](const Report& self) { return report::to_text(self); });
  module.def(
      "margins", &of_arrays, py::kw_only(), "w"_a, "G"_a, "measured"_a = "loop",
      "controller"_a = py::none(), "dt"_a = py::none(), "delay"_a = 0.0, "skew"_a = 0.0,
      "Margins of a measured frequency response.\n\n"
      "w (n): frequencies > 0 [rad/s], increasing, n >= 2. G (n): complex, not 0. measured:\n"
      "\"loop\" (L, or with a controller the plant), \"T\" = L/(1 + L) or \"S\" = 1/(1 + L).\n"
      "dt > 0 [s]: the controller is discrete. delay >= 0 [s] in addition to the measured one.\n"
      "skew as for a transfer function. Between frequencies, log|L| and the phase are linear\n"
      "in log w; nothing is extrapolated. Stability is assumed. Raises InvalidInput for wrong\n"
      "data.");
  module.def(
      "margins", &of_file, py::kw_only(), "frd"_a, "measured"_a = "loop",
      "controller"_a = py::none(), "dt"_a = py::none(), "delay"_a = 0.0, "skew"_a = 0.0,
      "The same of a file.\n\n"
      "frd: a text with one row per frequency. Its first line names the columns: w [rad/s] or\n"
      "f [Hz]; re and im, or mag or mag_db with phase_deg or phase_rad. Raises FileError if it\n"
      "cannot be read, and InvalidInput with \"file:line\".");
}

}  // namespace quadtune::python
