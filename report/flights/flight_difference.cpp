// SPDX-License-Identifier: Apache-2.0
#include "report/flights/flight_difference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "quadtune/internal/json.hpp"

namespace quadtune::report {
namespace {

using internal::Json;

constexpr const char* kCompared[][2] = {{"command.T", "T"},
                                        {"command.tau_x", "tau_x"},
                                        {"command.tau_y", "tau_y"},
                                        {"command.tau_z", "tau_z"},
                                        {"x.px", "px"},
                                        {"x.py", "py"},
                                        {"x.pz", "pz"},
                                        {"x.roll", "roll"},
                                        {"x.pitch", "pitch"},
                                        {"x.yaw", "yaw"},
                                        {"estimate.px", "believed_px"},
                                        {"estimate.py", "believed_py"},
                                        {"estimate.pz", "believed_pz"}};

Json flight_json(const std::string& name, const FlownFlight& flight) {
  const EstimateError error = estimate_error(flight.result.log);
  Json json = {{"name", name}};
  json.update(to_json(flight));
  json["estimate_error_m"] = {
      {"mean_absolute", error.mean_absolute}, {"max", error.max}, {"final", error.final}};
  return json;
}

std::string figure(double value) {
  if (std::isinf(value)) return "never";
  return std::isnan(value) ? "none" : fmt::format("{:.4g}", value);
}

}  // namespace

FlightDifference difference_of(const LogTable& a, const LogTable& b) {
  FlightDifference difference;
  const std::size_t rows = std::min(a.rows(), b.rows());
  const std::vector<double>& t = a.columns.front().values;
  if (rows > 0) difference.duration = t[rows - 1];
  for (const auto& [column, name] : kCompared) {
    const LogColumn* first = a.find(column);
    const LogColumn* second = b.find(column);
    if (first == nullptr || second == nullptr) continue;
    ColumnDifference one{column, name, first->unit};
    for (std::size_t k = 0; k < rows; ++k) {
      const double d = std::abs(first->values[k] - second->values[k]);
      one.mean_squared += d * d / static_cast<double>(rows);
      if (d <= one.max) continue;
      one.max = d;
      one.max_at = t[k];
    }
    difference.columns.push_back(one);
  }
  return difference;
}

EstimateError estimate_error(const LogTable& log) {
  EstimateError error;
  const auto& px = log.find("x.px")->values;
  const auto& py = log.find("x.py")->values;
  const auto& ex = log.find("estimate.px")->values;
  const auto& ey = log.find("estimate.py")->values;
  for (std::size_t k = 0; k < px.size(); ++k) {
    error.final = std::hypot(ex[k] - px[k], ey[k] - py[k]);
    error.mean_absolute += error.final / static_cast<double>(px.size());
    error.max = std::max(error.max, error.final);
  }
  return error;
}

Json to_json(const std::string& what, const std::array<std::string, 2>& names,
             const std::array<FlownFlight, 2>& flights, const FlightDifference& difference) {
  Json json = {{"what", what}};
  json["difference"] = {{"duration_s", difference.duration},
                        {"mean_squared", Json::object()},
                        {"max", Json::object()}};
  for (const ColumnDifference& column : difference.columns) {
    json["difference"]["mean_squared"][column.name] = column.mean_squared;
    json["difference"]["max"][column.name] = column.max;
  }
  json["a"] = flight_json(names[0], flights[0]);
  json["b"] = flight_json(names[1], flights[1]);
  return json;
}

std::string to_text(const std::string& what, const std::array<std::string, 2>& names,
                    const std::array<FlownFlight, 2>& flights, const FlightDifference& difference) {
  const FlightSetup& setup = flights[0].plan.setup;
  std::string text =
      fmt::format("{} flies {} twice, compared by {}: a {}, b {}\n  a  {}\n", setup.vehicle.name,
                  setup.mission.name, what, names[0], names[1], circumstances(flights[0].plan));
  text += fmt::format("  b  {}\n\n", circumstances(flights[1].plan));
  text += fmt::format("difference over {:.4g} s\n  {:<12} {:>14} {:>14} {:>10}\n",
                      difference.duration, "", "mean squared", "greatest", "at");
  const bool carried = std::holds_alternative<Carried>(setup.mission.kind);
  for (const ColumnDifference& column : difference.columns) {
    // Who is carried does not steer.
    if (carried && column.max == 0) continue;
    text +=
        fmt::format("  {:<12} {:>14} {:>14} {:>8} s  {}\n", column.name,
                    fmt::format("{:.3g}", column.mean_squared), fmt::format("{:.3g}", column.max),
                    fmt::format("{:.4g}", column.max_at), column.unit);
  }
  text += fmt::format("\n  {:<36} {:>14} {:>14}\n", "", "a", "b");
  const auto row = [&](const std::string& label, const std::string& a, const std::string& b) {
    text += fmt::format("  {:<36} {:>14} {:>14}\n", label, a, b);
  };
  row("verdict", flights[0].passed ? "pass" : "fail", flights[1].passed ? "pass" : "fail");
  for (std::size_t i = 0; i < kMetrics; ++i) {
    const auto metric = static_cast<Metric>(i);
    const double a = flights[0].result.metrics[metric], b = flights[1].result.metrics[metric];
    if (std::isnan(a) && std::isnan(b)) continue;
    const std::string& unit = unit_of(metric);
    row(label_of(metric) + (unit == "1" ? "" : " [" + unit + "]"), figure(a), figure(b));
  }
  const EstimateError a = estimate_error(flights[0].result.log);
  const EstimateError b = estimate_error(flights[1].result.log);
  row("believed wrong across, mean [m]", figure(a.mean_absolute), figure(b.mean_absolute));
  row("believed wrong across, at the end [m]", figure(a.final), figure(b.final));
  for (std::size_t i = 0; i < 2; ++i) {
    const std::vector<std::string> why = reasons(flights[i]);
    for (std::size_t k = 0; k < why.size(); ++k)
      text += fmt::format("{}{}: {}\n", i == 0 && k == 0 ? "\n" : "", i == 0 ? "a" : "b", why[k]);
  }
  return text;
}

}  // namespace quadtune::report
