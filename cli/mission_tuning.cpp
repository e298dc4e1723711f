// SPDX-License-Identifier: Apache-2.0
#include "mission_tuning.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <ostream>

#include "flight_story.hpp"
#include "number_arguments.hpp"
#include "print.hpp"
#include "program.hpp"
#include "quadtune/errors.hpp"

namespace quadtune::cli {
namespace {

using internal::Json;

[[noreturn]] void refuse(const std::string& verb, const std::string& option,
                         const std::string& why) {
  throw UsageError(fmt::format("quadtune {}: {}", verb, why), option);
}

Json finite_or_null(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

MissionRequirements requirements_of(const MissionTuning& tuning,
                                    const MissionTuningArguments& arguments) {
  MissionRequirements requirements;
  if (!arguments.requirements.empty()) requirements = read_requirements(arguments.requirements);
  if (!arguments.missions.empty() && !requirements.missions.empty())
    refuse(tuning.verb, "--mission",
           "--mission came beside requirements that have [[mission]], "
           "expected one of them");
  for (const std::string& name : arguments.missions) {
    CampaignMission mission;
    mission.mission = load_mission(name);
    mission.where = "--mission";
    mission.arguments.estimator = arguments.estimator;
    mission.arguments.sensors = arguments.sensors;
    mission.arguments.wind = arguments.wind;
    mission.arguments.duration = arguments.duration;
    requirements.limits.push_back(mission.mission.limits);
    requirements.missions.push_back(std::move(mission));
  }
  if (requirements.missions.empty())
    refuse(tuning.verb, "--mission",
           "expected --mission NAME, or --requirements FILE with "
           "[[mission]]");
  if (!arguments.measure.empty()) {
    try {
      requirements.measure = robust_measure(arguments.measure, "--measure");
    } catch (const InvalidInput& error) {
      refuse(tuning.verb, "--measure", error.what());
    }
  }
  return requirements;
}

TrialRequest request_of(const MissionTuning& tuning, const MissionRequirements& requirements,
                        const Controller& start, const MissionTuningArguments& arguments,
                        const Context& context) {
  TrialRequest request;
  request.cost = requirements.cost;
  request.measure = requirements.measure;
  request.share = requirements.share;
  request.draws = requirements.draws.value_or(static_cast<std::uint32_t>(arguments.draws));
  request.uncertainty = requirements.uncertainty;
  request.seed = context.seed;
  const ChosenLaw law{start, tuning.law, {}, tuning.position_bandwidth};
  for (std::size_t i = 0; i < requirements.missions.size(); ++i) {
    const CampaignMission& mission = requirements.missions[i];
    PlannedFlight plan =
        plan_flight(mission.arguments, tuning.vehicle, mission.mission, law, tuning.verb);
    for (const std::string& note : plan.notes) context.note(tuning.verb + ": note: " + note);
    request.missions.push_back(
        {mission.mission.name, std::move(plan.setup), requirements.limits[i]});
  }
  return request;
}

// --- what it tells ---

struct Told {
  const MissionTuning& tuning;
  const TrialRequest& request;
  const MissionSearchResult& result;
  std::vector<NamedMargins> before, after;
  std::optional<TrialOutcome> rival;
};

/// The figures of the cost and of the limits, mission by mission, on the fresh draws.
std::string missions_text(const Told& told) {
  const bool proved = !told.result.proof_before.costs.empty();
  const TrialOutcome& before = proved ? told.result.proof_before : told.result.before;
  const TrialOutcome& after = proved ? told.result.proof_after : told.result.after;
  std::string text = fmt::format("{:<16}{:<36}{:>11}{:>11}{}  {}\n", "mission", "figure, mean",
                                 "start", told.result.accepted ? "found" : "not taken",
                                 told.rival ? fmt::format("{:>11}", "published") : "", "unit");
  const auto cell = [](double x) {
    return std::isnan(x) ? std::string("-") : std::isinf(x) ? "never" : fmt::format("{:.4g}", x);
  };
  for (std::size_t m = 0; m < told.request.missions.size(); ++m)
    for (const Metric metric :
         {Metric::tracking_rms, Metric::tracking_max, Metric::settling_time, Metric::overshoot,
          Metric::tilt_max, Metric::saturation_time, Metric::energy}) {
      if (std::isnan(before.means[m][metric]) && std::isnan(after.means[m][metric])) continue;
      const std::string unit = unit_of(metric) == "1" ? "" : unit_of(metric);
      std::string line = fmt::format(
          "{:<16}{:<36}{:>11}{:>11}{}  {}", told.request.missions[m].name, label_of(metric),
          cell(before.means[m][metric]), cell(after.means[m][metric]),
          told.rival ? fmt::format("{:>11}", cell(told.rival->means[m][metric])) : "", unit);
      text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
    }
  text += fmt::format("{:<52}{:>11.4g}{:>11.4g}{}\n", "cost", before.cost, after.cost,
                      told.rival ? fmt::format("{:>11.4g}", told.rival->cost) : "");
  text += fmt::format("{:<52}{:>11}{:>11}{}  of {}", "flights that end early", before.failed,
                      after.failed, told.rival ? fmt::format("{:>11}", told.rival->failed) : "",
                      before.flights);
  return text;
}

std::string margins_text(const Told& told) {
  const std::vector<NamedMargins>* rival =
      told.tuning.rival ? &told.tuning.rival->margins : nullptr;
  std::string text = fmt::format("{:<10}{:>10}{:>10}{}{:>14}{:>12}{:>12}\n", "loop", "Ms: start",
                                 "found", rival ? fmt::format("{:>11}", "published") : "",
                                 "phase [deg]", "gain [dB]", "delay [ms]");
  const auto cell = [](double x) {
    return std::isfinite(x) ? fmt::format("{:.4g}", x) : std::string("-");
  };
  for (std::size_t i = 0; i < told.after.size(); ++i) {
    const LoopMargins& m = told.after[i].margins;
    text += fmt::format("{:<10}{:>10.4g}{:>10.4g}{}{:>14}{:>12}{:>12}\n", told.after[i].name,
                        told.before[i].margins.Ms, m.Ms,
                        rival ? fmt::format("{:>11.4g}", (*rival)[i].margins.Ms) : "",
                        cell(m.phase_margin * 180 / std::numbers::pi),
                        cell(20 * std::log10(m.gain_margin)), cell(1000 * m.delay_margin));
  }
  text.pop_back();
  return text;
}

std::string to_text(const Told& told) {
  const MissionSearchResult& r = told.result;
  std::string text = section("gains", told.tuning.text(told.tuning.start, r.best));
  text += section("missions", missions_text(told));
  text += section("margins", margins_text(told));
  if (!r.binding.empty()) text += section("binding", fmt::format("{}", fmt::join(r.binding, "\n")));
  return text + section("verdict", fmt::format("{}: {}\n{} evaluations in {:.3g} s, ended by {}",
                                               r.accepted ? "better" : "the start stays", r.reason,
                                               r.evaluations, r.seconds, to_string(r.end)));
}

Json margins_json(const std::vector<NamedMargins>& loops) {
  Json json = Json::array();
  for (const NamedMargins& loop : loops)
    json.push_back(
        {{"loop", loop.name},
         {"Ms", finite_or_null(loop.margins.Ms)},
         {"phase_margin_deg", finite_or_null(loop.margins.phase_margin * 180 / std::numbers::pi)},
         {"gain_margin_db", finite_or_null(20 * std::log10(loop.margins.gain_margin))},
         {"delay_margin_s", finite_or_null(loop.margins.delay_margin)}});
  return json;
}

Json outcome_json(const Told& told, const TrialOutcome& outcome) {
  Json missions = Json::array();
  for (std::size_t m = 0; m < outcome.means.size(); ++m) {
    Json metrics = Json::object();
    for (std::size_t i = 0; i < kMetrics; ++i)
      metrics[name_of(static_cast<Metric>(i))] = finite_or_null(outcome.means[m].value[i]);
    missions.push_back({{"mission", told.request.missions[m].name}, {"mean", metrics}});
  }
  Json limits = Json::array();
  for (const TrialLimit& limit : outcome.limits)
    limits.push_back({{"mission", limit.mission},
                      {"metric", name_of(limit.metric)},
                      {"value", finite_or_null(limit.value)},
                      {"at_most", limit.most},
                      {"ok", limit.excess() <= 0}});
  return {{"cost", outcome.cost},
          {"flights", outcome.flights},
          {"ended_early", outcome.failed},
          {"missions", missions},
          {"limits", limits}};
}

Json to_json(const Told& told) {
  const MissionSearchResult& r = told.result;
  const bool proved = !r.proof_before.costs.empty();
  Json json = {
      {"accepted", r.accepted},
      {"reason", r.reason},
      {"gains", told.tuning.json(r.best)},
      {"cost", {{"before", r.before.cost}, {"after", r.after.cost}}},
      {"before", outcome_json(told, proved ? r.proof_before : r.before)},
      {"after", outcome_json(told, proved ? r.proof_after : r.after)},
      {"difference",
       {{"mean", finite_or_null(r.difference.value)},
        {"low", finite_or_null(r.difference.low)},
        {"high", finite_or_null(r.difference.high)}}},
      {"margins", {{"before", margins_json(told.before)}, {"after", margins_json(told.after)}}},
      {"binding", r.binding},
      {"evaluations", r.evaluations},
      {"seconds", r.seconds},
      {"end", to_string(r.end)}};
  if (told.rival) {
    json["published"] = outcome_json(told, *told.rival);
    json["margins"]["published"] = margins_json(told.tuning.rival->margins);
  }
  return json;
}

}  // namespace

void add_mission_tuning_options(CLI::App& app, MissionTuningArguments& arguments) {
  app.add_option("--mission", arguments.missions,
                 "built-in missions or mission files that are flown; repeat the option")
      ->type_name("NAME")
      ->take_all()
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("--requirements", arguments.requirements,
                 "cost, limits of missions and margins, what is uncertain (docs/formats.md)")
      ->type_name("FILE");
  add_number(app, "--budget", arguments.budget, "time of the search [s]; 60")->type_name("S");
  add_count(app, "--evaluations", arguments.evaluations, 1, "designs that are tried at most")
      ->type_name("N");
  add_count(app, "--monte-carlo", arguments.draws, 1,
            "draws of each mission for one evaluation, the same for all; 4")
      ->type_name("N");
  add_count(app, "--proof", arguments.proof, 2,
            "fresh draws on which start and found are compared; 24")
      ->type_name("N");
  app.add_option("--measure", arguments.measure, "of the draws: mean (default), quantile or worst")
      ->type_name("NAME");
  app.add_option("--estimator", arguments.estimator, "as `quadtune fly`")->type_name("NAME");
  app.add_option("--sensors", arguments.sensors, "ideal, or real (default)")->type_name("KIND");
  app.add_option("--wind", arguments.wind, "as `quadtune fly`")->type_name("WIND");
  add_positive(app, "--duration", arguments.duration, "of each flight [s]; the mission's")
      ->type_name("S");
  app.add_option("-o", arguments.file, "a design file with what was found")->type_name("FILE");
  app.add_flag("--force", arguments.force, "write it whatever the answer is; it says so");
}

void run_mission_tuning(const MissionTuning& tuning, const MissionTuningArguments& arguments,
                        Context& context) {
  if (!(arguments.budget > 0) || arguments.budget > 1e6)
    refuse(tuning.verb, "--budget",
           fmt::format("--budget is {}, expected more than 0 and at most 1e6 s", arguments.budget));
  const MissionRequirements requirements = requirements_of(tuning, arguments);
  const TunedDesign start = tuning.design(tuning.start);
  if (!start.point.controller)
    throw NoSolution(tuning.verb + ": the design that the search begins with is not stable", "V");
  const TrialRequest request =
      request_of(tuning, requirements, *start.point.controller, arguments, context);
  const MissionTrial trial(request, *start.point.controller, context.threads);
  DesignSpace space;
  space.names = tuning.names;
  space.start = tuning.start;
  space.point = [&](const Eigen::VectorXd& x) {
    TunedDesign design = tuning.design(x);
    if (design.point.controller)
      design.point.limits = margin_limits(requirements, design.margins, start.margins);
    return std::move(design.point);
  };
  MissionSearchOptions options;
  options.seconds = arguments.budget;
  options.evaluations = static_cast<int>(std::min<std::uint64_t>(arguments.evaluations, 1 << 30));
  options.proof_draws =
      static_cast<std::uint32_t>(std::min<std::uint64_t>(arguments.proof, 1 << 20));
  options.stop = [] { return interrupted(); };
  const bool shown = !context.quiet && !context.json && isatty(STDERR_FILENO) != 0;
  if (shown)
    options.progress = [&](double best, int evaluations, double left) {
      context.err << fmt::format("\r\033[K{}: best cost {:.4g} after {} designs, {:.0f} s left",
                                 tuning.verb, best, evaluations, left)
                  << std::flush;
    };
  const MissionSearchResult result = search_missions(space, trial, options);
  if (shown) context.err << "\r\033[K" << std::flush;
  Told told{tuning, request, result, start.margins, tuning.design(result.best).margins, {}};
  if (tuning.rival)
    told.rival = trial.fly(tuning.rival->controller, request.draws, options.proof_draws);
  if (!arguments.file.empty() && (result.accepted || arguments.force)) {
    write_file(arguments.file,
               tuning.file(result.best, fmt::format("By {}; {}", context.command, result.reason)));
    context.written.push_back(arguments.file);
  }
  context.out << (context.json ? internal::readable(to_json(told)) + "\n" : to_text(told));
  if (result.end == SearchEnd::interrupted) throw Interrupted();
  if (!result.accepted) throw AnswerIsNo(tuning.verb + ": " + result.reason);
}

}  // namespace quadtune::cli
