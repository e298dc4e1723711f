// SPDX-License-Identifier: Apache-2.0
/// LQG regulators: a state feedback of the estimates of a Kalman filter, as one linear system.
#pragma once

#include <Eigen/Core>
#include <limits>

#include "quadtune/lti.hpp"
#include "quadtune/synthesis/kalman.hpp"
#include "quadtune/synthesis/lqr.hpp"

namespace quadtune {

/// Which estimate a discrete regulator uses.
enum class LqgEstimate {
  current,  ///< x[k|k], which includes the measurement of this sample
  delayed,  ///< x[k|k-1], for programs that need a sample period to compute the command
};

/// A regulator with its evidence. It is defined only if both equations are solved.
template <class Lti>
struct LqgRegulator {
  RiccatiResult lqr;    ///< the state feedback
  KalmanResult filter;  ///< the Kalman filter
  /// From y to -u, so that the loop has negative feedback: its states are the estimates x̂
  /// (discrete: x̂[k|k-1]).
  Lti controller;
  /// Minimum of the mean cost E[xᵀQx + 2xᵀNu + uᵀRu], per step if discrete.
  double cost = std::numeric_limits<double>::quiet_NaN();
  Eigen::VectorXd state_rms;  ///< (nx) standard deviations of the states in the closed loop
  Eigen::VectorXd input_rms;  ///< (nu) likewise of u
  Eigen::VectorXcd poles;     ///< (2 nx) of the closed loop: those of A - B K and of A - L C

  /// Whether both equations are solved.
  [[nodiscard]] bool solved() const { return lqr.solved() && filter.solved(); }
};

/// Computes u = -K x̂ with
///     x̂' = A x̂ + B u + L (y - C x̂ - D u).
/// @param plant    nx states, nu inputs, ny measurements C x + D u
/// @param weights  of the states and inputs
/// @param noise    spectral densities of process and measurement noise
/// @param options  of both Riccati equations, as for lqr() and kalman()
/// @throws InvalidInput  as lqr() and kalman()
[[nodiscard]] LqgRegulator<ContinuousLti> lqg_regulator(const ContinuousLti& plant,
                                                        const LqrWeights& weights,
                                                        const KalmanNoise& noise,
                                                        const RiccatiOptions& options = {});

/// Computes u = -K x̂[k|k] or u = -K x̂[k|k-1] with
///     x̂[k|k] = x̂[k|k-1] + M (y - C x̂[k|k-1] - D u),
///     x̂[k+1|k] = A x̂[k|k-1] + B u + L (y - C x̂[k|k-1] - D u).
/// If noise.N is not zero, the current estimate ignores what the innovation says about the process
/// noise of the sample, and the cost is that of the computed regulator all the same.
/// @throws InvalidInput  as lqr() and kalman(), or if the law is algebraic (I - K M D is singular)
[[nodiscard]] LqgRegulator<DiscreteLti> lqg_regulator(const DiscreteLti& plant,
                                                      const LqrWeights& weights,
                                                      const KalmanNoise& noise,
                                                      LqgEstimate estimate = LqgEstimate::current,
                                                      const RiccatiOptions& options = {});

}  // namespace quadtune
