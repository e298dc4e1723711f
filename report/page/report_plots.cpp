// SPDX-License-Identifier: Apache-2.0
#include "report/page/report_plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "quadtune/errors.hpp"
#include "report/page/decimate.hpp"
#include "report/page/page_text.hpp"

namespace quadtune::report {
namespace {

using nlohmann::json;

constexpr std::size_t kPlotRows = 4000;
constexpr std::size_t kMinPlotRows = 200;
constexpr std::size_t kPlotCells = 80 * kPlotRows;  // 1.7 MB in base64

constexpr const char* kReport = "report";

std::string style_text(SeriesStyle style) {
  switch (style) {
    case SeriesStyle::reference:
      return "reference";
    case SeriesStyle::estimate:
      return "estimate";
    case SeriesStyle::measurement:
      return "measurement";
    case SeriesStyle::band:
      return "band";
    case SeriesStyle::value:
      break;
  }
  return "value";
}

void check_log(const LogTable& log) {
  for (const LogColumn& c : log.columns)
    if (c.values.size() != log.rows())
      throw InvalidInput(kReport, fmt::format("column '{}' has {} rows, expected {} like the time",
                                              c.name, c.values.size(), log.rows()));
  if (log.columns.empty()) return;
  const std::vector<double>& time = log.columns.front().values;
  for (std::size_t i = 0; i < time.size(); ++i)
    if (!std::isfinite(time[i]) || (i > 0 && time[i] <= time[i - 1]))
      throw InvalidInput(
          kReport, fmt::format("the time is {} in row {}, expected finite and increasing times",
                               time[i], i));
}

/// The columns that are shown, without duplicates.
class ShownColumns {
 public:
  explicit ShownColumns(const LogTable& log) : log_(log) {}

  /// The index of a column among them.
  std::ptrdiff_t place(const std::string& name) {
    const std::vector<double>* values = &report_column(log_, name).values;
    const auto at = std::find(columns_.begin(), columns_.end(), values);
    const std::ptrdiff_t place = at - columns_.begin();
    if (at == columns_.end()) columns_.push_back(values);
    return place;
  }
  [[nodiscard]] const std::vector<const std::vector<double>*>& all() const { return columns_; }

 private:
  const LogTable& log_;
  std::vector<const std::vector<double>*> columns_;
};

json series_json(const ReportSeries& series, ShownColumns& columns) {
  json item = {{"label", series.label.empty() ? series.column : series.label},
               {"column", columns.place(series.column)},
               {"style", style_text(series.style)}};
  if (series.style == SeriesStyle::band) item["upper"] = columns.place(series.upper);
  if (!series.shown) item["hidden"] = true;
  return item;
}

}  // namespace

const LogColumn& report_column(const LogTable& log, const std::string& name) {
  const LogColumn* found = log.find(name);
  if (!found)
    throw InvalidInput(
        kReport, fmt::format("unknown column '{}', expected one of the {} columns of the log", name,
                             log.columns.size()));
  return *found;
}

json plots_json(const LogTable& log, const std::vector<ReportPlot>& plots) {
  check_log(log);
  ShownColumns columns(log);
  json list = json::array();
  for (const ReportPlot& plot : plots) {
    json series = json::array();
    for (const ReportSeries& one : plot.series) series.push_back(series_json(one, columns));
    json item = {{"title", plot.title},
                 {"unit", unit_text(plot.unit)},
                 {"factor", plot.factor},
                 {"series", std::move(series)}};
    if (plot.logarithmic) item["logarithmic"] = true;
    list.push_back(std::move(item));
  }
  const std::size_t shown = columns.all().size();
  if (shown == 0 || log.rows() == 0) return {{"plots", json::array()}, {"rows", log.rows()}};
  const std::size_t rows = std::clamp(kPlotCells / shown, kMinPlotRows, kPlotRows);
  const Decimated kept = decimate(log.columns.front().values, columns.all(), rows);
  json data = json::array();
  for (const std::vector<double>& values : kept.values) data.push_back(float32_base64(values));
  return {{"plots", std::move(list)},
          {"rows", log.rows()},
          {"kept", kept.time.size()},
          {"time", float64_base64(kept.time)},
          {"columns", std::move(data)}};
}

json events_json(const std::vector<LogEvent>& events) {
  json list = json::array();
  for (const LogEvent& event : events)
    list.push_back({{"time", event.time}, {"name", event.name}, {"detail", event.detail}});
  return list;
}

std::string unit_text(const std::string& unit) { return unit == "1" ? "" : unit; }

}  // namespace quadtune::report
