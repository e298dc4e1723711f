// SPDX-License-Identifier: Apache-2.0
/// Rotations between the body (forward-right-down) and the world (north-east-down): Euler angles
/// yaw, pitch, roll (turned in this order), matrices and quaternions, for any scalar type.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace quadtune {

/// A vector in three axes.
template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

/// A matrix between three axes.
template <class T>
using Matrix3 = Eigen::Matrix<T, 3, 3>;

/// If |cos pitch| is smaller, roll and yaw rotate about nearly the same axis.
inline constexpr double kMinCosPitch = 1e-6;

/// False if the pitch is so close to ±90° that the Euler angles and their rates are ill-defined.
/// Check before euler_rate_matrix(); the quaternion form of the equations has no such singularity.
[[nodiscard]] inline bool euler_angles_are_regular(double pitch) {
  return std::abs(std::cos(pitch)) > kMinCosPitch;  // false for NaN as well
}

/// R_WB = Rz(yaw) Ry(pitch) Rx(roll): rotates body components to world components.
template <class T>
[[nodiscard]] Matrix3<T> rotation_of_euler(const T& roll, const T& pitch, const T& yaw) {
  using std::cos, std::sin;
  const T cr = cos(roll), sr = sin(roll);
  const T cp = cos(pitch), sp = sin(pitch);
  const T cy = cos(yaw), sy = sin(yaw);
  Matrix3<T> R;
  R << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
      sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,   //
      -sp, cp * sr, cp * cr;
  return R;
}

/// The matrix M in w = M · (roll', pitch', yaw'): body rates from Euler rates.
template <class T>
[[nodiscard]] Matrix3<T> body_rate_matrix(const T& roll, const T& pitch) {
  using std::cos, std::sin;
  Matrix3<T> M;
  M << T(1), T(0), -sin(pitch),                 //
      T(0), cos(roll), sin(roll) * cos(pitch),  //
      T(0), -sin(roll), cos(roll) * cos(pitch);
  return M;
}

/// The matrix M in (roll', pitch', yaw') = M · w: Euler rates from body rates, the inverse of
/// body_rate_matrix(). Its entries grow like 1/cos pitch; see euler_angles_are_regular().
template <class T>
[[nodiscard]] Matrix3<T> euler_rate_matrix(const T& roll, const T& pitch) {
  using std::cos, std::sin;
  const T sr = sin(roll), cr = cos(roll);
  const T cp = cos(pitch), tp = sin(pitch) / cp;
  Matrix3<T> M;
  M << T(1), sr * tp, cr * tp,  //
      T(0), cr, -sr,            //
      T(0), sr / cp, cr / cp;
  return M;
}

/// The unit quaternion of the same rotation, computed from the half angles.
template <class T>
[[nodiscard]] Eigen::Quaternion<T> quaternion_of_euler(const T& roll, const T& pitch,
                                                       const T& yaw) {
  using std::cos, std::sin;
  const T cr = cos(roll / T(2)), sr = sin(roll / T(2));
  const T cp = cos(pitch / T(2)), sp = sin(pitch / T(2));
  const T cy = cos(yaw / T(2)), sy = sin(yaw / T(2));
  return {cr * cp * cy + sr * sp * sy, sr * cp * cy - cr * sp * sy,  //
          cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy};
}

/// (roll, pitch, yaw) of a rotation matrix; roll and yaw in [-π, π], pitch in [-π/2, π/2]. If the
/// nose points straight up or down, only roll ∓ yaw is defined and roll is returned as 0.
template <class T>
[[nodiscard]] Vector3<T> euler_of_rotation(const Matrix3<T>& R) {
  using std::atan2, std::sqrt;
  const T cos_pitch_squared = R(0, 0) * R(0, 0) + R(1, 0) * R(1, 0);
  if (!(cos_pitch_squared > T(kMinCosPitch * kMinCosPitch)))
    return {T(0), atan2(-R(2, 0), T(0)), atan2(-R(0, 1), R(1, 1))};
  return {atan2(R(2, 1), R(2, 2)), atan2(-R(2, 0), sqrt(cos_pitch_squared)),
          atan2(R(1, 0), R(0, 0))};
}

/// (roll, pitch, yaw) of a unit quaternion, in the ranges of euler_of_rotation().
template <class T>
[[nodiscard]] Vector3<T> euler_of_quaternion(const Eigen::Quaternion<T>& q) {
  return euler_of_rotation<T>(q.toRotationMatrix());
}

}  // namespace quadtune
