// SPDX-License-Identifier: Apache-2.0

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "lyapunov/eigenvalues.hpp"
#include "lyapunov/mode_names.hpp"
#include "margins/loop_grid.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/frequency_response.hpp"
#include "quadtune/synthesis/lyapunov.hpp"

namespace quadtune {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using internal::eigenvalues;

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

double largest_singular_value(const MatrixXcd& M) {
  if (!M.allFinite()) return kInfinite;
  return M.size() == 1 ? std::abs(M(0, 0)) : Eigen::JacobiSVD<MatrixXcd>(M).singularValues()[0];
}

template <class Lti>
Lti completed(Lti plant) {
  const Index nx = plant.A.rows();
  if (plant.C.size() == 0) plant.C = MatrixXd::Identity(nx, nx);
  if (plant.D.size() == 0) plant.D = MatrixXd::Zero(plant.C.rows(), plant.B.cols());
  return plant;
}

/// Computes the frequencies at which a singular value of the plant may be γ: the imaginary
/// eigenvalues of [A + B S DᵀC, B S Bᵀ; -Cᵀ(I + D S Dᵀ)C, -(A + B S DᵀC)ᵀ], S = (γ² I - DᵀD)⁻¹.
/// Eigenvalues that rounding errors have moved off the axis are included.
std::vector<double> crossings(const ContinuousLti& p, double gamma) {
  const Index n = p.A.rows();
  const Index nu = p.B.cols();
  const MatrixXd S = (gamma * gamma * MatrixXd::Identity(nu, nu) - p.D.transpose() * p.D).inverse();
  const MatrixXd F = p.A + p.B * S * p.D.transpose() * p.C;
  MatrixXd H(2 * n, 2 * n);
  // γ is distributed evenly over the off-diagonal blocks, so that both have the same magnitude.
  H << F, gamma * p.B * S * p.B.transpose(),
      -p.C.transpose() * (p.C + p.D * S * p.D.transpose() * p.C) / gamma, -F.transpose();
  const double rounding = 1e-8;
  std::vector<double> all;
  for (const std::complex<double>& value : eigenvalues(H))
    if (value.imag() >= 0 && std::abs(value.real()) <= rounding * std::max(std::abs(value), 1e-300))
      all.push_back(value.imag());
  std::sort(all.begin(), all.end());
  return all;
}

/// The two-step method of Bruinsma and Steinbuch: compute the crossings of a level just above the
/// largest gain so far, then evaluate the gain between the crossings. `gain_at` is exact; its
/// argument is a frequency of `plant`.
template <class Gain>
PeakGain climb(const ContinuousLti& plant, const VectorXcd& poles, double tolerance,
               const Gain& gain_at) {
  PeakGain best{0, 0, true};
  const auto try_at = [&](double w) {
    const double gain = gain_at(w);
    if (gain > best.gain) best = {gain, w, true};
  };
  // A level barely above the feed-through makes the matrix singular, so that a good initial level
  // is necessary.
  try_at(kInfinite);
  try_at(0);
  for (const std::complex<double>& pole : poles) {
    try_at(std::abs(pole.imag()));
    for (const double factor : {0.1, 0.3, 0.6, 1.0, 1.5, 3.0, 10.0})
      try_at(factor * std::abs(pole));
  }
  if (!(best.gain > 0) || !std::isfinite(best.gain)) return best;
  constexpr int kMaxLevels = 60;
  for (int level = 0; level < kMaxLevels; ++level) {
    const double gamma = (1 + 2 * tolerance) * best.gain;
    const std::vector<double> at = crossings(plant, gamma);
    const double before = best.gain;
    for (std::size_t i = 0; i + 1 < at.size(); ++i) try_at(0.5 * (at[i] + at[i + 1]));
    // The last interval ends at infinity; an interval may also have zero width.
    for (const double w : at) try_at(w);
    if (!at.empty()) try_at(2 * at.back());
    if (best.gain <= before * (1 + 2 * tolerance)) break;
  }
  // Just below a flat peak the two crossings coincide, and rounding moves them off the axis.
  constexpr double kNear = 3e-3;
  if (!(best.w > 0) || std::isinf(best.w)) return best;
  try_at(internal::lowest_between([&](double w) { return -gain_at(w); }, best.w * (1 - kNear),
                                  best.w * (1 + kNear))
             .w);
  return best;
}

void require_tolerance(double tolerance) {
  if (!(tolerance > 0 && tolerance <= 0.1))
    throw InvalidInput("peak_gain",
                       fmt::format("tolerance is {}, expected a number in (0, 0.1]", tolerance));
}

}  // namespace

PeakGain peak_gain(const ContinuousLti& given, double tolerance) {
  validate(given, "peak_gain");
  require_tolerance(tolerance);
  const ContinuousLti plant = completed(given);
  const FrequencyResponse response(plant);
  const double feed_through = largest_singular_value(plant.D.cast<std::complex<double>>());
  const VectorXcd poles = eigenvalues(plant.A);
  PeakGain peak = climb(plant, poles, tolerance, [&](double w) {
    return std::isinf(w) ? feed_through : largest_singular_value(response.at(w));
  });
  peak.stable = poles.real().maxCoeff() < 0;
  return peak;
}

PeakGain peak_gain(const DiscreteLti& given, double tolerance) {
  validate(given, "peak_gain");
  require_tolerance(tolerance);
  const DiscreteLti plant = completed(given);
  const FrequencyResponse response(plant);
  const VectorXcd poles = eigenvalues(plant.A);
  // s = (z - 1)/(z + 1) maps the circle to the axis; ω = tan(Ω dt/2).
  const Index nx = plant.A.rows();
  const Eigen::PartialPivLU<MatrixXd> lu(plant.A + MatrixXd::Identity(nx, nx));
  const double nyquist = std::numbers::pi / plant.dt;
  const auto gain_at = [&](double w) {
    return largest_singular_value(response.at(2 / plant.dt * std::atan(w)));
  };
  PeakGain peak;
  const double at_nyquist = largest_singular_value(response.at(nyquist));
  if (lu.rcond() > 1e-14 && std::isfinite(at_nyquist)) {
    ContinuousLti mapped;
    mapped.A = lu.solve(plant.A - MatrixXd::Identity(nx, nx));
    mapped.B = std::numbers::sqrt2 * lu.solve(plant.B);
    const MatrixXd Ct = lu.transpose().solve(plant.C.transpose());
    mapped.C = std::numbers::sqrt2 * Ct.transpose();
    mapped.D = plant.D - plant.C * lu.solve(plant.B);
    peak = climb(mapped, eigenvalues(mapped.A), tolerance, gain_at);
    peak.w = 2 / plant.dt * std::atan(peak.w);
  } else {
    peak.w = nyquist;
  }
  peak.stable = poles.cwiseAbs().maxCoeff() < 1;
  return peak;
}

namespace {

/// Throws if a pole is not stable, naming the least stable one.
void require_stable(const MatrixXd& A, bool discrete, const std::string& where) {
  const VectorXcd poles = eigenvalues(A);
  Index worst = 0;
  const double excess =
      discrete ? poles.cwiseAbs().maxCoeff(&worst) - 1 : poles.real().maxCoeff(&worst);
  if (excess >= 0)
    throw InvalidInput(
        where, fmt::format("A has a pole at {}, expected all poles {} because the "
                           "energy is infinite otherwise",
                           internal::format_mode(poles[worst]),
                           discrete ? "within the unit circle" : "left of the imaginary axis"));
}

MatrixXd solved(const LyapunovResult& result, const std::string& where) {
  if (!result.solved())
    throw InvalidInput(where, "A is too close to the stability boundary: " + result.culprit);
  return result.X;
}

MatrixXd symmetric_square(const MatrixXd& M) { return M * M.transpose(); }

}  // namespace

MatrixXd controllability_gramian(const ContinuousLti& plant) {
  validate(plant, "controllability_gramian");
  require_stable(plant.A, false, "controllability_gramian");
  return solved(lyapunov_continuous(plant.A, symmetric_square(plant.B)), "controllability_gramian");
}
MatrixXd controllability_gramian(const DiscreteLti& plant) {
  validate(plant, "controllability_gramian");
  require_stable(plant.A, true, "controllability_gramian");
  return solved(lyapunov_discrete(plant.A, symmetric_square(plant.B)), "controllability_gramian");
}

MatrixXd observability_gramian(const ContinuousLti& given) {
  validate(given, "observability_gramian");
  require_stable(given.A, false, "observability_gramian");
  const ContinuousLti plant = completed(given);
  return solved(lyapunov_continuous(plant.A.transpose(), symmetric_square(plant.C.transpose())),
                "observability_gramian");
}
MatrixXd observability_gramian(const DiscreteLti& given) {
  validate(given, "observability_gramian");
  require_stable(given.A, true, "observability_gramian");
  const DiscreteLti plant = completed(given);
  return solved(lyapunov_discrete(plant.A.transpose(), symmetric_square(plant.C.transpose())),
                "observability_gramian");
}

double h2_norm(const ContinuousLti& given) {
  validate(given, "h2_norm");
  const ContinuousLti plant = completed(given);
  if (!(eigenvalues(plant.A).real().maxCoeff() < 0) || (plant.D.array() != 0).any())
    return kInfinite;
  return std::sqrt((plant.C * controllability_gramian(plant) * plant.C.transpose()).trace());
}

double h2_norm(const DiscreteLti& given) {
  validate(given, "h2_norm");
  const DiscreteLti plant = completed(given);
  if (!(eigenvalues(plant.A).cwiseAbs().maxCoeff() < 1)) return kInfinite;
  return std::sqrt((plant.C * controllability_gramian(plant) * plant.C.transpose()).trace() +
                   plant.D.squaredNorm());
}

}  // namespace quadtune
