// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/schedule/schedule_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <utility>

#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/linearize/linearize.hpp"

namespace quadtune {
namespace {

/// For example "150 of 945 points have no gain, e.g. no trim at …"; empty if all points have one.
std::string infeasible_words(const GainSchedule& schedule) {
  std::string words;
  for (const PointStatus status : {PointStatus::no_trim, PointStatus::no_gain}) {
    const PointTally found = tally(schedule, status);
    if (found.count == 0) continue;
    words += fmt::format("{}{} of {}: {}, e.g. {}", words.empty() ? "" : "; ", found.count,
                         counted_points(static_cast<std::size_t>(schedule.size())),
                         to_string(status), culprit_words(schedule, found.first));
  }
  return words;
}

SchedulePoint point_of(const Vehicle& vehicle, const GainSchedule& schedule, Eigen::Index point) {
  return schedule_point(vehicle, schedule.axes, grid_point(schedule.axes, point), schedule.yaw);
}

/// The point with the most informative model: the last one that turns, or else the last.
Eigen::Index telling_point(const Vehicle& vehicle, const GainSchedule& schedule) {
  Eigen::Index last = 0;
  for (Eigen::Index i = 0; i < schedule.size(); ++i)
    if (schedule.solved(i)) last = i;
  for (Eigen::Index i = schedule.size(); i-- > 0;) {
    const FlightKind kind = point_of(vehicle, schedule, i).condition.kind;
    if (schedule.solved(i) && (kind == FlightKind::circle || kind == FlightKind::spin)) return i;
  }
  return last;
}

/// Notes about the models, for one representative point.
std::vector<std::string> notes_of_model(const Vehicle& vehicle, const GainSchedule& schedule,
                                        const LqrDesign& design) {
  const Eigen::Index index = telling_point(vehicle, schedule);
  const SchedulePoint point = point_of(vehicle, schedule, index);
  Vehicle moved = vehicle;
  moved.mass = point.mass;
  TrimOptions air;
  air.density_ratio = point.density_ratio;
  std::vector<std::string> notes =
      linearize(moved, point.condition, linearize_options(design), air).notes;
  for (std::string& note : notes)
    note = fmt::format("note: at {}: {}", point_words(schedule, index), note);
  return notes;
}

/// Axes whose numbers may be in another unit.
std::vector<std::string> notes_of_units(const GainSchedule& schedule) {
  constexpr double kFastTurn = 10;  // [rad/s]
  std::vector<std::string> notes;
  for (const ScheduleAxis& axis : schedule.axes) {
    const double low = axis.values.front(), high = axis.values.back();
    const std::string name = to_string(axis.quantity);
    const bool ratio =
        axis.quantity == ScheduleQuantity::mass || axis.quantity == ScheduleQuantity::density;
    if (ratio && !(low <= 1 && high >= 1))
      notes.push_back(
          fmt::format("{} is a ratio to that of the vehicle, and {:.6g} to {:.6g} does not contain "
                      "1, the vehicle as it is",
                      name, low, high));
    const double turn = std::max(std::abs(low), std::abs(high));
    if (axis.quantity == ScheduleQuantity::yaw_rate && turn > kFastTurn)
      notes.push_back(fmt::format("{} is in rad/s: {:.6g} rad/s is {:.4g} deg/s", name, turn,
                                  turn * 180 / std::numbers::pi));
  }
  return notes;
}

}  // namespace

PointTally tally(const GainSchedule& schedule, PointStatus status) {
  PointTally result;
  for (Eigen::Index i = schedule.size(); i-- > 0;) {
    if (schedule.status[static_cast<std::size_t>(i)] != status) continue;
    ++result.count;
    result.first = i;
  }
  return result;
}

std::string point_words(const GainSchedule& schedule, Eigen::Index point) {
  return grid_words(schedule.axes, grid_point(schedule.axes, point));
}

std::string culprit_words(const GainSchedule& schedule, Eigen::Index point) {
  return fmt::format("at {}: {}", point_words(schedule, point),
                     schedule.culprit[static_cast<std::size_t>(point)]);
}

std::string counted_points(std::size_t count) {
  return fmt::format("{} point{}", count, count == 1 ? "" : "s");
}

ScheduleReport schedule_report(const Vehicle& vehicle, std::vector<ScheduleAxis> axes,
                               const LqrDesign& design, const ScheduleOptions& options,
                               const std::string& where) {
  const auto start = std::chrono::steady_clock::now();
  ScheduleReport report;
  report.schedule = gain_schedule(vehicle, std::move(axes), design, options);
  const GainSchedule& schedule = report.schedule;
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  const std::string infeasible = infeasible_words(schedule);
  const std::vector<std::string> units = notes_of_units(schedule);
  if (schedule.solved_count() == 0)
    throw NoSolution(
        fmt::format("lqr: {}: no point of the schedule has a gain: {}{}{}", vehicle.name,
                    infeasible, units.empty() ? "" : "; ", internal::joined(units, "; ")),
        where);
  report.messages = notes_of_model(vehicle, schedule, design);
  for (const std::string& note : units) report.messages.push_back("note: " + note);
  if (!infeasible.empty()) report.messages.push_back("warning: " + infeasible);
  report.messages.push_back(fmt::format(
      "{} in {:.3f} s", counted_points(static_cast<std::size_t>(schedule.size())), wall.count()));
  return report;
}

}  // namespace quadtune
