// SPDX-License-Identifier: Apache-2.0
// Measures the speed of covariance estimation from logs: one likelihood, the whole fit and the
// gradient, against statsmodels and R; with --coverage, how often the intervals contain the true
// value. docs/benchmarks.md describes what is timed.
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kalman_coverage.hpp"
#include "kalman_peers.hpp"
#include "kalman_problems.hpp"
#include "machine.hpp"
#include "plants/filter_models.hpp"
#include "quadtune/estimation/nonlinear_filter.hpp"
#include "quadtune/tuning/innovation_likelihood.hpp"
#include "quadtune/tuning/noise_fit.hpp"
#include "wall_time.hpp"

namespace quadtune::bench {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kSamples = 20000;

/// Maximum time, and minimum ratios of the times of the peers to ours; 0: none.
struct Goal {
  double ns_per_sample = 0;
  double times_statsmodels = 0;
  double times_r = 0;
};

std::string verdict(double is, double goal, bool at_most, const char* unit) {
  if (goal == 0) return "";
  const bool met = at_most ? is <= goal : is >= goal;
  return fmt::format("{} {}{}: {}", at_most ? "≤" : "≥", goal, unit, met ? "met" : "not met");
}

void print_row(const std::string& name, double seconds, double samples, double difference,
               const std::string& slower, const std::string& goal) {
  fmt::print("| {} | {:.4g} | {:.4g} | {:.1e} | {} | {} |\n", name, seconds * 1e3,
             seconds / samples * 1e9, difference, slower, goal);
}

Wall evaluation_time(const InnovationLikelihood& likelihood, LikelihoodOrder order, int times) {
  const VectorXd theta = start_of(likelihood.model());
  // A processor that was idle while waiting for a peer is slow for about a fifth of a second.
  const auto warm = std::chrono::steady_clock::now() + std::chrono::milliseconds(400);
  while (std::chrono::steady_clock::now() < warm) (void)likelihood.evaluate(theta, order);
  Wall time = processor_time_of([&] {
    for (int i = 0; i < times; ++i) (void)likelihood.evaluate(theta, order);
  });
  time.median /= times;
  time.min /= times;
  return time;
}

/// One likelihood, compared with the peers. Our relative difference is to the filter that never
/// holds a gain; those of the peers are to ours.
void race_likelihood(const std::string& title, const KalmanProblem& problem, bool hold,
                     const Goal& goal, bool with_r) {
  InnovationLikelihood likelihood(problem.model, {problem.record});
  const VectorXd theta = start_of(problem.model);
  likelihood.hold_steady_gains(false);
  const double whole = likelihood.evaluate(theta).value;
  likelihood.hold_steady_gains(hold);
  const double value = likelihood.evaluate(theta).value;
  const auto N = static_cast<double>(problem.record.samples());
  const Wall time = evaluation_time(likelihood, LikelihoodOrder::value, hold ? 20 : 3);
  fmt::print(
      "\n| {} | ms | ns/sample | relative difference | slower | goal |\n"
      "|---|---:|---:|---:|---:|---|\n",
      title);
  print_row("quadtune", time.median, N, std::abs(value / whole - 1), "",
            verdict(time.median / N * 1e9, goal.ns_per_sample, true, " ns"));
  const auto peer = [&](KalmanPeer which, double times) {
    const auto is = ask_peer(which, hold ? PeerTask::likelihood : PeerTask::every_step, problem);
    if (!is) {
      fmt::print("| {} | not installed | | | | |\n",
                 which == KalmanPeer::r ? "R KalmanLike" : "statsmodels");
      return;
    }
    const double slower = is->seconds / time.median;
    print_row(is->name + (which == KalmanPeer::r ? " KalmanLike" : " ssm.loglike"), is->seconds, N,
              std::abs(is->value / value - 1), fmt::format("{:.0f} times", slower),
              verdict(slower, times, false, " times"));
  };
  peer(KalmanPeer::statsmodels, goal.times_statsmodels);
  if (with_r) peer(KalmanPeer::r, goal.times_r);
}

/// The fit of two variances, started at ten times and at a tenth of the true values.
void race_fit(const KalmanProblem& of) {
  KalmanProblem problem = of;
  const VectorXd truth = start_of(problem.model);
  const VectorXd start = truth + Eigen::Vector2d(std::log(10.0), -std::log(10.0));
  for (std::size_t i = 0; i < 2; ++i)
    problem.model.parameters[i].start = std::exp(start(static_cast<Index>(i)));
  const InnovationLikelihood likelihood(problem.model, {problem.record});
  NoiseFitOptions options;
  options.starts = 1;
  NoiseFit fit;
  const Wall time = processor_time_of([&] { fit = fit_noise(likelihood, options); });
  const VectorXd variances = fit.theta.array().exp();
  fmt::print(
      "\n| fit of two variances, {} samples | ms | evaluations | variances differ by | "
      "log-likelihood less by | slower | goal |\n|---|---:|---:|---:|---:|---:|---|\n"
      "| quadtune, with its standard errors | {:.3g} | {} | {} | | | |\n",
      kSamples, time.median * 1e3, fit.evaluations, to_string(fit.status));
  const auto peer = [&](KalmanPeer which, const char* name, double goal) {
    const auto is = ask_peer(which, PeerTask::fit, problem, start);
    if (!is) {
      fmt::print("| {} | not installed | | | | | |\n", name);
      return;
    }
    const double slower = is->seconds / time.median;
    fmt::print("| {} | {:.3g} | {} | {:.1e} | {:.1e} | {:.0f} times | {} |\n", name,
               is->seconds * 1e3, is->evaluations,
               (is->variances.array() / variances.array() - 1).abs().maxCoeff(),
               fit.after.value - is->value, slower, verdict(slower, goal, false, " times"));
  };
  peer(KalmanPeer::statsmodels, "statsmodels fit, L-BFGS", 100);
  peer(KalmanPeer::r, "R optim, BFGS on KalmanLike", 20);
}

void print_gradient(const std::string& name, const KalmanProblem& problem, bool hold) {
  InnovationLikelihood likelihood(problem.model, {problem.record});
  likelihood.hold_steady_gains(hold);
  const auto p = static_cast<double>(problem.model.parameters.size());
  const VectorXd theta = start_of(problem.model);
  const int times = hold ? 4 : 1;
  const auto time = [&](LikelihoodOrder order) {
    const auto work = [&] {
      for (int i = 0; i < times; ++i) (void)likelihood.evaluate(theta, order);
    };
    return processor_time_of(work, 1).min / times;
  };
  (void)evaluation_time(likelihood, LikelihoodOrder::gradient, times);
  // In turns, because the speed of a shared processor varies within seconds. The gradient also
  // writes and reads a tape as large as the second-level cache, so that load on the third level
  // delays it more than the value: the least times are those without it.
  double value = std::numeric_limits<double>::infinity(), gradient = value;
  for (int i = 0; i < 100; ++i) {
    value = std::min(value, time(LikelihoodOrder::value));
    gradient = std::min(gradient, time(LikelihoodOrder::gradient));
  }
  const auto N = static_cast<double>(problem.record.samples());
  const double ratio = gradient / value;
  fmt::print("| {} | {} | {} | {:.4g} | {:.4g} | {:.2f} | {} |\n", name, p, hold ? "yes" : "no",
             value / N * 1e9, gradient / N * 1e9, ratio, verdict(ratio, 1 + p / 2, true, ""));
}

void gradients() {
  fmt::print(
      "\n| value and gradient | p | steady gains | value [ns/sample] | both [ns/sample] | ratio | "
      "goal |\n|---|---:|---|---:|---:|---:|---|\n");
  for (const bool hold : {true, false}) {
    print_gradient("altitude", altitude_problem(kSamples), hold);
    // Shorter if no gain is held: a tenth of the samples takes equally long.
    for (const int p : {2, 4, 8, 16})
      print_gradient("12 states, 6 outputs", large_problem(hold ? kSamples : 2000, p, false), hold);
  }
}

/// The extended filter of 15 states: its run, and the likelihood of the linearized model, compared
/// with a linear filter of that size.
void race_extended() {
  constexpr int kFew = 2000;
  const KalmanProblem linear = problem_of_extended_size(kFew);
  const KalmanProblem hover = uquad_hover(kFew);
  const auto filter = nonlinear_filter(hover.model, {hover.record});
  const VectorXd theta = start_of(hover.model);
  const InnovationLikelihood likelihood(hover.model, filter->linearize(theta).records);
  fmt::print(
      "\n| extended filter, 15 states, 16 outputs, 11 parameters, {} instants | ms | ns/sample | "
      "of statsmodels' linear filter of this size | goal |\n|---|---:|---:|---:|---|\n",
      kFew);
  const auto peer = ask_peer(KalmanPeer::statsmodels, PeerTask::every_step, linear);
  const auto print = [&](const char* name, double seconds, double goal) {
    const double times = peer ? seconds / peer->seconds : 0;
    fmt::print("| {} | {:.4g} | {:.4g} | {} | {} |\n", name, seconds * 1e3, seconds / kFew * 1e9,
               peer ? fmt::format("{:.2g} times", times) : "not installed",
               peer ? verdict(times, goal, true, " times") : "");
  };
  const double run = processor_time_of([&] { (void)filter->linearize(theta); }).median;
  const double value = evaluation_time(likelihood, LikelihoodOrder::value, 3).median;
  print("run of the filter, linearized", run, 0);
  print("likelihood of that", value, 0);
  print("likelihood with gradient",
        evaluation_time(likelihood, LikelihoodOrder::gradient, 3).median, 0);
  print("likelihood with gradient and information",
        evaluation_time(likelihood, LikelihoodOrder::information, 3).median, 20);
  print("one evaluation of the nonlinear likelihood: run and likelihood", run + value, 20);
  const InnovationLikelihood same(linear.model, {testing::linearized(linear.model, linear.record)});
  print("the model of the linear filter, given instant by instant",
        evaluation_time(same, LikelihoodOrder::value, 3).median, 20);
  if (peer) print("statsmodels", peer->seconds, 0);
}

double resident_peak_in_MiB() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

/// A log of ten million samples, and the memory that its likelihood requires in addition.
void long_log() {
  const KalmanProblem piece = altitude_problem(10000);
  KalmanProblem problem{piece.model, {}};
  constexpr Index kTimes = 1000;
  const Index n = piece.record.samples();
  problem.record.name = "long";
  problem.record.y = piece.record.y.replicate(1, kTimes);
  problem.record.u = piece.record.u.replicate(1, kTimes);
  problem.record.time.resize(static_cast<std::size_t>(n * kTimes));
  for (std::size_t k = 0; k < problem.record.time.size(); ++k)
    problem.record.time[k] = 0.005 * static_cast<double>(k);
  std::vector<FilterRecord> records;
  records.push_back(std::move(problem.record));
  const double log = resident_peak_in_MiB();
  const InnovationLikelihood likelihood(problem.model, std::move(records));
  const double made = resident_peak_in_MiB();
  const Wall time = processor_time_of(
      [&] { (void)likelihood.evaluate(start_of(problem.model), LikelihoodOrder::information); }, 3);
  fmt::print(
      "\nten million samples of altitude: the likelihood with gradient takes {:.3g} s; the log "
      "takes {:.0f} MiB, the likelihood {:.0f} MiB more, its evaluation {:.0f} MiB\n",
      time.median, log, made - log, resident_peak_in_MiB() - made);
}

void race() {
  use_one_thread();
  fmt::print("{}threads:  1\n", describe_machine());
  const KalmanProblem altitude = altitude_problem(kSamples);
  race_likelihood("likelihood of altitude, 20,000 samples", altitude, true, {6, 80, 10}, true);
  race_fit(altitude);
  race_likelihood("the same, no steady gains", altitude, false, {25, 0, 0}, true);
  for (const bool sparse : {false, true})
    race_likelihood(
        fmt::format("12 states, 6 outputs, F {}, no steady gains", sparse ? "of chains" : "dense"),
        large_problem(2000, 18, sparse), false, {500, 0, 0}, false);
  race_extended();
  gradients();
  long_log();
}

}  // namespace
}  // namespace quadtune::bench

int main(int argc, char** argv) {
  // ./dev bench passes the options of Google Benchmark to every program; this one does not use it.
  bool coverage = false;
  for (const std::string_view option : std::span(argv, static_cast<std::size_t>(argc)).subspan(1)) {
    if (option.starts_with("--benchmark_filter=") && option.find("kalman") == option.npos) return 0;
    coverage = coverage || option == "--coverage";
  }
  try {
    if (coverage)
      quadtune::bench::print_coverage();
    else
      quadtune::bench::race();
  } catch (const std::exception& error) {
    std::fputs(error.what(), stderr);
    return 1;
  }
}
