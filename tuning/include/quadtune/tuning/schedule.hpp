// SPDX-License-Identifier: Apache-2.0
/// LQR gains over a grid of flights: trim, linearize and solve at every point.
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
  double yaw = 0;           ///< heading at the linearized instant [rad], of every point
  std::size_t threads = 0;  ///< 0: one for each processor. Changes the time, never the result.
  /// Asked now and then, by any thread; true ends with Interrupted. May be empty.
  std::function<bool()> interrupted = {};
};

/// Solves the design's LQR problem about the steady flight of every point of a grid. Quantities
/// that no axis names are 0 (speed, climb, yaw rate) or 1 (mass, density).
///
/// Points that the vehicle cannot fly, or that have no stabilizing gain, are marked with the
/// reason. Work is divided into runs of the grid's own order, within which a point starts from the
/// one before: the bytes of the result are the same for any number of threads.
///
/// @param design  states and inputs in the words of its convention; dt > 0 unless continuous
/// @throws InvalidInput  as checked_grid_size(), linearize(), state_feedback()
/// @throws Interrupted   when `interrupted` says so
[[nodiscard]] GainSchedule gain_schedule(const Vehicle& vehicle, std::vector<ScheduleAxis> axes,
                                         const LqrDesign& design,
                                         const ScheduleOptions& options = {});

/// The vehicle at one point of a grid, e.g. heavier; the flight and the air that trim() wants.
struct SchedulePoint {
  double mass = 0;  ///< [kg]
  FlightCondition condition;
  double density_ratio = 1;
};
[[nodiscard]] SchedulePoint schedule_point(const Vehicle& vehicle,
                                           const std::vector<ScheduleAxis>& axes,
                                           const Eigen::VectorXd& values, double yaw);

}  // namespace quadtune
