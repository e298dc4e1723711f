// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/lqr.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

#include "quadtune/discretize/van_loan.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {
namespace {

/// Rejects an indefinite R by the eigenvalue of R itself, before it is sampled. Other mistakes are
/// left to sampled_cost().
void require_not_indefinite(const Eigen::MatrixXd& R) {
  if (R.rows() != R.cols() || R.size() == 0 || !R.allFinite() || !R.isApprox(R.transpose())) return;
  if (Eigen::LLT<Eigen::MatrixXd>(R).info() == Eigen::Success) return;
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(R, Eigen::EigenvaluesOnly).eigenvalues();
  if (eigenvalues.minCoeff() < -1e-12 * eigenvalues.cwiseAbs().maxCoeff())
    throw InvalidInput("sample", fmt::format("R has eigenvalue {:.6g}, expected R >= 0, because a "
                                             "negative weight rewards a deviation; check the signs",
                                             eigenvalues.minCoeff()));
}

RiccatiOptions for_regulator(RiccatiOptions options, const std::vector<Signal>& states,
                             Eigen::Index nx) {
  options.problem = RiccatiProblem::regulator;
  if (options.state_names.empty() && !states.empty())
    options.state_names = names_or_numbers(states, nx);
  return options;
}

/// Calls care() or dare() with the state names of the plant. Their errors are rethrown with the
/// name of lqr().
template <class Equation, class Lti>
RiccatiResult solve(Equation equation, const Lti& plant, const LqrWeights& weights,
                    const RiccatiOptions& options) {
  try {
    return equation(plant.A, plant.B, weights.Q, weights.R, weights.N,
                    for_regulator(options, plant.states, plant.A.rows()));
  } catch (const InvalidInput& error) {
    throw InvalidInput("lqr", error.message());
  }
}

/// Position of a state by name.
Eigen::Index index_of(const std::vector<Signal>& states, const std::string& name) {
  const auto found = std::find_if(states.begin(), states.end(),
                                  [&](const Signal& state) { return state.name == name; });
  if (found != states.end()) return found - states.begin();
  throw InvalidInput(
      "with_integrals",
      fmt::format("no state '{}' to integrate, expected one of: {}{}", name, names(states),
                  internal::did_you_mean(
                      name, names_or_numbers(states, static_cast<Eigen::Index>(states.size())))));
}

}  // namespace

RiccatiResult lqr(const ContinuousLti& plant, const LqrWeights& weights,
                  const RiccatiOptions& options) {
  validate(plant, "lqr");
  return solve(care, plant, weights, options);
}

RiccatiResult lqr(const DiscreteLti& plant, const LqrWeights& weights,
                  const RiccatiOptions& options) {
  validate(plant, "lqr");
  return solve(dare, plant, weights, options);
}

SampledLqr sample(const ContinuousLti& plant, const LqrWeights& weights, double dt) {
  validate(plant, "sample");
  require_not_indefinite(weights.R);
  const SampledCost cost = sampled_cost(plant.A, plant.B, weights.Q, weights.R, weights.N, dt);
  SampledLqr sampled;
  sampled.plant = {cost.A, cost.B, plant.C, plant.D, dt, plant.states, plant.inputs, plant.outputs};
  sampled.weights = {cost.Q, cost.R, cost.N};
  return sampled;
}

ContinuousLti with_integrals(const ContinuousLti& plant,
                             const std::vector<std::string>& integrated) {
  validate(plant, "with_integrals");
  const Eigen::Index nx = plant.A.rows();
  const auto ni = static_cast<Eigen::Index>(integrated.size());
  ContinuousLti augmented = plant;
  if (ni == 0) return augmented;
  augmented.A = Eigen::MatrixXd::Zero(nx + ni, nx + ni);
  augmented.A.topLeftCorner(nx, nx) = plant.A;
  augmented.B = Eigen::MatrixXd::Zero(nx + ni, plant.B.cols());
  augmented.B.topRows(nx) = plant.B;
  for (Eigen::Index i = 0; i < ni; ++i) {
    const std::string& name = integrated[static_cast<std::size_t>(i)];
    if (std::count(integrated.begin(), integrated.end(), name) > 1)
      throw InvalidInput("with_integrals",
                         fmt::format("'{}' is listed twice, expected each state once", name));
    const Eigen::Index source = index_of(plant.states, name);
    augmented.A(nx + i, source) = 1;  // d/dt ∫x = x
    const Signal& state = plant.states[static_cast<std::size_t>(source)];
    augmented.states.push_back({"int_" + name, state.unit + " s"});
  }
  if (plant.C.size()) {
    augmented.C = Eigen::MatrixXd::Zero(plant.C.rows(), nx + ni);
    augmented.C.leftCols(nx) = plant.C;
  }
  return augmented;
}

LqrWeights with_integral_weights(const LqrWeights& weights,
                                 const Eigen::Ref<const Eigen::MatrixXd>& Q_integral) {
  require_shape(Q_integral, Q_integral.rows(), Q_integral.rows(), "with_integral_weights",
                "Q_integral", "one row and column per integral");
  const Eigen::Index nx = weights.Q.rows();
  const Eigen::Index ni = Q_integral.rows();
  LqrWeights augmented = weights;
  augmented.Q = Eigen::MatrixXd::Zero(nx + ni, nx + ni);
  augmented.Q.topLeftCorner(nx, nx) = weights.Q;
  augmented.Q.bottomRightCorner(ni, ni) = Q_integral;
  if (weights.N.size()) {
    augmented.N = Eigen::MatrixXd::Zero(nx + ni, weights.N.cols());
    augmented.N.topRows(nx) = weights.N;
  }
  return augmented;
}

}  // namespace quadtune
