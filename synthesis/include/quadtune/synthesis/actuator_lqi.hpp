// SPDX-License-Identifier: Apache-2.0
/// Linear-quadratic regulators of a hovering vehicle whose rotors lag and whose commands arrive
/// late, with integral action. Theory: docs/theory.md, "LQI with actuators".
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "quadtune/convention.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/linearize/linearize.hpp"
#include "quadtune/lti.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/synthesis/lqr.hpp"
#include "quadtune/synthesis/riccati.hpp"

namespace quadtune {

/// A vehicle near hover with the state of its actuators.
struct ActuatorModel {
  /// The 12 states of ned_convention(), then, if the rotors lag, the state m of the actuator of
  /// each input, with ṁ = (u - m)/lag. A change of m also exerts the reaction torque of the rotors.
  ContinuousLti plant;
  Eigen::VectorXd lag;  ///< (nu) time constants [s], > 0; empty if no rotor lags
  Linearization hover;  ///< the 12 states alone
};

/// Builds the model of a vehicle near hover.
/// @param vehicle  valid
/// @param inputs   the quantities that the law commands. For the wrench, the lag is the mean of the
///                 rotors' lags, which is exact if they are equal.
/// @throws InvalidInput  if the vehicle cannot hover, or if only some of its rotors lag
[[nodiscard]] ActuatorModel actuator_model(const Vehicle& vehicle, InputKind inputs);

/// Weights of the cost ∫ xᵀQx + uᵀRu + iᵀQ_integral i dt + Σ Δuᵀ R_change Δu, where
/// Δu[k] = u[k] - u[k-1].
struct ActuatorLqiWeights {
  Eigen::MatrixXd Q;           ///< (12 × 12) symmetric, ≥ 0
  Eigen::MatrixXd R;           ///< (nu × nu) symmetric, > 0
  Eigen::MatrixXd Q_integral;  ///< (ni × ni) symmetric, ≥ 0
  Eigen::MatrixXd R_change;    ///< (nu × nu) symmetric, ≥ 0, or empty; requires past ≥ 1
};

/// The problem of actuator_lqi() except for its weights.
struct ActuatorLqiOptions {
  InputKind inputs = InputKind::wrench;  ///< quantities that the law commands
  double dt = 0.005;                     ///< control period [s], > 0
  /// Number of whole control periods between a command and its arrival at the actuator, in
  /// [0, kMaxPastCommands]. Other delays of the loop, such as that of a gyroscope, have the same
  /// effect as a delay of the command and can be included here.
  int past = 0;
  std::vector<std::string> integrals;  ///< names of integrated states, e.g. px py pz yaw
  /// Of the Riccati equation, as for lqr(); without the poles by default.
  RiccatiOptions riccati = {.evidence = RiccatiEvidence::essential};
};

/// A law with the evidence that it is optimal.
struct ActuatorLqi {
  RiccatiResult riccati;  ///< of the plant with all its states
  /// The states are [12 states | m | u[k-1] … u[k-past] | integrals]. The plant is sampled exactly;
  /// the integrals are computed as the law computes them, i[k+1] = i[k] + dt x[k].
  DiscreteLti model;
  Gains gains;  ///< K, K_int, memory, heading axes, dt; all NaN unless solved

  [[nodiscard]] bool solved() const { return riccati.solved(); }  ///< whether there are gains
};

/// Designs u = u0 + K (x_sp - x) + K_int ∫(x_sp - x) - K_lag (m - u0) - K_past (u[k-1] - u0 …).
/// Without lag, delay and integrals, the result is that of lqr() for the sampled problem.
/// @throws InvalidInput  if a weight has the wrong shape, if the period, the delay or an integral
///                       is invalid, and for the reasons of actuator_model() and lqr(), which
///                       include Riccati options out of range
[[nodiscard]] ActuatorLqi actuator_lqi(const Vehicle& vehicle, const ActuatorLqiWeights& weights,
                                       const ActuatorLqiOptions& options);
/// The same for a model that has already been computed by actuator_model().
[[nodiscard]] ActuatorLqi actuator_lqi(const Vehicle& vehicle, const ActuatorModel& model,
                                       const ActuatorLqiWeights& weights,
                                       const ActuatorLqiOptions& options);

}  // namespace quadtune
