// SPDX-License-Identifier: Apache-2.0
/// Matrices with error bounds (midpoint and radius), and rigorous products and sums of them.
#pragma once

#include <Eigen/Core>

#include "riccati/riccati_parts.hpp"

namespace quadtune::internal {

/// The set of all matrices M with |M - mid| ≤ rad, entry by entry. After an overflow, entries are
/// not finite; a decision based on such an enclosure must be negative.
///
/// Rounding errors are bounded a priori, so that no rounding mode is changed: the error of a sum of
/// n products in any order, fused or not, is at most n u/(1 - n u) times the sum of their
/// magnitudes, u = 2⁻⁵³.
/// Source: Higham 2002, section 3.1; Rump 1999, midpoint and radius.
struct Enclosure {
  Eigen::MatrixXd mid;
  Eigen::MatrixXd rad;  ///< ≥ 0

  Enclosure() = default;
  /// The matrix M, with radius 0.
  explicit Enclosure(const ConstRef& M) : mid(M), rad(Eigen::MatrixXd::Zero(M.rows(), M.cols())) {}
  Enclosure(Eigen::MatrixXd middle, Eigen::MatrixXd radius)
      : mid(std::move(middle)), rad(std::move(radius)) {}

  [[nodiscard]] Eigen::Index rows() const { return mid.rows(); }
  [[nodiscard]] Eigen::Index cols() const { return mid.cols(); }
  [[nodiscard]] Enclosure transpose() const { return {mid.transpose(), rad.transpose()}; }
  /// Upper bounds of |M|.
  [[nodiscard]] Eigen::MatrixXd magnitude() const;
};

/// The set of all real numbers within a radius of a midpoint.
struct NumberEnclosure {
  double mid = 0;
  double rad = 0;  ///< ≥ 0

  /// The interval low … high, rounded outwards.
  [[nodiscard]] static NumberEnclosure between(double low, double high);
};

/// Returns an upper bound of the exact value of R ≥ 0, whose entries were computed in doubles by at
/// most 2000 sums and products each.
[[nodiscard]] Eigen::MatrixXd bounded_above(const ConstRef& R);
[[nodiscard]] double bounded_above(double r);

[[nodiscard]] Enclosure operator+(const Enclosure& a, const Enclosure& b);
[[nodiscard]] Enclosure operator-(const Enclosure& a, const Enclosure& b);
[[nodiscard]] Enclosure operator*(const Enclosure& a, const Enclosure& b);
[[nodiscard]] Enclosure operator*(const NumberEnclosure& a, const Enclosure& b);
/// M/c for an exact double c.
[[nodiscard]] Enclosure operator/(const Enclosure& a, double c);

/// An upper bound of ‖M‖₂ for |M| ≤ R.
[[nodiscard]] double norm_bound(const ConstRef& R);

/// Computes a proved lower bound c of the eigenvalues: every symmetric matrix in S is ≥ c I. The
/// result is not positive, or NaN, if no bound was found. S need not be symmetric: its asymmetry is
/// added to the radius.
///
/// If the Cholesky factorization of S.mid - t I completes, S.mid - t I ≥ -δ I, where δ bounds the
/// rounding errors of the factorization. Source: Rump 2006; Higham 2002, theorem 10.5.
[[nodiscard]] double min_eigenvalue_bound(const Enclosure& S);

}  // namespace quadtune::internal
