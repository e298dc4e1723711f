// SPDX-License-Identifier: Apache-2.0
/// quadtune lqr: LQR gains for matrices, or for a vehicle at a trim.
#include <fmt/format.h>

#include <cstdint>
#include <optional>

#include "arguments/matrix_arguments.hpp"
#include "lqr_vehicle.hpp"
#include "program/command_line.hpp"
#include "program/refusal.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/workbench/flown/plant_word.hpp"
#include "quadtune/workbench/systems/matrix_lqr.hpp"
#include "report/gains/gains.hpp"
#include "report/loops/matrix_loops.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  LqrArguments vehicle;  // Q and R serve for matrices, too
  std::string A, B, C, D, N;
  TimeArguments time;  // of the matrices
  std::uint64_t delay = 0;
  bool show_sampled = false;
  std::string schedule;
  std::string evidence;
  std::string plant;      // "flown", "ideal"; empty: chosen by the other options
  std::string structure;  // of the flown plant: "dynamic", "matrix"; empty: dynamic
  FlownLqrArguments flown;
};

struct PlantChoice {
  bool flown = true;       // with motor lag, sensor delays and estimator
  bool matrix = false;     // --structure matrix
  std::string implied_by;  // the option that selected the ideal plant if --plant is absent
};

/// Options that apply only to the ideal plant: other flights than hover, other conventions, other
/// costs.
constexpr const char* kIdealOptions[] = {"--at",       "--speed",  "--climb",      "--radius",
                                         "--yaw-rate", "--yaw",    "--convention", "--inputs",
                                         "--states",   "--method", "--schedule",   "--evidence"};

/// Whether --structure selects a matrix.
bool asks_for_matrix(const std::string& structure, const CommandLine& line) {
  if (structure.empty() || structure == "dynamic") return false;
  if (structure != "matrix")
    refuse("--structure", "--structure is '{}', expected dynamic or matrix{}",
           internal::printable(structure),
           internal::did_you_mean(structure, {"dynamic", "matrix"}));
  line.refuse_given(
      {"--change", "--past", "--integral"},
      "cannot be combined with --structure matrix, because that law always integrates "
      "px,py,pz,yaw and feeds back no past commands");
  return true;
}

/// The first given option that applies only to the ideal plant; empty if there is none.
std::string option_of_ideal(const CommandLine& line, bool matrix) {
  for (std::string name : kIdealOptions)
    if (line.was_given(name) && !(matrix && (name == "--convention" || name == "--inputs")))
      return name;
  return "";
}

/// @throws UsageError  for unknown values, and for options of the other plant or structure
PlantChoice choose_plant(const CommandLine& line, const std::string& plant,
                         const std::string& structure) {
  PlantChoice choice;
  choice.matrix = asks_for_matrix(structure, line);
  const std::string of_ideal = option_of_ideal(line, choice.matrix);
  choice.flown = plant.empty() ? of_ideal.empty() : asks_for_flown_plant(plant);
  if (choice.flown && !of_ideal.empty())
    refuse(of_ideal,
           "{} belongs to --plant ideal; on the flown plant the design is for a hover in "
           "convention ned with the wrench as input",
           of_ideal);
  if (!choice.flown && structure == "dynamic" && !of_ideal.empty())
    refuse(of_ideal,
           "{} cannot be combined with --structure dynamic; expected --structure matrix or no "
           "--structure",
           of_ideal);
  if (!choice.flown)
    line.refuse_given({"--change", "--estimator", "--height", "--past", "--sensors", "--structure"},
                      "belongs to the flown plant and cannot be combined with " +
                          (plant.empty() ? of_ideal : "--plant ideal"));
  if (plant.empty()) choice.implied_by = of_ideal;
  return choice;
}

// Options of the other kind of problem are rejected. If they were ignored, the gain would not be
// the requested one.

void run_matrices(const Options& options, Context& context) {
  require_one_time(options.time);
  std::optional<MarginsEvidence> evidence;
  if (!options.evidence.empty()) evidence = margins_evidence(options.evidence);
  const auto need = [&context](const std::string& path, const char* option) {
    return require_matrix(path, context.in, option);
  };
  MatrixLqrProblem problem;
  LqrProblem& lqr = problem.lqr;
  if (options.time.sampled) require_positive(*options.time.sampled, "--sampled");
  if (options.vehicle.dt) {
    if (options.time.sampled)
      refuse("--dt",
             "--dt cannot be combined with --sampled, which gives the sample period already");
    if (!options.time.discrete)
      refuse("--dt",
             "--dt with matrices requires --discrete; use --sampled DT for a "
             "continuous plant whose input is held");
    require_positive(*options.vehicle.dt, "--dt");
    problem.dt = *options.vehicle.dt;
  }
  if (options.show_sampled && !options.time.sampled)
    refuse("--show-sampled", "--show-sampled requires --sampled DT");
  constexpr std::uint64_t kMaxDelay = 2000;
  if (options.delay > kMaxDelay)
    refuse("--delay", "--delay is {} samples, expected at most {}", options.delay, kMaxDelay);
  if (options.delay > 0 && !options.time.discrete && !options.time.sampled)
    refuse("--delay", "--delay is in samples, expected --discrete or --sampled DT with it");
  if (options.C.empty() && !options.D.empty())
    refuse("--D", "--D requires --C, the outputs that are integrated");
  problem.delay = static_cast<int>(options.delay);
  lqr.sampled = options.time.sampled;
  lqr.discrete = options.time.discrete;
  lqr.A = need(options.A, "--A");
  lqr.B = need(options.B, "--B");
  problem.C = read_matrix(options.C, context.in, "--C");
  problem.D = read_matrix(options.D, context.in, "--D");
  lqr.weights = {need(options.vehicle.Q, "--Q"), need(options.vehicle.R, "--R"),
                 read_matrix(options.N, context.in, "--N")};
  const MatrixLqrReport report = matrix_lqr(problem, evidence);
  require_solved(report.lqr.riccati, "--A");
  note_period(options.time, options.vehicle.dt, context);
  context.notes(report.lqr.messages);
  context.notes("warning: ", margin_warnings(report.lqr.margins));
  context.print([&] { return to_json(report); },
                [&] { return to_text(report, options.show_sampled); });
}

void run_vehicle(const CommandLine& line, Options& options, Context& context) {
  line.refuse_given({"--continuous", "--discrete", "--sampled", "--show-sampled"},
                    "applies to matrices only; use --method and --dt with a vehicle");
  line.refuse_given({"--C", "--D"},
                    "applies to matrices only; --integral selects the states of a vehicle that are "
                    "integrated");
  line.refuse_given({"--N"}, "applies to matrices only");
  line.refuse_given({"--delay"},
                    "applies to matrices only; the delays of a vehicle are those of its file");
  const PlantChoice choice = choose_plant(line, options.plant, options.structure);
  if (choice.flown && choice.matrix) {
    run_matrix_lqr(options.vehicle, options.flown, line.was_given("--inputs"), context);
  } else if (choice.flown) {
    run_flown_lqr(options.vehicle, options.flown, context);
  } else if (options.schedule.empty()) {
    run_ideal_lqr(options.vehicle, options.evidence, context);
  } else {
    line.refuse_given({"--evidence"},
                      "cannot be combined with --schedule, because a schedule has no margins");
    line.refuse_given({"--at", "--speed", "--climb", "--radius", "--yaw-rate"},
                      "cannot be combined with --schedule; give the flight as axes of the grid, "
                      "e.g. --schedule \"speed=2\"");
    run_schedule(options.vehicle, options.schedule, context);
  }
  if (!choice.implied_by.empty())
    context.note(
        fmt::format("note: {} implies --plant ideal, the textbook plant without motor lag, "
                    "sensor delays and estimator",
                    choice.implied_by));
}

void run_lqr(const CommandLine& line, Options& options, Context& context) {
  const bool has_vehicle = !options.vehicle.plant.vehicle.empty();
  const bool has_matrices = !options.A.empty() || !options.B.empty();
  if (has_vehicle && has_matrices)
    refuse(options.A.empty() ? "--B" : "--A",
           "a vehicle and --A or --B were both given, expected one or the other");
  if (!has_vehicle && !has_matrices) refuse("V", "expected a vehicle, or --A, --B, --Q and --R");
  if (has_vehicle) {
    run_vehicle(line, options, context);
    return;
  }
  line.refuse_given({"--method"},
                    "applies to a vehicle only; use --discrete or --sampled DT with matrices");
  line.refuse_given({"--integral"},
                    "applies to a vehicle only; use --C, the outputs that are integrated, with "
                    "matrices");
  line.refuse_given({"--at", "--speed", "--climb", "--radius", "--yaw-rate", "--yaw",
                     "--convention", "--inputs", "--states", "--schedule", "--plant", "--change",
                     "--past", "--estimator", "--sensors", "--height", "--structure"},
                    "applies to a vehicle only");
  run_matrices(options, context);
}

void add_options(CommandLine& line, Options& options) {
  add_plant_options(line, options.vehicle.plant);
  line.add_option("--A FILE", options.A, "dynamics (nx x nx)");
  line.add_option("--B FILE", options.B, "inputs (nx x nu)");
  line.add_option(
      "--Q FILE|LIST", options.vehicle.Q,
      "state weights: a matrix file, or with V a list with the integrals last, or one number for "
      "all; default with V: Bryson's rule, or 1 on the ideal plant");
  line.add_option("--R FILE|LIST", options.vehicle.R,
                  "input weights, as --Q; > 0, or with --discrete >= 0 if R + B'SB is nonsingular");
  line.add_option("--N FILE", options.N, "cross weights (nx x nu); default: 0");
  line.add_option(
      "--C FILE", options.C,
      "outputs y = C x + D u whose integrals are fed back (LQI); the last rows of Q and N "
      "are theirs");
  line.add_option("--D FILE", options.D, "feed-through to these outputs; default: 0");
  line.add_count("--delay N", options.delay, 0,
                 "the input acts N samples late; with --discrete or --sampled");
  line.add_flag("--show-sampled", options.show_sampled,
                "with --sampled: also print the sampled A, B, Q, R and N; JSON always has them");
  line.add_flag("--continuous", options.time.continuous, "A and B are continuous (default)");
  line.add_flag("--discrete", options.time.discrete, "A and B are discrete");
  line.add_number("--sampled DT", options.time.sampled,
                  "continuous A, B, Q, R with the input held for DT [s]");
  line.add_option(
      "--integral LIST", options.vehicle.integral,
      "with V: states to integrate, or none; default px,py,pz,yaw, on the ideal plant none");
  line.add_option(
      "--method NAME", options.vehicle.method,
      "with V: continuous (default), discrete (weights per step) or sampled (exact cost)");
  line.add_number("--dt T", options.vehicle.dt,
                  "sample period [s]: with V, 0.005 on the flown plant; with --discrete, that of A "
                  "and B, default 1");
  line.add_option("--plant NAME", options.plant,
                  "with V: flown (default) includes motor lag, sensor delays and estimator; ideal "
                  "is the textbook plant with 12 states, which some of the other options require");
  add_flown_lqr_options(line, options.flown);
  line.add_option(
      "--structure NAME", options.structure,
      "flown plant: dynamic (default) feeds back past commands and the motor lag; matrix consists "
      "of one gain on 12 states and one on 4 integrals, for programs that store no more (K*.txt, "
      "controllerVars.m), in the convention of --convention and --inputs");
  line.add_option("--schedule GRID", options.schedule,
                  "with V: gain schedule over a grid, e.g. \"speed=0:0.5:10, yaw_rate=-2:1:2\" "
                  "(first:step:last); further axes are climb, and mass and density as ratios");
  line.add_option(
      "--evidence HOW", options.evidence,
      "margins that are computed: none, essential (each loop) or full (and all loops at once); "
      "default: full if that takes about a second, otherwise less and a note");
}

}  // namespace

Verb lqr_verb() {
  return {"lqr", "V [options]   or   --A FILE --B FILE --Q FILE --R FILE [options]",
          "design an LQR gain, for matrices or for a vehicle at a trim",
          "quadtune lqr uquad --convention uquad --Q 1,1,1,1e3,1e3,1e3,1,1,1,1,1,1 --R 0.01 "
          "--method discrete --dt 0.01",
          with_options(add_options, run_lqr)};
}

}  // namespace quadtune::cli
