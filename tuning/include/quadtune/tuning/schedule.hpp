// SPDX-License-Identifier: Apache-2.0
/// LQR gains over a grid of flight conditions: trim, linearize and solve at every point.
/// Method: docs/theory.md, "Gain schedules".
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "quadtune/design.hpp"
#include "quadtune/gain_schedule.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// How a schedule is computed.
struct ScheduleOptions {
  double yaw = 0;           ///< heading at the linearized instant [rad], for every point
  std::size_t threads = 0;  ///< 0: one per processor. Affects the time, never the result.
  /// Called regularly, by any thread; true throws Interrupted. May be empty.
  std::function<bool()> interrupted = {};
};

/// Solves the LQR problem of the design about the steady flight at every point of a grid.
/// Quantities without an axis are 0 (speed, climb, yaw rate) or 1 (mass, density).
///
/// Points that the vehicle cannot fly, or that have no stabilizing gain, are marked with the
/// reason. Work is divided into sequences in the order of the grid, within which a point starts
/// from the one before: the result is bitwise the same for any number of threads.
///
/// @param vehicle  valid
/// @param axes     at least one; the last varies fastest
/// @param design   states and inputs named as in its convention; dt > 0 unless continuous
/// @param options  heading and number of threads
/// @throws InvalidInput  as checked_grid_size(), linearize(), state_feedback()
/// @throws Interrupted   if `interrupted` returns true
[[nodiscard]] GainSchedule gain_schedule(const Vehicle& vehicle, std::vector<ScheduleAxis> axes,
                                         const LqrDesign& design,
                                         const ScheduleOptions& options = {});

/// The mass at one point of a grid, and the flight condition and air density for trim().
struct SchedulePoint {
  double mass = 0;            ///< [kg]
  FlightCondition condition;  ///< as trim() takes it
  double density_ratio = 1;   ///< air density over the vehicle's
};

/// The point of the grid with these values of the axes, one for each axis; yaw is a heading [rad].
[[nodiscard]] SchedulePoint schedule_point(const Vehicle& vehicle,
                                           const std::vector<ScheduleAxis>& axes,
                                           const Eigen::VectorXd& values, double yaw);

}  // namespace quadtune
