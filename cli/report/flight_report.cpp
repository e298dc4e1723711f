// SPDX-License-Identifier: Apache-2.0
#include "report/flight_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "quadtune/errors.hpp"
#include "report/assets.hpp"
#include "report/decimate.hpp"
#include "report/page_text.hpp"

namespace quadtune::cli {
namespace {

using nlohmann::json;

constexpr std::size_t kPlotRows = 4000;
constexpr std::size_t kLeastPlotRows = 200;
constexpr std::size_t kPlotCells = 80 * kPlotRows;  // 1.7 MB in base64
constexpr std::size_t kReplayRows = 3000;

constexpr const char* kWhere = "flight report";

/// A number for a person. JSON has no other way to say inf and nan either.
std::string number_text(double value) {
  if (std::isnan(value)) return "not a number";
  if (std::isinf(value)) return value > 0 ? "infinite" : "minus infinite";
  return fmt::format("{:.4g}", value);
}

std::string unit_text(const std::string& unit) { return unit == "1" ? "" : unit; }

std::string verdict_text(ReportVerdict verdict) {
  if (verdict == ReportVerdict::pass) return "pass";
  return verdict == ReportVerdict::fail ? "fail" : "none";
}

const LogColumn& column(const LogTable& log, const std::string& name) {
  const LogColumn* found = log.find(name);
  if (!found)
    throw InvalidInput(kWhere, fmt::format("column '{}', expected one of the log's {} columns",
                                           name, log.columns.size()));
  return *found;
}

void check(const FlightReport& report) {
  const LogTable& log = report.log;
  for (const LogColumn& c : log.columns)
    if (c.values.size() != log.rows())
      throw InvalidInput(kWhere, fmt::format("column '{}' has {} rows, expected {} as the time",
                                             c.name, c.values.size(), log.rows()));
  if (!log.columns.empty()) {
    const std::vector<double>& time = log.columns.front().values;
    for (std::size_t i = 0; i < time.size(); ++i)
      if (!std::isfinite(time[i]) || (i > 0 && time[i] <= time[i - 1]))
        throw InvalidInput(kWhere, fmt::format("time {} in row {}, expected finite numbers that "
                                               "increase, because plots are over it",
                                               time[i], i));
  }
  if (report.replay && report.replay->attitude.size() != 3 && report.replay->attitude.size() != 4)
    throw InvalidInput(kWhere,
                       fmt::format("attitude of {} columns, expected 3 angles or a quaternion of 4",
                                   report.replay->attitude.size()));
  for (const GainTable& table : report.gains)
    if (table.values.rows() != static_cast<Eigen::Index>(table.rows.size()) ||
        table.values.cols() != static_cast<Eigen::Index>(table.columns.size()))
      throw InvalidInput(kWhere, fmt::format("table '{}' is {}x{}, expected {}x{} as it has names",
                                             table.title, table.values.rows(), table.values.cols(),
                                             table.rows.size(), table.columns.size()));
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
      item["limit_is_least"] = metric.limit_is_least;
      item["ok"] = metric.ok;
    }
    list.push_back(std::move(item));
  }
  return list;
}

json events_json(const std::vector<LogEvent>& events) {
  json list = json::array();
  for (const LogEvent& event : events)
    list.push_back({{"time", event.time}, {"name", event.name}, {"detail", event.detail}});
  return list;
}

std::string style_text(SeriesStyle style) {
  switch (style) {
    case SeriesStyle::reference:
      return "reference";
    case SeriesStyle::estimate:
      return "estimate";
    case SeriesStyle::measurement:
      return "measurement";
    case SeriesStyle::value:
      break;
  }
  return "value";
}

/// The plots with their data: each column once, whatever number of plots show it.
json plots_json(const FlightReport& report) {
  const LogTable& log = report.log;
  std::vector<const std::vector<double>*> columns;
  json plots = json::array();
  for (const ReportPlot& plot : report.plots) {
    json series = json::array();
    for (const ReportSeries& s : plot.series) {
      const std::vector<double>* values = &column(log, s.column).values;
      const auto at = std::find(columns.begin(), columns.end(), values);
      series.push_back({{"label", s.label.empty() ? s.column : s.label},
                        {"column", at - columns.begin()},
                        {"style", style_text(s.style)}});
      if (at == columns.end()) columns.push_back(values);
    }
    plots.push_back({{"title", plot.title},
                     {"unit", unit_text(plot.unit)},
                     {"factor", plot.factor},
                     {"series", std::move(series)}});
  }
  if (columns.empty() || log.rows() == 0) return {{"plots", json::array()}, {"rows", log.rows()}};
  const std::size_t rows = std::clamp(kPlotCells / columns.size(), kLeastPlotRows, kPlotRows);
  const Decimated kept = decimate(log.columns.front().values, columns, rows);
  json data = json::array();
  for (const std::vector<double>& values : kept.values) data.push_back(float32_base64(values));
  return {{"plots", std::move(plots)},
          {"rows", log.rows()},
          {"kept", kept.time.size()},
          {"time", float64_base64(kept.time)},
          {"columns", std::move(data)}};
}

/// Body to world, of the sequence yaw, pitch, roll.
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
  for (const std::string& name : names) columns.push_back(&column(log, name).values);
  std::array<std::vector<double>, 4> result;
  for (const std::size_t row : rows) {
    Eigen::Vector4d q;
    if (columns.size() == 3) {
      q = quaternion_wxyz((*columns[0])[row], (*columns[1])[row], (*columns[2])[row]);
    } else {
      for (Eigen::Index i = 0; i < 4; ++i) q(i) = (*columns[static_cast<std::size_t>(i)])[row];
      q /= q.norm();  // what has no direction becomes NaN, which is not drawn
    }
    for (std::size_t i = 0; i < 4; ++i) result[i].push_back(q(static_cast<Eigen::Index>(i)));
  }
  return result;
}

json replay_json(const LogTable& log, const ReportReplay& replay) {
  const std::vector<std::size_t> rows = spread_rows(log.rows(), kReplayRows);
  const auto pick = [&](const std::string& name) {
    const std::vector<double>& values = column(log, name).values;
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
  json data = plots_json(report);
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

std::string asset(std::string_view name) {
  for (const Asset& file : assets())
    if (file.name == name) return std::string(file.text);
  throw std::logic_error(fmt::format("flight report: no asset {}", name));
}

/// The template with each {{name}} replaced. What is put in is not looked at again.
std::string filled(std::string_view page,
                   const std::vector<std::pair<std::string, std::string>>& parts) {
  std::string result;
  while (true) {
    const std::size_t open = page.find("{{");
    result += page.substr(0, open);
    if (open == std::string_view::npos) return result;
    const std::size_t close = page.find("}}", open);
    const std::string_view name = page.substr(open + 2, close - open - 2);
    const auto part =
        std::find_if(parts.begin(), parts.end(), [&](const auto& p) { return p.first == name; });
    if (part == parts.end()) throw std::logic_error(fmt::format("template: no part {}", name));
    result += part->second;
    page.remove_prefix(close + 2);
  }
}

}  // namespace

std::string html(const FlightReport& report) {
  check(report);
  const std::string style = asset("vendor/uplot.min.css") + "\n" + asset("report.css");
  const std::string uplot = asset("vendor/uplot.min.js");
  const std::string three = asset("vendor/three.min.js");
  const std::string script =
      asset("page.js") + asset("plots.js") + asset("replay.js") + asset("report.js");
  const std::string policy = fmt::format(
      "default-src 'none'; script-src {} {} {}; style-src {}; img-src data:; base-uri 'none'; "
      "form-action 'none'",
      policy_hash(uplot), policy_hash(three), policy_hash(script), policy_hash(style));
  return filled(asset("template.html"), {{"policy", policy},
                                         {"title", html_text(report.title)},
                                         {"style", style},
                                         {"uplot", uplot},
                                         {"three", three},
                                         {"script", script},
                                         {"uplot-licence", asset("vendor/uplot.LICENSE")},
                                         {"three-licence", asset("vendor/three.LICENSE")},
                                         {"data", script_json(report_json(report))}});
}

}  // namespace quadtune::cli
