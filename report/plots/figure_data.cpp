// SPDX-License-Identifier: Apache-2.0
#include "report/plots/figure_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "quadtune/internal/json.hpp"

namespace quadtune::report {
namespace {

std::string csv_text(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

internal::Json numbers_json(const std::vector<double>& values, std::size_t count) {
  internal::Json list = internal::Json::array();
  for (std::size_t i = 0; i < count; ++i) list.push_back(internal::finite_or_null(values[i]));
  return list;
}

std::size_t points_of(const Series& series) { return std::min(series.x.size(), series.y.size()); }

}  // namespace

std::string figure_csv(const Figure& figure) {
  std::string text = "panel,curve,x,y\n";
  for (const Panel& panel : figure.panels)
    for (const Series& series : panel.series) {
      const std::string start = csv_text(panel.title) + "," + csv_text(series.name) + ",";
      for (std::size_t i = 0; i < points_of(series); ++i)
        if (std::isfinite(series.x[i]) && std::isfinite(series.y[i]))
          text += fmt::format("{}{},{}\n", start, series.x[i], series.y[i]);
    }
  return text;
}

std::string figure_json(const Figure& figure) {
  internal::Json panels = internal::Json::array();
  for (const Panel& panel : figure.panels) {
    internal::Json curves = internal::Json::array();
    for (const Series& series : panel.series) {
      internal::Json curve;
      curve["name"] = series.name;
      curve["x"] = numbers_json(series.x, points_of(series));
      curve["y"] = numbers_json(series.y, points_of(series));
      curves.push_back(std::move(curve));
    }
    internal::Json entry;
    entry["title"] = panel.title;
    entry["x"] = panel.x.label;
    entry["y"] = panel.y.label;
    entry["curves"] = std::move(curves);
    panels.push_back(std::move(entry));
  }
  internal::Json json;
  json["title"] = figure.title;
  json["subtitle"] = figure.subtitle;
  json["panels"] = std::move(panels);
  return internal::readable(json) + "\n";
}

}  // namespace quadtune::report
