// SPDX-License-Identifier: Apache-2.0
#include "certify/enclosure.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace quadtune::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kUnit = 0x1p-53;  // half of the distance from 1 to the next double

// Bound of the underflow error in a sum of at most 2000 products.
constexpr double kUnderflow = 1e-290;

// Rounding error of a sum of n products, relative to the sum of their magnitudes.
double product_error(Index n) {
  const double nu = static_cast<double>(n + 2) * kUnit;
  return nu / (1 - nu);
}

// Whether the Cholesky factorization of S completes in doubles: all pivots are positive.
bool cholesky_ends(MatrixXd S) {
  const Index n = S.rows();
  for (Index j = 0; j < n; ++j) {
    double pivot = S(j, j);
    for (Index k = 0; k < j; ++k) pivot -= S(j, k) * S(j, k);
    if (!(pivot > 0) || !std::isfinite(pivot)) return false;
    S(j, j) = std::sqrt(pivot);
    for (Index i = j + 1; i < n; ++i) {
      double entry = S(i, j);
      for (Index k = 0; k < j; ++k) entry -= S(i, k) * S(j, k);
      S(i, j) = entry / S(j, j);
    }
  }
  return true;
}

}  // namespace

MatrixXd Enclosure::magnitude() const { return bounded_above(mid.cwiseAbs() + rad); }

NumberEnclosure NumberEnclosure::between(double low, double high) {
  const double mid = 0.5 * low + 0.5 * high;
  const double reach = std::max(std::abs(high - mid), std::abs(mid - low));
  return {mid, low == high ? 0 : bounded_above(reach + 4 * kUnit * std::abs(mid))};
}

// The relative error of 2000 sums and products of numbers ≥ 0 is less than 1e-12.
MatrixXd bounded_above(const ConstRef& R) {
  return (R.array() * (1 + 1e-12) + kUnderflow).matrix();
}

double bounded_above(double r) { return r * (1 + 1e-12) + kUnderflow; }

Enclosure operator+(const Enclosure& a, const Enclosure& b) {
  MatrixXd mid = a.mid + b.mid;
  MatrixXd rad = bounded_above(a.rad + b.rad + 2 * kUnit * mid.cwiseAbs());
  return {std::move(mid), std::move(rad)};
}

Enclosure operator-(const Enclosure& a, const Enclosure& b) {
  MatrixXd mid = a.mid - b.mid;
  MatrixXd rad = bounded_above(a.rad + b.rad + 2 * kUnit * mid.cwiseAbs());
  return {std::move(mid), std::move(rad)};
}

Enclosure operator*(const Enclosure& a, const Enclosure& b) {
  const MatrixXd A = a.mid.cwiseAbs();
  const MatrixXd B = b.mid.cwiseAbs();
  // |ab - mid| ≤ |a| rad b + rad a (|b| + rad b) + rounding of the product of the midpoints
  MatrixXd rad = A * b.rad + a.rad * (B + b.rad) + product_error(a.cols()) * (A * B);
  return {a.mid * b.mid, bounded_above(rad)};
}

Enclosure operator*(const NumberEnclosure& a, const Enclosure& b) {
  MatrixXd mid = a.mid * b.mid;
  MatrixXd rad =
      std::abs(a.mid) * b.rad + a.rad * (b.mid.cwiseAbs() + b.rad) + 2 * kUnit * mid.cwiseAbs();
  return {std::move(mid), bounded_above(rad)};
}

Enclosure operator/(const Enclosure& a, double c) {
  MatrixXd mid = a.mid / c;
  MatrixXd rad = a.rad / std::abs(c) + 2 * kUnit * mid.cwiseAbs();
  return {std::move(mid), bounded_above(rad)};
}

double norm_bound(const ConstRef& R) {
  if (R.size() == 0) return 0;
  // ‖M‖₂² ≤ ‖M‖₁ ‖M‖∞, and neither exceeds that of R.
  const double columns = R.colwise().sum().maxCoeff();
  const double rows = R.rowwise().sum().maxCoeff();
  return bounded_above(std::sqrt(columns * rows));
}

double min_eigenvalue_bound(const Enclosure& S) {
  const Index n = S.rows();
  if (!S.mid.allFinite() || !S.rad.allFinite()) return std::numeric_limits<double>::quiet_NaN();
  const MatrixXd mid = 0.5 * (S.mid + S.mid.transpose());
  const MatrixXd rad =
      bounded_above(0.5 * (S.rad + S.rad.transpose()) + 2 * kUnit * mid.cwiseAbs());
  const double guess =
      Eigen::SelfAdjointEigenSolver<MatrixXd>(mid, Eigen::EigenvaluesOnly).eigenvalues()(0);
  if (!(guess > 0)) return guess;
  // Try to prove half of the computed minimum eigenvalue.
  const double shift = 0.5 * guess;
  const MatrixXd shifted = mid - shift * MatrixXd::Identity(n, n);
  if (!cholesky_ends(shifted)) return 0;
  const double gamma = product_error(n);
  const double trace = shifted.diagonal().cwiseAbs().sum();
  const double subtraction = 2 * kUnit * (mid.diagonal().cwiseAbs().maxCoeff() + shift);
  const double lost = gamma / (1 - gamma) * trace + subtraction + norm_bound(rad);
  return shift - bounded_above(lost);
}

}  // namespace quadtune::internal
