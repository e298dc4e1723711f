// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/schedule_table.hpp"

#include <fmt/format.h>

#include <fstream>
#include <string>
#include <system_error>

#include "quadtune/convention_file.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/matrix_checks.hpp"
#include "schedule/schedule_parts.hpp"

namespace quadtune {
namespace exports {
namespace {

void require_size(Eigen::Index came, std::size_t expected, const char* name, const char* of,
                  const std::string& where) {
  if (came != static_cast<Eigen::Index>(expected))
    throw InvalidInput(where,
                       fmt::format("{} has {}, expected {}, one for each {}", name,
                                   internal::counted(came, "entry", "entries"), expected, of));
}

}  // namespace

GainSchedule start_schedule(ScheduleHead head, const std::string& where) {
  if (head.states.empty() || head.inputs.empty())
    throw InvalidInput(where,
                       fmt::format("has {} states and {} inputs, expected one or more of each",
                                   head.states.size(), head.inputs.size()));
  (void)convention(head.convention, where);
  if (!(head.dt >= 0))
    throw InvalidInput(where, fmt::format("dt_s is {}, expected 0 or more", head.dt));
  (void)checked_grid_size(head.axes, where);
  GainSchedule schedule = empty_schedule(std::move(head.axes), std::move(head.states),
                                         std::move(head.inputs), std::move(head.integrals));
  schedule.vehicle = std::move(head.vehicle);
  schedule.convention = std::move(head.convention);
  schedule.input_kind = head.input_kind;
  schedule.sign_law = head.sign_law;
  schedule.dt = head.dt;
  schedule.yaw = head.yaw;
  return schedule;
}

void put_point(const SchedulePointText& point, Eigen::Index index, const std::string& where,
               GainSchedule& schedule) {
  require_size(point.at.size(), schedule.axes.size(), "at", "axis", where);
  const Eigen::VectorXd expected = grid_point(schedule.axes, index);
  if (point.at != expected)
    throw InvalidInput(where, fmt::format("is at {}, expected {}: the points follow the axes, the "
                                          "last of which runs fastest",
                                          grid_words(schedule.axes, point.at),
                                          grid_words(schedule.axes, expected)));
  const auto p = static_cast<std::size_t>(index);
  schedule.status[p] = point.status;
  if (point.status != PointStatus::solved) {
    schedule.culprit[p] = point.culprit;
    return;
  }
  const auto nx = static_cast<Eigen::Index>(schedule.states.size());
  const auto nu = static_cast<Eigen::Index>(schedule.inputs.size());
  const auto ni = static_cast<Eigen::Index>(schedule.integrals.size());
  require_shape(point.K, nu, nx, where, "K", "inputs by states");
  if (ni > 0) require_shape(point.K_int, nu, ni, where, "K_int", "inputs by integrals");
  require_size(point.x0.size(), schedule.states.size(), "x0", "state", where);
  require_size(point.u0.size(), schedule.inputs.size(), "u0", "input", where);
  schedule.K.col(index) = point.K.reshaped();
  if (ni > 0) schedule.K_int.col(index) = point.K_int.reshaped();
  schedule.x0.col(index) = point.x0;
  schedule.u0.col(index) = point.u0;
  schedule.residual(index) = point.residual;
}

void require_all_points(std::size_t came, const GainSchedule& schedule, const std::string& where) {
  if (static_cast<Eigen::Index>(came) != schedule.size())
    throw InvalidInput(where, fmt::format("has {} points, expected {}, one for each combination of "
                                          "the axes' values",
                                          came, schedule.size()));
}

}  // namespace exports

TableFormat table_format(const std::filesystem::path& file, const std::string& where) {
  const std::string end = file.extension().string();
  if (end == ".toml") return TableFormat::toml;
  if (end == ".json") return TableFormat::json;
  throw InvalidInput(
      where, fmt::format("cannot determine the format from '{}'; expected a file name that ends "
                         "in .toml or .json",
                         internal::printable(file.filename().string())));
}

std::string schedule_text(const GainSchedule& schedule, TableFormat format) {
  if (!is_built_in(convention(schedule.convention, "schedule")))
    throw InvalidInput(
        "schedule", fmt::format("uses the convention '{}', which is defined in a file; expected a "
                                "built-in convention because a table cannot hold a definition",
                                schedule.convention));
  return format == TableFormat::toml ? exports::schedule_toml(schedule)
                                     : exports::schedule_json(schedule);
}

GainSchedule parse_schedule(const std::string& text, const std::string& origin,
                            TableFormat format) {
  return format == TableFormat::toml ? exports::parse_schedule_toml(text, origin)
                                     : exports::parse_schedule_json(text, origin);
}

bool is_schedule(const std::filesystem::path& path) {
  constexpr std::streamsize kHead = 4096;  // the format is the first key in the file
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(path, unknown)) return false;  // a pipe is read only once
  std::string head(static_cast<std::size_t>(kHead), '\0');
  std::ifstream file(path, std::ios::binary);
  if (!file) return false;
  file.read(head.data(), kHead);
  head.resize(static_cast<std::size_t>(file.gcount()));
  return head.find(fmt::format("\"{}\"", exports::kScheduleFormat)) != std::string::npos;
}

GainSchedule read_schedule(const std::filesystem::path& path) {
  const TableFormat format = table_format(path, path.string());
  return parse_schedule(internal::read_text_file(path.string(), kScheduleTableLimit), path.string(),
                        format);
}

}  // namespace quadtune
