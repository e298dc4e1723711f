// SPDX-License-Identifier: Apache-2.0
/// quadtune kalman: the steady filter of matrices.
#include "quadtune/synthesis/kalman.hpp"

#include <fmt/format.h>

#include <memory>

#include "arguments/matrix_arguments.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/internal/json.hpp"
#include "report/gains/kalman_report.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string A, G, C, Q, R, N;
  bool discrete = false;
  bool continuous = false;
  double sampled = 0;
};

void check(const Options& options, bool sampled) {
  if (static_cast<int>(options.discrete) + static_cast<int>(options.continuous) +
          static_cast<int>(sampled) !=
      1)
    throw UsageError(
        "quadtune kalman: expected one of --discrete (A is discrete), --continuous, --sampled DT",
        "--discrete");
}

KalmanResult solve(const Options& options, bool sampled, std::istream& in) {
  const auto need = [&in](const std::string& path, const char* option) {
    return require_matrix(path, in, "kalman", option);
  };
  const KalmanNoise noise = {read_matrix(options.G, in), need(options.Q, "--Q"),
                             need(options.R, "--R"), read_matrix(options.N, in)};
  if (options.discrete) {
    DiscreteLti model;
    model.A = need(options.A, "--A");
    model.C = need(options.C, "--C");
    return kalman(model, noise);
  }
  ContinuousLti model;
  model.A = need(options.A, "--A");
  model.C = need(options.C, "--C");
  return sampled ? kalman_sampled(model, noise, options.sampled) : kalman(model, noise);
}

}  // namespace

Verb kalman_verb() {
  return {
      "kalman", "--A FILE --C FILE --Q FILE --R FILE (--discrete | --continuous | --sampled DT)",
      "design a steady-state Kalman filter",
      "quadtune kalman --A docs/examples/A.txt --C docs/examples/C.txt --Q docs/examples/Q.txt "
      "--R docs/examples/R.txt --sampled 0.01",
      [](CommandLine& line) -> Action {
        auto options = std::make_shared<Options>();
        line.add_option("--A", options->A, "dynamics (nx x nx)")->type_name("FILE");
        line.add_option("--G", options->G, "where the process noise enters (nx x nw); identity")
            ->type_name("FILE");
        line.add_option("--C", options->C, "measurements (ny x nx)")->type_name("FILE");
        line.add_option("--Q", options->Q,
                        "process noise: covariance per step, or density with --continuous and "
                        "--sampled (nw x nw)")
            ->type_name("FILE");
        line.add_option("--R", options->R, "measurement noise, likewise (ny x ny)")
            ->type_name("FILE");
        line.add_option("--N", options->N, "cross-correlation (nw x ny); none")->type_name("FILE");
        line.add_flag("--discrete", options->discrete, "A is discrete");
        line.add_flag("--continuous", options->continuous, "A is continuous");
        Option* dt = line.add_number("--sampled", options->sampled,
                                     "sample the continuous model every DT seconds")
                         ->type_name("DT");
        return [options, dt](Context& context) {
          const bool sampled = dt->was_given();
          check(*options, sampled);
          if (sampled) require_positive(options->sampled, "kalman", "--sampled");
          const KalmanResult result = solve(*options, sampled, context.in);
          if (!result.solved())
            throw NoSolution(
                fmt::format("kalman: {}: {}", to_string(result.status), result.culprit), "--A");
          if (!result.warning.empty()) context.note("kalman: warning: " + result.warning);
          const double period = options->continuous ? 0 : sampled ? options->sampled : 1;
          context.print([&] { return to_json(result, period); },
                        [&] { return to_text(result, period); });
        };
      }};
}

}  // namespace quadtune::cli
