// SPDX-License-Identifier: Apache-2.0
/// Certificates of stability over a box of vehicles.
#include "quadtune/workbench/verify/certify.hpp"

#include <fmt/format.h>

#include "quadtune/errors.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/flown/plant_word.hpp"
#include "quadtune/workbench/verify/uncertain_range.hpp"
#include "report/loops/loops.hpp"
#include "support/arguments.hpp"
#include "support/interrupts.hpp"
#include "support/results.hpp"
#include "support/topics.hpp"

namespace quadtune::python {
namespace {

namespace py = pybind11;
using namespace py::literals;

/// (low, high).
using Range = std::pair<double, double>;

/// As the command reads it: the checks of its words are those of the range.
std::string text(const Range& range) { return fmt::format("{}:{}", range.first, range.second); }

CertifyReport certify_directory(const Path& directory, const std::optional<VehicleWord>& vehicle,
                                const std::string& controller, const std::optional<Range>& mass,
                                const std::optional<Range>& inertia,
                                const std::optional<Range>& thrust,
                                const std::optional<Range>& delay, const std::optional<Range>& lag,
                                const std::optional<std::string>& integrator,
                                const std::string& plant, int budget, std::uint64_t seed,
                                std::size_t threads) {
  CertifyOptions options;
  if (vehicle) options.vehicle = vehicle->text;
  options.controller = controller_kind(controller, false);
  if (mass) options.mass = uncertain_ratios(text(*mass), "mass");
  if (inertia) options.inertia = uncertain_ratios(text(*inertia), "inertia");
  if (thrust) options.thrust = uncertain_ratios(text(*thrust), "thrust");
  if (delay) options.delay = uncertain_delay(text(*delay), "delay");
  if (lag) options.lag = uncertain_lag(text(*lag), "lag");
  if (integrator) options.integrator = pid_method(*integrator, "integrator");
  options.flown = asks_for_flown_plant(plant);
  if (budget < 1)
    throw OptionError("budget", fmt::format("budget is {}, expected at least 1", budget));
  options.max_boxes = budget;
  options.seed = seed;
  options.threads = threads;
  CertifyReport report = long_call([&](const Stop& stop) {
    options.stop = stop;
    return certify(directory.text, options);
  });
  if (report.failed)
    throw InvalidInput(directory.text, fmt::format("does not verify: the check '{}' failed: {}",
                                                   report.failed->name, report.failed->detail));
  return report;
}

}  // namespace

void add_certify(py::module_& module) {
  py::class_<CertifiedLaw>(module, "CertifiedLaw", "What was proved of one law of an export.")
      .def_readonly("name", &CertifiedLaw::name, "\"state feedback\" or \"cascade\".")
      .def_readonly("dt", &CertifiedLaw::dt, "Control period [s].")
      .def_property_readonly("proved", &CertifiedLaw::proved, "Whether the whole box is.")
      .def_property_readonly("reason", &CertifiedLaw::reason, "Why not; empty if it is.")
      .def_property_readonly(
          "gap", [](const CertifiedLaw& law) { return law.robustness.proof.gap; },
          "By how much every loop contracts a period at least.")
      .def_property_readonly(
          "boxes", [](const CertifiedLaw& law) { return law.robustness.boxes; },
          "Boxes that the proofs inspected.")
      .def_property_readonly(
          "worst_radius", [](const CertifiedLaw& law) { return law.robustness.worst.radius; },
          "Largest spectral radius that the search found in the box.")
      .def_property_readonly(
          "proved_scale", [](const CertifiedLaw& law) { return law.robustness.proved_scale; },
          "Scale of the largest box that was proved.")
      .def_property_readonly(
          "found_scale", [](const CertifiedLaw& law) { return law.robustness.found_scale; },
          "Scale of the smallest box with an unstable loop; infinite for none.");
  py::class_<CertifyReport> type(
      module, "Certificate", "Whether the loops of an export are stable for a box of vehicles.");
  type.def_property_readonly("proved", &CertifyReport::proved, "Whether every law is.")
      .def_property_readonly("verdict", &CertifyReport::verdict,
                             "\"proved\", \"unstable\" or \"not proved\".")
      .def_readonly("vehicle", &CertifyReport::vehicle, "Name of the vehicle.")
      .def_readonly("laws", &CertifyReport::laws, "CertifiedLaw of each law.");
  add_report(
      type, "quadtune certify DIR",
      [](const CertifyReport& report) { return report::to_json(report); },
      [](const CertifyReport& report) { return report::to_text(report); });
  module.def(
      "certify", &certify_directory, "directory"_a, py::kw_only(), "vehicle"_a = py::none(),
      "controller"_a = "", "mass"_a = py::none(), "inertia"_a = py::none(), "thrust"_a = py::none(),
      "delay"_a = py::none(), "lag"_a = py::none(), "integrator"_a = py::none(),
      "plant"_a = "flown", "budget"_a = CertifyOptions().max_boxes, "seed"_a = 1, "threads"_a = 0,
      "Prove the loops of an export stable for every vehicle of a box, or find one that is\n"
      "not.\n\n"
      "directory: of an export. vehicle: where the manifest's is not built in. controller:\n"
      "\"state-feedback\" or \"cascaded-pid\", where both were exported. mass, inertia,\n"
      "thrust: (low, high) > 0, ratios to the vehicle's file; default: those of its [spread], or\n"
      "0.9 to 1.1, 0.8 to 1.2 and 0.9 to 1.1. delay >= 0 of the loop and lag\n"
      ">= 0 of the motors: (low, high) [s]; default: up to one period, and that of the\n"
      "vehicle. integrator of a cascade: \"euler\", \"backward-euler\" or \"tustin\". plant:\n"
      "\"flown\" or \"ideal\". budget: boxes that a proof may inspect. threads: 0 for one of\n"
      "each processor. Raises InvalidInput for a wrong argument or export, FileError if files\n"
      "cannot be read.");
}

}  // namespace quadtune::python
