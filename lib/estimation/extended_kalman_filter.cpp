// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/extended_kalman_filter.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>
#include <utility>

#include "quadtune/errors.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr const char* kExtendedFilter = "extended filter";

/// @param definite  whether M must be > 0 instead of ≥ 0
void require_covariance_matrix(const MatrixXd& M, Index size, bool definite, const char* name,
                               const std::string& why) {
  require_shape(M, size, size, kExtendedFilter, name, why);
  require_finite(M, kExtendedFilter, name);
  require_symmetric(M, kExtendedFilter, name);
  const auto reject = [&](const std::string& what) {
    throw InvalidInput(kExtendedFilter,
                       fmt::format("{} has {}, expected {} {} 0 because it is a covariance", name,
                                   what, name, definite ? ">" : ">="));
  };
  VectorXd units = M.diagonal();
  for (Index i = 0; i < size; ++i) {
    if (units(i) < 0 || (definite && units(i) == 0))
      reject(fmt::format("the variance {} at ({},{})", units(i), i + 1, i + 1));
    units(i) = units(i) > 0 ? 1 / std::sqrt(units(i)) : 1;
    if (M(i, i) == 0 && !M.row(i).isZero(0))
      reject(fmt::format("a covariance of a quantity without variance in row {}", i + 1));
  }
  // The eigenvalues of the correlation matrix do not depend on units.
  constexpr double kRounding = 1e-12;
  const MatrixXd correlations = units.asDiagonal() * M * units.asDiagonal();
  const double min = Eigen::SelfAdjointEigenSolver<MatrixXd>(correlations, Eigen::EigenvaluesOnly)
                         .eigenvalues()
                         .minCoeff();
  if (min < (definite ? kRounding : -kRounding * static_cast<double>(size)))
    reject(fmt::format("a correlation matrix with the eigenvalue {:.3g}", min));
}

/// "has 1 row", "has 2 states", …
std::string has_count(Index count, const char* what) {
  return fmt::format("has {} {}{}", count, what, count == 1 ? "" : "s");
}
std::string states_of(const VectorXd& x) { return "the filter " + has_count(x.size(), "state"); }
std::string rows_of_y(const VectorXd& y) { return "y " + has_count(y.size(), "row"); }

}  // namespace

ExtendedKalmanFilter::ExtendedKalmanFilter(VectorXd x0, MatrixXd P0, Correction correction)
    : x_(std::move(x0)), P_(std::move(P0)), correction_(std::move(correction)) {
  if (x_.size() == 0)
    throw InvalidInput(kExtendedFilter, "x0 is empty, expected at least one state");
  require_finite(x_, kExtendedFilter, "x0");
  require_covariance_matrix(P_, x_.size(), false, "P0", states_of(x_));
}

void ExtendedKalmanFilter::require_prediction(double dt, const MatrixXd& Q) const {
  if (!(dt > 0) || !std::isfinite(dt))
    throw InvalidInput(kExtendedFilter, fmt::format("dt is {} s, expected a positive number", dt));
  require_covariance_matrix(Q, x_.size(), false, "Q", states_of(x_));
}

void ExtendedKalmanFilter::finish_prediction(const Linearized& f, const MatrixXd& Q) {
  require_shape(f.value, x_.size(), 1, kExtendedFilter, "f(x, u, dt)", states_of(x_));
  require_finite(f.value, kExtendedFilter, "f(x, u, dt)");
  require_finite(f.jacobian, kExtendedFilter, "the Jacobian of f");
  take(f.value, f.jacobian * P_ * f.jacobian.transpose() + Q);
}

void ExtendedKalmanFilter::require_update(const VectorXd& y, const MatrixXd& R,
                                          const ExtendedUpdateOptions& options) {
  if (!(options.gate > 0))
    throw InvalidInput(kExtendedFilter,
                       fmt::format("gate is {}, expected a positive number", options.gate));
  if (y.size() == 0)
    throw InvalidInput(kExtendedFilter, "y is empty, expected at least one measurement");
  require_finite(y, kExtendedFilter, "y");
  require_covariance_matrix(R, y.size(), true, "R", rows_of_y(y));
}

ExtendedUpdate ExtendedKalmanFilter::finish_update(const Linearized& h, const VectorXd& y,
                                                   const MatrixXd& R,
                                                   const ExtendedUpdateOptions& options) {
  const std::string rows = rows_of_y(y);
  require_shape(h.value, y.size(), 1, kExtendedFilter, "h(x, u)", rows);
  require_finite(h.value, kExtendedFilter, "h(x, u)");
  require_finite(h.jacobian, kExtendedFilter, "the Jacobian of h");
  ExtendedUpdate result;
  result.H = h.jacobian;
  result.innovation = options.innovation ? options.innovation(y, h.value) : VectorXd(y - h.value);
  require_shape(result.innovation, y.size(), 1, kExtendedFilter, "the innovation", rows);
  require_finite(result.innovation, kExtendedFilter, "the innovation");
  const MatrixXd& H = result.H;
  const VectorXd& e = result.innovation;
  const MatrixXd PHt = P_ * H.transpose();
  result.S = H * PHt + R;
  result.S = 0.5 * (result.S + result.S.transpose()).eval();
  require_finite(result.S, kExtendedFilter, "S = H P H' + R");
  const Eigen::LLT<MatrixXd> llt(result.S);
  if (llt.info() != Eigen::Success)
    throw InvalidInput(kExtendedFilter,
                       "S = H P H' + R is not positive definite up to rounding, expected an R that "
                       "is larger compared with H P H'");
  result.innovation_square = e.dot(llt.solve(e));
  if (!std::isfinite(result.innovation_square))
    throw InvalidInput(kExtendedFilter,
                       "the innovation exceeds the range of a double compared with its covariance, "
                       "expected a measurement closer to h(x, u)");
  double log_det = 0;
  for (Index i = 0; i < e.size(); ++i) log_det += 2 * std::log(llt.matrixLLT()(i, i));
  result.log_likelihood = -0.5 * (result.innovation_square + log_det +
                                  static_cast<double>(e.size()) * std::log(2 * std::numbers::pi));
  result.used = result.innovation_square <= options.gate;
  if (!result.used) return result;
  const MatrixXd K = llt.solve(PHt.transpose()).transpose();
  const MatrixXd T = MatrixXd::Identity(x_.size(), x_.size()) - K * H;
  // Joseph's form stays ≥ 0 whatever the rounding error of K.
  take(x_ + K * e, T * P_ * T.transpose() + K * R * K.transpose());
  return result;
}

/// Corrects and checks a new estimate before it replaces the present one.
void ExtendedKalmanFilter::take(VectorXd x, MatrixXd P) {
  const Index nx = x_.size();
  if (correction_) correction_(x);
  require_shape(x, nx, 1, kExtendedFilter, "the corrected x", states_of(x_));
  require_finite(x, kExtendedFilter, "the new x");
  P = (0.5 * P + 0.5 * P.transpose()).eval();
  require_finite(P, kExtendedFilter, "the new P");
  x_ = std::move(x);
  P_ = std::move(P);
}

}  // namespace quadtune
