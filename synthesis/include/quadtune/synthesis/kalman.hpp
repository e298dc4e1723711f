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

/// Noise of a model: process noise w enters the states through G, measurement noise v is added to
/// y = C x. The matrices are covariances per step (discrete) or spectral densities (continuous).
struct KalmanNoise {
  Eigen::MatrixXd G;  ///< (nx × nw), or empty for the identity
  Eigen::MatrixXd Q;  ///< (nw × nw) symmetric, ≥ 0: covariance of w
  Eigen::MatrixXd R;  ///< (ny × ny) symmetric: covariance of v; > 0 continuous, ≥ 0 discrete
  Eigen::MatrixXd N;  ///< (nw × ny) cross-covariance of w and v, or empty for zero
};

/// The steady-state filter with its evidence. Matrices are NaN unless solved.
struct KalmanResult {
  /// not_detectable: an unstable mode or a mode on the stability boundary is unobservable through
  /// C; not_stabilizable: a mode on the stability boundary is not driven by the process noise.
  RiccatiStatus status = RiccatiStatus::not_run;
  Eigen::MatrixXd M;  ///< (nx × ny) filter gain: x⁺ = x + M (y - C x); empty when continuous
  /// (nx × ny) predictor gain: x[k+1|k] = A x[k|k-1] + B u + L (y - C x[k|k-1]);
  /// continuous: x' = A x + B u + L (y - C x).
  Eigen::MatrixXd L;
  Eigen::MatrixXd P;       ///< (nx × nx) error covariance before the measurement
  Eigen::MatrixXd Z;       ///< (nx × nx) error covariance after it; empty when continuous
  Eigen::VectorXcd poles;  ///< (nx) eigenvalues of A - L C; as RiccatiResult::poles
  double residual = std::numeric_limits<double>::quiet_NaN();  ///< as RiccatiResult::residual
  double rcond = std::numeric_limits<double>::quiet_NaN();     ///< as RiccatiResult::rcond
  int iterations = 0;                                          ///< as RiccatiResult::iterations
  std::string culprit;  ///< e.g. "mode at 1: bias cannot be observed by the measurements"
  std::string warning;  ///< as RiccatiResult::warning, about L

  /// Whether there is a filter.
  [[nodiscard]] bool solved() const { return status == RiccatiStatus::solved; }
};

/// Computes the steady-state filter of x[k+1] = A x + B u + G w, y = C x + v.
///
/// @param model    A, C (ny × nx) and the state names; B may be empty
/// @param noise    covariances per step
/// @param options  of the Riccati equation. Its state_names are those of the model unless given;
///                 its problem is always the filter, and an indefinite Q is always rejected
/// @throws InvalidInput  for wrong shapes, entries that are not finite, asymmetric or indefinite
///                       covariances, and options out of range.
[[nodiscard]] KalmanResult kalman(const DiscreteLti& model, const KalmanNoise& noise,
                                  const RiccatiOptions& options = {});

/// Computes the steady-state (Kalman–Bucy) filter of x' = A x + B u + G w, y = C x + v.
[[nodiscard]] KalmanResult kalman(const ContinuousLti& model, const KalmanNoise& noise,
                                  const RiccatiOptions& options = {});

/// A continuous model that is measured every dt seconds, as a discrete one.
struct SampledKalman {
  DiscreteLti model;  ///< A and C
  KalmanNoise noise;  ///< Q (nx × nx) and R per step; G and N are empty
};

/// Samples A and G Q Gᵀ exactly; R [unit² s] becomes R / dt.
/// @param model  nx states
/// @param noise  spectral densities; N empty or zero
/// @param dt     sample period [s], > 0
/// @throws InvalidInput  as kalman(), if N is not zero, or if dt is out of range
/// Source: Van Loan 1978.
[[nodiscard]] SampledKalman sampled_kalman(const ContinuousLti& model, const KalmanNoise& noise,
                                           double dt);

/// Computes the filter of sampled_kalman().
/// @param model, noise, dt  as for sampled_kalman()
/// @param options           as for kalman()
[[nodiscard]] KalmanResult kalman_sampled(const ContinuousLti& model, const KalmanNoise& noise,
                                          double dt, const RiccatiOptions& options = {});

}  // namespace quadtune
