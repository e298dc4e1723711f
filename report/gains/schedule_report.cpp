// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/schedule/schedule_report.hpp"

#include <fmt/format.h>

#include "quadtune/gain_schedule.hpp"
#include "report/gains/gains.hpp"
#include "report/text/print.hpp"

namespace quadtune::report {
namespace {

std::string axis_text(const ScheduleAxis& axis) {
  const std::string of = unit(axis.quantity).empty() ? "" : " " + unit(axis.quantity);
  if (axis.values.size() == 1)
    return fmt::format("{:<9} {}{}", to_string(axis.quantity), number(axis.values[0]), of);
  return fmt::format("{:<9} {} ... {}{}, {} values", to_string(axis.quantity),
                     number(axis.values.front()), number(axis.values.back()), of,
                     axis.values.size());
}

std::string grid_text(const GainSchedule& schedule) {
  std::string text;
  for (const ScheduleAxis& axis : schedule.axes)
    text += (text.empty() ? "" : "\n") + axis_text(axis);
  return text;
}

/// The solved point with the largest residual.
Eigen::Index least_accurate(const GainSchedule& schedule, Eigen::Index first_solved) {
  Eigen::Index worst = first_solved;
  for (Eigen::Index i = 0; i < schedule.size(); ++i)
    if (schedule.solved(i) && schedule.residual(i) > schedule.residual(worst)) worst = i;
  return worst;
}

}  // namespace

std::string to_text(const GainSchedule& schedule) {
  const PointTally solved = tally(schedule, PointStatus::solved);
  std::string text = section("grid", grid_text(schedule)) +
                     section("points", fmt::format("{}, {} solved", schedule.size(), solved.count));
  for (const PointStatus status : {PointStatus::no_trim, PointStatus::no_gain}) {
    const PointTally found = tally(schedule, status);
    if (found.count > 0)
      text +=
          section(to_string(status), fmt::format("{}, the first {}", counted_points(found.count),
                                                 culprit_words(schedule, found.first)));
  }
  const Eigen::Index worst = least_accurate(schedule, solved.first);
  const Gains gains = schedule.gains(solved.first);
  const std::vector<std::string> inputs = names_of(gains.inputs);
  text += section("residual", fmt::format("maximum {:.2g}, at {}", schedule.residual(worst),
                                          point_words(schedule, worst))) +
          section("first gain", fmt::format("at {}\n{}", point_words(schedule, solved.first),
                                            table(gains.K, inputs, names_of(gains.states))));
  if (gains.K_int.size() > 0)
    text += section("integral K", table(gains.K_int, inputs, names_of(gains.integrals)));
  return text;
}

}  // namespace quadtune::report
