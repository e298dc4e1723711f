// SPDX-License-Identifier: Apache-2.0
/// Model of inertial navigation aided by position, velocity or height: an error-state Kalman filter
/// driven by a gyroscope and an accelerometer. Theory: "Covariances from logs", "Inertial
/// navigation".
#pragma once

#include <Eigen/Core>

#include "quadtune/estimation/filter_model.hpp"

namespace quadtune {

/// Indices of the first state of each group of an inertial model: attitude error, a small rotation
/// about the world axes [rad]; velocity and position in world axes; gyroscope and accelerometer
/// biases in body axes.
inline constexpr int kInertialAttitude = 0;
inline constexpr int kInertialVelocity = 3;  ///< velocity, world axes [m/s]
inline constexpr int kInertialPosition = 6;  ///< position, world axes [m]
inline constexpr int kGyroOffset = 9;        ///< bias of the gyroscope, body axes [rad/s]
inline constexpr int kForceOffset = 12;      ///< bias of the accelerometer, body axes [m/s²]
inline constexpr int kInertialStates = 15;   ///< number of states

/// Model with the states, inputs and noises of inertial navigation, without sensors and
/// covariances: Ṙ = R [ω - b_ω - w_ω], v̇ = R (f - b_f - w_f) + gravity, ṗ = v; the biases are
/// random walks.
/// @param gravity  in world axes [m/s²]: (0, 0, -9.81) if z points up
[[nodiscard]] FilterModel inertial_model(const Eigen::Vector3d& gravity);

}  // namespace quadtune
