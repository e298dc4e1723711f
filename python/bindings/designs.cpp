// SPDX-License-Identifier: Apache-2.0
/// The whole way from a design file to files that flight code reads; exports and their
/// verification.
#include <fmt/format.h>

#include <filesystem>

#include "flights.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/design/design_verdict.hpp"
#include "quadtune/workbench/design/usual_design.hpp"
#include "quadtune/workbench/export/source_export.hpp"
#include "quadtune/workbench/verify/verify_directory.hpp"
#include "report/flights/flights.hpp"
#include "report/gains/gains.hpp"
#include "support/interrupts.hpp"
#include "support/topics.hpp"

namespace quadtune::python {
namespace {

namespace py = pybind11;
using namespace py::literals;
namespace fs = std::filesystem;

struct DesignResult {
  DesignOutcome outcome;
  MissionDiagnoses diagnoses;
  std::vector<WrittenExport> written;

  [[nodiscard]] DesignFailure failure() const { return failure_of(outcome, written); }
};

struct ExportResult {
  std::string directory;
  std::vector<ManifestFile> files;
  std::vector<std::string> notes;
};

// --- design ---

void require_tuned(const DesignOutcome& outcome, bool force) {
  if (force) return;
  const std::vector<std::string> doubts = unconfirmed_covariances(outcome.design);
  if (!doubts.empty())
    throw InvalidInput(outcome.design.file.string(),
                       doubts.front() + "; force=True takes it all the same");
}

/// The exports, and a page for each mission.
std::vector<WrittenExport> write_all(const DesignOutcome& outcome, const std::string& directory,
                                     bool force, const Stop& stop) {
  std::vector<WrittenExport> written = write_exports(
      outcome, directory,
      [&](const fs::path& place, ExportKind kind, const ExportContent& content) {
        return write_export(place, kind, content, stop);
      },
      force);
  for (const FlownFlight& flight : outcome.flights)
    save((fs::path(directory) / ("flight-" + flight.plan.setup.mission.name + ".html")).string(),
         html(report::flight_page(flight, "")));
  return written;
}

DesignResult design_file(const Path& file, const std::optional<Path>& directory, bool force,
                         std::optional<std::uint32_t> seeds, std::uint64_t seed,
                         const std::optional<Names>& to) {
  if (seeds && *seeds < 1) throw OptionError("seeds", "seeds is 0, expected at least 1");
  return long_call([&](const Stop& stop) {
    DesignResult result;
    DesignOutcome& outcome = result.outcome;
    outcome = run_design(fs::path(file.text), to ? to->list : std::vector<std::string>());
    if (seeds && outcome.design.missions.empty())
      throw OptionError("seeds",
                        "seeds requires a [[mission]] to fly, but " + file.text + " has none");
    require_tuned(outcome, force);
    outcome.flights =
        fly_missions(outcome, seed, directory.has_value(), stop, seeds.value_or(kDesignSeeds));
    outcome.disturbed = fly_disturbed(outcome, seed, stop);
    if (directory && (force || (laws_hold(outcome) && missions_passed(outcome))))
      result.written = write_all(outcome, directory->text, force, stop);
    result.diagnoses = diagnose_missions(outcome);
    return result;
  });
}

std::vector<Flight> flights_of(const std::vector<FlownFlight>& flown,
                               const std::vector<std::optional<Diagnosis>>& diagnoses) {
  std::vector<Flight> flights;
  for (std::size_t i = 0; i < flown.size(); ++i)
    flights.push_back({flown[i], i < diagnoses.size() ? diagnoses[i] : std::nullopt});
  return flights;
}

void add_design(py::module_& module) {
  py::class_<DesignResult> type(module, "Design", "What a design file leads to.");
  type.def_property_readonly(
          "passed",
          [](const DesignResult& result) { return result.failure() == DesignFailure::none; },
          "Whether the loops hold, every mission passed and every export reads back right.")
      .def_property_readonly(
          "failure", [](const DesignResult& result) { return to_string(result.failure()); },
          "Why not; empty if it passed.")
      .def_property_readonly(
          "gains",
          [](const DesignResult& result) -> const std::optional<Gains>& {
            return result.outcome.gains;
          },
          py::return_value_policy::reference_internal, "The state feedback, or None.")
      .def_property_readonly(
          "loops",
          [](const DesignResult& result) {
            const auto& cascade = result.outcome.cascade;
            return cascade ? cascade->cascade.gains.loops : std::vector<PidLoop>();
          },
          "The loops of the PID cascade, if there is one.")
      .def_property_readonly(
          "poles",
          [](const DesignResult& result) -> const Eigen::VectorXcd& {
            return result.outcome.poles;
          },
          py::return_value_policy::reference_internal, "(n) of the loop as it is sampled.")
      .def_property_readonly(
          "margins",
          [](const DesignResult& result) -> const std::optional<MarginsReport>& {
            return result.outcome.margins;
          },
          py::return_value_policy::reference_internal, "At the inputs of the plant, or None.")
      .def_property_readonly(
          "model",
          [](const DesignResult& result) -> const Linearization& { return result.outcome.model; },
          py::return_value_policy::reference_internal, "The linear model.")
      .def_property_readonly(
          "flights",
          [](const DesignResult& result) {
            return flights_of(result.outcome.flights, result.diagnoses.flights);
          },
          "A Flight of each mission: the worst of its seeds.")
      .def_property_readonly(
          "disturbed",
          [](const DesignResult& result) {
            return flights_of(result.outcome.disturbed, result.diagnoses.disturbed);
          },
          "The same missions with a gust and with a load.")
      .def_property_readonly(
          "files",
          [](const DesignResult& result) {
            std::vector<ManifestFile> files;
            for (const WrittenExport& one : result.written)
              files.insert(files.end(), one.files.begin(), one.files.end());
            return files;
          },
          "ExportedFile of everything that was written.")
      .def_property_readonly(
          "warnings", [](const DesignResult& result) { return design_warnings(result.outcome); },
          "Warnings to consider before flying.")
      .def_property_readonly(
          "notes", [](const DesignResult& result) { return design_notes(result.outcome); },
          "Notes on the model and the flights.");
  add_report(
      type, "quadtune design FILE",
      [](const DesignResult& result) {
        return report::design_json(result.outcome, result.diagnoses, result.written);
      },
      [](const DesignResult& result) {
        return report::design_text(result.outcome, result.diagnoses, result.written);
      });
  module.def("design", &design_file, "file"_a, py::kw_only(), "directory"_a = py::none(),
             "force"_a = false, "seeds"_a = py::none(), "seed"_a = 1, "to"_a = py::none(),
             "Trim, linearize, compute gains, fly missions, export and verify, as a design\n"
             "file says, or for the usual cascade of a vehicle.\n\n"
             "file: a design file, a vehicle file or a built-in vehicle. to: for a vehicle, the\n"
             "names of the exports, by default json and c; the gains are designed for a\n"
             "firmware among them.\n"
             "directory: where exports and pages are written if the design passes; with force\n"
             "whatever the outcome. seeds >= 1: flights of each mission, by default 5; seed:\n"
             "of the first. A design that fails is a result with passed == False and its\n"
             "failure. Raises InvalidInput with \"file:line\" for a wrong file, NoSolution if\n"
             "a problem of it has none, FileError if files cannot be read or written.");
}

// --- export ---

ExportResult write_source(const SourceExport& request, const std::string& directory) {
  std::error_code ignored;
  if (fs::equivalent(request.source, directory, ignored))
    throw OptionError("directory", "directory is the source itself, expected another one");
  return long_call([&](const Stop& stop) {
    try {
      PreparedExport prepared = prepare_export(request);
      return ExportResult{directory, write_export(directory, prepared.kind, prepared.content, stop),
                          std::move(prepared.notes)};
    } catch (const ExportRefused& error) {
      throw InvalidInput(error.where(),
                         fmt::format("{}, nothing was written{}", error.what(),
                                     error.forcible() ? "; force=True writes all the same" : ""));
    }
  });
}

void add_export(py::module_& module) {
  py::class_<ExportResult> type(module, "Export", "Files that were written for another program.");
  type.def_readonly("directory", &ExportResult::directory, "Where they are.")
      .def_readonly("files", &ExportResult::files, "ExportedFile of each, the manifest last.")
      .def_readonly("notes", &ExportResult::notes, "What the program changes of the gains.");
  add_report(
      type, "quadtune export",
      [](const ExportResult& result) {
        return internal::Json{{"files", report::to_json(result.files)}};
      },
      [](const ExportResult& result) { return report::to_text(result.files, result.directory); });
  module.def(
      "export",
      [](const Path& source, const std::string& to, const Path& directory,
         const std::optional<VehicleWord>& vehicle, const std::string& name,
         const std::string& precision, const std::string& law, const std::string& adapter,
         const std::optional<Path>& imu_calibration, bool constants,
         const std::string& firmware_version, const std::string& setup, bool filter_noise,
         bool force) {
        SourceExport request;
        request.source = source.text;
        request.to = to;
        if (vehicle) request.vehicle = vehicle->text;
        request.name = name;
        request.precision = precision;
        request.law = law;
        request.adapter = adapter;
        if (imu_calibration) request.imu_calibration = imu_calibration->text;
        request.constants = constants;
        request.firmware = {firmware_version, setup, filter_noise};
        request.force = force;
        return write_source(request, directory.text);
      },
      "source"_a, "to"_a, "directory"_a, py::kw_only(), "vehicle"_a = py::none(), "name"_a = "",
      "precision"_a = "", "law"_a = "", "adapter"_a = "", "imu_calibration"_a = py::none(),
      "constants"_a = false, "firmware"_a = "", "setup"_a = "", "filter_noise"_a = false,
      "force"_a = false,
      "Write gains, or what a design gives, for another program.\n\n"
      "source: an export, a gain file, a design file, a vehicle or, with to=\"c\", a gain\n"
      "schedule. to: \"uquad\", \"mambo\", \"json\", \"mat\", \"c\", \"px4\", \"ardupilot\",\n"
      "\"betaflight\" or \"crazyflie\". directory: where the files are written. vehicle: where\n"
      "the source does not name one. With to=\"c\": name of the functions, precision\n"
      "\"float\" or \"double\", law and adapter. With to=\"uquad\": imu_calibration, a file,\n"
      "and constants. With an autopilot: firmware, its version, setup and filter_noise. force:\n"
      "also a design that does not pass. docs/cli.md explains them, as options of `quadtune\n"
      "export`. Raises InvalidInput for a wrong argument or source, and for gains that do not\n"
      "hold the vehicle; NoSolution if a design has none; FileError.");
}

// --- verify ---

void add_verify(py::module_& module) {
  py::class_<VerifyCheck>(module, "VerifyCheck", "One question about an export, and its answer.")
      .def_readonly("name", &VerifyCheck::name, "The question.")
      .def_readonly("ok", &VerifyCheck::ok, "The answer.")
      .def_readonly("detail", &VerifyCheck::detail, "What was found.");
  py::class_<VerifyReport> type(module, "Verification", "An export, read back and checked.");
  type.def_property_readonly("ok", &VerifyReport::ok, "Whether every check is.")
      .def_readonly("checks", &VerifyReport::checks, "VerifyCheck of each question.")
      .def_readonly("gains", &VerifyReport::gains, "As read from the files, or None.")
      .def_readonly("poles", &VerifyReport::poles, "(n) of the closed loop of these gains.");
  add_report(
      type, "quadtune verify DIR", [](const VerifyReport& self) { return report::to_json(self); },
      [](const VerifyReport& self) {
        return fmt::format("{}\nverdict: {}\n", report::to_text(self), self.ok() ? "pass" : "fail");
      });
  module.def(
      "verify",
      [](const Path& directory, const std::optional<VehicleWord>& vehicle,
         const std::optional<Path>& design, bool arm) {
        return long_call([&](const Stop&) {
          return verify_directory(directory.text, vehicle ? vehicle->text : "",
                                  design ? design->text : "", arm);
        });
      },
      "directory"_a, py::kw_only(), "vehicle"_a = py::none(), "design"_a = py::none(),
      "arm"_a = false,
      "Read an export back as the flight program would, and check everything in it.\n\n"
      "directory: of the export. vehicle: where the manifest's is not built in. design: the\n"
      "design file that it was made from, to solve it again and compare. arm: compile flight\n"
      "code for ARM as well. A wrong export is a result with ok == False. Raises InvalidInput\n"
      "for a manifest that cannot be understood, FileError if files cannot be read.");
}

}  // namespace

void add_designs(py::module_& module) {
  add_design(module);
  add_export(module);
  add_verify(module);
}

}  // namespace quadtune::python
