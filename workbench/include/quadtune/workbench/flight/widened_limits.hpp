// SPDX-License-Identifier: Apache-2.0
/// Widens limits of a mission that are tighter than its sensors allow. Theory: docs/theory.md,
/// "What the sensors can know".
#pragma once

#include <string>
#include <vector>

#include "quadtune/simulation/mission.hpp"
#include "quadtune/workbench/flight/sensor_bound.hpp"

namespace quadtune {

/// A flight passes with an error of up to this many times the bound's rms.
inline constexpr double kRmsOverBound = 1.5;

/// One limit, or one settling band, that was widened.
struct WidenedLimit {
  std::string what;   ///< name_of() its metric, or "settling_band", "settling_yaw_band"
  std::string label;  ///< in words, e.g. "tracking error, rms"
  std::string unit;   ///< "m", "rad" or, for a share, as unit_of()
  double asked = 0;   ///< limit of the mission
  double bound = 0;   ///< rms of the optimal filter's error
  double judged = 0;  ///< limit that is applied
};

/// Widens the limits that the error of the optimal filter alone would exceed:
///
/// - tracking_rms, height_rms, yaw_rms, estimate_rms to kRmsOverBound times the bound, or, if
///   larger, to the value that the rms over one flight exceeds in one flight of a thousand;
/// - tracking_max, height_max, yaw_max, estimate_max, final_distance and position_drift to the
///   value that an error of kRmsOverBound times the bound exceeds in one flight of a thousand, so
///   that a permitted rms implies permitted maxima; the settling bands likewise;
/// - overshoot and yaw_overshoot likewise, for the error along the step as a share of the step.
///
/// All other limits, and those that are already wider, stay unchanged.
///
/// @param bound    of the mission's sensors
/// @param mission  its limits and settling rule are changed
/// @return         the changes, in the order of the mission's limits
std::vector<WidenedLimit> widen_limits(const MissionBound& bound, Mission& mission);

/// For example "limit 0.05 m widened to 0.48 m, because the sensors alone cause 0.32 m rms".
[[nodiscard]] std::string describe(const WidenedLimit& widened);

}  // namespace quadtune
