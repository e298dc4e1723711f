// SPDX-License-Identifier: Apache-2.0
/// Plots over one time, as a report's page draws them: what to draw, and its data.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "quadtune/logs/log_table.hpp"

namespace quadtune::report {

enum class SeriesStyle {
  value,        ///< what happened: a full line
  reference,    ///< what was wanted: dashes
  estimate,     ///< what the vehicle believed: a thin line
  measurement,  ///< what a sensor said: dots
  band,         ///< between two columns: an area
};

/// One curve. The n-th reference and the n-th estimate of a plot belong to its n-th value.
struct ReportSeries {
  std::string label = {};
  std::string column = {};  ///< a name of the log
  SeriesStyle style = SeriesStyle::value;
  std::string upper = {};  ///< of a band: the column of its upper edge; its lower is `column`
  bool shown = true;       ///< at first; its key shows or hides it
};

/// Curves over one axis of time and one of values.
struct ReportPlot {
  std::string title = {};
  std::string unit = {};  ///< of what is drawn; empty or "1" for none
  std::vector<ReportSeries> series = {};
  double factor = 1;         ///< the columns are multiplied by it, e.g. 180/pi to show rad in "deg"
  bool logarithmic = false;  ///< the axis of values; what is not positive is not drawn
};

/// The log's column of that name.
/// @throws InvalidInput
[[nodiscard]] const LogColumn& report_column(const LogTable& log, const std::string& name);

/// "plots", "rows" of the log, and where there is something to draw "kept" of them, "time" and
/// "columns": each column once, whatever number of plots show it, at most 4000 rows of each (fewer
/// where there are more than 80), by decimate(), as 32-bit floats in base64.
/// @throws InvalidInput  for a column that the log does not have or that has another number of
///                       rows, or a time that does not increase
[[nodiscard]] nlohmann::json plots_json(const LogTable& log, const std::vector<ReportPlot>& plots);

/// A list of "time", "name" and "detail".
[[nodiscard]] nlohmann::json events_json(const std::vector<LogEvent>& events);

/// "" for the unit "1".
[[nodiscard]] std::string unit_text(const std::string& unit);

}  // namespace quadtune::report
