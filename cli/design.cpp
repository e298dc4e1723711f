// SPDX-License-Identifier: Apache-2.0
/// quadtune design: the whole way from a design file to files that the flight code reads.
#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <ostream>

#include "arguments/trusted_covariances.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/workbench/design/export_content.hpp"
#include "quadtune/workbench/verify/verify_directory.hpp"
#include "report/flights/design_flights.hpp"
#include "report/flights/flight_story.hpp"
#include "report/gains/design_report.hpp"
#include "report/gains/verify_report.hpp"

namespace quadtune::cli {
namespace {

/// Writes every export that the design asks for and reads it back. A single one goes into the
/// directory itself, several into one folder each.
std::vector<WrittenExport> write_all(const DesignOutcome& outcome, const std::string& directory,
                                     Context& context) {
  const Design& design = outcome.design;
  if (design.exports.empty())
    throw InvalidInput(design.file.string(), "has no [[export]], expected one because of -o");
  std::vector<WrittenExport> written;
  const ExportContent content = export_content(outcome);
  std::vector<InputAtHand> inputs;
  for (const FileContent& input : content.inputs) inputs.push_back({input.name, "", input.bytes});
  // All in memory first, so that what one cannot express keeps the others from being written.
  for (const ExportRequest& request : design.exports)
    (void)export_files(export_kind(request.to, design.file.string()), content);
  for (const ExportRequest& request : outcome.design.exports) {
    WrittenExport one;
    one.kind = export_kind(request.to, outcome.design.file.string());
    one.directory = outcome.design.exports.size() == 1
                        ? directory
                        : (std::filesystem::path(directory) / request.to).string();
    {
      const WritingFiles writing;
      one.files = write_export(one.directory, one.kind, content, interrupted);
      context.written.push_back(one.directory);
    }
    one.verification = verify_with(one.directory, design.vehicle, inputs, &outcome.flown);
    written.push_back(std::move(one));
  }
  return written;
}

/// A page for each mission, beside the exports.
void write_reports(const DesignOutcome& outcome, const std::string& directory,
                   const Context& context) {
  for (const FlownFlight& flight : outcome.flights) {
    const std::string file =
        (std::filesystem::path(directory) / ("flight-" + flight.plan.setup.mission.name + ".html"))
            .string();
    write_file(file, html(report_of(flight, context.command)));
  }
}

constexpr std::uint64_t kMostSeeds = 1000;

}  // namespace

Verb design_verb() {
  struct Options {
    std::string file, directory;
    bool force = false;
    std::uint64_t seeds = kDesignSeeds;
  };
  return {
      "design", "FILE [-o DIR]",
      "the whole way: trim, linearize, synthesize, fly, export, verify, report",
      "quadtune design designs/uquad-hover.toml -o out/uquad-hover",
      [](CommandLine& line) -> Action {
        auto options = std::make_shared<Options>();
        line.add_option("FILE", options->file, "a design file (docs/formats.md)");
        line.add_option("-o", options->directory, "directory to write; without it, only print")
            ->type_name("DIR");
        line.add_flag("--force", options->force,
                      "write although a flown loop is unstable or a mission failed, and take "
                      "tuned covariances whatever their verdict");
        line.add_count(
                "--seeds", options->seeds, 1,
                fmt::format("flights of each mission, all of which must pass; {}", kDesignSeeds))
            ->type_name("N");
        return [options, &line](Context& context) {
          if (options->file.empty())
            throw UsageError("quadtune design: expected a design file", "FILE");
          if (options->seeds > kMostSeeds)
            throw UsageError(fmt::format("quadtune design: --seeds is {}, expected at most {}",
                                         options->seeds, kMostSeeds),
                             "--seeds");
          DesignOutcome outcome = run_design(options->file);
          if (line.was_given("--seeds") && outcome.design.missions.empty())
            throw UsageError(fmt::format("quadtune design: --seeds came, but {} has no [[mission]] "
                                         "to fly",
                                         internal::printable(options->file)),
                             "--seeds");
          require_tuned(outcome, options->force, context);
          outcome.flights = fly_missions(outcome, context.seed, !options->directory.empty(),
                                         interrupted, static_cast<std::uint32_t>(options->seeds));
          outcome.disturbed = fly_disturbed(outcome, context.seed, interrupted);
          for (const std::string& note : outcome.model.notes) context.note("design: note: " + note);
          for (const std::string& note : notes_of_flights(outcome))
            context.note("design: note: " + note);
          if (outcome.design.condition.yaw != 0 && outcome.gains)
            context.note("design: note: position is in world axes, so K holds at this yaw only");
          std::vector<WrittenExport> written;
          const bool holds = laws_hold(outcome), flies = missions_passed(outcome);
          if (!options->directory.empty() && ((holds && flies) || options->force)) {
            written = write_all(outcome, options->directory, context);
            write_reports(outcome, options->directory, context);
          }
          if (context.json)
            context.out << internal::readable(design_json(outcome, written)) << "\n";
          else
            context.out << design_text(outcome, written);
          if (passed(outcome, written)) return;
          if (outcome.cascade && unstable(*outcome.cascade))
            throw AnswerIsNo("design: the cascade does not hold the vehicle");
          if (holds && flies) throw AnswerIsNo("design: what was written does not verify");
          std::string failed = !holds ? "the flown loop is unstable" : "a mission failed";
          if (!options->directory.empty() && !options->force)
            failed += ", so nothing is written; --force writes all the same";
          throw AnswerIsNo("design: " + failed);
        };
      }};
}

}  // namespace quadtune::cli
