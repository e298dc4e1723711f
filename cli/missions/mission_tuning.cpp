// SPDX-License-Identifier: Apache-2.0
#include "missions/mission_tuning.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <ostream>

#include "quadtune/workbench/missions/flown_evidence.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/built_in.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/utf8.hpp"
#include "quadtune/version.hpp"
#include "missions/mission_tuning_report.hpp"

namespace quadtune::cli {
namespace {

constexpr std::uint32_t kUsualDraws = 4, kUsualProof = 24;
/// Longest command that a file repeats whole.
constexpr std::size_t kCommentLength = 4096;
/// More draws than anybody flies for one number.
constexpr std::uint64_t kMostDraws = 100000;

[[noreturn]] void refuse(const std::string& verb, const std::string& option,
                         const std::string& why) {
  throw UsageError(fmt::format("quadtune {}: {}", verb, why), option);
}

/// What is flown for the cost, and what of the plans the report tells.
struct PlannedTrial {
  TrialRequest request;
  PlannedFlight first;              ///< of the first mission
  std::vector<TunedLimit> widened;  ///< limits tighter than the sensors can keep
};

PlannedTrial plan_trial(const MissionTuning& tuning, const MissionRequirements& requirements,
                        const Controller& start, const MissionTuningArguments& arguments,
                        const Context& context) {
  PlannedTrial trial;
  TrialRequest& request = trial.request;
  request.cost = requirements.cost;
  request.measure = requirements.measure;
  request.share = requirements.share;
  request.draws = arguments.draws > 0 ? static_cast<std::uint32_t>(arguments.draws)
                                      : requirements.draws.value_or(kUsualDraws);
  request.uncertainty = requirements.uncertainty;
  request.seed = context.seed;
  const ChosenLaw law{start, tuning.law, {}, tuning.position_bandwidth};
  for (std::size_t i = 0; i < requirements.missions.size(); ++i) {
    CampaignMission mission = requirements.missions[i];
    mission.mission.limits = requirements.limits[i];
    PlannedFlight plan = option_of_command(tuning.verb, [&] {
      return plan_flight(mission.arguments, tuning.vehicle, mission.mission, law);
    });
    for (const std::string& note : plan.notes) context.note(tuning.verb + ": note: " + note);
    if (i == 0) trial.first = plan;
    for (const WidenedLimit& widened : plan.widened)
      trial.widened.push_back({mission.mission.name, widened});
    std::vector<Limit> limits = plan.setup.mission.limits;
    request.missions.push_back({mission.mission.name, std::move(plan.setup), std::move(limits)});
  }
  return trial;
}

std::uint32_t proof_draws(const TrialRequest& request, const std::string& verb,
                          const MissionTuningArguments& arguments) {
  const std::uint32_t least = least_draws(request);
  if (arguments.proof == 0) return std::max(kUsualProof, least);
  if (arguments.proof < least)
    refuse(verb, "--proof",
           fmt::format("--proof is {}, expected at least {} because fewer draws tell too little of "
                       "the {:g} quantile",
                       arguments.proof, least, request.share));
  return static_cast<std::uint32_t>(arguments.proof);
}

}  // namespace

void require_design_name(const std::string& file, const std::string& verb) {
  std::error_code ignored;
  if (file.empty() || file.ends_with(".toml") || std::filesystem::is_other(file, ignored)) return;
  refuse(verb, "-o",
         fmt::format("-o is '{}', expected a name that ends in .toml because `quadtune export` and "
                     "`fly --gains` know a design file by it",
                     internal::printable(file)));
}

void add_mission_tuning_options(CommandLine& line, MissionTuningArguments& arguments) {
  line.add_list("--mission", arguments.missions,
                "built-in missions or mission files that are flown; several: repeat the option")
      ->type_name("NAME");
  line.add_option("--requirements", arguments.requirements,
                  "cost, limits of missions and margins, what is uncertain (docs/formats.md)")
      ->type_name("FILE");
  line.add_number("--budget", arguments.budget, "time of the search [s]; 60")->type_name("S");
  line.add_count("--evaluations", arguments.evaluations, 1, "designs that are tried at most")
      ->type_name("N");
  line.add_count(
          "--monte-carlo", arguments.draws, 1,
          "draws of each mission for one evaluation, the same for all; as the requirements have "
          "it, or 4")
      ->type_name("N");
  line.add_count("--proof", arguments.proof, 2,
                 "fresh draws on which start and found are compared; 24, or what a quantile needs")
      ->type_name("N");
  line.add_option("--measure", arguments.measure, "of the draws: mean (default), quantile or worst")
      ->type_name("NAME");
  line.add_option("--estimator", arguments.estimator, "as `quadtune fly`")->type_name("NAME");
  line.add_option("--sensors", arguments.sensors, "ideal, or real (default)")->type_name("KIND");
  line.add_option("--wind", arguments.wind, "as `quadtune fly`")->type_name("WIND");
  line.add_positive("--duration", arguments.duration, "of each flight [s]; the mission's")
      ->type_name("S");
  line.add_option("-o", arguments.file, "a design file with what was found")->type_name("FILE");
  line.add_flag("--force", arguments.force,
                "write what was found whatever the answer is; the file says so");
  line.add_option("--report", arguments.report, "write a page to look at: a .html file");
}

std::string vehicle_text(const std::string& word) {
  const std::string vehicle =
      internal::looks_like_path(word) ? std::filesystem::absolute(word).string() : word;
  if (internal::valid_utf8(vehicle) != vehicle)
    throw InvalidInput(
        vehicle, "is not UTF-8, expected a path that a design file can name, as TOML is UTF-8");
  return internal::json_text(internal::Json(vehicle));  // which is TOML, too
}

void require_sane(const std::string& verb, const MissionTuningArguments& arguments) {
  FlightOptions flight;
  flight.estimator = arguments.estimator;
  flight.sensors = arguments.sensors;
  if (!arguments.wind.empty()) flight.wind = arguments.wind;
  option_of_command(verb, [&] { require_flight_words(flight); });
  if (!arguments.file.empty()) (void)vehicle_text(arguments.vehicle);  // before a long search
  if (!(arguments.budget > 0) || arguments.budget > 1e6)
    refuse(verb, "--budget",
           fmt::format("--budget is {}, expected more than 0 and at most 1e6 s", arguments.budget));
  for (const auto& [option, draws] :
       {std::pair("--monte-carlo", arguments.draws), std::pair("--proof", arguments.proof)})
    if (draws > kMostDraws)
      refuse(verb, option, fmt::format("{} is {}, expected at most {}", option, draws, kMostDraws));
  require_design_name(arguments.file, verb);
  if (arguments.report.empty()) return;
  if (!arguments.report.ends_with(".html"))
    refuse(verb, "--report",
           fmt::format("--report is '{}', expected a name that ends in .html",
                       internal::printable(arguments.report)));
}

MissionRequirements mission_requirements(const std::string& verb,
                                         const MissionTuningArguments& arguments) {
  MissionRequirements requirements;
  if (!arguments.requirements.empty()) requirements = read_requirements(arguments.requirements);
  if (!arguments.missions.empty() && !requirements.missions.empty())
    refuse(verb, "--mission",
           "--mission came beside requirements that have [[mission]], "
           "expected one of them");
  // Who says how missions are flown shall not think that it was heard.
  for (const auto& [option, came] : {std::pair("--estimator", !arguments.estimator.empty()),
                                     std::pair("--sensors", !arguments.sensors.empty()),
                                     std::pair("--wind", !arguments.wind.empty()),
                                     std::pair("--duration", arguments.duration.has_value())})
    if (came && !requirements.missions.empty())
      refuse(verb, option,
             fmt::format("{} came beside requirements that have [[mission]], expected it there",
                         option));
  for (const std::string& name : arguments.missions) {
    CampaignMission mission;
    mission.mission = load_mission(name);
    mission.where = "--mission";
    mission.arguments.estimator = arguments.estimator;
    mission.arguments.sensors = arguments.sensors;
    if (!arguments.wind.empty()) mission.arguments.wind = arguments.wind;
    mission.arguments.duration = arguments.duration;
    requirements.limits.push_back(mission.mission.limits);
    requirements.missions.push_back(std::move(mission));
  }
  if (requirements.missions.empty())
    refuse(verb, "--mission",
           "expected --mission NAME, or --requirements FILE with "
           "[[mission]]");
  if (!arguments.measure.empty()) {
    try {
      requirements.measure = robust_measure(arguments.measure, "--measure");
    } catch (const InvalidInput& error) {
      refuse(verb, "--measure", error.what());
    }
  }
  return requirements;
}

void run_mission_tuning(const MissionTuning& tuning, const MissionRequirements& requirements,
                        const MissionTuningArguments& arguments, Context& context) {
  const TunedDesign start = tuning.design(tuning.start);
  if (!start.point.controller)
    throw NoSolution(tuning.verb + ": the design that the search begins with is not stable", "V");
  const auto limits = [&](const TunedDesign& design) {
    return margin_limits(requirements, design.margins, start.margins);
  };
  (void)limits(start);  // refuses loops that are not there before anything flies
  const PlannedTrial planned =
      plan_trial(tuning, requirements, *start.point.controller, arguments, context);
  const TrialRequest& request = planned.request;
  const KeepsTheBest keeps_the_best;
  const MissionTrial trial(request, *start.point.controller, context.threads, interrupted);
  DesignSpace space;
  space.names = tuning.names;
  space.start = tuning.start;
  space.point = [&](const Eigen::VectorXd& x) {
    TunedDesign design = tuning.design(x);
    if (design.point.controller) design.point.limits = limits(design);
    return std::move(design.point);
  };
  MissionSearchOptions options;
  options.seconds = arguments.budget;
  options.evaluations = static_cast<int>(std::min<std::uint64_t>(arguments.evaluations, 1 << 30));
  options.proof_draws = proof_draws(request, tuning.verb, arguments);
  options.stop = interrupted;
  const bool shown = !context.quiet && !context.json && isatty(STDERR_FILENO) != 0;
  if (shown)
    options.progress = [&](double best, int evaluations, double left) {
      context.err << fmt::format("\r\033[K{}: best cost {:.4g} after {} designs, {:.0f} s left",
                                 tuning.verb, best, evaluations, std::ceil(left))
                  << std::flush;
    };
  MissionSearchResult result = search_missions(space, trial, options);
  if (shown) context.err << "\r\033[K" << std::flush;
  // After an interrupt what was found is still told and written: that is little work.
  const MissionTrial::Stop stop =
      result.end == SearchEnd::interrupted ? MissionTrial::Stop{} : MissionTrial::Stop{interrupted};
  const TunedDesign best = tuning.design(result.candidate);
  MissionTuningReport report{tuning,       request,      result, start.margins,
                             best.margins, limits(best), {}};
  const auto fresh = static_cast<std::uint32_t>(result.proof_before.costs.size());
  if (tuning.rival)
    report.rival = fresh > 0 ? trial.fly(tuning.rival->controller, request.draws, fresh, stop)
                             : trial.fly(tuning.rival->controller, stop);
  report.widened = planned.widened;
  report.flown =
      flown_evidence(planned.first, start.point.controller, best.point.controller,
                     tuning.rival ? std::optional(tuning.rival->controller) : std::nullopt);
  reject_unstable(report.flown, tuning.start, result);
  // First, so that a file that cannot be written does not take a long search with it.
  context.out << (context.json ? internal::readable(to_json(report)) + "\n" : to_text(report))
              << std::flush;
  context.answered = true;
  if (!arguments.file.empty() && (result.accepted || arguments.force)) {
    write_file(arguments.file,
               tuning.file(result.candidate,
                           fmt::format("{}By {}; {}", result.accepted ? "" : "NOT TAKEN. ",
                                       internal::printable(context.command, kCommentLength),
                                       result.reason)),
               stop);
    context.written.push_back(arguments.file);
  }
  if (!arguments.report.empty()) {
    GainsPage page = page_of(report, trial, stop);
    page.command = context.command;
    page.version = std::string(kVersion);
    page.seed = fmt::format("{}", context.seed);
    write_file(arguments.report, html(page), stop);
    context.written.push_back(arguments.report);
  }
  if (result.end == SearchEnd::interrupted) throw Interrupted();
  if (!result.accepted) throw AnswerIsNo(tuning.verb + ": " + result.reason);
}

}  // namespace quadtune::cli
