// SPDX-License-Identifier: Apache-2.0
/// The whole way from a design file to files that flight code reads; exports and their
/// verification.
#include <fmt/format.h>

#include <filesystem>

#include "flights.hpp"
#include "quadtune/design/export_target.hpp"
#include "quadtune/design/flight_code_words.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/exports/firmware.hpp"
#include "quadtune/exports/imu_calibration_file.hpp"
#include "quadtune/exports/schedule_table.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/design/design_verdict.hpp"
#include "quadtune/workbench/design/export_content.hpp"
#include "quadtune/workbench/design/gains_export.hpp"
#include "quadtune/workbench/design/given_gains.hpp"
#include "quadtune/workbench/design/usual_design.hpp"
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

struct ExportArguments {
  std::string source, to, directory, vehicle;
  FlightCodeOptions flight_code;
  std::string precision, imu_calibration;
  FirmwareOptions firmware;
  bool constants = false, force = false;

  [[nodiscard]] bool of_schedule() const { return is_schedule(source); }
  /// Also of a vehicle, whose default cascade is a design.
  [[nodiscard]] bool of_design() const {
    return (source.ends_with(".toml") && !of_schedule()) || names_vehicle(source);
  }
};

void require_target(ExportArguments& given, const ExportKind& kind) {
  const std::pair<const char*, bool> of_c[] = {{"name", !given.flight_code.name.empty()},
                                               {"precision", !given.precision.empty()},
                                               {"law", !given.flight_code.law.empty()},
                                               {"adapter", !given.flight_code.adapter.empty()}};
  for (const auto& [name, came] : of_c)
    if (came && given.to != "c")
      throw OptionError(
          name, fmt::format("{} is for to='c', expected none with to='{}'", name, given.to));
  FlightCodeOptions& code = given.flight_code;
  if (!code.name.empty()) require_flight_code_name(code.name, "name");
  if (!code.law.empty()) require_flight_code_law(code.law, "law");
  if (!code.adapter.empty()) require_flight_code_adapter(code.adapter, "adapter");
  if (!given.precision.empty())
    code.double_precision = is_double_precision(given.precision, "precision");
  const bool is_firmware = export_target(kind.name(), "to").is_firmware;
  const std::pair<const char*, bool> of_firmware[] = {
      {"firmware", !given.firmware.version.empty()},
      {"setup", !given.firmware.setup.empty()},
      {"filter_noise", given.firmware.filter_noise}};
  for (const auto& [name, came] : of_firmware)
    if (came && !is_firmware)
      throw OptionError(
          name, fmt::format("{} is for the parameters of a firmware, expected none with to='{}'",
                            name, given.to));
  if (is_firmware) (void)firmware_of_options(firmware_kind(kind.name(), "to"), given.firmware);
  const std::pair<const char*, bool> of_uquad[] = {
      {"imu_calibration", !given.imu_calibration.empty()}, {"constants", given.constants}};
  for (const auto& [name, came] : of_uquad)
    if (came && given.to != "uquad")
      throw OptionError(
          name, fmt::format("{} is for to='uquad', expected none with to='{}'", name, given.to));
}

/// What the manifest of an export says of its design; nothing of other sources.
std::vector<std::string> forced_of(const std::string& source) {
  std::error_code ignored;
  const fs::path folder = source;
  if (!fs::is_regular_file(folder / kManifestName, ignored)) return {};
  return read_manifest(folder).forced;
}

[[noreturn]] void refuse_export(const ExportArguments& given,
                                const std::vector<std::string>& reasons) {
  throw InvalidInput(given.source, fmt::format("{}, nothing was written; force=True writes all the "
                                               "same",
                                               internal::joined(reasons, "; ")));
}

ExportContent content_of(const ExportArguments& given) {
  if (given.of_schedule()) {
    if (given.to != kFlightCodeTarget)
      throw InvalidInput(given.source,
                         fmt::format("is a gain schedule, expected to='{}' because no "
                                     "other export holds one",
                                     kFlightCodeTarget));
    return schedule_content(given.source, given.vehicle);
  }
  if (given.of_design()) {
    const DesignOutcome outcome = run_design(fs::path(given.source));
    require_tuned(outcome, given.force);
    ExportContent content = export_content(outcome);
    content.forced = reasons_against_export(outcome);
    if (!content.forced.empty() && !given.force) refuse_export(given, content.forced);
    return content;
  }
  const std::vector<std::string> forced = forced_of(given.source);
  if (!forced.empty() && !given.force) refuse_export(given, forced);
  GivenLaws laws = read_given_laws(given.source);
  require_sampled(laws.laws, given.source);
  ExportContent content = export_content(std::move(laws.laws), given.vehicle, given.source);
  content.forced = forced;
  return content;
}

ExportResult write_source(ExportArguments given) {
  std::error_code ignored;
  if (fs::equivalent(given.source, given.directory, ignored))
    throw OptionError("directory", "directory is the source itself, expected another one");
  const ExportKind kind = export_kind(given.to, "to");
  require_target(given, kind);
  return long_call([&](const Stop& stop) {
    ExportContent content = content_of(given);
    content.flight_code = given.flight_code;
    content.firmware = given.firmware;
    content.uquad_constants = given.constants;
    if (!given.imu_calibration.empty())
      content.imu_calibration = read_imu_calibration(given.imu_calibration);
    ExportResult result{given.directory, {}, adapt_to_program(content, kind)};
    // Gains that do not hold the vehicle are not written.
    if (const std::string problem = unstable_loop(content);
        !problem.empty() && !(given.of_design() && given.force))
      throw InvalidInput(given.source, problem + ", nothing was written");
    if (const std::string weak = weak_loops(content, kind); !weak.empty()) {
      if (!given.force) refuse_export(given, {weak});
      content.forced.push_back(weak);
    }
    result.files = write_export(given.directory, kind, content, stop);
    return result;
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
        ExportArguments given;
        given.source = source.text;
        given.to = to;
        given.directory = directory.text;
        if (vehicle) given.vehicle = vehicle->text;
        given.flight_code = {name, false, law, adapter};
        given.precision = precision;
        if (imu_calibration) given.imu_calibration = imu_calibration->text;
        given.constants = constants;
        given.firmware = {firmware_version, setup, filter_noise};
        given.force = force;
        return write_source(std::move(given));
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
      "\"single\" or \"double\", law and adapter. With to=\"uquad\": imu_calibration, a file,\n"
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
