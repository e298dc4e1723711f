// SPDX-License-Identifier: Apache-2.0
/// Computes a reference that guides a vehicle from waypoint to waypoint.
///
/// On the segment from w1 to w2 the reference is the point `look_ahead` ahead of the vehicle's
/// projection on the segment, but not beyond w2. The next segment begins when the vehicle is within
/// `transition_radius` of w2, or has crossed the plane through w2 that bisects the corner:
///
///     (p - w2) · (e12 + e23) ≥ 0,  e unit vectors along the segments
///
/// On this plane the lines of both segments have the same distance. (If the path reverses, the sum
/// is zero, and the plane is perpendicular to the segment.) The whole plane counts: a vehicle that
/// is far on the inside of a sharp corner crosses it before it is near the waypoint. The first
/// waypoint is the reference until the vehicle is within the radius; after the last waypoint is
/// reached, it remains the reference. At most one waypoint is reached per call, in order.
/// Source: thesis on the Parrot Mambo's model, section 3.2 and figure 3.2.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "quadtune/simulation/mission.hpp"

namespace quadtune {

/// Progress of a vehicle along the waypoints.
struct WaypointProgress {
  std::size_t reached = 0;  ///< number of waypoints reached
};

/// Computes the reference for a vehicle at `position`, world [m].
/// @param waypoints  at least 2, consecutive points differ
/// @param position   estimated [m]; a value that is not finite does not change the progress
/// @param progress   updated by the call
[[nodiscard]] Eigen::Vector3d follow_waypoints(const Waypoints& waypoints,
                                               const Eigen::Vector3d& position,
                                               WaypointProgress& progress);

}  // namespace quadtune
