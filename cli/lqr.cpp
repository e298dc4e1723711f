// SPDX-License-Identifier: Apache-2.0
/// quadtune lqr: of matrices, or of a vehicle about a trim.
#include "quadtune/synthesis/lqr.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <memory>
#include <optional>
#include <ostream>

#include "arguments/lqr_arguments.hpp"
#include "arguments/matrix_arguments.hpp"
#include "arguments/plant_arguments.hpp"
#include "laws/flown_or_ideal.hpp"
#include "laws/lqr_flown.hpp"
#include "laws/lqr_matrix.hpp"
#include "laws/lqr_schedule.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/synthesis/state_feedback.hpp"
#include "quadtune/workbench/flown/flying_loop.hpp"
#include "report/gains/laws_json.hpp"
#include "report/loops/flown_report.hpp"
#include "report/loops/margins_report.hpp"
#include "report/text/print.hpp"

namespace quadtune::cli {
namespace {

using internal::Json;

struct Options {
  LqrArguments vehicle;  // Q and R are the matrices', too
  std::string A, B, N;
  bool continuous = false;
  bool discrete = false;
  double sampled = 0;
  std::string schedule;
  std::string evidence;
  std::string plant;      // "flown", "ideal"; empty: by the other options
  std::string structure;  // of the flown plant: "dynamic", "matrix"; empty: dynamic
  FlownLqrArguments flown;
};

/// Ends with status 4 and the culprit unless the equation was solved; passes on its warning.
/// @param plant  what gave the model: a vehicle or "--A".
void require_solved(const RiccatiResult& result, const std::string& plant, const Context& context) {
  if (!result.solved())
    throw NoSolution(fmt::format("lqr: {}: {}", to_string(result.status), result.culprit),
                     result.status == RiccatiStatus::not_detectable ? "--Q" : plant);
  if (!result.warning.empty()) context.note("lqr: warning: " + result.warning);
}

Json evidence_json(const RiccatiResult& result) {
  Json json;
  json["poles"] = internal::poles_to_json(result.poles, "poles");
  json["residual"] = internal::number_to_json(result.residual, "residual");
  json["rcond"] = internal::number_to_json(result.rcond, "rcond");
  json["iterations"] = result.iterations;
  json["gain_error"] = internal::finite_or_null(result.gain_error);
  json["culprit"] = result.culprit;
  json["warning"] = result.warning;
  return json;
}

std::string evidence_text(const RiccatiResult& result) {
  return fmt::format("residual {:.2g}, rcond {:.2g}, {}", result.residual, result.rcond,
                     result.used_extended ? "in 50 digits"
                     : result.used_schur  ? "ordered Schur method"
                                          : fmt::format("{} doubling steps", result.iterations));
}

/// What --evidence asks for; nothing without it.
std::optional<MarginsEvidence> asked_evidence(const std::string& word) {
  if (word.empty()) return {};
  if (word == "none") return MarginsEvidence::none;
  if (word == "essential") return MarginsEvidence::essential;
  if (word == "full") return MarginsEvidence::full;
  throw UsageError(
      fmt::format("quadtune lqr: --evidence is '{}', expected none, essential or full{}", word,
                  internal::did_you_mean(word, {"none", "essential", "full"})),
      "--evidence");
}

/// Unasked, what takes about a second, with a note of what that leaves out.
MarginsEvidence evidence_or_affordable(std::optional<MarginsEvidence> asked, Eigen::Index states,
                                       Eigen::Index channels, Context& context) {
  if (asked) return *asked;
  const MarginsEvidence evidence = affordable_evidence(states, channels);
  if (evidence != MarginsEvidence::full)
    context.note(fmt::format(
        "lqr: note: {} left out, since with {} states and {} inputs it would take more than about "
        "a second; --evidence full computes all",
        evidence == MarginsEvidence::none ? "the margins are"
                                          : "the disk margin of all loops at once is",
        states, channels));
  return evidence;
}

void write_notes(const MarginsReport& margins, Context& context) {
  for (const std::string& note : margin_notes(margins)) context.note("lqr: note: " + note);
}

/// Whether R, which is symmetric and >= 0, has an eigenvalue that is 0 up to rounding.
bool is_singular(const Eigen::MatrixXd& R) {
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(R, Eigen::EigenvaluesOnly).eigenvalues();
  return eigenvalues.minCoeff() <= 1e-15 * eigenvalues.maxCoeff();
}

// --- matrices ------------------------------------------------------------------------------------

void run_matrices(const Options& options, bool sampled, Context& context) {
  if (static_cast<int>(options.continuous) + static_cast<int>(options.discrete) +
          static_cast<int>(sampled) >
      1)
    throw UsageError(
        "quadtune lqr: more than one of --continuous, --discrete and --sampled came, expected one",
        sampled ? "--sampled" : "--discrete");
  const std::optional<MarginsEvidence> evidence = asked_evidence(options.evidence);
  const auto need = [&context](const std::string& path, const char* option) {
    return require_matrix(path, context.in, "lqr", option);
  };
  if (sampled) require_positive(options.sampled, "lqr", "--sampled");
  const ContinuousLti plant = {need(options.A, "--A"), need(options.B, "--B"), {}, {}, {}, {}, {}};
  const LqrWeights weights = {need(options.vehicle.Q, "--Q"), need(options.vehicle.R, "--R"),
                              read_matrix(options.N, context.in)};
  RiccatiResult result;
  DiscreteLti discrete{plant.A, plant.B, {}, {}, 1, {}, {}, {}};
  if (options.discrete) {
    result = lqr(discrete, weights);
  } else if (sampled) {
    SampledLqr problem = sample(plant, weights, options.sampled);
    result = lqr(problem.plant, problem.weights);
    discrete = std::move(problem.plant);
  } else {
    result = lqr(plant, weights);
  }
  require_solved(result, "--A", context);
  const bool is_discrete = options.discrete || sampled;
  if (options.discrete && is_singular(weights.R) && result.warning.empty())
    context.note("lqr: note: R is singular; there is a solution because R + B'SB is not");
  const MarginsReport margins = margins_report(
      is_discrete ? loop_at_inputs(discrete, result.K) : loop_at_inputs(plant, result.K),
      numbered("u", plant.B.cols()),
      evidence_or_affordable(evidence, plant.A.rows(), plant.B.cols(), context));
  write_notes(margins, context);
  if (context.json) {
    Json json = {{"status", to_string(result.status)},
                 {"K", internal::matrix_to_json(result.K, "K")},
                 {"S", internal::matrix_to_json(result.X, "S")}};
    json.update(evidence_json(result));
    json["margins"] = to_json(margins);
    context.out << internal::readable(json) << "\n";
    return;
  }
  context.out << section("gain K", plain(result.K)) << section("cost S", plain(result.X))
              << section("poles", pole_table(result.poles, is_discrete ? discrete.dt : 0))
              << section("margins", to_text(margins)) << section("evidence", evidence_text(result));
}

// --- a vehicle -----------------------------------------------------------------------------------

void run_vehicle(const LqrArguments& arguments, const std::string& asked, Context& context) {
  const std::optional<MarginsEvidence> evidence = asked_evidence(asked);
  const LinearVehicle plant = make_plant(arguments.plant);
  const LqrDesign design =
      make_design(arguments, plant.model.plant.states, plant.model.plant.inputs);
  const StateFeedback feedback = state_feedback(plant.model.plant, design);
  const Gains gains = make_gains(plant.vehicle, plant.model, design, feedback);
  require_solved(feedback.riccati, arguments.plant.vehicle, context);
  for (const std::string& note : plant.model.notes) context.note("lqr: note: " + note);
  const MarginsReport margins = flying_margins(plant.model, gains, feedback.riccati,
                                               evidence.value_or(MarginsEvidence::full));
  write_notes(margins, context);
  const std::optional<FlownLoop> flown =
      flown_loop_of_ideal(plant.vehicle, plant.model, gains, context);
  if (flown && flown->grows())
    context.note(
        "lqr: warning: with the rotors' lag, the sensors and the estimator the loop is "
        "unstable; without --plant ideal the design includes them");
  if (context.json) {
    Json json = {{"status", to_string(feedback.riccati.status)},
                 {"plant", "ideal"},
                 {"K", internal::matrix_to_json(feedback.K, "K")},
                 {"K_int", internal::matrix_to_json(feedback.K_int, "K_int")},
                 {"S", internal::matrix_to_json(feedback.riccati.X, "S")}};
    json.update(evidence_json(feedback.riccati));
    json["states"] = internal::signals_to_json(plant.model.plant.states);
    json["inputs"] = internal::signals_to_json(plant.model.plant.inputs);
    json["integrals"] = design.integrals;
    json["margins"] = to_json(margins);
    json["flown"] = Json();
    if (flown) {
      json["flown"] = to_json(*flown);
      json["flown"]["margins"] = to_json(flown->margins);
    }
    ExportContent content;
    content.vehicle = plant.vehicle;
    content.gains = gains;
    add_laws(json, content);
    context.out << internal::readable(json) << "\n";
    return;
  }
  context.out << section("gain K", table(feedback.K, design.inputs, design.states));
  if (!design.integrals.empty())
    context.out << section("integral K", table(feedback.K_int, design.inputs, design.integrals));
  context.out << section("poles",
                         pole_table(flying_poles(plant.model, gains, feedback.riccati), design.dt))
              << section("margins", to_text(margins));
  if (flown)
    context.out << section("flown loop", to_text(*flown))
                << section("margins of the flown loop", to_text(flown->margins));
  context.out << section("evidence", evidence_text(feedback.riccati));
}

/// Options of the ideal plant alone: another flight than hover, other words, another cost.
constexpr const char* kIdealOptions[] = {"--at",       "--speed",  "--climb",      "--radius",
                                         "--yaw-rate", "--yaw",    "--convention", "--inputs",
                                         "--states",   "--method", "--schedule",   "--evidence"};

/// Options of a law of the flown plant that remembers its commands.
constexpr const char* kDynamicOptions[] = {"--change", "--past", "--integral"};

/// Whether --structure asks for a matrix alone.
bool asks_for_matrix(const std::string& structure, const CommandLine& line) {
  const std::vector<std::string> known = {"dynamic", "matrix"};
  if (structure.empty() || structure == "dynamic") return false;
  if (structure != "matrix")
    throw UsageError(
        fmt::format("quadtune lqr: --structure is '{}', expected dynamic or matrix{}",
                    internal::printable(structure), internal::did_you_mean(structure, known)),
        "--structure");
  for (const char* name : kDynamicOptions)
    if (line.was_given(name))
      throw UsageError(fmt::format("quadtune lqr: {} came with --structure matrix, expected none "
                                   "because that law integrates px,py,pz,yaw and does not "
                                   "remember its commands",
                                   name),
                       name);
  return true;
}

/// Whether the design is on the plant that flies, as --plant says, or where it is silent the other
/// options.
/// @param implied_by  becomes the option of the ideal plant that decided, where --plant is silent
bool on_flown_plant(const Options& options, const CommandLine& line, std::string& implied_by) {
  const bool matrix = asks_for_matrix(options.structure, line);
  std::string of_ideal;
  for (const std::string name : kIdealOptions)
    if (of_ideal.empty() && line.was_given(name) &&
        !(matrix && (name == "--convention" || name == "--inputs")))
      of_ideal = name;
  const std::string of_flown =
      options.flown.given.empty() ? std::string() : *options.flown.given.begin();
  const bool flown =
      options.plant.empty() ? of_ideal.empty() : asks_for_flown_plant(options.plant, "lqr");
  if (flown && !of_ideal.empty())
    throw UsageError(fmt::format("quadtune lqr: {} belongs to --plant ideal, expected a hover in "
                                 "the words of ned with the wrench on the flown plant",
                                 of_ideal),
                     of_ideal);
  if (!flown && options.structure == "dynamic" && !of_ideal.empty())
    throw UsageError(fmt::format("quadtune lqr: {} came with --structure dynamic, expected "
                                 "--structure matrix or none",
                                 of_ideal),
                     of_ideal);
  if (!flown && !of_flown.empty())
    throw UsageError(
        fmt::format("quadtune lqr: {} belongs to the flown plant, expected none with {}", of_flown,
                    options.plant.empty() ? of_ideal : "--plant ideal"),
        of_flown);
  if (options.plant.empty()) implied_by = of_ideal;
  return flown;
}

/// Refuses options of the other mode: taken in silence they would give another gain than was asked.
void refuse_options(const CommandLine& line, const std::vector<std::string>& names,
                    const std::string& why) {
  for (const std::string& name : names)
    if (line.was_given(name)) throw UsageError(fmt::format("quadtune lqr: {} {}", name, why), name);
}

bool any_matrix_option(const Options& options) { return !options.A.empty() || !options.B.empty(); }

}  // namespace

Verb lqr_verb() {
  return {
      "lqr", "V [options]   or   --A FILE --B FILE --Q FILE --R FILE [options]",
      "design an LQR gain, for matrices or for a vehicle about a trim",
      "quadtune lqr uquad --convention uquad --Q 1,1,1,1e3,1e3,1e3,1,1,1,1,1,1 --R 0.01 "
      "--method discrete --dt 0.01",
      [](CommandLine& line) -> Action {
        auto options = std::make_shared<Options>();
        add_plant_options(line, options->vehicle.plant);
        line.add_option("--A", options->A, "dynamics (nx x nx)")->type_name("FILE");
        line.add_option("--B", options->B, "inputs (nx x nu)")->type_name("FILE");
        line.add_option(
                "--Q", options->vehicle.Q,
                "state weights: a matrix file, or with V a list, integrals last; one number "
                "stands for all; default with V: Bryson's rule, on the ideal plant 1")
            ->type_name("FILE|LIST");
        line.add_option("--R", options->vehicle.R,
                        "input weights, likewise; > 0, or with --discrete >= 0 where R + B'SB is "
                        "regular")
            ->type_name("FILE|LIST");
        line.add_option("--N", options->N, "cross weights (nx x nu); none")->type_name("FILE");
        line.add_flag("--continuous", options->continuous, "A and B are continuous (default)");
        line.add_flag("--discrete", options->discrete, "A and B are discrete");
        Option* sampled =
            line.add_number("--sampled", options->sampled,
                            "continuous A, B, Q, R with the input held for DT seconds")
                ->type_name("DT");
        line.add_option("--integral", options->vehicle.integral,
                        "with V: states to integrate, or none; default px,py,pz,yaw, on the ideal "
                        "plant none")
            ->type_name("LIST");
        line.add_option("--method", options->vehicle.method,
                        "with V: continuous (default), discrete (weights per step) or sampled "
                        "(exact cost)")
            ->type_name("NAME");
        line.add_number("--dt", options->vehicle.dt,
                        "with V: sample period [s], 0.005 on the flown plant")
            ->type_name("T");
        line.add_option("--plant", options->plant,
                        "with V: flown (default) includes the rotors' lag, the sensors' delays and "
                        "the estimator; ideal is the textbook plant with 12 states, which options "
                        "from --at to --states, --method, --schedule and --evidence imply, of a "
                        "matrix but for --convention and --inputs")
            ->type_name("NAME");
        add_flown_lqr_options(line, options->flown);
        line.add_option("--structure", options->structure,
                        "flown plant: dynamic (default) remembers past commands and the rotors' "
                        "lag; matrix is one on 12 states and one on 4 integrals, for programs that "
                        "hold no more (K*.txt, controllerVars.m), in the words of --convention and "
                        "--inputs")
            ->type_name("NAME");
        line.add_option("--schedule", options->schedule,
                        "with V: gains over a grid, e.g. \"speed=0:0.5:10, yaw_rate=-2:1:2\" "
                        "(first:step:last); also climb, and mass and density as ratios")
            ->type_name("GRID");
        line.add_option(
                "--evidence", options->evidence,
                "margins that are computed: none, essential (each loop) or full (and all at "
                "once); full where that takes about a second, less with a note otherwise")
            ->type_name("HOW");
        return [options, sampled, owner = &line](Context& context) {
          const bool has_vehicle = !options->vehicle.plant.vehicle.empty();
          options->vehicle.has_dt = owner->was_given("--dt");
          if (has_vehicle && any_matrix_option(*options))
            throw UsageError(
                "quadtune lqr: a vehicle and --A or --B came together, expected "
                "one or the other",
                options->A.empty() ? "--B" : "--A");
          if (!has_vehicle && !any_matrix_option(*options))
            throw UsageError("quadtune lqr: expected a vehicle, or --A, --B, --Q and --R", "V");
          if (has_vehicle) {
            refuse_options(*owner, {"--N", "--continuous", "--discrete", "--sampled"},
                           "belongs to matrices, expected --method and --dt with a vehicle");
            options->flown.given = given_flown_options(*owner);
            if (!options->structure.empty()) options->flown.given.insert("--structure");
            std::string implied_by;
            if (on_flown_plant(*options, *owner, implied_by)) {
              if (options->structure == "matrix")
                run_matrix_lqr(options->vehicle, options->flown, owner->was_given("--inputs"),
                               context);
              else
                run_flown_lqr(options->vehicle, options->flown, context);
              return;
            }
            if (options->schedule.empty()) {
              run_vehicle(options->vehicle, options->evidence, context);
            } else {
              refuse_options(
                  *owner, {"--evidence"},
                  "came with --schedule, expected none because a schedule has no margins");
              refuse_options(*owner, {"--at", "--speed", "--climb", "--radius", "--yaw-rate"},
                             "came with --schedule, expected the flight as axes of the grid, "
                             "e.g. --schedule \"speed=2\"");
              run_schedule(options->vehicle, options->schedule, context);
            }
            if (!implied_by.empty())
              context.note(
                  fmt::format("lqr: note: {} implies --plant ideal, the textbook plant "
                              "without the rotors' lag, the sensors' delays and the "
                              "estimator",
                              implied_by));
          } else {
            refuse_options(*owner,
                           {"--at",     "--speed",      "--climb",    "--radius", "--yaw-rate",
                            "--yaw",    "--convention", "--inputs",   "--states", "--integral",
                            "--method", "--dt",         "--schedule", "--plant",  "--change",
                            "--past",   "--estimator",  "--sensors",  "--height", "--structure"},
                           "belongs to a vehicle, expected --discrete or --sampled DT with "
                           "matrices");
            run_matrices(*options, sampled->was_given(), context);
          }
        };
      }};
}

}  // namespace quadtune::cli
