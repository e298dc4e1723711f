// SPDX-License-Identifier: Apache-2.0
/// quadtune export: writes gains or a design for another program.
#include "quadtune/exports/export.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "arguments/trusted_covariances.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/design/export_target.hpp"
#include "quadtune/design/flight_code_words.hpp"
#include "quadtune/exports/firmware.hpp"
#include "quadtune/exports/imu_calibration_file.hpp"
#include "quadtune/exports/schedule_table.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/workbench/design/design_verdict.hpp"
#include "quadtune/workbench/design/export_content.hpp"
#include "quadtune/workbench/design/gains_export.hpp"
#include "quadtune/workbench/design/given_gains.hpp"
#include "quadtune/workbench/design/usual_design.hpp"
#include "report/gains/gains.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string source, to, directory, vehicle, name, precision, law, adapter, imu_calibration;
  FirmwareOptions firmware;
  bool force = false, constants = false;

  [[nodiscard]] bool of_schedule() const { return is_schedule(source); }
  /// Also of a vehicle, whose default cascade is a design.
  [[nodiscard]] bool of_design() const {
    return (source.ends_with(".toml") && !of_schedule()) || names_vehicle(source);
  }
};

void require_complete(const Options& options) {
  if (options.source.empty())
    refuse("SOURCE", "SOURCE is missing, expected an export, gains, a design or a vehicle");
  if (options.to.empty()) refuse("--to", "--to is missing, expected the format to write");
  if (options.directory.empty()) refuse("-o", "-o is missing, expected the directory to write");
  // An export that replaces its own source would lose what it does not contain.
  std::error_code ignored;
  if (std::filesystem::equivalent(options.source, options.directory, ignored))
    refuse("-o", "-o {} is the source itself, expected another directory", options.directory);
}

/// The reasons for --force in the manifest of an export; empty for other sources.
std::vector<std::string> forced_of(const std::string& source) {
  std::error_code ignored;
  const std::filesystem::path folder = source;
  if (!std::filesystem::is_regular_file(folder / kManifestName, ignored)) return {};
  return read_manifest(folder).forced;
}

/// A gain schedule can only be exported as flight code, and its loops are not analysed.
void require_schedule_options(const Options& options) {
  if (options.to != kFlightCodeTarget)
    throw InvalidInput(options.source,
                       fmt::format("is a gain schedule, expected --to {}, because no other format "
                                   "stores one, or the gains of a single law",
                                   kFlightCodeTarget));
  const std::pair<const char*, bool> given[] = {{"--law", !options.law.empty()},
                                                {"--adapter", !options.adapter.empty()},
                                                {"--force", options.force}};
  for (const auto& [option, came] : given)
    if (came)
      refuse(option, "{} cannot be combined with a gain schedule, because {}", option,
             options.force ? "there is no reason against its export"
                           : "the program contains only the schedule");
}

/// Rejects --vehicle with a source that belongs to another vehicle.
///
/// @param own  the vehicle's name; empty: the source does not state it
void require_vehicle_of_source(const Options& options, const std::string& own) {
  if (options.vehicle.empty() || own.empty()) return;
  const std::string given = load_vehicle(options.vehicle).name;
  if (given != own)
    throw OptionError("vehicle", fmt::format("vehicle is '{}', expected '{}', the vehicle of {}",
                                             given, own, internal::printable(options.source)));
}

ExportContent content_of(const Options& options, const Context& context) {
  if (options.of_schedule()) return schedule_content(options.source, options.vehicle);
  if (options.of_design()) {
    const DesignOutcome outcome = run_design(options.source);
    require_tuned(outcome, options.force, context);
    ExportContent content = export_content(outcome);
    require_vehicle_of_source(options, content.vehicle.name);
    content.forced = reasons_against_export(outcome);
    if (!content.forced.empty() && !options.force)
      throw Refusal(
          fmt::format("{}: {}; nothing was written; use --force to export it",
                      internal::printable(options.source), internal::joined(content.forced, "; ")),
          options.source);
    return content;
  }
  const std::vector<std::string> forced = forced_of(options.source);
  if (!forced.empty() && !options.force)
    throw Refusal(fmt::format("{}: was exported with --force although {}; nothing was "
                              "written; use --force to export it",
                              internal::printable(options.source),
                              internal::printable(internal::joined(forced, "; "))),
                  options.source);
  GivenLaws given = read_given_laws(options.source);
  require_sampled(given.laws, options.source);
  require_vehicle_of_source(options, given.laws.vehicle);
  ExportContent content = export_content(std::move(given.laws), options.vehicle, options.source);
  content.forced = forced;
  return content;
}

FlightCodeOptions flight_code_options(const Options& options) {
  const std::pair<const char*, const std::string*> given[] = {{"--name", &options.name},
                                                              {"--precision", &options.precision},
                                                              {"--law", &options.law},
                                                              {"--adapter", &options.adapter}};
  for (const auto& [option, value] : given)
    if (options.to != "c" && !value->empty())
      refuse(option, "{} applies to --to c only, not to --to {}", option, options.to);
  if (!options.name.empty()) require_flight_code_name(options.name, "--name");
  if (!options.law.empty()) require_flight_code_law(options.law, "--law");
  if (!options.adapter.empty()) require_flight_code_adapter(options.adapter, "--adapter");
  return {options.name,
          !options.precision.empty() && is_double_precision(options.precision, "--precision"),
          options.law, options.adapter};
}

void require_firmware_options(const Options& options, const ExportKind& kind) {
  const bool is_firmware = export_target(kind.name(), "--to").is_firmware;
  if (!is_firmware && options.firmware.filter_noise)
    refuse("--filter-noise",
           "--filter-noise applies to the parameters of a firmware only, not to --to {}",
           options.to);
  const std::pair<const char*, const std::string*> given[] = {
      {"--firmware", &options.firmware.version}, {"--setup", &options.firmware.setup}};
  for (const auto& [option, value] : given)
    if (!is_firmware && !value->empty())
      refuse(option, "{} applies to the parameters of a firmware only, not to --to {}", option,
             options.to);
  if (!is_firmware) return;
  const FirmwareKind target = firmware_kind(kind.name(), "--to");
  (void)firmware_of_options(target, options.firmware);
}

void run_export(const Options& options, Context& context) {
  require_complete(options);
  const ExportKind kind = export_kind(options.to, "--to");
  const FlightCodeOptions flight_code = flight_code_options(options);
  require_firmware_options(options, kind);
  if (!options.imu_calibration.empty() && options.to != "uquad")
    refuse("--imu-calibration", "--imu-calibration applies to --to uquad only, not to --to {}",
           options.to);
  if (options.constants && options.to != "uquad")
    refuse("--constants", "--constants applies to --to uquad only, not to --to {}", options.to);
  if (options.of_schedule()) require_schedule_options(options);
  ExportContent content = content_of(options, context);
  content.flight_code = flight_code;
  content.firmware = options.firmware;
  content.uquad_constants = options.constants;
  if (!options.imu_calibration.empty())
    content.imu_calibration = read_imu_calibration(options.imu_calibration);
  context.notes("note: ", adapt_to_program(content, kind));
  // Gains whose loop is unstable are not written.
  if (const std::string problem = unstable_loop(content);
      !problem.empty() && !(options.of_design() && options.force))
    throw Refusal(fmt::format("{}; nothing was written", problem), content.vehicle.name);
  if (const std::string weak = weak_loops(content, kind); !weak.empty()) {
    if (!options.force)
      throw Refusal(fmt::format("{}: {}; nothing was written; use gains of `quadtune pid V "
                                "--for {}`, or --force to export these",
                                internal::printable(options.source), weak, options.to),
                    options.source);
    content.forced.push_back(weak);
  }
  if (content.forced.empty() && options.force && !options.of_design())
    refuse("--force", "--force is not needed: there is no reason against the export of {}",
           internal::printable(options.source));
  if (!options.of_design() && !options.of_schedule())
    context.note(
        "note: only what the source holds is exported: gains, trim, cascade, estimator and "
        "vehicle; weights and Kalman filters are exported from a design file");
  std::vector<ManifestFile> files;
  {
    const WritingFiles writing;
    files = write_export(options.directory, kind, content, interrupted);
    context.written.push_back(options.directory);
  }
  context.print(
      [&] {
        return internal::Json{{"files", to_json(files)}};
      },
      [&] { return to_text(files, options.directory); });
}

void add_options(CommandLine& line, Options& options) {
  line.add_option(
      "SOURCE", options.source,
      "an export's directory, a gain file, a design file, a vehicle (its default cascade) "
      "or, with --to c, a gain schedule");
  line.add_option("--to NAME", options.to,
                  "uquad, mambo, json, mat, c, px4, ardupilot, betaflight or crazyflie");
  line.add_option("-o DIR", options.directory, "directory to write");
  line.add_option(
      "--vehicle V", options.vehicle,
      "the vehicle, if the one that the gains name is neither built in nor, if SOURCE is "
      "an export, found near it or in the working folder");
  line.add_option("--name NAME", options.name,
                  "prefix of the names in the C program; default: the vehicle's name, for a "
                  "schedule followed by _schedule");
  line.add_option("--precision WORD", options.precision,
                  "precision of the C program: float or double");
  line.add_option("--law LAW", options.law,
                  "law of the C program, if the design has two: cascaded-pid or state-feedback");
  line.add_option("--adapter BOARD", options.adapter,
                  "files that connect the C program to a board: main, mambo, crazyflie or px4");
  line.add_option("--imu-calibration FILE", options.imu_calibration,
                  "calibration of the uquad's sensors to export with the gains, as `quadtune "
                  "calibrate imu -o` writes it");
  line.add_flag("--constants", options.constants,
                "for uquad: write a C header of the vehicle's constants as well");
  line.add_flag(
      "--force", options.force,
      "export even if the loop of a design is unstable, the logs did not confirm the covariances, "
      "the margins on a firmware are too small or SOURCE was forced; the manifest records the "
      "reason");
  line.add_option("--firmware VERSION", options.firmware.version,
                  "version of the firmware, e.g. 1.15 of px4; default: px4 1.16, ardupilot 4.6, "
                  "betaflight 2026.6, crazyflie 2026.08");
  line.add_flag(
      "--filter-noise", options.firmware.filter_noise,
      "for a firmware: write the noise of its estimator as well, from the design's filter");
  line.add_option("--setup NAME", options.firmware.setup,
                  "propellers of a Crazyflie: standard (default), legacy, thrust-kit or brushless");
}

}  // namespace

Verb export_verb() {
  return {"export", "DIR|FILE --to NAME -o DIR",
          "write gains, or the results of a design, for another program",
          "quadtune export designs/uquad-hover.toml --to json -o out/uquad-json",
          with_options(add_options, run_export)};
}

}  // namespace quadtune::cli
