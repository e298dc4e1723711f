// SPDX-License-Identifier: Apache-2.0
/// Gains over a grid of trims, with messages for the user.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "quadtune/design.hpp"
#include "quadtune/gain_schedule.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/tuning/schedule.hpp"

namespace quadtune {

/// A gain schedule with messages.
struct ScheduleReport {
  GainSchedule schedule;  ///< with at least one gain
  /// "note: …" about the linear models and the computing time, "warning: …" about points without a
  /// gain.
  std::vector<std::string> messages;
};

/// Solves with gain_schedule().
/// @param vehicle  valid
/// @param axes     at least one; the last varies fastest
/// @param design   weights, states and inputs of the law
/// @param options  heading and number of threads
/// @param where    file or vehicle, for the message of NoSolution
/// @throws NoSolution  if no point has a gain
/// @throws InvalidInput, Interrupted  as gain_schedule()
[[nodiscard]] ScheduleReport schedule_report(const Vehicle& vehicle, std::vector<ScheduleAxis> axes,
                                             const LqrDesign& design,
                                             const ScheduleOptions& options,
                                             const std::string& where);

/// Number of points with one status.
struct PointTally {
  std::size_t count = 0;   ///< number of points
  Eigen::Index first = 0;  ///< index of the first of them; 0 if there is none
};

/// Counts the points of a schedule with this status.
[[nodiscard]] PointTally tally(const GainSchedule& schedule, PointStatus status);

/// "speed 8, mass 1" for a point of the schedule.
[[nodiscard]] std::string point_words(const GainSchedule& schedule, Eigen::Index point);

/// "at speed 8, mass 1: …" with the reason why that point has no gain.
[[nodiscard]] std::string culprit_words(const GainSchedule& schedule, Eigen::Index point);

/// "1 point", "3 points".
[[nodiscard]] std::string counted_points(std::size_t count);

}  // namespace quadtune
