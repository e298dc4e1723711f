// SPDX-License-Identifier: Apache-2.0
/// Steady-state Kalman filters, continuous and discrete.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>

#include "quadtune/filter.hpp"
#include "quadtune/lti.hpp"
#include "quadtune/synthesis/riccati.hpp"

namespace quadtune {

/// Process noise w enters by G, measurement noise v adds to y = C x. Discrete: covariances per
/// step. Continuous: spectral densities.
struct KalmanNoise {
  Eigen::MatrixXd G;  ///< (nx × nw), or empty for the identity
  Eigen::MatrixXd Q;  ///< (nw × nw) symmetric, ≥ 0: of w
  Eigen::MatrixXd R;  ///< (ny × ny) symmetric; > 0 continuous, ≥ 0 discrete: of v
  Eigen::MatrixXd N;  ///< (nw × ny) between w and v, or empty for zero
};

/// The steady filter with its evidence. Matrices are NaN unless solved.
struct KalmanResult {
  /// not_detectable: C does not see an unstable or boundary mode; not_stabilizable: the noise does
  /// not drive a boundary mode.
  RiccatiStatus status = RiccatiStatus::not_run;
  Eigen::MatrixXd M;  ///< (nx × ny) filter gain: x⁺ = x + M (y - C x); empty when continuous
  /// (nx × ny) predictor gain: x[k+1|k] = A x[k|k-1] + B u + L (y - C x[k|k-1]);
  /// continuous: x' = A x + B u + L (y - C x).
  Eigen::MatrixXd L;
  Eigen::MatrixXd P;       ///< (nx × nx) error covariance before the measurement
  Eigen::MatrixXd Z;       ///< (nx × nx) error covariance after it; empty when continuous
  Eigen::VectorXcd poles;  ///< (nx) eigenvalues of A - L C
  double residual = std::numeric_limits<double>::quiet_NaN();  ///< as RiccatiResult::residual
  double rcond = std::numeric_limits<double>::quiet_NaN();     ///< as RiccatiResult::rcond
  int iterations = 0;
  std::string culprit;  ///< e.g. "mode at 1: bias cannot be seen by the measurements"
  std::string warning;  ///< as RiccatiResult::warning, of L

  [[nodiscard]] bool solved() const { return status == RiccatiStatus::solved; }
};

/// Steady filter of x[k+1] = A x + B u + G w, y = C x + v.
///
/// @param model  A, C (ny × nx) and the state names; B may be empty
/// @throws InvalidInput  for shapes, non-finite entries, asymmetry, indefinite covariances.
[[nodiscard]] KalmanResult kalman(const DiscreteLti& model, const KalmanNoise& noise);

/// Steady filter (Kalman–Bucy) of x' = A x + B u + G w, y = C x + v.
[[nodiscard]] KalmanResult kalman(const ContinuousLti& model, const KalmanNoise& noise);

/// The discrete filter of a continuous model whose measurements come every dt seconds: A and G Q Gᵀ
/// are sampled exactly, and R [unit² s] becomes R / dt.
/// Source: Van Loan 1978.
[[nodiscard]] KalmanResult kalman_sampled(const ContinuousLti& model, const KalmanNoise& noise,
                                          double dt);

}  // namespace quadtune
