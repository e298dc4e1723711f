// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/carried_motion.hpp"

namespace quadtune {

StateVector<double> Motion::state() const {
  const Eigen::Matrix3d R_WB = rotation_of_euler(attitude.x(), attitude.y(), attitude.z());
  StateVector<double> x;
  x << position, attitude, R_WB.transpose() * velocity, rates;
  return x;
}

Eigen::Vector3d Motion::specific_force(double gravity) const {
  const Eigen::Matrix3d R_WB = rotation_of_euler(attitude.x(), attitude.y(), attitude.z());
  return R_WB.transpose() * (acceleration - Eigen::Vector3d(0, 0, gravity));
}

CarriedMotion::CarriedMotion(const Carried& carried) : path_(carried.path) {
  validate(path_, "carried motion");
}

Motion CarriedMotion::at(double t) const {
  const PathPoint point = path_point(path_, t);
  Motion motion;
  motion.position = point.position;
  motion.velocity = point.velocity;
  motion.acceleration = point.acceleration;
  motion.attitude.z() = point.yaw;
  motion.rates.z() = point.yaw_rate;  // level, so body rates equal Euler rates
  return motion;
}

}  // namespace quadtune
