// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/systems/matrix_lqr.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "quadtune/errors.hpp"
#include "quadtune/matrix_checks.hpp"
#include "quadtune/synthesis/delayed_lqi.hpp"
#include "quadtune/synthesis/series.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// The part of the weights that belongs to the states of the plant.
LqrWeights plant_weights(const LqrWeights& weights, Index nx) {
  LqrWeights part = weights;
  part.Q = weights.Q.topLeftCorner(nx, nx);
  if (weights.N.size()) part.N = weights.N.topRows(nx);
  return part;
}

/// Checks the shape of Q, whose first nx rows belong to the states.
void require_weights(const MatrixLqrProblem& problem, Index nx, Index ny) {
  const LqrWeights& weights = problem.lqr.weights;
  require_shape(weights.Q, nx + ny, nx + ny, "lqr", "Q",
                fmt::format("{} states and {} integrals of outputs", nx, ny));
  if (weights.N.size())
    require_shape(weights.N, nx + ny, problem.lqr.B.cols(), "lqr", "N",
                  fmt::format("{} states and {} integrals of outputs, {} inputs", nx, ny,
                              problem.lqr.B.cols()));
}

/// The plant per step, its cost, and the integrals of its outputs.
AugmentedLqr<DiscreteLti> discrete_problem(const MatrixLqrProblem& problem, SampledLqr& sampled) {
  const LqrProblem& lqr = problem.lqr;
  const Index nx = lqr.A.rows();
  const Index ny = problem.C.rows();
  DiscreteLti plant{lqr.A, lqr.B, problem.C, problem.D, problem.dt, {}, {}, {}};
  LqrWeights weights = lqr.weights;
  if (lqr.sampled) {
    require_weights(problem, nx, ny);
    if (ny > 0 && weights.Q.topRightCorner(nx, ny).cwiseAbs().maxCoeff() > 0)
      throw InvalidInput("lqr",
                         "Q has cross weights between states and integrals, expected 0 for a "
                         "sampled problem because they are not sampled alike");
    if (ny > 0 && weights.N.size() && weights.N.bottomRows(ny).cwiseAbs().maxCoeff() > 0)
      throw InvalidInput("lqr",
                         "N has cross weights of integrals, expected 0 for a sampled problem "
                         "because they are not sampled as those of states");
    sampled = sample({lqr.A, lqr.B, {}, {}, {}, {}, {}}, plant_weights(weights, nx), *lqr.sampled);
    plant.A = sampled.plant.A;
    plant.B = sampled.plant.B;
    plant.dt = *lqr.sampled;
    const MatrixXd Q_integral = *lqr.sampled * weights.Q.bottomRightCorner(ny, ny);
    weights = ny > 0 ? with_integral_weights(sampled.weights, Q_integral) : sampled.weights;
  }
  if (ny > 0) return with_output_integrals(plant, weights);
  plant.C.resize(0, 0);
  plant.D.resize(0, 0);
  return {plant, weights};
}

/// Splits the gain of all states.
void split_gain(const MatrixXd& K, Index nx, Index ny, MatrixLqrReport& report) {
  report.K = K.leftCols(nx);
  report.K_int = K.middleCols(nx, ny);
  report.K_past = K.rightCols(K.cols() - nx - ny);
}

MarginsEvidence affordable_with_note(Index states, Index channels,
                                     std::vector<std::string>& messages) {
  const MarginsEvidence evidence = affordable_evidence(states, channels);
  if (evidence != MarginsEvidence::full)
    messages.push_back(
        fmt::format("note: with {} states and {} inputs, not all margins are "
                    "computed because it would take more than about a second; "
                    "--evidence full computes all",
                    states, channels));
  return evidence;
}

}  // namespace

MatrixLqrReport matrix_lqr(const MatrixLqrProblem& problem,
                           std::optional<MarginsEvidence> evidence) {
  const LqrProblem& lqr_problem = problem.lqr;
  const Index nx = lqr_problem.A.rows();
  const Index ny = problem.C.rows();
  const Index nu = lqr_problem.B.cols();
  const bool is_discrete = lqr_problem.discrete || lqr_problem.sampled.has_value();
  MatrixLqrReport report;
  const bool plain = ny == 0 && problem.delay == 0 && (problem.dt == 1 || !lqr_problem.discrete);
  if (plain) {
    report.lqr = lqr_report(lqr_problem, evidence);
    if (!report.lqr.riccati.solved()) return report;
    split_gain(report.lqr.riccati.K, nx, 0, report);
    if (lqr_problem.sampled)
      report.sampled = sample({lqr_problem.A, lqr_problem.B, {}, {}, {}, {}, {}},
                              lqr_problem.weights, *lqr_problem.sampled);
    return report;
  }
  if (!is_discrete && problem.delay > 0)
    throw InvalidInput("lqr",
                       "the problem is continuous, expected a discrete or sampled one with a "
                       "delay of whole samples");
  RiccatiResult& riccati = report.lqr.riccati;
  std::optional<OpenLoop> loop;
  if (is_discrete) {
    SampledLqr sampled;
    const AugmentedLqr<DiscreteLti> augmented =
        with_input_delay(discrete_problem(problem, sampled), problem.delay);
    riccati = lqr(augmented.plant, augmented.weights);
    if (!riccati.solved()) return report;
    report.lqr.dt = augmented.plant.dt;
    if (lqr_problem.sampled) report.sampled = std::move(sampled);
    loop = loop_at_inputs(augmented.plant, riccati.K);
  } else {
    const AugmentedLqr<ContinuousLti> augmented = with_output_integrals(
        ContinuousLti{lqr_problem.A, lqr_problem.B, problem.C, problem.D, {}, {}, {}},
        lqr_problem.weights);
    riccati = lqr(augmented.plant, augmented.weights);
    if (!riccati.solved()) return report;
    loop = loop_at_inputs(augmented.plant, riccati.K);
  }
  split_gain(riccati.K, nx, ny, report);
  if (!riccati.warning.empty()) report.lqr.messages.push_back("warning: " + riccati.warning);
  if (!evidence) evidence = affordable_with_note(riccati.K.cols(), nu, report.lqr.messages);
  report.lqr.margins = margins_report(*loop, numbered("u", nu), *evidence);
  for (const std::string& note : margin_notes(report.lqr.margins))
    report.lqr.messages.push_back("note: " + note);
  return report;
}

namespace {

template <class Lti>
void take_regulator(LqgRegulator<Lti> regulator, const Lti& plant, MatrixLqgReport& report) {
  report.lqr = std::move(regulator.lqr);
  report.filter = std::move(regulator.filter);
  if (!report.solved()) return;
  report.A = regulator.controller.A;
  report.B = regulator.controller.B;
  report.C = regulator.controller.C;
  report.D = regulator.controller.D;
  report.poles = regulator.poles;
  report.state_rms = regulator.state_rms;
  report.input_rms = regulator.input_rms;
  report.cost = regulator.cost;
  if (!std::isfinite(report.cost))
    report.messages.emplace_back(
        "warning: the mean cost and the standard deviations are not computed: the covariance of "
        "the "
        "closed loop is lost to rounding; choose units that bring the entries of the matrices "
        "closer "
        "together");
  const OpenLoop loop(series(plant, regulator.controller));
  const Index nu = plant.B.cols();
  report.margins = margins_report(loop, numbered("u", nu),
                                  affordable_with_note(loop.A().rows(), nu, report.messages));
  for (const std::string* warning : {&report.lqr.warning, &report.filter.warning})
    if (!warning->empty()) report.messages.push_back("warning: " + *warning);
  for (const std::string& note : margin_notes(report.margins))
    report.messages.push_back("note: " + note);
}

}  // namespace

MatrixLqgReport matrix_lqg(const MatrixLqgProblem& problem) {
  MatrixLqgReport report;
  const ContinuousLti plant{problem.A, problem.B, problem.C, problem.D, {}, {}, {}};
  if (problem.time == MatrixTime::continuous) {
    take_regulator(lqg_regulator(plant, problem.weights, problem.noise), plant, report);
    return report;
  }
  report.dt = problem.dt;
  DiscreteLti discrete{problem.A, problem.B, problem.C, problem.D, problem.dt, {}, {}, {}};
  LqrWeights weights = problem.weights;
  KalmanNoise noise = problem.noise;
  if (problem.time == MatrixTime::sampled) {
    validate(plant, "lqg");
    const SampledLqr sampled = sample(plant, weights, problem.dt);
    discrete.A = sampled.plant.A;
    discrete.B = sampled.plant.B;
    weights = sampled.weights;
    noise = sampled_kalman(plant, noise, problem.dt).noise;
  }
  take_regulator(lqg_regulator(discrete, weights, noise, problem.estimate), discrete, report);
  return report;
}

}  // namespace quadtune
