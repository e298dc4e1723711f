// SPDX-License-Identifier: Apache-2.0
/// Gain schedules of every kind, with random numbers.
#pragma once

#include <random>
#include <string>
#include <utility>
#include <vector>

#include "quadtune/exports/content.hpp"
#include "quadtune/gain_schedule.hpp"

namespace quadtune::testing {

struct ScheduleCase {
  const char* name;
  std::vector<ScheduleAxis> axes;
  int states = 12;
  int inputs = 4;
  int integrals = 0;
  bool holes = false;  ///< whether every fifth point has no gain
  SignLaw sign_law = SignLaw::set_point_minus_state;
};

inline GainSchedule random_schedule(const ScheduleCase& of) {
  const auto signals = [](const std::string& name, int count, const char* unit) {
    std::vector<Signal> all;
    all.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) all.push_back({name + std::to_string(i), unit});
    return all;
  };
  GainSchedule schedule =
      empty_schedule(of.axes, signals("x", of.states, "m"), signals("u", of.inputs, "N"),
                     signals("x", of.integrals, "m s"));
  schedule.vehicle = "uquad";
  schedule.convention = "ned";
  schedule.input_kind = InputKind::wrench;
  schedule.sign_law = of.sign_law;
  schedule.dt = 0.005;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (Eigen::Index p = 0; p < schedule.size(); ++p) {
    const auto at = static_cast<std::size_t>(p);
    if (of.holes && p % 5 == 2) {
      schedule.culprit[at] = "too fast";
      continue;
    }
    schedule.status[at] = PointStatus::solved;
    for (Eigen::MatrixXd* M : {&schedule.K, &schedule.K_int, &schedule.x0, &schedule.u0})
      for (double& x : M->col(p)) x = normal(random);
    schedule.residual(p) = 1e-16;
  }
  return schedule;
}

inline const std::vector<ScheduleCase>& schedule_cases() {
  using enum ScheduleQuantity;
  static const std::vector<ScheduleCase> cases = {
      {"line", {{speed, {0, 0.1, 1, 4}}}},
      {"two_values", {{climb, {-1.3, 2}}}, 2, 1},
      {"one_value", {{mass, {1.1}}}, 3, 2, 1},
      {"plane", {{yaw_rate, {-1, 0, 0.7}}, {speed, {0, 1.0 / 3, 2}}}, 12, 4, 4},
      {"plane_with_one_value", {{density, {1}}, {climb, {-2, -1.0 / 7, 3}}}, 6, 4},
      {"space_with_holes",
       {{speed, {0, 0.5, 2}}, {mass, {0.9, 1, 1.15}}, {climb, {-1, 1}}},
       12,
       6,
       2,
       true,
       SignLaw::state_minus_set_point},
      {"five_axes",
       {{density, {0.8, 1}},
        {mass, {0.9, 1}},
        {yaw_rate, {-1, 0, 1}},
        {climb, {0}},
        {speed, {0, 3}}},
       4,
       8,
       4}};
  return cases;
}

inline ExportContent schedule_content_of(GainSchedule schedule, bool double_precision) {
  ExportContent content;
  content.vehicle = load_vehicle(schedule.vehicle);
  content.schedule = std::move(schedule);
  content.flight_code.double_precision = double_precision;
  return content;
}

}  // namespace quadtune::testing
