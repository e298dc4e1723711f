// SPDX-License-Identifier: Apache-2.0
#include "report/page/flight_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "quadtune/errors.hpp"
#include "report/page/decimate.hpp"
#include "report/page/page_text.hpp"
#include "report/page/report_page.hpp"
#include "report/page/report_plots.hpp"

namespace quadtune::report {
namespace {

using nlohmann::json;

constexpr std::size_t kReplayRows = 3000;

constexpr const char* kWhere = "flight report";

/// A number as text. JSON has no other representation of infinity and NaN.
std::string number_text(double value) {
  if (std::isnan(value)) return "not a number";
  if (std::isinf(value)) return value > 0 ? "infinite" : "minus infinite";
  return fmt::format("{:.4g}", value);
}

void check(const FlightReport& report) {
  if (report.replay && report.replay->attitude.size() != 3 && report.replay->attitude.size() != 4)
    throw InvalidInput(
        kWhere, fmt::format("the attitude has {} columns, expected 3 angles or a quaternion of 4",
                            report.replay->attitude.size()));
  for (const GainTable& table : report.gains)
    if (table.values.rows() != static_cast<Eigen::Index>(table.rows.size()) ||
        table.values.cols() != static_cast<Eigen::Index>(table.columns.size()))
      throw InvalidInput(
          kWhere, fmt::format("table '{}' is {}x{}, expected {}x{} to match its names", table.title,
                              table.values.rows(), table.values.cols(), table.rows.size(),
                              table.columns.size()));
}

json metrics_json(const std::vector<ReportMetric>& metrics) {
  json list = json::array();
  for (const ReportMetric& metric : metrics) {
    json item = {{"name", metric.name},
                 {"label", metric.label.empty() ? metric.name : metric.label},
                 {"value", metric.value},
                 {"text", number_text(metric.value)},
                 {"unit", unit_text(metric.unit)}};
    if (metric.limit) {
      item["limit"] = *metric.limit;
      item["limit_text"] = number_text(*metric.limit);
      item["limit_is_least"] = metric.limit_is_minimum;
      item["ok"] = metric.ok;
    }
    list.push_back(std::move(item));
  }
  return list;
}

/// The rotation from body to world of the sequence yaw, pitch, roll.
Eigen::Vector4d quaternion_wxyz(double roll, double pitch, double yaw) {
  const double cr = std::cos(roll / 2), sr = std::sin(roll / 2);
  const double cp = std::cos(pitch / 2), sp = std::sin(pitch / 2);
  const double cy = std::cos(yaw / 2), sy = std::sin(yaw / 2);
  return {cy * cp * cr + sy * sp * sr, cy * cp * sr - sy * sp * cr, cy * sp * cr + sy * cp * sr,
          sy * cp * cr - cy * sp * sr};
}

/// Quaternions w, x, y, z of unit length at some rows of the log, component by component.
std::array<std::vector<double>, 4> attitudes(const LogTable& log,
                                             const std::vector<std::string>& names,
                                             const std::vector<std::size_t>& rows) {
  std::vector<const std::vector<double>*> columns;
  columns.reserve(names.size());
  for (const std::string& name : names) columns.push_back(&report_column(log, name).values);
  std::array<std::vector<double>, 4> result;
  for (const std::size_t row : rows) {
    Eigen::Vector4d q;
    if (columns.size() == 3) {
      q = quaternion_wxyz((*columns[0])[row], (*columns[1])[row], (*columns[2])[row]);
    } else {
      for (Eigen::Index i = 0; i < 4; ++i) q(i) = (*columns[static_cast<std::size_t>(i)])[row];
      q /= q.norm();  // a zero quaternion becomes NaN, which is not drawn
    }
    for (std::size_t i = 0; i < 4; ++i) result[i].push_back(q(static_cast<Eigen::Index>(i)));
  }
  return result;
}

json replay_json(const LogTable& log, const ReportReplay& replay) {
  const std::vector<std::size_t> rows = spread_rows(log.rows(), kReplayRows);
  const auto pick = [&](const std::string& name) {
    const std::vector<double>& values = report_column(log, name).values;
    std::vector<double> picked;
    picked.reserve(rows.size());
    for (const std::size_t row : rows) picked.push_back(values[row]);
    return picked;
  };
  const auto pick_position = [&](const std::array<std::string, 3>& names) {
    json list = json::array();
    for (const std::string& name : names) list.push_back(float32_base64(pick(name)));
    return list;
  };
  json quaternion = json::array();
  for (const std::vector<double>& component : attitudes(log, replay.attitude, rows))
    quaternion.push_back(float32_base64(component));
  json result = {{"position", pick_position(replay.position)},
                 {"quaternion", std::move(quaternion)},
                 {"arm", replay.arm},
                 {"rotor_radius", replay.rotor_radius}};
  if (rows.empty()) return nullptr;
  result["time"] = float64_base64(pick(log.columns.front().name));
  if (replay.reference) result["reference"] = pick_position(*replay.reference);
  if (replay.estimate) result["estimate"] = pick_position(*replay.estimate);
  json rotors = json::array();
  for (const ReportRotor& rotor : replay.rotors) {
    json item = {{"position", {rotor.position.x(), rotor.position.y(), rotor.position.z()}},
                 {"spin", rotor.spin < 0 ? -1 : 1}};
    if (!rotor.speed_column.empty()) item["speed"] = float32_base64(pick(rotor.speed_column));
    rotors.push_back(std::move(item));
  }
  result["rotors"] = std::move(rotors);
  return result;
}

json gains_json(const std::vector<GainTable>& gains) {
  json list = json::array();
  for (const GainTable& table : gains) {
    json values = json::array();
    for (Eigen::Index i = 0; i < table.values.rows(); ++i) {
      json row = json::array();
      for (Eigen::Index j = 0; j < table.values.cols(); ++j) row.push_back(table.values(i, j));
      values.push_back(std::move(row));
    }
    list.push_back({{"title", table.title},
                    {"rows", table.rows},
                    {"columns", table.columns},
                    {"values", std::move(values)}});
  }
  return list;
}

json margins_json(const std::vector<MarginRow>& margins) {
  json list = json::array();
  for (const MarginRow& row : margins) {
    json values = json::array();
    for (const MarginValue& value : row.values)
      values.push_back({{"name", value.name},
                        {"unit", unit_text(value.unit)},
                        {"text", number_text(value.value)}});
    list.push_back({{"loop", row.loop}, {"values", std::move(values)}});
  }
  return list;
}

json report_json(const FlightReport& report) {
  json about = json::array();
  for (const auto& [key, value] : report.log.about) about.push_back({key, value});
  json data = plots_json(report.log, report.plots);
  data["title"] = report.title;
  data["verdict"] = verdict_text(report.verdict);
  data["reasons"] = report.reasons;
  data["metrics"] = metrics_json(report.metrics);
  data["about"] = std::move(about);
  data["events"] = events_json(report.log.events);
  data["replay"] = report.replay ? replay_json(report.log, *report.replay) : json(nullptr);
  data["gains"] = gains_json(report.gains);
  data["margins"] = margins_json(report.margins);
  data["command"] = report.command;
  data["version"] = report.version;
  data["seed"] = report.seed;
  return data;
}

}  // namespace

std::string html(const FlightReport& report) {
  check(report);
  return page_html({.title = report.title,
                    .libraries = {{"vendor/uplot.min.js", "vendor/uplot.LICENSE"},
                                  {"vendor/three.min.js", "vendor/three.LICENSE"}},
                    .scripts = {"page.js", "plots.js", "frame.js", "replay.js", "report.js"},
                    .data = script_json(report_json(report))});
}

}  // namespace quadtune::report
