// SPDX-License-Identifier: Apache-2.0
/// Gains over a grid of flights, with what a user should know of them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "quadtune/design.hpp"
#include "quadtune/gain_schedule.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/tuning/schedule.hpp"

namespace quadtune {

struct ScheduleReport {
  GainSchedule schedule;  ///< with one gain at least
  /// "note: …" of the linear models, "warning: …" of points without a gain, and how long it took.
  std::vector<std::string> messages;
};

/// Solves by gain_schedule().
/// @param where  the file or vehicle that asked for it, for NoSolution
/// @throws NoSolution  if no point has a gain
/// @throws InvalidInput, Interrupted  as gain_schedule()
[[nodiscard]] ScheduleReport schedule_report(const Vehicle& vehicle, std::vector<ScheduleAxis> axes,
                                             const LqrDesign& design,
                                             const ScheduleOptions& options,
                                             const std::string& where);

/// Points of one status.
struct PointTally {
  std::size_t count = 0;
  Eigen::Index first = 0;  ///< of them; 0 where there is none
};
[[nodiscard]] PointTally tally(const GainSchedule& schedule, PointStatus status);

/// "speed 8, mass 1" of a point of the schedule.
[[nodiscard]] std::string point_words(const GainSchedule& schedule, Eigen::Index point);

/// "at speed 8, mass 1: …" with the reason why that point has no gain.
[[nodiscard]] std::string culprit_words(const GainSchedule& schedule, Eigen::Index point);

/// "1 point", "3 points".
[[nodiscard]] std::string counted_points(std::size_t count);

}  // namespace quadtune
