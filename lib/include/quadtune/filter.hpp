// SPDX-License-Identifier: Apache-2.0
/// A steady-state Kalman filter together with the model and noise that it was designed for.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "quadtune/lti.hpp"

namespace quadtune {

/// x[k+1] = A x + B u + G w, y = C x + v; cov(w) = Q, cov(v) = R, cov(w, v) = N.
struct KalmanFilter {
  std::string name;   ///< e.g. "altitude"
  DiscreteLti model;  ///< A, B, C, dt and the names of states, inputs, measurements
  Eigen::MatrixXd G;  ///< (nx × nw)
  Eigen::MatrixXd Q;  ///< (nw × nw) per step
  Eigen::MatrixXd R;  ///< (ny × ny)
  Eigen::MatrixXd N;  ///< (nw × ny)
  Eigen::MatrixXd M;  ///< (nx × ny) filter gain: x⁺ = x + M (y - C x)
  Eigen::MatrixXd L;  ///< (nx × ny) predictor gain: x[k+1|k] = A x[k|k-1] + L (y - C x[k|k-1])
  Eigen::MatrixXd P;  ///< (nx × nx) covariance before the measurement
  Eigen::MatrixXd Z;  ///< (nx × nx) covariance after the measurement
  std::string noise_source = {};  ///< source of Q and R, e.g. a file; empty: given directly
};

}  // namespace quadtune
