// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/verify/verify_directory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "quadtune/design/export_target.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/exports_below.hpp"
#include "quadtune/exports/file_set.hpp"
#include "quadtune/exports/firmware.hpp"
#include "quadtune/exports/flight_code.hpp"
#include "quadtune/exports/manifest.hpp"
#include "quadtune/exports/read_gains.hpp"
#include "quadtune/exports/schedule_table.hpp"
#include "quadtune/exports/text_difference.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/toml_reader.hpp"
#include "quadtune/version.hpp"
#include "quadtune/workbench/design/cascade_report.hpp"
#include "quadtune/workbench/export/export_content.hpp"
#include "quadtune/workbench/flown/flying_loop.hpp"
#include "quadtune/workbench/verify/verify_design.hpp"
#include "quadtune/workbench/verify/verify_evidence.hpp"
#include "verify/manifest_vehicle.hpp"

namespace quadtune {
namespace {

namespace fs = std::filesystem;

/// The current file of the vehicle. The file of a built-in vehicle belongs to the program: another
/// version may have another file; the manifest then has another version.
void add_vehicle(const Manifest& manifest, const Vehicle& vehicle,
                 std::vector<InputAtHand>& inputs) {
  const auto same = [](const std::pair<std::string, std::string>& version) {
    return version.first == "quadtune" && version.second == kVersion;
  };
  if (!vehicle.file.empty() ||
      std::any_of(manifest.versions.begin(), manifest.versions.end(), same))
    inputs.push_back({vehicle_file_name(vehicle), vehicle.file.string(), vehicle.text});
}

/// Adds the inputs of the manifest, which are stored by name only, from a folder.
void add_from(const fs::path& folder, const Manifest& manifest, std::vector<InputAtHand>& inputs) {
  for (const ManifestFile& input : manifest.inputs) {
    std::error_code ignored;
    const fs::path path = folder / input.path;
    if (!fs::is_regular_file(path, ignored) || fs::file_size(path, ignored) > internal::kTomlLimit)
      continue;
    try {
      inputs.push_back(
          {input.path, path.string(), internal::read_file(path.string(), internal::kTomlLimit)});
    } catch (const FileError&) {
      // An unreadable file counts as not available.
    }
  }
}

/// Rejects a file that the export was not made from, which would be compared with nothing.
void require_design_of(const std::string& directory, const Manifest& manifest,
                       const Vehicle& vehicle, const std::string& design) {
  const std::string given = fs::path(design).filename().string();
  // The first of the inputs, or the second if the first is the vehicle.
  const auto source = std::find_if(
      manifest.inputs.begin(), manifest.inputs.end(),
      [&](const ManifestFile& input) { return input.path != vehicle_file_name(vehicle); });
  const std::string made_from = source == manifest.inputs.end() ? "" : source->path;
  const std::string shown = internal::printable(given);
  if (made_from.empty())
    throw OptionError("design", fmt::format("design is '{}', expected no such option, because {} "
                                            "was made without a design file",
                                            shown, internal::printable(directory)));
  if (given != made_from)
    throw OptionError("design",
                      fmt::format("design is '{}', expected '{}', from which the export was made",
                                  shown, internal::printable(made_from)));
}

std::vector<InputAtHand> inputs_at_hand(const std::string& directory, const Manifest& manifest,
                                        const Vehicle& vehicle, const std::string& design) {
  std::vector<InputAtHand> inputs;
  add_vehicle(manifest, vehicle, inputs);
  if (!vehicle.file.empty()) add_from(vehicle.file.parent_path(), manifest, inputs);
  if (!design.empty()) {
    require_design_of(directory, manifest, vehicle, design);
    inputs.push_back({fs::path(design).filename().string(), design,
                      internal::read_text_file(design, internal::kTomlLimit)});
    add_from(fs::path(design).parent_path(), manifest, inputs);
    return inputs;
  }
  for (const fs::path& folder : internal::folders_of_inputs(directory))
    add_from(folder, manifest, inputs);
  return inputs;
}

/// The cascade in an export's files; errors in them are left to the report.
std::optional<CascadeDesign> cascade_of(const std::string& directory) {
  try {
    return read_laws(directory).cascade;
  } catch (const InvalidInput&) {
    return std::nullopt;
  } catch (const FileError&) {
    return std::nullopt;
  }
}

/// Compares the schedule of an export with the table from which it was made.
VerifyCheck schedule_again(const std::string& directory, const std::string& table) {
  constexpr char kSameSchedule[] = "schedule is that of the table";
  if (!is_schedule(table))
    return {kSameSchedule, false,
            table + ": is not a gain schedule; expected the table of the export"};
  const std::string expected = schedule_text(read_schedule(table), TableFormat::json);
  const std::string found = internal::read_text_file(
      (fs::path(directory) / kScheduleJsonName).string(), internal::kTomlLimit);
  if (found == expected) return {kSameSchedule, true, table + ", byte by byte"};
  return {kSameSchedule, false,
          fmt::format("{}, line {}, differs from what {} gives", kScheduleJsonName,
                      first_other_line(found, expected), table)};
}

/// Compares the export with its design; fails also if the design was changed after the export.
VerifyCheck designed_again(const std::string& directory, const Manifest& manifest,
                           const std::string& design) {
  try {
    if (holds_schedule(directory)) return schedule_again(directory, design);
    return check_design(directory, manifest, run_design(fs::path(design)));
  } catch (const InvalidInput& error) {
    return {"files are what the design gives", false, error.what()};
  } catch (const FileError& error) {
    return {"files are what the design gives", false, error.what()};
  } catch (const NoSolution& error) {
    return {"files are what the design gives", false, error.what()};
  }
}

/// Rejects a directory that only contains exports; the message names them.
void require_export(const std::string& directory) {
  std::error_code error;
  if (fs::exists(fs::path(directory) / kManifestName, error)) return;
  if (fs::exists(directory, error) && !fs::is_directory(directory, error))
    throw FileError(
        directory,
        "is not a directory; expected that of an export, as written by `quadtune export FILE --to "
        "json -o DIR`");
  const std::vector<std::string> below = exports_below(directory);
  if (!below.empty())
    throw FileError(directory, fmt::format("has no {}; expected one of the exports in it: {}",
                                           kManifestName, internal::joined(below, ", ")));
}

/// The estimator of an export. verify_export() reports a file that cannot be read.
std::optional<StoredEstimator> estimator_of(const std::string& directory) {
  try {
    return read_laws(directory).estimator;
  } catch (const std::exception&) {
    return {};
  }
}

/// Adds a failed check if the vehicle's file is not one of the files of the manifest.
void check_same_vehicle(const Manifest& manifest, const Vehicle& vehicle, VerifyReport& report) {
  if (vehicle.text.empty() || manifest.inputs.empty()) return;
  const std::string hash = sha256(vehicle.text);
  if (std::any_of(manifest.inputs.begin(), manifest.inputs.end(),
                  [&](const ManifestFile& input) { return input.sha256 == hash; }))
    return;
  // The first of the failed checks, because it is the cause of the others.
  report.checks.insert(
      report.checks.begin(),
      {"the vehicle is that of the manifest", false,
       fmt::format("{} has other bytes than the vehicle file from which the export was made",
                   internal::printable(place_of(vehicle)))});
}

}  // namespace

VerifyReport verify_with(const std::string& directory, const Vehicle& vehicle,
                         const std::vector<InputAtHand>& inputs, const std::vector<FlownLaw>* flown,
                         const std::vector<FlightCodeTarget>& targets) {
  const Manifest manifest = read_manifest(directory);
  std::optional<VerifyModel> model;
  VerifyFacts facts{{}, inputs};
  try {
    if (manifest.gains && manifest.gains->dt > 0) model = model_of(vehicle, *manifest.gains);
    if (const auto cascade = cascade_of(directory))
      facts.cascade_plant = cascade_plant(vehicle, *cascade, directory);
    VerifyReport report = verify_export(directory, model, facts);
    const auto add = [&](std::vector<VerifyCheck> checks) {
      for (VerifyCheck& check : checks) report.checks.push_back(std::move(check));
    };
    add(check_evidence(vehicle, manifest));
    add(check_filters(directory, manifest));
    add(written_again_checks(directory, vehicle));
    add(checks_of(flown != nullptr ? *flown
                                   : flown_laws(vehicle, report.gains, report.cascade,
                                                estimator_of(directory))));
    if (manifest.kind.name() == "c") add(flight_code_checks(directory, vehicle, targets));
    if (export_target(manifest.kind.name(), kManifestName).is_firmware)
      add(firmware_checks(directory, vehicle));
    return report;
  } catch (const NoSolution& error) {
    // A trim that the vehicle cannot fly is a failed check.
    VerifyReport report = verify_export(directory, model, facts);
    report.checks.push_back({"the vehicle can fly the trim", false, error.what()});
    return report;
  }
}

VerifyReport verify_directory(const std::string& directory, const std::string& vehicle_name,
                              const std::string& design, bool arm) {
  require_export(directory);
  const Manifest manifest = read_manifest(directory);
  if (arm && manifest.kind.name() != "c")
    throw OptionError("arm",
                      fmt::format("arm is only for flight code, expected an export to 'c'; this "
                                  "is one to '{}'",
                                  to_string(manifest.kind)));
  std::vector<FlightCodeTarget> targets = {FlightCodeTarget::host};
  if (arm) targets.push_back(FlightCodeTarget::arm);
  const Vehicle vehicle = internal::vehicle_of_manifest(directory, manifest, vehicle_name);
  VerifyReport report = verify_with(
      directory, vehicle, inputs_at_hand(directory, manifest, vehicle, design), nullptr, targets);
  if (!vehicle_name.empty()) check_same_vehicle(manifest, vehicle, report);
  if (!manifest.forced.empty())
    report.checks.push_back({kForcedCheck, false,
                             "written with --force although " +
                                 internal::printable(internal::joined(manifest.forced, "; "))});
  if (!design.empty()) report.checks.push_back(designed_again(directory, manifest, design));
  return report;
}

}  // namespace quadtune
