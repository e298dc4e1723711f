// SPDX-License-Identifier: Apache-2.0
/// Limits of a mission that are tighter than what its sensors can know, and by what they are judged
/// instead. Theory: docs/theory.md, "What the sensors can know".
#pragma once

#include <string>
#include <vector>

#include "quadtune/simulation/mission.hpp"
#include "quadtune/workbench/flight/sensor_bound.hpp"

namespace quadtune {

/// A flight is judged by an error with this many times the bound's rms.
inline constexpr double kRmsOverBound = 1.5;

/// One limit, or one settling band, that was widened.
struct WidenedLimit {
  std::string what;   ///< name_of() its metric, or "settling_band", "settling_yaw_band"
  std::string label;  ///< in words, e.g. "tracking error, rms"
  std::string unit;   ///< "m", "rad" or, for a share, as unit_of()
  double asked = 0;   ///< the mission's
  double bound = 0;   ///< rms of the best filter's error
  double judged = 0;  ///< what the flight is judged by
};

/// Widens the limits that the best filter's error alone would exceed:
///
/// - tracking_rms, height_rms, yaw_rms, estimate_rms to kRmsOverBound times the bound, or to what
///   the rms over one flight exceeds in one flight of a thousand if that is more;
/// - tracking_max, height_max, yaw_max, estimate_max, final_distance and position_drift to what an
///   error of kRmsOverBound times the bound exceeds in one flight of a thousand, so that an rms
///   that is allowed has greatest values that are allowed; the settling bands likewise;
/// - overshoot and yaw_overshoot likewise, by the error along the step as a share of the step.
///
/// All other limits stay, and so does each of these that is wider already.
///
/// @param mission  whose limits and settling rule are changed
/// @return         what was changed, in the order of the mission's limits
std::vector<WidenedLimit> widen_limits(const MissionBound& bound, Mission& mission);

/// "bound of the sensors 0.32 m rms; judged by 0.48 m instead of 0.05 m"
[[nodiscard]] std::string in_words(const WidenedLimit& widened);

}  // namespace quadtune
