// SPDX-License-Identifier: Apache-2.0
/// A reference that leads a vehicle from waypoint to waypoint.
///
/// On the segment from w1 to w2 the reference is the point `look_ahead` ahead of the vehicle's
/// projection on the segment, at most w2. The next segment begins when the vehicle is within
/// `transition_radius` of w2, or has crossed the plane through w2 that bisects the corner:
///
///     (p - w2) · (e12 + e23) ≥ 0,  e unit vectors along the segments
///
/// which is where both segments' lines are equally far. (Where the way turns right back the sum is
/// zero, and the plane is square to the segment.) The rule looks at the whole plane: a vehicle that
/// strays far to the inside of a sharp corner crosses it before it is near the waypoint. The first
/// waypoint is the reference until it is within the radius; the last stays it. One waypoint at most
/// is reached per call, in their order.
/// Source: thesis on the Parrot Mambo's model, section 3.2 and figure 3.2.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "quadtune/simulation/mission.hpp"

namespace quadtune {

/// How far a vehicle has come.
struct WaypointProgress {
  std::size_t reached = 0;  ///< waypoints, from 0 to all of them
};

/// The reference for a vehicle at `position`, world [m].
/// @param waypoints  at least 2, neighbours differ.
/// @param position   where the vehicle believes itself [m]; what is not finite moves nothing.
/// @param progress   brought up to date.
[[nodiscard]] Eigen::Vector3d follow_waypoints(const Waypoints& waypoints,
                                               const Eigen::Vector3d& position,
                                               WaypointProgress& progress);

}  // namespace quadtune
