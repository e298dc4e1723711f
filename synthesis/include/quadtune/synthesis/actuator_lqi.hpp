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

/// @param inputs  what the law commands. For the wrench the lag is the mean of the rotors' lags,
///                which is exact if they are equal.
/// @throws InvalidInput  for a vehicle that cannot hover, or of whose rotors only some lag
[[nodiscard]] ActuatorModel actuator_model(const Vehicle& vehicle, InputKind inputs);

/// The cost ∫ xᵀQx + uᵀRu + iᵀQ_integral i dt + Σ Δuᵀ R_change Δu, Δu[k] = u[k] - u[k-1].
struct ActuatorLqiWeights {
  Eigen::MatrixXd Q;           ///< (12 × 12) symmetric, ≥ 0
  Eigen::MatrixXd R;           ///< (nu × nu) symmetric, > 0
  Eigen::MatrixXd Q_integral;  ///< (ni × ni) symmetric, ≥ 0
  Eigen::MatrixXd R_change;    ///< (nu × nu) symmetric, ≥ 0; or empty. Only with past ≥ 1.
};

struct ActuatorLqiOptions {
  InputKind inputs = InputKind::wrench;
  double dt = 0.005;  ///< control period [s], > 0
  /// Whole control periods from a command to its actuator, in [0, kMostPastCommands]. Other delays
  /// of the loop, as that of a gyroscope, act like a delay of the command.
  int past = 0;
  std::vector<std::string> integrals;  ///< names of integrated states, e.g. px py pz yaw
};

struct ActuatorLqi {
  RiccatiResult riccati;
  /// [12 states | m | u[k-1] … u[k-past] | integrals], sampled exactly; the integrals are those of
  /// the law, i[k+1] = i[k] + dt x[k].
  DiscreteLti model;
  Gains gains;  ///< K, K_int, memory, heading axes, dt; all NaN unless solved

  [[nodiscard]] bool solved() const { return riccati.solved(); }
};

/// Designs u = u0 + K (x_sp - x) + K_int ∫(x_sp - x) - K_lag (m - u0) - K_past (u[k-1] - u0 …).
/// Without lag, delay and integrals it is lqr() of the sampled problem.
/// @throws InvalidInput  for weights of other shapes, a period, delay or integral out of range, or
///                       as actuator_model() and lqr()
[[nodiscard]] ActuatorLqi actuator_lqi(const Vehicle& vehicle, const ActuatorLqiWeights& weights,
                                       const ActuatorLqiOptions& options);
/// The same for a model at hand.
[[nodiscard]] ActuatorLqi actuator_lqi(const Vehicle& vehicle, const ActuatorModel& model,
                                       const ActuatorLqiWeights& weights,
                                       const ActuatorLqiOptions& options);

}  // namespace quadtune
