// SPDX-License-Identifier: Apache-2.0
/// The exact motion of a vehicle that is carried along a path, for tests of sensors and estimators
/// against a known truth.
#pragma once

#include <Eigen/Core>

#include "quadtune/model/rigid_body.hpp"
#include "quadtune/simulation/mission.hpp"

namespace quadtune {

/// Position, attitude and their derivatives for a carried vehicle.
struct Motion {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< world [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< world [m/s]
  /// World axes, gravity not included [m/s²]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();
  /// Roll pitch yaw [rad], yaw not wrapped
  Eigen::Vector3d attitude = Eigen::Vector3d::Zero();
  Eigen::Vector3d rates = Eigen::Vector3d::Zero();  ///< body axes [rad/s]

  /// The motion as the 12 states of ned_convention().
  [[nodiscard]] StateVector<double> state() const;
  /// Specific force that an ideal accelerometer at the centre of mass measures: R_BW (acceleration
  /// - gravity), body axes [m/s²].
  /// @param gravity  [m/s²]
  [[nodiscard]] Eigen::Vector3d specific_force(double gravity) const;
};

/// Motion along a path. The vehicle stays level; if the path's nose is ahead, the yaw follows the
/// path.
class CarriedMotion {
 public:
  /// @throws InvalidInput  if validate() rejects the path
  explicit CarriedMotion(const Carried& carried);

  /// Motion at time t [s]. Velocity, acceleration and rates are exact derivatives.
  [[nodiscard]] Motion at(double t) const;

 private:
  SmoothPath path_;
};

}  // namespace quadtune
