// SPDX-License-Identifier: Apache-2.0
/// quadtune tune lqr: weights of an LQR problem, tuned over missions or matched to a given gain.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "arguments/lqr_arguments.hpp"
#include "arguments/matrix_arguments.hpp"
#include "arguments/mission_arguments.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/convention_file.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/convert.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/design/gain_match.hpp"
#include "quadtune/workbench/missions/lqr_tuning.hpp"
#include "report/gains/gains.hpp"
#include "report/text/print.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  LqrArguments problem;
  MissionTuningArguments missions;
  bool separate = false;
  std::string gains;
  std::vector<std::string> ties;
  double tolerance = 1e-3;
  std::uint64_t starts = 8;
};

/// Options that are absent take their values from the gains, or from the design that contains them.
void complete(const CommandLine& line, const GivenGains& given, LqrArguments& problem) {
  const auto absent = [&line](const char* option) { return !line.was_given(option); };
  PlantArguments& plant = problem.plant;
  if (absent("--convention")) plant.convention = given.gains.convention;
  if (absent("--inputs")) plant.inputs = to_string(given.gains.input_kind);
  const Convention& words = named_convention(plant.convention, "--convention");
  plant.convention = words.name;
  const Gains turned = in_convention(given.gains, words);
  if (absent("--states")) plant.states = internal::joined(names_of(turned.states), ",");
  if (absent("--integral")) problem.integral = internal::joined(names_of(turned.integrals), ",");
  if (!problem.dt && given.gains.dt > 0) problem.dt = given.gains.dt;
  if (!given.design) return;
  if (absent("--method") && given.design->lqr)
    problem.method = to_string(given.design->lqr->method);
  const FlightCondition& flight = given.design->condition;
  if (absent("--yaw")) plant.yaw = flight.yaw;
  for (const char* option : {"--at", "--speed", "--climb", "--radius", "--yaw-rate"})
    if (!absent(option)) return;
  plant.at = to_string(flight.kind);
  plant.speed = flight.speed;
  plant.climb = flight.climb;
  plant.radius = flight.radius;
  plant.yaw_rate = flight.yaw_rate;
}

/// @param problem  `method` is empty if it was not given
LqrArguments with_defaults(LqrArguments problem) {
  if (problem.plant.at != "hover")
    refuse("--at", "--at is '{}', expected hover, because missions are flown with gains for hover",
           internal::printable(problem.plant.at));
  if (problem.Q.empty() && problem.R.empty()) problem.plant.inputs = "wrench";
  if (problem.method.empty()) problem.method = "sampled";
  if (!problem.dt && problem.method != "continuous") problem.dt = kUsualPeriod;
  return problem;
}

void run_missions(const CommandLine& line, Options& options, Context& context) {
  if (options.missions.words.missions.empty() && options.missions.words.requirements.empty())
    refuse("--mission",
           "expected --mission NAME or --requirements FILE to tune weights over missions, or "
           "--match-gains FILE to compute the weights of a gain");
  line.refuse_given({"--tie", "--tolerance", "--starts"}, "requires --match-gains");
  const bool standard = options.problem.Q.empty() && options.problem.R.empty();
  (void)input_kind(options.problem.plant.inputs, "--inputs");
  if (standard && line.was_given("--inputs") && options.problem.plant.inputs != "wrench")
    refuse("--inputs",
           "--inputs {} requires --Q or --R, because Bryson's rule gives weights for the wrench "
           "only",
           options.problem.plant.inputs);
  options.missions.vehicle = options.problem.plant.vehicle;
  require_sane(options.missions);
  const MissionRequirements requirements = mission_requirements(options.missions.words);
  if (!line.was_given("--method")) options.problem.method.clear();
  const LqrArguments problem = with_defaults(options.problem);
  LinearVehicle plant = make_plant(problem.plant);
  const LqrDesign design = make_design(problem, plant.model.plant.states, plant.model.plant.inputs);
  if (standard && (problem.plant.convention != "ned" || problem.plant.states != "full"))
    refuse("--Q",
           "--convention and --states require --Q or --R, because Bryson's rule gives weights for "
           "all states in ned only");
  if (design.dt == 0)
    refuse("--method",
           "--method is continuous, expected discrete or sampled, because the gains run on a "
           "computer");
  run_mission_tuning(lqr_tuning(std::move(plant), design, standard, options.separate), requirements,
                     options.missions, context);
}

GainMatchOptions match_options(const Options& options, const Context& context) {
  GainMatchOptions settings;
  settings.tolerance = options.tolerance;
  settings.starts = static_cast<int>(std::min<std::uint64_t>(options.starts, 1000));
  settings.seed = context.seed;
  settings.interrupted = interrupted;
  for (const std::string& tie : options.ties) settings.ties.push_back(word_list(tie));
  return settings;
}

/// Writes and prints the result.
/// @throws AnswerIsNo  if no weights give the gain
void tell(const GainMatchReport& report, const Options& options, Context& context) {
  const GainMatch& match = report.match;
  const bool matched = match.status == GainMatchStatus::matched;
  const std::string& file = options.missions.file;
  if (!file.empty() && (matched || options.missions.force)) {
    context.write(file, design_file(report, file, context.command));
  }
  context.print([&] { return to_json(report); }, [&] { return to_text(report); });
  if (!matched)
    throw AnswerIsNo(fmt::format(
        "{}: no diagonal weights{} give this gain: the best ones leave a "
        "difference of {:.3g} at {}, tolerance {:.3g}{}",
        options.gains, options.ties.empty() ? "" : " with these ties", match.after, match.worst,
        options.tolerance, so_not_written(options.missions.file, options.missions.force)));
}

void run_match(const CommandLine& line, Options& options, Context& context) {
  line.refuse_given(
      {"--mission", "--requirements", "--budget", "--evaluations", "--monte-carlo", "--proof",
       "--measure", "--estimator", "--sensors", "--wind", "--duration", "--separate", "--report"},
      "applies to flights and cannot be combined with --match-gains, which flies none");
  if (!(options.tolerance > 0 && options.tolerance < 1))
    refuse("--tolerance", "--tolerance is {}, expected more than 0 and less than 1: 0.05 is 5 %",
           options.tolerance);
  require_design_name(options.missions.file);
  const GivenGains given = read_given_gains(options.gains);
  if (given.gains.memory)
    throw InvalidInput(options.gains,
                       "the law feeds back its past commands, expected a matrix on the states and "
                       "their integrals, because the weights are computed on the ideal plant");
  LqrArguments& problem = options.problem;
  complete(line, given, problem);
  const LinearVehicle plant = make_plant(problem.plant);
  const ContinuousLti& lti = plant.model.plant;
  require_states(given.gains, lti.states, convention(problem.plant.convention, "--convention"),
                 options.gains);
  const LqrDesign design = make_design(problem, lti.states, lti.inputs);
  const auto& [gains, match] =
      match_given_gains(given.gains, plant, design, match_options(options, context), options.gains);
  if (match.status == GainMatchStatus::interrupted) throw Interrupted();
  if (!match.has_weights())
    throw NoSolution(fmt::format("tune lqr: no weights were found that give the gain of {}: {}",
                                 options.gains, match.culprit),
                     options.gains);
  context.notes("note: ", plant.model.notes);
  tell({plant.vehicle, problem.plant.vehicle, flight_condition(problem.plant), options.gains,
        gains.K, gains.K_int, match, options.tolerance},
       options, context);
}

void run_tune_lqr(const CommandLine& line, Options& options, Context& context) {
  if (options.problem.plant.vehicle.empty())
    refuse("V", "expected a vehicle, and --mission NAME or --match-gains FILE");
  if (options.gains.empty())
    run_missions(line, options, context);
  else
    run_match(line, options, context);
}

void add_options(CommandLine& line, Options& options) {
  add_plant_options(line, options.problem.plant);
  line.add_option("--match-gains FILE", options.gains,
                  "compute weights that give this gain: an export, a file of gains, or a design "
                  "with [published] or [lqr] gains; absent options take their values from it");
  line.add_option("--Q LIST", options.problem.Q,
                  "start of the search: a list with the integrals last; a single number applies to "
                  "all; default: 1, or over missions, if --R is absent too, Bryson's rule; a "
                  "weight of 0 stays 0");
  line.add_option(
      "--R LIST", options.problem.R,
      "likewise for the inputs; with --match-gains its geometric mean is kept, because a "
      "gain determines the weights only up to a factor");
  line.add_option("--integral LIST", options.problem.integral, "states to integrate");
  line.add_option("--method NAME", options.problem.method,
                  "continuous (default with --match-gains), discrete (weights per step) or sampled "
                  "(exact cost; default over missions)");
  line.add_number("--dt T", options.problem.dt, "sample period [s]");
  line.add_list("--tie LIST", options.ties,
                "states, integrals (as int_x) or inputs that share one weight; repeat the option "
                "for several");
  line.add_number("--tolerance SHARE", options.tolerance,
                  "largest difference of an entry of the gain that counts as matched, relative to "
                  "the largest entry of its row or of its column; default 0.001");
  line.add_count("--starts N", options.starts, 1,
                 "maximum number of searches from different starts; default 8");
  add_mission_tuning_options(line, options.missions);
  line.add_flag("--separate", options.separate,
                "over missions: tune the weights of x and y, and of roll and pitch, separately");
}

}  // namespace

Verb tune_lqr_verb() {
  return {
      "tune lqr",
      "V (--mission NAME | --requirements FILE) [options]   or   V --match-gains FILE [options]",
      "search LQR weights over missions, or compute the weights that give a gain",
      "quadtune tune lqr uquad --match-gains designs/uquad-hover.toml --R 0.01",
      with_options(add_options, run_tune_lqr)};
}

}  // namespace quadtune::cli
