// SPDX-License-Identifier: Apache-2.0
/// quadtune kalman: the steady-state Kalman filter for matrices.
#include "quadtune/synthesis/kalman.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "arguments/matrix_arguments.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/internal/json.hpp"
#include "report/gains/gains.hpp"
#include "report/text/print.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string A, G, C, Q, R, N;
  TimeArguments time;
  bool show_sampled = false;
};

/// The filter, and with --sampled the problem that it solves.
struct Solution {
  KalmanResult filter;
  std::optional<SampledKalman> sampled = {};
};

Solution solve(const Options& options, std::istream& in) {
  const auto need = [&in](const std::string& path, const char* option) {
    return require_matrix(path, in, option);
  };
  const KalmanNoise noise = {read_matrix(options.G, in, "--G"), need(options.Q, "--Q"),
                             need(options.R, "--R"), read_matrix(options.N, in, "--N")};
  if (options.time.discrete) {
    DiscreteLti model;
    model.A = need(options.A, "--A");
    model.C = need(options.C, "--C");
    return {kalman(model, noise)};
  }
  ContinuousLti model;
  model.A = need(options.A, "--A");
  model.C = need(options.C, "--C");
  const std::optional<double>& sampled = options.time.sampled;
  if (!sampled) return {kalman(model, noise)};
  SampledKalman problem = sampled_kalman(model, noise, *sampled);
  KalmanResult filter = kalman(problem.model, problem.noise);
  return {std::move(filter), std::move(problem)};
}

void add_options(CommandLine& line, Options& options) {
  line.add_option("--A FILE", options.A, "dynamics (nx x nx)");
  line.add_option("--G FILE", options.G,
                  "input matrix of the process noise (nx x nw); default: identity");
  line.add_option("--C FILE", options.C, "measurements (ny x nx)");
  line.add_option("--Q FILE", options.Q,
                  "process noise: covariance per step, or spectral density with --continuous and "
                  "--sampled (nw x nw)");
  line.add_option("--R FILE", options.R, "measurement noise, as --Q (ny x ny)");
  line.add_option("--N FILE", options.N,
                  "cross-covariance (nw x ny); default: 0; not with --sampled");
  line.add_flag("--discrete", options.time.discrete, "A is discrete");
  line.add_flag("--continuous", options.time.continuous, "A is continuous");
  line.add_number("--sampled DT", options.time.sampled,
                  "sample period of the continuous model [s]");
  line.add_flag("--show-sampled", options.show_sampled,
                "with --sampled: also print the sampled A, Q and R; JSON always has them");
}

void run_kalman(const Options& options, Context& context) {
  const TimeArguments& time = options.time;
  require_one_time(time);
  require_time(time);
  if (time.sampled) require_positive(*time.sampled, "--sampled");
  if (options.show_sampled && !time.sampled)
    refuse("--show-sampled", "--show-sampled requires --sampled DT");
  if (time.sampled && !options.N.empty())
    refuse("--N", "--N cannot be combined with --sampled, expected no --N, which is 0 by default");
  const Solution solution = solve(options, context.in);
  const KalmanResult& result = solution.filter;
  if (!result.solved())
    throw NoSolution(fmt::format("kalman: {}: {}", to_string(result.status), result.culprit),
                     "--A");
  if (!result.warning.empty()) context.note("warning: " + result.warning);
  note_period(time, {}, context);
  const double period = time.continuous ? 0 : time.sampled.value_or(1);
  context.print(
      [&] {
        internal::Json json = to_json(result, period);
        if (solution.sampled)
          json["sampled"] = {{"A", internal::matrix_to_json(solution.sampled->model.A, "A")},
                             {"Q", internal::matrix_to_json(solution.sampled->noise.Q, "Q")},
                             {"R", internal::matrix_to_json(solution.sampled->noise.R, "R")}};
        return json;
      },
      [&] {
        std::string text = to_text(result, period);
        if (!options.show_sampled) return text;
        return text + section("sampled A", plain(solution.sampled->model.A)) +
               section("sampled Q", plain(solution.sampled->noise.Q)) +
               section("sampled R", plain(solution.sampled->noise.R));
      });
}

}  // namespace

Verb kalman_verb() {
  return {"kalman",
          "--A FILE --C FILE --Q FILE --R FILE (--discrete | --continuous | --sampled DT)",
          "design a steady-state Kalman filter",
          "quadtune kalman --A docs/examples/A.txt --C docs/examples/C.txt --Q docs/examples/Q.txt "
          "--R docs/examples/R.txt --sampled 0.01",
          with_options(add_options, run_kalman)};
}

}  // namespace quadtune::cli
