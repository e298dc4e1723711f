// SPDX-License-Identifier: Apache-2.0
/// Parts of results that several topics have.
#include <fmt/format.h>

#include "quadtune/exports/manifest.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/synthesis/riccati.hpp"
#include "quadtune/workbench/design/margins_report.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"
#include "support/results.hpp"
#include "support/topics.hpp"

namespace quadtune::python {
namespace {

namespace py = pybind11;

void add_riccati(py::module_& module) {
  py::class_<RiccatiResult>(module, "Riccati",
                            "The solution of an algebraic Riccati equation with its evidence, or "
                            "the reason why there is none.")
      .def_property_readonly(
          "status", [](const RiccatiResult& result) { return to_string(result.status); },
          "\"solved\", \"not stabilizable\", \"not detectable\", ...")
      .def_property_readonly("solved", &RiccatiResult::solved, "Whether status is \"solved\".")
      .def_readonly("X", &RiccatiResult::X, "The solution (nx, nx); NaN unless solved.")
      .def_readonly("K", &RiccatiResult::K, "The gain of u = -K x (nu, nx); NaN unless solved.")
      .def_readonly("poles", &RiccatiResult::poles,
                    "(nx) eigenvalues of A - B K; empty unless solved.")
      .def_readonly("residual", &RiccatiResult::residual, "Relative residual of the equation.")
      .def_readonly("rcond", &RiccatiResult::rcond, "Reciprocal condition number of the equation.")
      .def_readonly("iterations", &RiccatiResult::iterations, "Doubling steps.")
      .def_readonly("culprit", &RiccatiResult::culprit,
                    "The mode that prevents a solution; empty when solved.")
      .def_readonly("warning", &RiccatiResult::warning, "What is doubtful; empty for nothing.")
      .def("__repr__", [](const RiccatiResult& result) {
        return fmt::format("<Riccati {}>",
                           result.solved() ? to_string(result.status) : result.culprit);
      });
}

void add_margins(py::module_& module) {
  py::class_<GainCrossover>(module, "GainCrossover", "A frequency at which |L| = 1.")
      .def_readonly("w", &GainCrossover::w, "Frequency [rad/s].")
      .def_readonly("phase_margin", &GainCrossover::phase_margin, "Phase margin there [rad].")
      .def_readonly("delay_margin", &GainCrossover::delay_margin, "Delay margin there [s].");
  py::class_<PhaseCrossover>(module, "PhaseCrossover",
                             "A frequency at which L is real and negative.")
      .def_readonly("w", &PhaseCrossover::w, "Frequency [rad/s].")
      .def_readonly("gain_margin", &PhaseCrossover::gain_margin, "Factor that brings L to -1.");
  py::class_<DiskMargin>(module, "DiskMargin",
                         "The largest disk of complex factors that leaves the loop stable.")
      .def_readonly("alpha", &DiskMargin::alpha, "Size of the disk; 0 of an unstable loop.")
      .def_readonly("w", &DiskMargin::w, "Frequency of the worst factor [rad/s].")
      .def_readonly("gain_low", &DiskMargin::gain_low, "Smallest real factor of the disk.")
      .def_readonly("gain_high", &DiskMargin::gain_high, "Largest real factor of the disk.")
      .def_readonly("phase", &DiskMargin::phase, "Phase of the disk, either way [rad].");
  py::class_<LoopMargins>(module, "LoopMargins", "Margins of one loop.")
      .def_readonly("stable", &LoopMargins::stable, "Whether the closed loop is stable.")
      .def_readonly("gain_crossovers", &LoopMargins::gain_crossovers, "Of the loop, by frequency.")
      .def_readonly("phase_crossovers", &LoopMargins::phase_crossovers,
                    "Of the loop, by frequency.")
      .def_readonly("gain_margin", &LoopMargins::gain_margin,
                    "Smallest factor > 1 that brings L to -1; may be infinite.")
      .def_readonly("gain_reduction", &LoopMargins::gain_reduction,
                    "Largest factor < 1 that brings L to -1; 0 for none.")
      .def_readonly("phase_margin", &LoopMargins::phase_margin,
                    "Smallest phase lag that makes the loop unstable [rad]; may be infinite.")
      .def_readonly("crossover", &LoopMargins::crossover, "Frequency of the phase margin [rad/s].")
      .def_readonly("delay_margin", &LoopMargins::delay_margin,
                    "Smallest delay that makes the loop unstable [s]; may be infinite.")
      .def_readonly("Ms", &LoopMargins::Ms, "Sensitivity peak max |1/(1 + L)|.")
      .def_readonly("w_Ms", &LoopMargins::w_Ms, "Its frequency [rad/s].")
      .def_readonly("Mt", &LoopMargins::Mt, "Peak max |L/(1 + L)|.")
      .def_readonly("w_Mt", &LoopMargins::w_Mt, "Its frequency [rad/s].")
      .def_readonly("disk", &LoopMargins::disk, "Disk margin of the loop.");
  py::class_<SimultaneousDiskMargin>(module, "SimultaneousDiskMargin",
                                     "The disk in which the factors of all loops may be at once.")
      .def_readonly("guaranteed", &SimultaneousDiskMargin::guaranteed,
                    "The largest disk for which stability is proved.")
      .def_readonly("alpha_destabilizing", &SimultaneousDiskMargin::alpha_destabilizing,
                    "Size of a disk with factors that destabilize.");
  py::class_<MarginsReport>(module, "MarginsReport", "Margins of the channels of a loop.")
      .def_readonly("dt", &MarginsReport::dt, "Sample period [s]; 0 of a continuous loop.")
      .def_readonly("names", &MarginsReport::names, "Names of the channels.")
      .def_readonly("loops", &MarginsReport::loops, "LoopMargins of each channel.")
      .def_readonly("together", &MarginsReport::together, "Of all channels at once, or None.")
      .def_property_readonly("warnings", &margin_warnings,
                             "Channels with less than 6 dB, 30 degrees or one sample of delay.")
      .def_property_readonly("notes", &margin_notes, "Conventions that apply to these margins.");
}

void add_flown(py::module_& module) {
  py::class_<FlownLoop>(
      module, "FlownLoop",
      "The loop as it flies about a hover: with motor lag, sensors and estimator.")
      .def_property_readonly("stable", &FlownLoop::stable, "Whether every mode decays.")
      .def_property_readonly("grows", &FlownLoop::grows,
                             "Whether a mode grows by more than a thousandth in ten seconds.")
      .def_property_readonly(
          "largest_pole", [](const FlownLoop& loop) { return std::abs(loop.mode.z); },
          "Largest |z| of a pole.")
      .def_property_readonly("decay", &FlownLoop::decay, "Decay rate of that mode [1/s].")
      .def_property_readonly("frequency", &FlownLoop::frequency, "Its frequency [rad/s].")
      .def_property_readonly(
          "mode", [](const FlownLoop& loop) { return loop.mode.states; }, "Its largest states.")
      .def_readonly("dt", &FlownLoop::dt, "Control period [s].")
      .def_readonly("period", &FlownLoop::period,
                    "Control periods after which the sample times of the sensors repeat.")
      .def_readonly("estimator", &FlownLoop::estimator, "Name of the estimator.")
      .def_readonly("sensors", &FlownLoop::sensors, "\"real\" or \"ideal\".")
      .def_readonly("margins", &FlownLoop::margins, "At the outputs of the law.")
      .def_property_readonly(
          "drifts", [](const FlownLoop& loop) { return names_of(loop.drifts); },
          "States that no sensor observes.")
      .def_property_readonly("notes", &flown_notes, "What a reader should know.")
      .def(
          "__str__", [](const FlownLoop& loop) { return describe(loop); },
          "The slowest or unstable mode in words.");
}

void add_gains(py::module_& module) {
  py::class_<Gains>(module, "Gains",
                    "u = u0 + K (x_sp - x) + K_int integral(x_sp - x), with what is needed to "
                    "apply it.")
      .def_readonly("K", &Gains::K, "(nu, nx) of the states.")
      .def_readonly("K_int", &Gains::K_int, "(nu, ni) of the integrals.")
      .def_property_readonly(
          "states", [](const Gains& gains) { return names_of(gains.states); }, "Names of states.")
      .def_property_readonly(
          "inputs", [](const Gains& gains) { return names_of(gains.inputs); }, "Names of inputs.")
      .def_property_readonly(
          "integrals", [](const Gains& gains) { return names_of(gains.integrals); },
          "Names of integrated states.")
      .def_readonly("x0", &Gains::x0, "Trim state (nx).")
      .def_readonly("u0", &Gains::u0, "Trim input (nu).")
      .def_readonly("vehicle", &Gains::vehicle, "Name of the vehicle.")
      .def_readonly("convention", &Gains::convention, "Name of the convention.")
      .def_property_readonly(
          "sign_law", [](const Gains& gains) { return to_string(gains.sign_law); },
          "\"set-point-minus-state\" or \"state-minus-set-point\".")
      .def_readonly("dt", &Gains::dt, "Sample period [s]; 0 of a continuous law.");
  py::class_<PidLoop>(module, "PidLoop",
                      "output = Kp error + Ki integral(error) + Kd (rate + rate_lead rate')")
      .def_readonly("name", &PidLoop::name, "\"x\", \"y\", \"pitch\", \"roll\", \"yaw\", ...")
      .def_readonly("output", &PidLoop::output, "What the loop commands.")
      .def_readonly("unit", &PidLoop::unit, "Of the output per unit of the error.")
      .def_readonly("Kp", &PidLoop::Kp, "Proportional gain.")
      .def_readonly("Ki", &PidLoop::Ki, "Integral gain.")
      .def_readonly("Kd", &PidLoop::Kd, "Derivative gain, with its own sign.")
      .def_readonly("rate_lead", &PidLoop::rate_lead, "Lead time of the rate [s]; 0: none.")
      .def_readonly("rate_filter", &PidLoop::rate_filter,
                    "Time constant of the low pass of the rate's derivative [s].")
      .def("__repr__", [](const PidLoop& loop) {
        return fmt::format("<PidLoop {} Kp={} Ki={} Kd={}>", loop.name, loop.Kp, loop.Ki, loop.Kd);
      });
  py::class_<ManifestFile>(module, "ExportedFile", "One file of an export.")
      .def_readonly("path", &ManifestFile::path, "Name within the export.")
      .def_readonly("sha256", &ManifestFile::sha256, "Hash of its bytes.")
      .def_readonly("size", &ManifestFile::size, "Size in bytes.")
      .def("__repr__",
           [](const ManifestFile& file) { return fmt::format("<ExportedFile {}>", file.path); });
}

}  // namespace

void add_evidence(py::module_& module) {
  add_riccati(module);
  add_margins(module);
  add_flown(module);
  add_gains(module);
}

}  // namespace quadtune::python
