// SPDX-License-Identifier: Apache-2.0
/// A gain schedule as stored in its files, and the checks that both formats share.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "quadtune/gain_schedule.hpp"

namespace quadtune::exports {

inline constexpr char kScheduleFormat[] = "quadtune-gain-schedule";

/// The part of a file before the points.
struct ScheduleHead {
  std::string vehicle;
  std::string convention;
  InputKind input_kind = InputKind::rotor_speed;
  SignLaw sign_law = SignLaw::set_point_minus_state;
  double dt = 0;
  double yaw = 0;
  std::vector<Signal> states, inputs, integrals;
  std::vector<ScheduleAxis> axes;
};

/// Creates a schedule with this head and no points.
/// @throws InvalidInput  if the head is invalid; `where` is the file
[[nodiscard]] GainSchedule start_schedule(ScheduleHead head, const std::string& where);

/// One point as read; members are empty if the file has no such key.
struct SchedulePointText {
  Eigen::VectorXd at;
  PointStatus status = PointStatus::no_trim;
  std::string culprit;
  double residual = 0;
  Eigen::MatrixXd K, K_int;
  Eigen::VectorXd x0, u0;
};

/// @throws InvalidInput  "where: …" if the point is not the grid's `index`-th, or a shape is wrong
void put_point(const SchedulePointText& point, Eigen::Index index, const std::string& where,
               GainSchedule& schedule);

/// @throws InvalidInput  unless the number of points read is that of the grid
void require_all_points(std::size_t came, const GainSchedule& schedule, const std::string& where);

[[nodiscard]] std::string schedule_toml(const GainSchedule& schedule);
[[nodiscard]] GainSchedule parse_schedule_toml(const std::string& text, const std::string& origin);
[[nodiscard]] std::string schedule_json(const GainSchedule& schedule);
[[nodiscard]] GainSchedule parse_schedule_json(const std::string& text, const std::string& origin);

}  // namespace quadtune::exports
