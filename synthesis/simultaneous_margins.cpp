// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/simultaneous_margins.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <vector>

#include "disk.hpp"
#include "frequency_grid.hpp"

namespace quadtune {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

namespace {

using Svd = Eigen::JacobiSVD<MatrixXcd>;

MatrixXcd scaled(const MatrixXcd& M, const VectorXd& d) {
  return d.asDiagonal() * M * d.cwiseInverse().asDiagonal();
}

/// The scaling of least Frobenius norm (Osborne 1960): near the one of least largest singular
/// value.
VectorXd frobenius_scaling(const MatrixXcd& M) {
  const Index n = M.rows();
  VectorXd d = VectorXd::Ones(n);
  Eigen::MatrixXd squares = M.cwiseAbs2();
  squares.diagonal().setZero();
  // Where one channel acts on another and not back, they would be driven apart without end.
  constexpr double kFarthest = 1e8;
  for (int sweep = 0; sweep < 30; ++sweep) {
    double change = 0;
    for (Index i = 0; i < n; ++i) {
      const double ratio = squares.col(i).sum() / squares.row(i).sum();
      if (!(ratio > 0) || !std::isfinite(ratio)) continue;
      const double factor =
          std::clamp(d[i] * std::pow(ratio, 0.25), 1 / kFarthest, kFarthest) / d[i];
      d[i] *= factor;
      squares.row(i) *= factor * factor;
      squares.col(i) /= factor * factor;
      change = std::max(change, std::abs(std::log(factor)));
    }
    if (change < 1e-3) break;
  }
  return d;
}

/// Lowers σ_max(D M D⁻¹), which is convex in the logarithms of D, by steps along its gradient
/// σ (|uᵢ|² - |vᵢ|²) with halving.
double descend(const MatrixXcd& M, VectorXd& d) {
  Svd svd(scaled(M, d), Eigen::ComputeFullU | Eigen::ComputeFullV);
  double best = svd.singularValues()[0];
  double step = 1;
  constexpr int kMaxSteps = 60;
  for (int i = 0; i < kMaxSteps && step > 1e-6; ++i) {
    const VectorXd slope = svd.matrixU().col(0).cwiseAbs2() - svd.matrixV().col(0).cwiseAbs2();
    if (slope.norm() < 1e-9) break;
    const VectorXd tried = d.array() * (-step * slope).array().exp();
    const Svd there(scaled(M, tried), Eigen::ComputeFullU | Eigen::ComputeFullV);
    if (there.singularValues()[0] < best) {
      best = there.singularValues()[0];
      d = tried;
      svd = there;
      step *= 1.6;
    } else {
      step *= 0.4;
    }
  }
  return best;
}

/// ρ(U M), U turning each entry of the left singular vector onto the right one's: where D is best
/// and σ_max single, both have entries of one size, and this is σ_max itself. Then the phases are
/// turned towards those for which an eigenvector's shares yᵢ* xᵢ are all positive.
double phases_that_meet(const MatrixXcd& M) {
  const Svd svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  VectorXcd turn(M.rows());
  for (Index i = 0; i < M.rows(); ++i)
    turn[i] = std::polar(1.0, std::arg(svd.matrixV()(i, 0)) - std::arg(svd.matrixU()(i, 0)));
  double best = 0;
  for (int round = 0; round < 20; ++round) {
    const Eigen::ComplexEigenSolver<MatrixXcd> eigen(turn.asDiagonal() * M);
    Index at = 0;
    const double radius = eigen.eigenvalues().cwiseAbs().maxCoeff(&at);
    if (radius <= best * (1 + 1e-9)) break;
    best = radius;
    const VectorXcd x = eigen.eigenvectors().col(at);
    const VectorXcd y = eigen.eigenvectors().inverse().row(at).adjoint();
    for (Index i = 0; i < M.rows(); ++i)
      turn[i] *= std::polar(1.0, -std::arg(std::conj(y[i]) * x[i]));
  }
  return best;
}

}  // namespace

StructuredGain structured_gain(const MatrixXcd& M) {
  if (M.rows() == 1) return {std::abs(M(0, 0)), std::abs(M(0, 0))};
  VectorXd d = frobenius_scaling(M);
  StructuredGain gain;
  gain.upper = descend(M, d);
  gain.lower = std::min(phases_that_meet(scaled(M, d)), gain.upper);
  return gain;
}

SimultaneousDiskMargin simultaneous_disk_margin(const OpenLoop& loop, double skew) {
  SimultaneousDiskMargin margin;
  if (!internal::closed_loop_is_stable(loop)) return margin;
  const MatrixXcd I = MatrixXcd::Identity(loop.size(), loop.size());
  const auto at = [&](double w) -> MatrixXcd { return loop.sensitivity(w) + 0.5 * (skew - 1) * I; };
  // A bound that costs one singular value first, the best one where that comes near the largest.
  std::vector<double> grid;
  std::vector<double> values;
  for (const double w : frequency_grid(loop)) {
    const MatrixXcd M = at(w);
    if (!M.allFinite()) continue;
    grid.push_back(w);
    values.push_back(Svd(scaled(M, frobenius_scaling(M))).singularValues()[0]);
  }
  constexpr double kNear = 0.8;
  const double level = kNear * *std::max_element(values.begin(), values.end());
  for (std::size_t i = 0; i < grid.size(); ++i)
    if (values[i] >= level) values[i] = structured_gain(at(grid[i])).upper;
  const auto [peak, w] = internal::refine_peak(
      [&](double frequency) { return structured_gain(at(frequency)).upper; }, grid, values);
  margin.guaranteed = internal::disk_of_peak(peak, w, skew);
  margin.alpha_destabilizing = 1 / structured_gain(at(w)).lower;
  return margin;
}

}  // namespace quadtune
