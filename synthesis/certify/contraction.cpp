// SPDX-License-Identifier: Apache-2.0
#include "certify/contraction.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "lyapunov/lapack.hpp"
#include "lyapunov/schur_lyapunov.hpp"

namespace quadtune::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// A smaller deviation from linearity is not the obstacle; rounding is.
constexpr double kNothing = 1e-12;

/// The closed loops at the corners of a box, and the bounds of the interpolation error in between.
struct Corners {
  std::vector<Index> free;        ///< coordinates of positive width: parameters, then `ahead`
  std::vector<Enclosure> values;  ///< bit b of the index selects the upper end of free[b]
  std::vector<MatrixXd> bends;    ///< interpolation error along each of free
  MatrixXd R;                     ///< sum of the interpolation errors
};

Corners corners_of(const UncertainLoop& loop, const EnclosedBox& box) {
  Corners corners;
  const Index count = box.low.size();
  for (Index i = 0; i < count; ++i)
    if (box.high(i) > box.low(i)) corners.free.push_back(i);
  if (box.past > 0 && box.ahead_high > box.ahead_low) corners.free.push_back(count);
  for (std::size_t index = 0; index < (std::size_t{1} << corners.free.size()); ++index) {
    VectorXd numbers = box.low;
    double ahead = box.ahead_low;
    for (std::size_t b = 0; b < corners.free.size(); ++b) {
      if ((index >> b & 1) == 0) continue;
      if (corners.free[b] == count)
        ahead = box.ahead_high;
      else
        numbers(corners.free[b]) = box.high(corners.free[b]);
    }
    corners.values.push_back(enclosed_loop(loop, numbers, ahead, box.past));
  }
  const std::vector<MatrixXd> errors = interpolation_errors(loop, box);
  corners.R = MatrixXd::Zero(errors.back().rows(), errors.back().cols());
  for (const Index i : corners.free) {
    corners.bends.push_back(errors[static_cast<std::size_t>(i)]);
    corners.R += corners.bends.back();
  }
  corners.R = bounded_above(corners.R);
  return corners;
}

/// Eigenvalues of M and its eigenvectors as columns (real and imaginary part of a complex pair in
/// consecutive columns), for M balanced so that its rows and columns have similar norms.
struct Modes {
  Eigen::VectorXcd values;
  MatrixXd vectors;
  VectorXd scale;  ///< scale factors of the balancing
  double radius = std::numeric_limits<double>::infinity();
};

Modes modes_of(const MatrixXd& M) {
  const auto n = static_cast<lapack_int>(M.rows());
  MatrixXd balanced = M;
  Modes modes;
  modes.scale.resize(n);
  modes.vectors.resize(n, n);
  VectorXd real(n);
  VectorXd imaginary(n);
  lapack_int low = 0;
  lapack_int high = 0;
  double unused = 0;
  if (LAPACKE_dgebal(LAPACK_COL_MAJOR, 'S', n, balanced.data(), n, &low, &high,
                     modes.scale.data()) != 0 ||
      LAPACKE_dgeev(LAPACK_COL_MAJOR, 'N', 'V', n, balanced.data(), n, real.data(),
                    imaginary.data(), &unused, 1, modes.vectors.data(), n) != 0)
    return modes;
  modes.values.resize(n);
  modes.values.real() = real;
  modes.values.imag() = imaginary;
  modes.radius = modes.values.cwiseAbs().maxCoeff();
  return modes;
}

/// Groups eigenvalues whose mutual distance is less than `share` of their distance from the unit
/// circle, and complex pairs.
std::vector<std::vector<Index>> clusters(const Eigen::VectorXcd& values, double share) {
  const Index n = values.size();
  std::vector<std::vector<Index>> all;
  std::vector<bool> taken(static_cast<std::size_t>(n), false);
  for (Index i = 0; i < n; ++i) {
    if (taken[static_cast<std::size_t>(i)]) continue;
    taken[static_cast<std::size_t>(i)] = true;
    std::vector<Index> cluster = {i};
    for (std::size_t k = 0; k < cluster.size(); ++k)  // the cluster grows inside the loop
      for (Index j = 0; j < n; ++j) {
        if (taken[static_cast<std::size_t>(j)]) continue;
        const std::complex<double> a = values(cluster[k]);
        const std::complex<double> b = values(j);
        const double room = 1 - std::max(std::abs(a), std::abs(b));
        if (a != std::conj(b) && !(std::abs(a - b) < share * room)) continue;
        taken[static_cast<std::size_t>(j)] = true;
        cluster.push_back(j);
      }
    std::sort(cluster.begin(), cluster.end());
    all.push_back(std::move(cluster));
  }
  return all;
}

/// Computes a basis of the invariant subspace of a cluster in which the norm of the loop is close
/// to its largest |eigenvalue|: the eigenvectors themselves if the cluster is a single eigenvalue
/// or a pair, otherwise from a Lyapunov equation.
MatrixXd cluster_basis(const MatrixXd& M, const Modes& modes, const std::vector<Index>& cluster) {
  MatrixXd vectors = modes.vectors(Eigen::all, cluster);
  if (cluster.size() == 1) return vectors;
  if (cluster.size() == 2 && modes.values(cluster[0]).imag() != 0) return vectors;
  const MatrixXd basis = Eigen::HouseholderQR<MatrixXd>(vectors).householderQ() *
                         MatrixXd::Identity(vectors.rows(), vectors.cols());
  const MatrixXd block = basis.transpose() * M * basis;
  const double largest = modes.values(cluster).cwiseAbs().maxCoeff();
  const double rate = largest + 0.3 * (1 - largest);
  // (block/rate)ᵀ P (block/rate) - P + I = 0
  const SchurLyapunov lyapunov(Time::discrete, block.transpose() / rate);
  if (!lyapunov.ok()) return vectors;
  const Eigen::LLT<MatrixXd> llt(lyapunov.solve(MatrixXd::Identity(block.rows(), block.cols())));
  if (llt.info() != Eigen::Success) return vectors;
  MatrixXd inverse = MatrixXd(llt.matrixU()).inverse();
  inverse /= inverse.norm() / std::sqrt(static_cast<double>(block.rows()));
  return basis * inverse;
}

std::optional<Coordinates> along(const MatrixXd& M, const Modes& modes, double share) {
  const Index n = M.rows();
  const MatrixXd balanced = modes.scale.cwiseInverse().asDiagonal() * M * modes.scale.asDiagonal();
  MatrixXd vectors(n, n);
  Index column = 0;
  for (const std::vector<Index>& cluster : clusters(modes.values, share)) {
    vectors.middleCols(column, std::ssize(cluster)) = cluster_basis(balanced, modes, cluster);
    column += std::ssize(cluster);
  }
  vectors = (modes.scale.asDiagonal() * vectors).eval();
  if (!vectors.allFinite()) return std::nullopt;
  const Eigen::PartialPivLU<MatrixXd> lu(vectors);
  Coordinates z{lu.inverse(), vectors};
  if (!z.Y.allFinite()) return std::nullopt;
  return z;
}

double largest_singular_value(const MatrixXd& N) {
  const MatrixXd square = N.transpose() * N;
  if (!square.allFinite()) return std::numeric_limits<double>::infinity();
  const VectorXd values =
      Eigen::SelfAdjointEigenSolver<MatrixXd>(square, Eigen::EigenvaluesOnly).eigenvalues();
  return std::sqrt(std::max(0.0, values(values.size() - 1)));
}

std::vector<MatrixXd> seen_in(const Coordinates& z, const Corners& corners) {
  std::vector<MatrixXd> seen;
  seen.reserve(corners.values.size());
  for (const Enclosure& value : corners.values) seen.push_back(z.Y * value.mid * z.X);
  return seen;
}

/// The norm of a nonnegative matrix of bounds in these coordinates.
double size_in(const Coordinates& z, const MatrixXd& R) {
  return norm_bound(z.Y.cwiseAbs() * R * z.X.cwiseAbs());
}

double corner_expansion(const Coordinates& z, const Corners& corners) {
  double max = 0;
  for (const MatrixXd& N : seen_in(z, corners)) max = std::max(max, largest_singular_value(N));
  return max;
}

/// The maximum ‖Y M X‖₂ in the box, approximately.
double expansion(const Coordinates& z, const Corners& corners) {
  return corner_expansion(z, corners) + size_in(z, corners.R);
}

/// A singular value σ of N = Y M X beyond a target, with its vectors. Y ← (I + E) Y changes it by
/// ⟨E, J⟩ = Σ E_ij J_ij with J = σ (u uᵀ - v vᵀ).
struct Excess {
  double sigma = 0;
  VectorXd u;
  VectorXd v;
};

/// ⟨J_a, J_b⟩
double inner(const Excess& a, const Excess& b) {
  const double uu = a.u.dot(b.u), uv = a.u.dot(b.v), vu = a.v.dot(b.u), vv = a.v.dot(b.v);
  return a.sigma * b.sigma * (uu * uu - uv * uv - vu * vu + vv * vv);
}

/// Computes the excesses of all corners; the largest ones if there are more than kMaxExcesses.
/// @param most  the largest singular value of all corners
/// @return      none if a corner is not finite
std::optional<std::vector<Excess>> excesses(const Coordinates& z, const Corners& corners,
                                            double target, double& max) {
  constexpr std::size_t kMaxExcesses = 256;  // each adds one linear equation
  std::vector<Excess> all;
  max = 0;
  for (const MatrixXd& N : seen_in(z, corners)) {
    const MatrixXd square = N.transpose() * N;
    if (!square.allFinite()) return std::nullopt;
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(square);
    for (Index k = square.rows() - 1; k >= 0; --k) {
      const double sigma = std::sqrt(std::max(0.0, eigen.eigenvalues()(k)));
      max = std::max(max, sigma);
      if (!(sigma > target)) break;
      const VectorXd v = eigen.eigenvectors().col(k);
      all.push_back({sigma, N * v / sigma, v});
    }
  }
  if (all.size() > kMaxExcesses) {
    std::nth_element(all.begin(), all.begin() + kMaxExcesses, all.end(),
                     [](const Excess& a, const Excess& b) { return a.sigma > b.sigma; });
    all.resize(kMaxExcesses);
  }
  return all;
}

/// Computes the E with the minimum Frobenius norm for which all singular values would equal the
/// target if they were linear in E: E = -Σ w_i J_i with (⟨J_i, J_j⟩ + λ δ_ij) w = σ - target.
MatrixXd step_towards(double target, const std::vector<Excess>& excesses) {
  constexpr double kDamping = 1e-3;  // of the mean of ⟨J_i, J_i⟩
  const Index count = std::ssize(excesses);
  const Index n = excesses.front().u.size();
  MatrixXd gram(count, count);
  VectorXd by(count);
  for (Index i = 0; i < count; ++i) {
    const Excess& one = excesses[static_cast<std::size_t>(i)];
    by(i) = one.sigma - target;
    for (Index j = 0; j <= i; ++j)
      gram(i, j) = gram(j, i) = inner(one, excesses[static_cast<std::size_t>(j)]);
  }
  const double damping = kDamping * gram.diagonal().mean() + std::numeric_limits<double>::min();
  gram.diagonal().array() += damping;
  const VectorXd w = gram.llt().solve(by);
  MatrixXd E = MatrixXd::Zero(n, n);
  for (Index i = 0; i < count; ++i) {
    const Excess& one = excesses[static_cast<std::size_t>(i)];
    E -= w(i) * one.sigma * (one.u * one.u.transpose() - one.v * one.v.transpose());
  }
  return E;
}

/// Improves the coordinates until no corner expands, by the damped Gauss-Newton method on the
/// singular values that exceed a target. The target is half way between the spectral radius at the
/// midpoint, which is a lower bound in all coordinates, and the value that suffices for a proof.
/// @param least  in: the expansion in z; out: that of the result
Coordinates improved(Coordinates z, const Corners& corners, double radius, double& min) {
  constexpr int kSteps = 60;
  constexpr double kMax = 0.4;  // maximum step, so that I + E is regular
  Coordinates best = z;
  for (int step = 0; step < kSteps && !(min < 1); ++step) {
    const double bend = size_in(z, corners.R);
    const double target = std::max(radius, 0.5 * (radius + 1 - bend));
    double max = 0;
    const std::optional<std::vector<Excess>> beyond = excesses(z, corners, target, max);
    if (!beyond) break;
    if (max + bend < min) {
      min = max + bend;
      best = z;
    }
    if (min < 1 || beyond->empty()) break;
    const MatrixXd E = step_towards(target, *beyond);
    const double size = E.norm();
    if (!(size > 0) || !std::isfinite(size)) break;
    const MatrixXd turn = MatrixXd::Identity(E.rows(), E.cols()) + std::min(1.0, kMax / size) * E;
    z.Y = (turn * z.Y).eval();
    z.X = (z.X * turn.inverse()).eval();
  }
  return best;
}

/// Compares the coordinates of `start` with those of several groupings of the eigenvalues, and
/// returns those with the minimum expansion of the corners.
/// @param least  in: the expansion in the coordinates of `start`, infinite if there are none; out:
///               that of the result
std::optional<Coordinates> chosen(const MatrixXd& middle, const Modes& modes,
                                  const Corners& corners, const Coordinates* start, double min) {
  std::optional<Coordinates> best;
  if (start != nullptr) best = *start;
  for (const double share : {0.0, 0.3, 1.0, 3.0}) {
    std::optional<Coordinates> z = along(middle, modes, share);
    if (!z) continue;
    const double max = expansion(*z, corners);
    if (!(max < min)) continue;
    min = max;
    best = std::move(z);
    if (min < 1) return best;
  }
  if (best && std::isfinite(min)) best = improved(*best, corners, modes.radius, min);
  return best;
}

/// Chooses the coordinate to split. If the corners contract, the obstacle is the interpolation
/// error, and the coordinate with the largest one is split; otherwise the one along which the loops
/// of two corners that differ only in it differ most.
Index widest(const Coordinates& z, const Corners& corners) {
  const bool bent = corner_expansion(z, corners) < 1 && size_in(z, corners.R) > kNothing;
  const std::vector<MatrixXd> seen = seen_in(z, corners);
  Index place = -1;
  double max = -1;
  for (std::size_t b = 0; b < corners.free.size(); ++b) {
    double apart = 0;
    if (bent) apart = size_in(z, corners.bends[b]);
    for (std::size_t index = 0; index < seen.size() && !bent; ++index)
      if ((index >> b & 1) == 0)
        apart = std::max(apart, (seen[index | std::size_t{1} << b] - seen[index]).norm());
    if (!(apart <= max)) {
      max = apart;
      place = corners.free[b];
    }
  }
  return place;
}

/// The rigorous proof. Its correctness does not depend on the accuracy of the preceding
/// computations.
void prove(const Coordinates& z, const Corners& corners, Contraction& result) {
  const Index n = corners.R.rows();
  const Enclosure Y(z.Y);
  const Enclosure X(z.X);
  const Enclosure G = Y * X;  // approximately I
  const MatrixXd off = (G - Enclosure(MatrixXd(MatrixXd::Identity(n, n)))).magnitude();
  const double g = norm_bound(off);
  if (!(g < 0.5)) return;
  const Enclosure GG = G.transpose() * G;
  double min = std::numeric_limits<double>::infinity();
  for (const Enclosure& value : corners.values) {
    const Enclosure M(value.mid, bounded_above(value.rad + corners.R));
    const Enclosure H = Y * M * X;
    // GᵀG - HᵀH = Xᵀ (YᵀY - MᵀYᵀYM) X ≥ c I also proves that X, and therefore Y, is regular.
    const double c = min_eigenvalue_bound(GG - H.transpose() * H);
    if (!(c > 0)) return;
    min = std::min(min, c);
  }
  // ‖Y M X ξ‖² ≤ ‖z‖² - c ‖ξ‖² with z = G ξ, ‖ξ‖ ≥ ‖z‖/(1 + g).
  result.gap = min / (2 * (1 + g) * (1 + g)) * (1 - 1e-12);
  result.condition =
      bounded_above(norm_bound(z.Y.cwiseAbs()) * norm_bound(z.X.cwiseAbs()) / (1 - g));
  result.proved = result.gap > 0 && std::isfinite(result.condition);
}

}  // namespace

Contraction prove_contraction(const UncertainLoop& loop, const EnclosedBox& box,
                              const Coordinates* start) {
  Contraction result;
  const Corners corners = corners_of(loop, box);
  if (!corners.free.empty()) result.widest = corners.free.back();
  double min = std::numeric_limits<double>::infinity();
  if (start != nullptr) {
    min = expansion(*start, corners);
    if (min < 1) prove(*start, corners, result);
    if (result.proved) {
      result.radius = std::numeric_limits<double>::quiet_NaN();
      return result;
    }
  }
  const MatrixXd middle = enclosed_loop(loop, 0.5 * (box.low + box.high),
                                        0.5 * (box.ahead_low + box.ahead_high), box.past)
                              .mid;
  const Modes modes = modes_of(middle);
  result.radius = modes.radius;
  if (!(modes.radius < 1)) return result;
  result.coordinates = chosen(middle, modes, corners, start, min);
  if (!result.coordinates) return result;
  prove(*result.coordinates, corners, result);
  if (!result.proved && !corners.free.empty()) result.widest = widest(*result.coordinates, corners);
  return result;
}

}  // namespace quadtune::internal
