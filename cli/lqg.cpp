// SPDX-License-Identifier: Apache-2.0
/// quadtune lqg: state feedback and filter together, with the deviations that sensor noise causes,
/// for a vehicle or for matrices.
#include <fmt/format.h>

#include "arguments/flown_lqr_arguments.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/workbench/design/lqg_report.hpp"
#include "quadtune/workbench/systems/matrix_lqr.hpp"
#include "report/gains/gains.hpp"
#include "report/loops/matrix_loops.hpp"
#include "report/text/print.hpp"

namespace quadtune::cli {
namespace {

/// Files of a problem with given matrices; Q and R are those of LqrArguments.
struct MatrixFiles {
  std::string A, B, C, D, N, G, noise_Q, noise_R, noise_N;
  TimeArguments time;
  std::string estimate = "current";

  [[nodiscard]] bool given() const { return !A.empty() || !B.empty() || !C.empty(); }
};

struct Options {
  LqrArguments common;
  FlownLqrArguments flown;
  LqgOptions lqg;
  MatrixFiles matrices;
};

MatrixLqgProblem read_problem(const Options& options, Context& context) {
  const MatrixFiles& files = options.matrices;
  const auto need = [&context](const std::string& path, const char* option) {
    return require_matrix(path, context.in, option);
  };
  MatrixLqgProblem problem;
  problem.A = need(files.A, "--A");
  problem.B = need(files.B, "--B");
  problem.C = need(files.C, "--C");
  problem.D = read_matrix(files.D, context.in, "--D");
  problem.weights = {need(options.common.Q, "--Q"), need(options.common.R, "--R"),
                     read_matrix(files.N, context.in, "--N")};
  problem.noise = {read_matrix(files.G, context.in, "--G"), need(files.noise_Q, "--noise-Q"),
                   need(files.noise_R, "--noise-R"),
                   read_matrix(files.noise_N, context.in, "--noise-N")};
  problem.time = files.time.sampled    ? MatrixTime::sampled
                 : files.time.discrete ? MatrixTime::discrete
                                       : MatrixTime::continuous;
  problem.dt = files.time.sampled.value_or(options.common.dt.value_or(1));
  problem.estimate = files.estimate == "delayed" ? LqgEstimate::delayed : LqgEstimate::current;
  return problem;
}

void run_matrices(const CommandLine& line, const Options& options, Context& context) {
  const MatrixFiles& files = options.matrices;
  if (!options.common.plant.vehicle.empty())
    refuse("V", "a vehicle and matrices were given together, expected only one of them");
  line.refuse_given({"--integral", "--change", "--past", "--estimator", "--sensors", "--height",
                     "--time", "--recover", "--noise-budget"},
                    "applies to a vehicle only");
  require_one_time(files.time);
  require_time(files.time);
  if (files.time.sampled) require_positive(*files.time.sampled, "--sampled");
  if (options.common.dt && !files.time.discrete)
    refuse("--dt", "--dt with matrices requires --discrete");
  if (options.common.dt) require_positive(*options.common.dt, "--dt");
  if (files.estimate != "current" && files.estimate != "delayed")
    refuse("--estimate", "--estimate is '{}', expected current or delayed",
           internal::printable(files.estimate));
  if (files.time.continuous && line.was_given("--estimate"))
    refuse("--estimate", "--estimate requires --discrete or --sampled DT");
  const MatrixLqgReport report = matrix_lqg(read_problem(options, context));
  if (!report.lqr.solved())
    throw NoSolution(fmt::format("lqg: {}: {}", to_string(report.lqr.status), report.lqr.culprit),
                     "--A");
  if (!report.filter.solved())
    throw NoSolution(
        fmt::format("lqg: filter: {}: {}", to_string(report.filter.status), report.filter.culprit),
        "--A");
  note_period(files.time, options.common.dt, context);
  context.notes(report.messages);
  context.print([&] { return to_json(report); }, [&] { return to_text(report); });
  context.notes("warning: ", margin_warnings(report.margins));
}

void run_lqg(const CommandLine& line, const Options& options, Context& context) {
  if (options.matrices.given()) {
    run_matrices(line, options, context);
    return;
  }
  line.refuse_given({"--D", "--N", "--G", "--noise-Q", "--noise-R", "--noise-N", "--continuous",
                     "--discrete", "--sampled", "--estimate"},
                    "applies to matrices only; expected --A, --B and --C");
  if (!options.lqg.recover && line.was_given("--noise-budget"))
    refuse("--noise-budget", "--noise-budget requires --recover");
  if (options.common.plant.vehicle.empty())
    refuse("V", "expected a built-in vehicle or a vehicle file, or --A, --B and --C");
  require_positive(options.lqg.time, "--time");
  constexpr double kMax = 1e6;
  if (options.lqg.time > kMax)
    refuse("--time", "--time is {}, expected at most {} s", number(options.lqg.time), number(kMax));
  const Vehicle vehicle = load_vehicle(options.common.plant.vehicle);
  const LqgReport report = design_on_flown_plant(
      options.common, options.flown, [&](const FlightOptions& flight, const FlownLoopOptions& at) {
        LqgOptions asked = options.lqg;
        asked.design = flown_lqi_options(vehicle, lqi_design(options.common, options.flown));
        return lqg_report(vehicle, asked, flight, at);
      });
  context.notes(report.messages);
  context.print([&] { return to_json(report, vehicle); }, [&] { return to_text(report); });
}

void add_matrix_options(CommandLine& line, MatrixFiles& files) {
  line.add_option("--A FILE", files.A, "dynamics (nx x nx)");
  line.add_option("--B FILE", files.B, "inputs (nx x nu)");
  line.add_option("--C FILE", files.C, "measurements (ny x nx)");
  line.add_option("--D FILE", files.D, "feed-through (ny x nu); default: 0");
  line.add_option("--N FILE", files.N, "cross weights of states and inputs; default: 0");
  line.add_option("--G FILE", files.G, "input matrix of the process noise; default: identity");
  line.add_option("--noise-Q FILE", files.noise_Q,
                  "process noise: covariance per step, or spectral density");
  line.add_option("--noise-R FILE", files.noise_R, "measurement noise, as --noise-Q");
  line.add_option("--noise-N FILE", files.noise_N,
                  "their cross-covariance; default: 0; not with --sampled");
  line.add_flag("--continuous", files.time.continuous, "A and B are continuous");
  line.add_flag("--discrete", files.time.discrete, "A and B are discrete");
  line.add_number("--sampled DT", files.time.sampled,
                  "continuous A, B, Q, R and noise with the input held for DT [s]");
  line.add_option("--estimate WHICH", files.estimate,
                  "current (default): the command uses the measurement of its sample; delayed: it "
                  "does not");
}

void add_options(CommandLine& line, Options& options) {
  line.add_option("V", options.common.plant.vehicle, "built-in vehicle or vehicle file");
  line.add_option("--Q FILE|LIST", options.common.Q,
                  "weights of the 12 states, then of the integrals; a single number applies to "
                  "all; default: Bryson's rule, with other weights if the margins need them; "
                  "with matrices, a "
                  "matrix file");
  line.add_option("--R FILE|LIST", options.common.R,
                  "weights of the wrench or, with matrices, of the inputs; otherwise as --Q");
  line.add_option("--integral LIST", options.common.integral,
                  "states to integrate, or none; default px,py,pz,yaw");
  line.add_number("--dt T", options.common.dt,
                  "control period [s], default 0.005; with --discrete, that of A and B, default 1");
  add_matrix_options(line, options.matrices);
  add_flown_lqr_options(line, options.flown);
  line.add_number("--time S", options.lqg.time, "time of the prediction [s], default 60");
  line.add_flag("--recover", options.lqg.recover,
                "raise the gyroscope and accelerometer noise that the filter assumes if that gives "
                "larger margins (loop transfer recovery)");
  line.add_number(
      "--noise-budget F", options.lqg.noise_budget,
      "largest factor by which --recover may increase the rms of a command, default 1.5");
}

}  // namespace

Verb lqg_verb() {
  return {
      "lqg",
      "V [options]   or   --A FILE --B FILE --C FILE --Q FILE --R FILE --noise-Q FILE --noise-R "
      "FILE (--discrete | --continuous | --sampled DT)",
      "state feedback and filter together: predicted deviations, margins with the filter",
      "quadtune lqg mambo --recover", with_options(add_options, run_lqg)};
}

}  // namespace quadtune::cli
