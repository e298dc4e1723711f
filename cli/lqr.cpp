// SPDX-License-Identifier: Apache-2.0
/// quadtune lqr: of matrices, or of a vehicle about a trim.
#include <fmt/format.h>

#include <memory>
#include <optional>

#include "arguments/matrix_arguments.hpp"
#include "lqr_vehicle.hpp"
#include "program/command_line.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/design/lqr_report.hpp"
#include "report/gains/lqr_report.hpp"

namespace quadtune::cli {
namespace {

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

/// Refuses options of the other kind of problem: taken in silence they would give another gain than
/// was asked.
void refuse_options(const CommandLine& line, const std::vector<std::string>& names,
                    const std::string& why) {
  for (const std::string& name : names)
    if (line.was_given(name)) throw UsageError(fmt::format("quadtune lqr: {} {}", name, why), name);
}

void run_matrices(const Options& options, bool sampled, Context& context) {
  if (static_cast<int>(options.continuous) + static_cast<int>(options.discrete) +
          static_cast<int>(sampled) >
      1)
    throw UsageError(
        "quadtune lqr: more than one of --continuous, --discrete and --sampled came, expected one",
        sampled ? "--sampled" : "--discrete");
  std::optional<MarginsEvidence> evidence;
  if (!options.evidence.empty())
    evidence = option_of_command("lqr", [&] { return margins_evidence(options.evidence); });
  const auto need = [&context](const std::string& path, const char* option) {
    return require_matrix(path, context.in, "lqr", option);
  };
  LqrProblem problem;
  if (sampled) {
    require_positive(options.sampled, "lqr", "--sampled");
    problem.sampled = options.sampled;
  }
  problem.discrete = options.discrete;
  problem.A = need(options.A, "--A");
  problem.B = need(options.B, "--B");
  problem.weights = {need(options.vehicle.Q, "--Q"), need(options.vehicle.R, "--R"),
                     read_matrix(options.N, context.in)};
  const LqrReport report = lqr_report(problem, evidence);
  require_solved(report.riccati, "--A");
  for (const std::string& message : report.messages) context.note("lqr: " + message);
  context.print([&] { return to_json(report); }, [&] { return to_text(report); });
}

void run_vehicle(const CommandLine& line, Options& options, Context& context) {
  refuse_options(line, {"--N", "--continuous", "--discrete", "--sampled"},
                 "belongs to matrices, expected --method and --dt with a vehicle");
  options.flown.given = given_flown_options(line);
  if (!options.structure.empty()) options.flown.given.insert("--structure");
  const PlantChoice choice = choose_plant(line, options.plant, options.structure, options.flown);
  if (choice.flown && choice.matrix) {
    run_matrix_lqr(options.vehicle, options.flown, line.was_given("--inputs"), context);
  } else if (choice.flown) {
    run_flown_lqr(options.vehicle, options.flown, context);
  } else if (options.schedule.empty()) {
    run_ideal_lqr(options.vehicle, options.evidence, context);
  } else {
    refuse_options(line, {"--evidence"},
                   "came with --schedule, expected none because a schedule has no margins");
    refuse_options(line, {"--at", "--speed", "--climb", "--radius", "--yaw-rate"},
                   "came with --schedule, expected the flight as axes of the grid, e.g. --schedule "
                   "\"speed=2\"");
    run_schedule(options.vehicle, options.schedule, context);
  }
  if (!choice.implied_by.empty())
    context.note(
        fmt::format("lqr: note: {} implies --plant ideal, the textbook plant without the "
                    "rotors' lag, the sensors' delays and the estimator",
                    choice.implied_by));
}

void run(const CommandLine& line, Options& options, Context& context) {
  const bool has_vehicle = !options.vehicle.plant.vehicle.empty();
  const bool has_matrices = !options.A.empty() || !options.B.empty();
  options.vehicle.has_dt = line.was_given("--dt");
  if (has_vehicle && has_matrices)
    throw UsageError(
        "quadtune lqr: a vehicle and --A or --B came together, expected one or the other",
        options.A.empty() ? "--B" : "--A");
  if (!has_vehicle && !has_matrices)
    throw UsageError("quadtune lqr: expected a vehicle, or --A, --B, --Q and --R", "V");
  if (has_vehicle) {
    run_vehicle(line, options, context);
    return;
  }
  refuse_options(line, {"--at",     "--speed",      "--climb",    "--radius", "--yaw-rate",
                        "--yaw",    "--convention", "--inputs",   "--states", "--integral",
                        "--method", "--dt",         "--schedule", "--plant",  "--change",
                        "--past",   "--estimator",  "--sensors",  "--height", "--structure"},
                 "belongs to a vehicle, expected --discrete or --sampled DT with matrices");
  run_matrices(options, line.was_given("--sampled"), context);
}

void add_options(CommandLine& line, Options& options) {
  add_plant_options(line, options.vehicle.plant);
  line.add_option("--A", options.A, "dynamics (nx x nx)")->type_name("FILE");
  line.add_option("--B", options.B, "inputs (nx x nu)")->type_name("FILE");
  line.add_option("--Q", options.vehicle.Q,
                  "state weights: a matrix file, or with V a list, integrals last; one number "
                  "stands for all; default with V: Bryson's rule, on the ideal plant 1")
      ->type_name("FILE|LIST");
  line.add_option("--R", options.vehicle.R,
                  "input weights, likewise; > 0, or with --discrete >= 0 where R + B'SB is "
                  "regular")
      ->type_name("FILE|LIST");
  line.add_option("--N", options.N, "cross weights (nx x nu); none")->type_name("FILE");
  line.add_flag("--continuous", options.continuous, "A and B are continuous (default)");
  line.add_flag("--discrete", options.discrete, "A and B are discrete");
  line.add_number("--sampled", options.sampled,
                  "continuous A, B, Q, R with the input held for DT seconds")
      ->type_name("DT");
  line.add_option("--integral", options.vehicle.integral,
                  "with V: states to integrate, or none; default px,py,pz,yaw, on the ideal "
                  "plant none")
      ->type_name("LIST");
  line.add_option("--method", options.vehicle.method,
                  "with V: continuous (default), discrete (weights per step) or sampled "
                  "(exact cost)")
      ->type_name("NAME");
  line.add_number("--dt", options.vehicle.dt, "with V: sample period [s], 0.005 on the flown plant")
      ->type_name("T");
  line.add_option("--plant", options.plant,
                  "with V: flown (default) includes the rotors' lag, the sensors' delays and "
                  "the estimator; ideal is the textbook plant with 12 states, which options "
                  "from --at to --states, --method, --schedule and --evidence imply, of a "
                  "matrix but for --convention and --inputs")
      ->type_name("NAME");
  add_flown_lqr_options(line, options.flown);
  line.add_option("--structure", options.structure,
                  "flown plant: dynamic (default) remembers past commands and the rotors' "
                  "lag; matrix is one on 12 states and one on 4 integrals, for programs that "
                  "hold no more (K*.txt, controllerVars.m), in the words of --convention and "
                  "--inputs")
      ->type_name("NAME");
  line.add_option("--schedule", options.schedule,
                  "with V: gains over a grid, e.g. \"speed=0:0.5:10, yaw_rate=-2:1:2\" "
                  "(first:step:last); also climb, and mass and density as ratios")
      ->type_name("GRID");
  line.add_option("--evidence", options.evidence,
                  "margins that are computed: none, essential (each loop) or full (and all at "
                  "once); full where that takes about a second, less with a note otherwise")
      ->type_name("HOW");
}

}  // namespace

Verb lqr_verb() {
  return {"lqr", "V [options]   or   --A FILE --B FILE --Q FILE --R FILE [options]",
          "design an LQR gain, for matrices or for a vehicle about a trim",
          "quadtune lqr uquad --convention uquad --Q 1,1,1,1e3,1e3,1e3,1,1,1,1,1,1 --R 0.01 "
          "--method discrete --dt 0.01",
          [](CommandLine& line) -> Action {
            auto options = std::make_shared<Options>();
            add_options(line, *options);
            return [options, owner = &line](Context& context) { run(*owner, *options, context); };
          }};
}

}  // namespace quadtune::cli
