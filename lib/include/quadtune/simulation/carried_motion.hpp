// SPDX-License-Identifier: Apache-2.0
/// The true motion of a vehicle that an arm carries along a path, to feed sensors and estimators
/// with what is known exactly.
#pragma once

#include <Eigen/Core>

#include "quadtune/model/rigid_body.hpp"
#include "quadtune/simulation/mission.hpp"

namespace quadtune {

/// Where a carried vehicle is and how it moves.
struct Motion {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();      ///< world [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();      ///< world [m/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< world, gravity not in it [m/s²]
  Eigen::Vector3d attitude = Eigen::Vector3d::Zero();      ///< roll pitch yaw [rad], yaw unwrapped
  Eigen::Vector3d rates = Eigen::Vector3d::Zero();         ///< body axes [rad/s]

  /// The same as the 12 states of ned_convention().
  [[nodiscard]] StateVector<double> state() const;
  /// What an ideal accelerometer at the centre of mass reads: R_BW (acceleration - gravity), body
  /// axes [m/s²].
  /// @param gravity  [m/s²].
  [[nodiscard]] Eigen::Vector3d specific_force(double gravity) const;
};

/// The vehicle stays level and, where the path's nose is ahead, turns with the path.
class CarriedMotion {
 public:
  /// @throws InvalidInput  for a path that validate() refuses.
  explicit CarriedMotion(const Carried& carried);

  /// At time t [s]. Velocity, acceleration and rates are exact derivatives.
  [[nodiscard]] Motion at(double t) const;

 private:
  SmoothPath path_;
};

}  // namespace quadtune
