// SPDX-License-Identifier: Apache-2.0
/// A model of inertial navigation aided by position, velocity or height: an error-state Kalman
/// filter driven by a gyroscope and an accelerometer. Theory: "Covariances from logs", "Inertial
/// navigation".
#pragma once

#include <Eigen/Core>

#include "quadtune/estimation/filter_model.hpp"

namespace quadtune {

/// Where the states of an inertial model begin: the error of the attitude, a small turn about the
/// world's axes [rad]; velocity and position in world axes; offsets of gyroscope and accelerometer
/// in body axes.
inline constexpr int kInertialAttitude = 0;
inline constexpr int kInertialVelocity = 3;
inline constexpr int kInertialPosition = 6;
inline constexpr int kGyroOffset = 9;
inline constexpr int kForceOffset = 12;
inline constexpr int kInertialStates = 15;

/// A model with states, inputs and noises of inertial navigation, and no sensors or covariances
/// yet: Ṙ = R [ω - b_ω - w_ω], v̇ = R (f - b_f - w_f) + gravity, ṗ = v, and the offsets wander.
/// @param gravity  in world axes [m/s²]: (0, 0, -9.81) where z points up
[[nodiscard]] FilterModel inertial_model(const Eigen::Vector3d& gravity);

}  // namespace quadtune
