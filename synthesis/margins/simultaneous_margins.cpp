// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/simultaneous_margins.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "margins/disk.hpp"
#include "margins/loop_grid.hpp"

namespace quadtune {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

namespace {

/// The largest singular value and its vectors: M v = σ u. They are computed from the eigenvalues of
/// MᴴM, which is many times faster than a full SVD and as accurate for the largest singular value.
struct Largest {
  double sigma = 0;
  VectorXcd u, v;
};
Largest largest_singular_value(const MatrixXcd& M) {
  const double size = M.cwiseAbs().maxCoeff();
  if (!(size > 0)) return {0, VectorXcd::Unit(M.rows(), 0), VectorXcd::Unit(M.rows(), 0)};
  const MatrixXcd unit = M / size;
  const Eigen::SelfAdjointEigenSolver<MatrixXcd> eigen(unit.adjoint() * unit);
  Largest largest;
  largest.v = eigen.eigenvectors().col(M.rows() - 1);
  largest.u = unit * largest.v;
  const double norm = largest.u.norm();
  largest.u /= norm;
  largest.sigma = norm * size;
  return largest;
}

MatrixXcd scaled(const MatrixXcd& M, const VectorXd& d) {
  return d.asDiagonal() * M * d.cwiseInverse().asDiagonal();
}

/// Computes the scaling with the minimum Frobenius norm (Osborne 1960), which is close to that with
/// the minimum largest singular value.
VectorXd frobenius_scaling(const MatrixXcd& M) {
  const Index n = M.rows();
  VectorXd d = VectorXd::Ones(n);
  Eigen::MatrixXd squares = M.cwiseAbs2();
  squares.diagonal().setZero();
  // If one channel acts on another but not vice versa, their scales would diverge.
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

/// Minimizes σ_max(D M D⁻¹), which is convex in the logarithms of D, by gradient descent with step
/// halving; the gradient is σ (|uᵢ|² - |vᵢ|²).
double descend(const MatrixXcd& M, VectorXd& d) {
  Largest now = largest_singular_value(scaled(M, d));
  double step = 1;
  constexpr int kMaxSteps = 60;
  for (int i = 0; i < kMaxSteps && step > 1e-6; ++i) {
    const VectorXd slope = now.u.cwiseAbs2() - now.v.cwiseAbs2();
    if (slope.norm() < 1e-9) break;
    const VectorXd tried = d.array() * (-step * slope).array().exp();
    Largest there = largest_singular_value(scaled(M, tried));
    if (there.sigma < now.sigma) {
      d = tried;
      now = std::move(there);
      step *= 1.6;
    } else {
      step *= 0.4;
    }
  }
  return now.sigma;
}

double upper_bound(const MatrixXcd& M) {
  VectorXd d = frobenius_scaling(M);
  return descend(M, d);
}

/// Computes a lower bound ρ(U M). The initial U rotates each entry of the left singular vector to
/// the phase of the right one: if D is optimal and σ_max is simple, the entries of both have equal
/// magnitudes, and the bound is σ_max itself. The phases are then moved towards those for which the
/// products yᵢ* xᵢ of the left and right eigenvectors are all positive.
double phases_that_meet(const MatrixXcd& M) {
  const Largest largest = largest_singular_value(M);
  VectorXcd turn(M.rows());
  for (Index i = 0; i < M.rows(); ++i)
    turn[i] = std::polar(1.0, std::arg(largest.v[i]) - std::arg(largest.u[i]));
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

namespace {

/// Searches the maximum of the upper bound of μ over frequencies. A bound is improved only if it
/// may be the largest.
class PeakSearch {
 public:
  PeakSearch(const OpenLoop& loop, double skew)
      : loop_(loop), offset_(0.5 * (skew - 1) * MatrixXcd::Identity(loop.size(), loop.size())) {
    for (const double w : frequency_grid(loop)) add(w);
    if (!loop.discrete()) add(std::numeric_limits<double>::infinity());
  }

  /// Returns the largest upper bound and its frequency.
  [[nodiscard]] internal::Peak find() {
    improve_largest();
    return internal::highest_peak([&](double w) { return upper_bound(at(w)); }, w_, upper_);
  }

  [[nodiscard]] MatrixXcd at(double w) const { return loop_.sensitivity(w) + offset_; }

 private:
  void add(double w) {
    const MatrixXcd M = at(w);
    if (!M.allFinite()) return;
    w_.push_back(w);
    upper_.push_back(largest_singular_value(scaled(M, frobenius_scaling(M))).sigma);
  }

  /// Computes the optimal scaling, which costs a hundred times as much, starting with the largest
  /// bound, until no remaining bound is larger than the largest improved one.
  void improve_largest() {
    std::vector<std::size_t> order(w_.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](std::size_t i, std::size_t j) { return upper_[i] > upper_[j]; });
    double best = 0;
    for (const std::size_t i : order) {
      if (upper_[i] <= best) break;
      upper_[i] = upper_bound(at(w_[i]));
      best = std::max(best, upper_[i]);
    }
  }

  const OpenLoop& loop_;
  MatrixXcd offset_;
  std::vector<double> w_;
  std::vector<double> upper_;
};

}  // namespace

SimultaneousDiskMargin simultaneous_disk_margin(const OpenLoop& loop, double skew) {
  SimultaneousDiskMargin margin;
  if (!internal::closed_loop_is_stable(loop)) return margin;
  if (loop.size() == 1) {
    margin.guaranteed = internal::disk_margin(loop, skew);
    margin.alpha_destabilizing = margin.guaranteed.alpha;
    return margin;
  }
  PeakSearch search(loop, skew);
  const auto [peak, w] = search.find();
  margin.guaranteed = internal::disk_of_peak(peak, w, skew);
  margin.alpha_destabilizing = 1 / structured_gain(search.at(w)).lower;
  return margin;
}

}  // namespace quadtune
