// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/waypoint_follower.hpp"

namespace quadtune {
namespace {

using Eigen::Vector3d;

// If the sum of two unit vectors is shorter than this, they have opposite directions.
constexpr double kStraightBack = 1e-9;

// Whether `position` has reached points[target].
bool reached(const Waypoints& way, const Vector3d& position, std::size_t target) {
  const Vector3d& point = way.points[target];
  if ((position - point).norm() <= way.transition_radius) return true;
  if (target == 0 || target + 1 == way.points.size()) return false;
  const Vector3d before = (point - way.points[target - 1]).normalized();
  const Vector3d after = (way.points[target + 1] - point).normalized();
  Vector3d normal = before + after;
  if (normal.norm() < kStraightBack) normal = before;
  return (position - point).dot(normal) >= 0;
}

}  // namespace

Eigen::Vector3d follow_waypoints(const Waypoints& waypoints, const Eigen::Vector3d& position,
                                 WaypointProgress& progress) {
  const std::vector<Vector3d>& points = waypoints.points;
  if (progress.reached < points.size() && reached(waypoints, position, progress.reached))
    ++progress.reached;
  if (progress.reached == 0) return points.front();
  if (progress.reached >= points.size()) return points.back();
  const Vector3d& from = points[progress.reached - 1];
  const Vector3d& to = points[progress.reached];
  const double length = (to - from).norm();
  const Vector3d along = (to - from) / length;
  const double projection = (position - from).dot(along);
  const double ahead = (projection > 0 ? projection : 0) + waypoints.look_ahead;
  return ahead < length ? Vector3d(from + along * ahead) : to;
}

}  // namespace quadtune
