// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/export/source_export.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "quadtune/design/export_target.hpp"
#include "quadtune/design/flight_code_words.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/firmware.hpp"
#include "quadtune/exports/imu_calibration_file.hpp"
#include "quadtune/exports/manifest.hpp"
#include "quadtune/exports/schedule_table.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/workbench/design/design_verdict.hpp"
#include "quadtune/workbench/design/given_gains.hpp"
#include "quadtune/workbench/design/usual_design.hpp"
#include "quadtune/workbench/export/export_content.hpp"
#include "quadtune/workbench/export/gains_export.hpp"

namespace quadtune {
namespace {

using Reasons = std::vector<std::string>;

/// Whether the source is a design file, or a vehicle, whose default cascade is a design.
bool is_design(const std::string& source) {
  return (source.ends_with(".toml") && !is_schedule(source)) || names_vehicle(source);
}

/// Calls a function that rejects a word with the key of its option as the place.
/// @throws OptionError  in place of that InvalidInput
template <class Function>
auto word_of(const char* key, Function&& function) {
  try {
    return function(key);
  } catch (const OptionError&) {
    throw;
  } catch (const InvalidInput& error) {
    if (error.where() != key) throw;
    throw OptionError(key, fmt::format("{}: {}", key, error.message()));
  }
}

/// Rejects the first option that was given although it does not apply to the format.
void refuse_given(const std::vector<std::pair<const char*, bool>>& options, const char* formats,
                  const std::string& to) {
  for (const auto& [key, given] : options)
    if (given)
      throw OptionError(key, fmt::format("{} applies to {} only, not to {}", key, formats, to));
}

/// The options of the format; those of others are rejected.
FlightCodeOptions options_of_target(const SourceExport& request, const ExportKind& kind) {
  const std::string& to = request.to;
  const FirmwareOptions& firmware = request.firmware;
  if (to != kFlightCodeTarget)
    refuse_given({{"name", !request.name.empty()},
                  {"precision", !request.precision.empty()},
                  {"law", !request.law.empty()},
                  {"adapter", !request.adapter.empty()}},
                 "the format c", to);
  if (!export_target(kind.name(), "to").is_firmware)
    refuse_given({{"firmware", !firmware.version.empty()},
                  {"setup", !firmware.setup.empty()},
                  {"filter-noise", firmware.filter_noise}},
                 "the parameters of a firmware", to);
  else
    (void)firmware_of_options(firmware_kind(kind.name(), "to"), firmware);
  if (to != "uquad")
    refuse_given(
        {{"imu-calibration", !request.imu_calibration.empty()}, {"constants", request.constants}},
        "the format uquad", to);
  if (!request.name.empty())
    word_of("name", [&](const char* key) { require_flight_code_name(request.name, key); });
  if (!request.law.empty())
    word_of("law", [&](const char* key) { require_flight_code_law(request.law, key); });
  if (!request.adapter.empty())
    word_of("adapter", [&](const char* key) { require_flight_code_adapter(request.adapter, key); });
  const bool in_double = !request.precision.empty() && word_of("precision", [&](const char* key) {
    return is_double_precision(request.precision, key);
  });
  return {request.name, in_double, request.law, request.adapter};
}

/// A gain schedule can only be exported as flight code, and its loops are not analysed.
ExportContent content_of_schedule(const SourceExport& request) {
  if (request.to != kFlightCodeTarget)
    throw InvalidInput(request.source,
                       fmt::format("is a gain schedule, expected the format {}, because no other "
                                   "format stores one, or the gains of a single law",
                                   kFlightCodeTarget));
  for (const auto& [key, given] :
       {std::pair("law", !request.law.empty()), std::pair("adapter", !request.adapter.empty()),
        std::pair("force", request.force)})
    if (given)
      throw OptionError(key,
                        fmt::format("{} cannot be combined with a gain schedule, because {}", key,
                                    request.force ? "there is no reason against its export"
                                                  : "the program contains only the schedule"));
  return schedule_content(request.source, request.vehicle);
}

/// Rejects the vehicle of the request with a source that belongs to another one.
/// @param own  name of the source's vehicle; empty: the source does not state it
void require_vehicle_of_source(const SourceExport& request, const std::string& own) {
  if (request.vehicle.empty() || own.empty()) return;
  const std::string given = load_vehicle(request.vehicle).name;
  if (given != own)
    throw OptionError("vehicle", fmt::format("vehicle is '{}', expected '{}', the vehicle of {}",
                                             given, own, internal::printable(request.source)));
}

void refuse_unless_forced(const SourceExport& request, const std::string& why) {
  if (!request.force)
    throw ExportRefused(fmt::format("{}: {}", internal::printable(request.source), why),
                        request.source, true);
}

ExportContent content_of_design(const SourceExport& request, Reasons& warnings) {
  const DesignOutcome outcome = run_design(std::filesystem::path(request.source));
  for (const std::string& doubt : unconfirmed_covariances(outcome.design)) {
    refuse_unless_forced(request, doubt);
    warnings.push_back(doubt);
  }
  ExportContent content = export_content(outcome);
  require_vehicle_of_source(request, content.vehicle.name);
  content.forced = reasons_against_export(outcome);
  if (!content.forced.empty())
    refuse_unless_forced(request, internal::joined(content.forced, "; "));
  return content;
}

/// The reasons for the use of force in the manifest of an export; empty for other sources.
Reasons forced_of(const std::string& source) {
  std::error_code ignored;
  const std::filesystem::path folder = source;
  if (!std::filesystem::is_regular_file(folder / kManifestName, ignored)) return {};
  return read_manifest(folder).forced;
}

ExportContent content_of_files(const SourceExport& request) {
  Reasons forced = forced_of(request.source);
  if (!forced.empty())
    refuse_unless_forced(request, fmt::format("was exported by force although {}",
                                              internal::printable(internal::joined(forced, "; "))));
  GivenLaws given = read_given_laws(request.source);
  require_sampled(given.laws, request.source);
  require_vehicle_of_source(request, given.laws.vehicle);
  ExportContent content = export_content(std::move(given.laws), request.vehicle, request.source);
  content.forced = std::move(forced);
  return content;
}

}  // namespace

PreparedExport prepare_export(const SourceExport& request) {
  const ExportKind kind =
      word_of("to", [&](const char* key) { return export_kind(request.to, key); });
  const FlightCodeOptions flight_code = options_of_target(request, kind);
  const bool of_schedule = is_schedule(request.source);
  const bool of_design = !of_schedule && is_design(request.source);
  Reasons warnings;
  ExportContent content = of_schedule ? content_of_schedule(request)
                          : of_design ? content_of_design(request, warnings)
                                      : content_of_files(request);
  content.flight_code = flight_code;
  content.firmware = request.firmware;
  content.uquad_constants = request.constants;
  if (!request.imu_calibration.empty())
    content.imu_calibration = read_imu_calibration(request.imu_calibration);
  Reasons notes = adapt_to_program(content, kind);
  if (const std::string problem = unstable_loop(content);
      !problem.empty() && !(of_design && request.force))
    throw ExportRefused(problem, content.vehicle.name, false);
  // The design was checked with its flown loop, and the firmware's loops are checked below.
  if (const std::string problem = of_design || export_target(kind.name(), "to").is_firmware
                                      ? ""
                                      : unstable_flown_loop(content);
      !problem.empty()) {
    refuse_unless_forced(request, problem);
    content.forced.push_back(problem);
  }
  if (const std::string weak = weak_loops(content, kind); !weak.empty()) {
    refuse_unless_forced(
        request, fmt::format("{}; expected gains for this firmware, such as those of `quadtune pid "
                             "V --for {}`",
                             weak, request.to));
    content.forced.push_back(weak);
  }
  if (content.forced.empty() && request.force && !of_design)
    throw OptionError("force", fmt::format("force is not needed: there is no reason against the "
                                           "export of {}",
                                           internal::printable(request.source)));
  return {kind, std::move(content), std::move(notes), std::move(warnings),
          !of_design && !of_schedule};
}

}  // namespace quadtune
