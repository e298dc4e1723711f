// SPDX-License-Identifier: Apache-2.0
/// quadtune design: the whole way from a design file to files that the flight code reads.
#include <fmt/format.h>

#include <cstdint>
#include <filesystem>

#include "arguments/trusted_covariances.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/words.hpp"
#include "quadtune/workbench/design/design_verdict.hpp"
#include "report/flights/flights.hpp"
#include "report/gains/gains.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string file, directory, to;
  bool force = false, has_seeds = false;
  std::uint64_t seeds = kDesignSeeds;
};

void require_sane(const Options& options) {
  constexpr std::uint64_t kMaxSeeds = 1000;
  if (options.file.empty())
    refuse("FILE", "expected a design file, a vehicle file or a built-in vehicle");
  if (options.seeds > kMaxSeeds)
    refuse("--seeds", "--seeds is {}, expected at most {}", options.seeds, kMaxSeeds);
}

DesignOutcome designed_and_flown(const Options& options, const Context& context) {
  DesignOutcome outcome = options.to.empty()
                              ? run_design(options.file)
                              : run_design(options.file, internal::comma_separated(options.to));
  if (options.has_seeds && outcome.design.missions.empty())
    refuse("--seeds", "--seeds requires a [[mission]] to fly, but {} has none",
           internal::printable(options.file));
  require_tuned(outcome, options.force, context);
  outcome.flights = fly_missions(outcome, context.seed, !options.directory.empty(), interrupted,
                                 static_cast<std::uint32_t>(options.seeds));
  outcome.disturbed = fly_disturbed(outcome, context.seed, interrupted);
  context.notes("note: ", design_notes(outcome));
  return outcome;
}

/// Writes the exports, and next to them a page for each mission.
std::vector<WrittenExport> write_all(const DesignOutcome& outcome, const std::string& directory,
                                     bool force, Context& context) {
  const auto write = [&](const std::filesystem::path& place, ExportKind kind,
                         const ExportContent& content) {
    const WritingFiles writing;
    std::vector<ManifestFile> files = write_export(place, kind, content, interrupted);
    context.written.push_back(place.string());
    return files;
  };
  std::vector<WrittenExport> written = write_exports(outcome, directory, write, force);
  for (const WrittenExport& one : written)
    context.notes(fmt::format("note: export to {}: ", to_string(one.kind)), one.notes);
  for (const FlownFlight& flight : outcome.flights) {
    const std::string name = "flight-" + flight.plan.setup.mission.name + ".html";
    write_file((std::filesystem::path(directory) / name).string(),
               html(flight_page(flight, context.command)));
  }
  return written;
}

/// Rejects a file in place of the directory, before the flights, which take time.
void require_directory(const std::string& directory) {
  std::error_code ignored;
  if (std::filesystem::exists(directory, ignored) &&
      !std::filesystem::is_directory(directory, ignored))
    throw FileError(directory, "is a file, expected a directory to write into");
}

void run_design(const CommandLine& line, Options& options, Context& context) {
  require_directory(options.directory);
  options.has_seeds = line.was_given("--seeds");
  require_sane(options);
  const DesignOutcome outcome = designed_and_flown(options, context);
  const bool writes = !options.directory.empty();
  std::vector<WrittenExport> written;
  if (writes && (options.force || (laws_hold(outcome) && missions_passed(outcome))))
    written = write_all(outcome, options.directory, options.force, context);
  const MissionDiagnoses diagnoses = diagnose_missions(outcome);
  context.print([&] { return design_json(outcome, diagnoses, written); },
                [&] { return design_text(outcome, diagnoses, written); });
  const DesignFailure failure = failure_of(outcome, written);
  if (failure == DesignFailure::none) return;
  const bool kept_from_writing =
      failure == DesignFailure::unstable_flown_loop || failure == DesignFailure::mission;
  throw AnswerIsNo(fmt::format("{}{}", to_string(failure),
                               kept_from_writing && writes && !options.force
                                   ? ", so nothing is written; --force writes nevertheless"
                                   : ""));
}

void add_options(CommandLine& line, Options& options) {
  line.add_option(
      "FILE", options.file,
      "a design file (docs/formats.md) or a vehicle; a vehicle gets the default cascade");
  line.add_option("-o DIR", options.directory, "directory to write; without it, only print");
  line.add_option("--to LIST", options.to,
                  "for a vehicle: formats to export, such as json,px4; default json,c. The gains "
                  "are designed for the firmware that is named");
  line.add_flag(
      "--force", options.force,
      "write even if a flown loop is unstable, a mission failed or the margins on a firmware "
      "are too small, and use tuned covariances whatever their verdict");
  line.add_count(
      "--seeds N", options.seeds, 1,
      fmt::format("flights of each mission, all of which must pass; default {}", kDesignSeeds));
}

}  // namespace

Verb design_verb() {
  return {"design", "FILE [-o DIR]",
          "trim, linearize, compute gains, fly missions, export, verify and report",
          "quadtune design designs/uquad-hover.toml -o out/uquad-hover",
          with_options(add_options, run_design)};
}

}  // namespace quadtune::cli
