// SPDX-License-Identifier: Apache-2.0
/// Matrices known up to a radius, and products and sums that never lose what they stand for.
#pragma once

#include <Eigen/Core>

#include "riccati/riccati_parts.hpp"

namespace quadtune::internal {

/// Every matrix M with |M - mid| ≤ rad, entry by entry. Overflow leaves entries that are not
/// finite; whoever decides by an enclosure takes these for a no.
///
/// Rounding is bounded beforehand, so no rounding mode is changed: a sum of n products in any
/// order, fused or not, is off by at most n u/(1 - n u) times the sum of their sizes, u = 2⁻⁵³.
/// Source: Higham 2002, section 3.1; Rump 1999, midpoint and radius.
struct Enclosure {
  Eigen::MatrixXd mid;
  Eigen::MatrixXd rad;  ///< ≥ 0

  Enclosure() = default;
  /// M itself.
  explicit Enclosure(const ConstRef& M) : mid(M), rad(Eigen::MatrixXd::Zero(M.rows(), M.cols())) {}
  Enclosure(Eigen::MatrixXd middle, Eigen::MatrixXd radius)
      : mid(std::move(middle)), rad(std::move(radius)) {}

  [[nodiscard]] Eigen::Index rows() const { return mid.rows(); }
  [[nodiscard]] Eigen::Index cols() const { return mid.cols(); }
  [[nodiscard]] Enclosure transpose() const { return {mid.transpose(), rad.transpose()}; }
  /// Upper bounds of |M|.
  [[nodiscard]] Eigen::MatrixXd magnitude() const;
};

/// All real numbers within a radius of one.
struct NumberEnclosure {
  double mid = 0;
  double rad = 0;  ///< ≥ 0

  /// low … high, rounded outwards.
  [[nodiscard]] static NumberEnclosure between(double low, double high);
};

/// A bound of R from R itself, where R ≥ 0 was made in doubles by at most 2000 sums and products a
/// entry.
[[nodiscard]] Eigen::MatrixXd bounded_above(const ConstRef& R);
[[nodiscard]] double bounded_above(double r);

[[nodiscard]] Enclosure operator+(const Enclosure& a, const Enclosure& b);
[[nodiscard]] Enclosure operator-(const Enclosure& a, const Enclosure& b);
[[nodiscard]] Enclosure operator*(const Enclosure& a, const Enclosure& b);
[[nodiscard]] Enclosure operator*(const NumberEnclosure& a, const Enclosure& b);
/// M/c for a c that is a double.
[[nodiscard]] Enclosure operator/(const Enclosure& a, double c);

/// An upper bound of ‖M‖₂ for |M| ≤ R.
[[nodiscard]] double norm_bound(const ConstRef& R);

/// A c for which every symmetric matrix of S is ≥ c I, proved; not above 0, or NaN, where none was
/// found. S need not be symmetric to rounding: what is not is counted into its radius.
///
/// A Cholesky factorization of S.mid - t I that ends proves S.mid - t I ≥ -δ I, δ the
/// factorization's own rounding. Source: Rump 2006; Higham 2002, theorem 10.5.
[[nodiscard]] double least_eigenvalue_bound(const Enclosure& S);

}  // namespace quadtune::internal
