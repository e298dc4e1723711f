// SPDX-License-Identifier: Apache-2.0
/// Angles from sensors: wrapping into one turn, tilt from an accelerometer, yaw from a
/// magnetometer.
#pragma once

#include <cmath>
#include <numbers>
#include <type_traits>

#include "quadtune/model/rotation.hpp"
#include "quadtune/scalar.hpp"

namespace quadtune {
namespace on_board_math {

/// Rounds to the nearest integer, ties to even, as the overload for Pack does.
template <class T>
requires std::is_floating_point_v<T>
[[nodiscard]] inline T nearest(T x) { return std::nearbyint(x); }

}  // namespace on_board_math

/// The angle minus the nearest multiple of 2π, within [-π, π] [rad].
template <class T>
[[nodiscard]] T wrap_angle(const T& angle) {
  using on_board_math::nearest;
  return angle - T(2 * std::numbers::pi) * nearest(angle * T(0.5 / std::numbers::pi));
}

/// Attitude that an accelerometer at rest measures; the yaw is not observable.
template <class T>
struct Tilt {
  T roll = T(0);   ///< -π … π [rad]
  T pitch = T(0);  ///< -π/2 … π/2 [rad]
};

/// Roll and pitch of a body that does not accelerate and measures the specific force f: the
/// solution of f = -g R_WBᵀ e_z. The length of f does not matter; it must not be 0.
template <class T>
[[nodiscard]] Tilt<T> tilt_from_force(const Vector3<T>& f) {
  using std::atan2, std::sqrt;
  return {atan2(-f.y(), -f.z()), atan2(f.x(), T(sqrt(f.y() * f.y() + f.z() * f.z())))};
}

/// Yaw from the earth's magnetic field in body axes, for a body with this roll and pitch [rad],
/// within [-π, π] of the declination.
/// @param field        magnetic field in body axes, in any unit
/// @param tilt         roll and pitch of the body [rad]
/// @param declination  of magnetic north, positive to the east [rad]
template <class T>
[[nodiscard]] T yaw_from_field(const Vector3<T>& field, const Tilt<T>& tilt, const T& declination) {
  using std::atan2, std::cos, std::sin;
  const T sr = sin(tilt.roll), cr = cos(tilt.roll);
  const T sp = sin(tilt.pitch), cp = cos(tilt.pitch);
  // Ry(pitch) Rx(roll) m = |m_h| (cos(declination - yaw), sin(declination - yaw), ·)
  const T aft = sr * field.y() + cr * field.z();
  const T ahead = cp * field.x() + sp * aft;
  const T right = cr * field.y() - sr * field.z();
  return declination - T(atan2(right, ahead));
}

}  // namespace quadtune
