// SPDX-License-Identifier: Apache-2.0
#include "arguments/mission_arguments.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <ostream>

#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/progress.hpp"
#include "program/refusal.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/version.hpp"
#include "report/missions/mission_tuning_report.hpp"

namespace quadtune::cli {
namespace {

/// Longest command that is quoted in full in a file [characters].
constexpr std::size_t kCommentLength = 4096;
/// Maximum number of draws.
constexpr std::uint64_t kMaxDraws = 100000;

MissionTuningOptions tuning_options(const MissionTuningArguments& arguments,
                                    const Context& context) {
  MissionTuningOptions options;
  options.seconds = arguments.budget;
  options.evaluations = arguments.evaluations;
  options.draws = static_cast<std::uint32_t>(arguments.draws);
  options.proof = static_cast<std::uint32_t>(arguments.proof);
  options.seed = context.seed;
  options.threads = context.threads;
  options.stop = interrupted;
  return options;
}

}  // namespace

void require_design_name(const std::string& file) {
  std::error_code ignored;
  if (file.empty() || file.ends_with(".toml") || std::filesystem::is_other(file, ignored)) return;
  refuse("-o",
         "-o is '{}', expected a name that ends in .toml, by which `quadtune export` and `fly "
         "--gains` recognize a design file",
         internal::printable(file));
}

void add_mission_tuning_options(CommandLine& line, MissionTuningArguments& arguments) {
  line.add_list("--mission NAME", arguments.words.missions,
                "built-in mission or mission file to fly; repeat the option for several");
  line.add_option("--requirements FILE", arguments.words.requirements,
                  "file of cost, limits and uncertain parameters (docs/formats.md)");
  line.add_number("--budget S", arguments.budget, "maximum time of the search [s]; default 60");
  line.add_count("--evaluations N", arguments.evaluations, 1,
                 "maximum number of designs that are evaluated");
  line.add_count("--monte-carlo N", arguments.draws, 1,
                 "draws of each mission in one evaluation, the same in all; default: that of the "
                 "requirements, or 4");
  line.add_count("--proof N", arguments.proof, 2,
                 "fresh draws on which the start and the result are compared; default 24, or as "
                 "many as a quantile needs");
  line.add_option("--measure NAME", arguments.words.measure,
                  "measure over the draws: mean (default), quantile or worst");
  line.add_option("--estimator NAME", arguments.words.estimator, "as for `quadtune fly`");
  line.add_option("--sensors KIND", arguments.words.sensors, "ideal, or real (default)");
  line.add_option("--wind WIND", arguments.words.wind, "as for `quadtune fly`");
  line.add_positive("--duration S", arguments.words.duration,
                    "duration of each flight [s]; default: that of the mission");
  line.add_option("-o FILE", arguments.file, "design file to write the result to");
  line.add_flag("--force", arguments.force,
                "write the result even if it is not accepted; the file states the verdict");
  line.add_option("--report FILE", arguments.report, "write a web page: a .html file");
}

void require_sane(const MissionTuningArguments& arguments) {
  require_flight_words(arguments.words);
  if (!arguments.file.empty()) (void)vehicle_text(arguments.vehicle);  // before a long search
  if (!(arguments.budget > 0) || arguments.budget > 1e6)
    refuse("--budget", "--budget is {}, expected more than 0 and at most 1e6 s", arguments.budget);
  for (const auto& [option, draws] :
       {std::pair("--monte-carlo", arguments.draws), std::pair("--proof", arguments.proof)})
    if (draws > kMaxDraws)
      refuse(option, "{} is {}, expected at most {}", option, draws, kMaxDraws);
  require_design_name(arguments.file);
  if (arguments.report.empty()) return;
  if (!arguments.report.ends_with(".html"))
    refuse("--report", "--report is '{}', expected a name that ends in .html",
           internal::printable(arguments.report));
}

void run_mission_tuning(const MissionTuning& tuning, const MissionRequirements& requirements,
                        const MissionTuningArguments& arguments, Context& context) {
  MissionTuningOptions options = tuning_options(arguments, context);
  MissionTuningPlan plan = plan_mission_tuning(tuning, requirements, options, context.verb);
  context.notes("note: ", plan.notes);
  const KeepsTheBest keeps_the_best;
  const MissionTuningResult result = [&] {
    Progress progress(context);
    options.progress = [&](double best, int evaluations, double left) {
      progress.show(fmt::format("{}: minimum cost {:.4g} after {} designs, {:.0f} s left",
                                context.verb, best, evaluations, std::ceil(left)));
    };
    return tune_missions(tuning, requirements, std::move(plan), options);
  }();
  const MissionSearchResult& search = result.search;
  // Printed before files are written, so that a failing write does not lose the result of a long
  // search.
  context.print([&] { return to_json(result); }, [&] { return to_text(result); });
  context.out << std::flush;
  context.answered = true;
  // After an interrupt the best result is still printed and written, which takes little time.
  const bool ended = search.end == SearchEnd::interrupted;
  const MissionTrial::Stop stop = ended ? MissionTrial::Stop{} : MissionTrial::Stop{interrupted};
  if (!arguments.file.empty() && (search.accepted || arguments.force)) {
    context.write(arguments.file,
                  tuning.file(search.candidate,
                              fmt::format("{}By {}; {}", search.accepted ? "" : "NOT ACCEPTED. ",
                                          internal::printable(context.command, kCommentLength),
                                          search.reason)),
                  stop);
  }
  if (!arguments.report.empty()) {
    GainsPage page = page_of(result, tuned_flights(result, stop));
    page.command = context.command;
    page.version = std::string(kVersion);
    page.seed = fmt::format("{}", context.seed);
    context.write(arguments.report, html(page), stop);
  }
  if (ended) throw Interrupted();
  if (!search.accepted)
    throw AnswerIsNo(search.reason + so_not_written(arguments.file, arguments.force));
}

}  // namespace quadtune::cli
