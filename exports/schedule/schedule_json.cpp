// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "json/to_json.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/json.hpp"
#include "schedule/schedule_parts.hpp"

namespace quadtune::exports {

using internal::matrix_to_json;
using internal::member;
using internal::number_to_json;
using internal::vector_to_json;

namespace {

Json axis_to_json(const ScheduleAxis& axis) {
  Json json;
  json["name"] = to_string(axis.quantity);
  json["unit"] = unit(axis.quantity);
  json["values"] = axis.values;
  return json;
}

Json point_to_json(const GainSchedule& schedule, Eigen::Index index) {
  const auto p = static_cast<std::size_t>(index);
  Json json;
  json["at"] = vector_to_json(grid_point(schedule.axes, index), "at");
  json["status"] = to_string(schedule.status[p]);
  if (!schedule.solved(index)) {
    json["culprit"] = schedule.culprit[p];
    return json;
  }
  const std::string name = fmt::format("points[{}]", index);
  const Gains gains = schedule.gains(index);
  json["residual"] = number_to_json(schedule.residual(index), name + ".residual");
  json["x0"] = vector_to_json(gains.x0, name + ".x0");
  json["u0"] = vector_to_json(gains.u0, name + ".u0");
  json["K"] = matrix_to_json(gains.K, name + ".K");
  if (gains.K_int.size() > 0) json["K_int"] = matrix_to_json(gains.K_int, name + ".K_int");
  return json;
}

std::vector<ScheduleAxis> axes_from_json(const Json& json, const std::string& where) {
  if (!json.is_array()) throw InvalidInput(where, "is not an array; expected the axes of the grid");
  std::vector<ScheduleAxis> axes;
  axes.reserve(json.size());
  for (std::size_t i = 0; i < json.size(); ++i) {
    const std::string here = fmt::format("{}[{}]", where, i);
    const std::string name =
        internal::string_from_json(member(json[i], "name", here), here + ".name");
    const Eigen::VectorXd values =
        internal::vector_from_json(member(json[i], "values", here), here + ".values");
    axes.push_back({schedule_quantity(name, here + ".name"),
                    std::vector<double>(values.begin(), values.end())});
    const std::string came =
        internal::string_from_json(member(json[i], "unit", here), here + ".unit");
    if (came != unit(axes.back().quantity))
      throw InvalidInput(here + ".unit", fmt::format("unit of {} is '{}', expected '{}'", name,
                                                     came, unit(axes.back().quantity)));
  }
  return axes;
}

SchedulePointText point_from_json(const Json& json, const std::string& where, bool integrals) {
  const auto path = [&](const char* key) { return where + "." + key; };
  const auto at = [&](const char* key) -> const Json& { return member(json, key, where); };
  SchedulePointText point;
  point.at = internal::vector_from_json(at("at"), path("at"));
  point.status =
      point_status(internal::string_from_json(at("status"), path("status")), path("status"));
  if (point.status != PointStatus::solved) {
    point.culprit = internal::string_from_json(at("culprit"), path("culprit"));
    return point;
  }
  point.residual = internal::number_from_json(at("residual"), path("residual"));
  point.x0 = internal::vector_from_json(at("x0"), path("x0"));
  point.u0 = internal::vector_from_json(at("u0"), path("u0"));
  point.K = internal::matrix_from_json(at("K"), path("K"));
  if (integrals) point.K_int = internal::matrix_from_json(at("K_int"), path("K_int"));
  return point;
}

ScheduleHead head_from_json(const Json& json, const std::string& where) {
  const auto path = [&](const char* key) { return where + ": " + key; };
  const auto at = [&](const char* key) -> const Json& { return member(json, key, where); };
  const auto text = [&](const char* key) { return internal::string_from_json(at(key), path(key)); };
  ScheduleHead head;
  head.vehicle = text("vehicle");
  head.convention = text("convention");
  head.input_kind = input_kind(text("input_kind"), path("input_kind"));
  head.sign_law = sign_law(text("sign_law"), path("sign_law"));
  head.dt = internal::number_from_json(at("dt_s"), path("dt_s"));
  head.yaw = internal::number_from_json(at("yaw_rad"), path("yaw_rad"));
  head.states = internal::signals_from_json(at("states"), path("states"));
  head.inputs = internal::signals_from_json(at("inputs"), path("inputs"));
  head.integrals = internal::signals_from_json(at("integrals"), path("integrals"));
  head.axes = axes_from_json(at("axes"), path("axes"));
  return head;
}

}  // namespace

std::string schedule_json(const GainSchedule& schedule) {
  Json json;
  json["format"] = kScheduleFormat;
  json["format_version"] = 1;
  json["vehicle"] = schedule.vehicle;
  json["convention"] = schedule.convention;
  json["input_kind"] = to_string(schedule.input_kind);
  json["sign_law"] = to_string(schedule.sign_law);
  json["dt_s"] = number_to_json(schedule.dt, "dt_s");
  json["yaw_rad"] = number_to_json(schedule.yaw, "yaw_rad");
  json["states"] = internal::signals_to_json(schedule.states);
  json["inputs"] = internal::signals_to_json(schedule.inputs);
  json["integrals"] = internal::signals_to_json(schedule.integrals);
  json["axes"] = Json::array();
  for (const ScheduleAxis& axis : schedule.axes) json["axes"].push_back(axis_to_json(axis));
  json["points"] = Json::array();
  for (Eigen::Index i = 0; i < schedule.size(); ++i)
    json["points"].push_back(point_to_json(schedule, i));
  return internal::readable(json) + "\n";
}

GainSchedule parse_schedule_json(const std::string& text, const std::string& origin) {
  const Json json = parse_json(text, origin, kScheduleFormat);
  GainSchedule schedule = start_schedule(head_from_json(json, origin), origin);
  const Json& points = member(json, "points", origin);
  if (!points.is_array())
    throw InvalidInput(origin + ": points", "is not an array; expected the points of the grid");
  require_all_points(points.size(), schedule, origin + ": points");
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::string where = fmt::format("{}: points[{}]", origin, i);
    put_point(point_from_json(points[i], where, !schedule.integrals.empty()),
              static_cast<Eigen::Index>(i), where, schedule);
  }
  return schedule;
}

}  // namespace quadtune::exports
