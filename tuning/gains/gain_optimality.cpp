// SPDX-License-Identifier: Apache-2.0
#include "gains/gain_optimality.hpp"

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <cmath>

#include "quadtune/synthesis/lyapunov.hpp"
#include "quadtune/synthesis/open_loop.hpp"

namespace quadtune::internal {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

SensitivityPeak weighted_sensitivity(const DiagonalLqr& problem, const VectorXd& w,
                                     const RiccatiResult& solution, const MatrixXd& K) {
  VectorXd inputs_only = w;
  inputs_only.head(problem.states()).setZero();
  const MatrixXd R0 = problem.weights(inputs_only).R;
  const auto peak = [&](const auto& plant, const MatrixXd& S) {
    const OpenLoop loop = loop_at_inputs(plant, K);
    // With R₀ = U₀ᵀU₀ and S = UᵀU the inequality reads σ(U₀ (I + L)⁻¹ U⁻¹) ≤ 1.
    const MatrixXd left = Eigen::LLT<MatrixXd>(R0).matrixU();
    const MatrixXd right =
        Eigen::LLT<MatrixXd>(S).matrixU().solve(MatrixXd::Identity(S.rows(), S.cols()));
    SensitivityPeak result;
    for (const double frequency : frequency_grid(loop)) {
      const Eigen::MatrixXcd weighted = left * loop.sensitivity(frequency) * right;
      if (!weighted.allFinite()) continue;
      const double sigma = Eigen::JacobiSVD<Eigen::MatrixXcd>(weighted).singularValues()(0);
      if (sigma > result.value) result = {sigma, frequency};
    }
    return result;
  };
  if (const auto* plant = std::get_if<ContinuousLti>(&problem.plant()))
    return peak(*plant, problem.weights(w).R);
  const auto& plant = std::get<DiscreteLti>(problem.plant());
  const MatrixXd S = problem.weights(w).R + plant.B.transpose() * solution.X * plant.B;
  return peak(plant, 0.5 * (S + S.transpose()));
}

ExcessCost excess_cost(const DiagonalLqr& problem, const VectorXd& w, const RiccatiResult& solution,
                       const MatrixXd& K) {
  // The excess cost of K over the optimum is Σ (K - K*)ᵀ S (K - K*) along the closed loop of K.
  // This avoids the difference of two large numbers.
  const MatrixXd off = K - solution.K;
  const LqrWeights weights = problem.weights(w);
  LyapunovResult excess;
  if (const auto* plant = std::get_if<ContinuousLti>(&problem.plant())) {
    const MatrixXd cost = off.transpose() * weights.R * off;
    excess =
        lyapunov_continuous((plant->A - plant->B * K).transpose(), 0.5 * (cost + cost.transpose()));
  } else {
    const auto& discrete = std::get<DiscreteLti>(problem.plant());
    const MatrixXd S = weights.R + discrete.B.transpose() * solution.X * discrete.B;
    const MatrixXd cost = off.transpose() * S * off;
    excess = lyapunov_discrete((discrete.A - discrete.B * K).transpose(),
                               0.5 * (cost + cost.transpose()));
  }
  ExcessCost worst;
  if (!excess.solved()) {
    worst.culprit = "its loop is too close to the stability limit: " + excess.culprit;
    return worst;
  }
  for (Index i = 0; i < K.cols(); ++i) {
    if (!(solution.X(i, i) > 0)) continue;
    const double relative = excess.X(i, i) / solution.X(i, i);
    if (!(relative <= worst.value)) worst = {relative, i, {}};
  }
  if (std::isnan(worst.value)) worst.culprit = "the cost with the computed gain is 0";
  return worst;
}

}  // namespace quadtune::internal
