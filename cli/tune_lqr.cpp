// SPDX-License-Identifier: Apache-2.0
/// quadtune tune lqr: weights of an LQR problem, over missions or those whose gain is a given one.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <ostream>

#include "arguments/lqr_arguments.hpp"
#include "arguments/matrix_arguments.hpp"
#include "arguments/mission_arguments.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/convert.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/tuning/match_gains.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/design/given_gains.hpp"
#include "quadtune/workbench/missions/lqr_tuning.hpp"
#include "report/gains/gain_match_report.hpp"

namespace quadtune::cli {
namespace {

constexpr char kVerb[] = "tune lqr";

struct Options {
  LqrArguments problem;
  MissionTuningArguments missions;
  bool separate = false;
  std::string gains;
  std::vector<std::string> ties;
  double tolerance = 1e-3;
  std::uint64_t starts = 8;
};

[[noreturn]] void refuse(const char* option, const std::string& why) {
  throw UsageError(fmt::format("quadtune {}: {}", kVerb, why), option);
}

std::string list_of(const std::vector<Signal>& signals) {
  std::vector<std::string> words;
  words.reserve(signals.size());
  for (const Signal& signal : signals) words.push_back(signal.name);
  return fmt::format("{}", internal::joined(words, ","));
}

/// What the command line leaves open is as the gains, or the design that they stand in, have it.
void complete(const CommandLine& line, const GivenGains& given, LqrArguments& problem) {
  const auto absent = [&line](const char* option) { return !line.was_given(option); };
  PlantArguments& plant = problem.plant;
  if (absent("--convention")) plant.convention = given.gains.convention;
  if (absent("--inputs")) plant.inputs = to_string(given.gains.input_kind);
  const Convention& words = convention(plant.convention, "--convention");
  const Gains turned = in_convention(given.gains, words);
  if (absent("--states")) plant.states = list_of(turned.states);
  if (absent("--integral")) problem.integral = list_of(turned.integrals);
  problem.has_dt = !absent("--dt");
  if (!problem.has_dt && given.gains.dt > 0) {
    problem.dt = given.gains.dt;
    problem.has_dt = true;
  }
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

/// What the library refuses of the ties is the option's mistake.
GainMatch match_or_refuse(const LinearVehicle& plant, const LqrDesign& design,
                          const OrderedGains& gains, const GainMatchOptions& options,
                          const std::string& file) {
  try {
    return match_gains(plant.model.plant, design, gains.K, gains.K_int, options);
  } catch (const InvalidInput& error) {
    if (error.where() != "match_gains") throw;
    const std::string& why = error.message();
    if (why.find(" tie") != std::string::npos) refuse("--tie", "--tie: " + why);
    throw InvalidInput(file, why);
  }
}

/// @param problem  `method` is empty where it was not said
LqrArguments with_defaults(LqrArguments problem) {
  problem.verb = "tune lqr";
  if (problem.plant.at != "hover")
    throw UsageError(fmt::format("quadtune tune lqr: --at is '{}', expected hover because missions "
                                 "are flown with gains about it",
                                 internal::printable(problem.plant.at)),
                     "--at");
  if (problem.Q.empty() && problem.R.empty()) problem.plant.inputs = "wrench";
  if (problem.method.empty()) problem.method = "sampled";
  if (!problem.has_dt && problem.method != "continuous") {
    problem.dt = kUsualPeriod;
    problem.has_dt = true;
  }
  return problem;
}

void run_missions(const Options& options, Context& context) {
  require_sane(kVerb, options.missions);
  const MissionRequirements requirements = mission_requirements(kVerb, options.missions);
  const LqrArguments problem = with_defaults(options.problem);
  LinearVehicle plant = make_plant(problem.plant);
  const LqrDesign design = make_design(problem, plant.model.plant.states, plant.model.plant.inputs);
  const bool standard = problem.Q.empty() && problem.R.empty();
  if (standard && (problem.plant.convention != "ned" || problem.plant.states != "full"))
    refuse("--Q",
           "expected --Q and --R beside --convention or --states, because weights by Bryson's rule "
           "are of all states in ned");
  if (design.dt == 0)
    refuse("--method",
           "--method continuous came, expected discrete or sampled because the gains are flown by "
           "a computer");
  run_mission_tuning(kVerb, lqr_tuning(std::move(plant), design, standard, options.separate),
                     requirements, options.missions, context);
}

void run(const CommandLine& line, Options options, Context& context) {
  if (options.problem.plant.vehicle.empty())
    refuse("V", "expected a vehicle, and --mission NAME or --match-gains FILE");
  if (options.gains.empty()) {
    options.missions.vehicle = options.problem.plant.vehicle;
    options.problem.has_dt = line.was_given("--dt");
    if (!line.was_given("--method")) options.problem.method.clear();
    if (options.missions.missions.empty() && options.missions.requirements.empty())
      refuse("--mission",
             "expected --mission NAME or --requirements FILE to tune weights over missions, or "
             "--match-gains FILE to find those of a gain");
    for (const char* option : {"--tie", "--tolerance", "--starts"})
      if (line.was_given(option))
        refuse(option, fmt::format("{} is for --match-gains, expected none", option));
    if (options.problem.Q.empty() && options.problem.R.empty() && line.was_given("--inputs") &&
        options.problem.plant.inputs != "wrench")
      refuse("--inputs",
             "--inputs came without --Q and --R, expected none or wrench because weights by "
             "Bryson's rule are of it");
    run_missions(options, context);
    return;
  }
  for (const char* option :
       {"--mission", "--requirements", "--budget", "--evaluations", "--monte-carlo", "--proof",
        "--measure", "--estimator", "--sensors", "--wind", "--duration", "--separate", "--report"})
    if (line.was_given(option))
      refuse(option, fmt::format("{} is for missions, expected none beside --match-gains", option));
  if (!(options.tolerance > 0))
    refuse("--tolerance",
           fmt::format("--tolerance is {}, expected a positive number", options.tolerance));
  require_design_name(options.missions.file, kVerb);
  const GivenGains given = read_given_gains(options.gains);
  if (given.gains.memory)
    throw InvalidInput(options.gains,
                       "the law feeds back its past commands, expected a matrix on the states and "
                       "their integrals, because weights are sought on the textbook plant");
  options.problem.verb = kVerb;
  complete(line, given, options.problem);
  const LinearVehicle plant = make_plant(options.problem.plant);
  require_states(given.gains, plant.model.plant.states,
                 convention(options.problem.plant.convention, "--convention"), options.gains);
  const LqrDesign design =
      make_design(options.problem, plant.model.plant.states, plant.model.plant.inputs);
  for (Eigen::Index i = 0; i < design.R.rows(); ++i)
    if (design.R(i, i) == 0) refuse("--R", "--R has a 0, expected more because R shall be > 0");
  const OrderedGains gains = in_order_of(given.gains, plant.vehicle, design, options.gains);
  GainMatchOptions settings;
  settings.tolerance = options.tolerance;
  settings.starts = static_cast<int>(std::min<std::uint64_t>(options.starts, 1000));
  settings.seed = context.seed;
  settings.interrupted = [] { return interrupted(); };
  for (const std::string& tie : options.ties) settings.ties.push_back(word_list(tie));
  const GainMatch match = match_or_refuse(plant, design, gains, settings, options.gains);
  if (match.status == GainMatchStatus::interrupted) throw Interrupted();
  if (!match.has_weights())
    throw NoSolution(fmt::format("tune: {}: {}", options.gains, match.culprit), options.gains);
  for (const std::string& note : plant.model.notes) context.note("tune: note: " + note);
  const GainMatchReport report{plant.vehicle,
                               options.problem.plant.vehicle,
                               flight_condition(options.problem.plant),
                               options.gains,
                               gains.K,
                               gains.K_int,
                               match,
                               options.tolerance};
  const bool matched = match.status == GainMatchStatus::matched;
  if (!options.missions.file.empty() && (matched || options.missions.force)) {
    write_file(options.missions.file, design_file(report, options.missions.file, context.command));
    context.written.push_back(options.missions.file);
  }
  context.out << (context.json ? internal::readable(to_json(report)) + "\n" : to_text(report));
  if (!matched)
    throw AnswerIsNo(
        fmt::format("tune: {}: no diagonal weights{} were found that give this gain: the nearest "
                    "leave {:.3g} at "
                    "{}, tolerance {:.3g}",
                    options.gains, options.ties.empty() ? "" : " so tied", match.after, match.worst,
                    options.tolerance));
}

void add_options(CommandLine& line, Options& options) {
  add_plant_options(line, options.problem.plant);
  line.add_option("--match-gains", options.gains,
                  "find weights whose gain is this one: an export, a file of gains, or a design "
                  "with [published] gains; options that are absent are as there")
      ->type_name("FILE");
  line.add_option("--Q", options.problem.Q,
                  "where the search begins: a list, integrals last; one number stands for all, 1 "
                  "if absent; a weight of 0 stays 0")
      ->type_name("LIST");
  line.add_option("--R", options.problem.R,
                  "likewise of the inputs; its geometric mean stays, as a gain tells weights up to "
                  "a factor")
      ->type_name("LIST");
  line.add_option("--integral", options.problem.integral, "states to integrate")->type_name("LIST");
  line.add_option("--method", options.problem.method,
                  "continuous (default with --match-gains), discrete (weights per step) or sampled "
                  "(exact cost; default over missions)")
      ->type_name("NAME");
  line.add_number("--dt", options.problem.dt, "sample period [s]")->type_name("T");
  line.add_list("--tie", options.ties,
                "states, integrals as int_x, or inputs of one weight; several: repeat the option")
      ->type_name("LIST");
  line.add_number(
          "--tolerance", options.tolerance,
          "greatest difference of an entry, over its row's or column's largest, that counts as "
          "matched; 0.001")
      ->type_name("SHARE");
  line.add_count("--starts", options.starts, 1, "searches from different starts at most; 8")
      ->type_name("N");
  add_mission_tuning_options(line, options.missions);
  line.add_flag("--separate", options.separate,
                "over missions: weights of x and y, roll and pitch each for itself");
}

}  // namespace

Verb tune_lqr_verb() {
  return {kVerb, "V --mission NAME [options]   or   V --match-gains FILE [options]",
          "search LQR weights over missions, or those whose gain is a given one",
          "quadtune tune lqr uquad --match-gains designs/uquad-hover.toml --R 0.01",
          [](CommandLine& line) -> Action {
            auto options = std::make_shared<Options>();
            add_options(line, *options);
            return [options, owner = &line](Context& context) { run(*owner, *options, context); };
          }};
}

}  // namespace quadtune::cli
