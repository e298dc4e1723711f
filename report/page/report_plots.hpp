// SPDX-License-Identifier: Apache-2.0
/// Plots over a common time for the pages of reports: their definition and their data.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "quadtune/logs/log_table.hpp"

namespace quadtune::report {

enum class SeriesStyle {
  value,        ///< true value: a solid line
  reference,    ///< set point: a dashed line
  estimate,     ///< estimate of the vehicle: a thin line
  measurement,  ///< measurement: dots
  band,         ///< the area between two columns
};

/// One curve. The n-th reference and the n-th estimate of a plot belong to its n-th value.
struct ReportSeries {
  std::string label = {};
  std::string column = {};  ///< name of a column of the log
  SeriesStyle style = SeriesStyle::value;
  std::string upper = {};  ///< column of the upper edge of a band; the lower edge is `column`
  bool shown = true;       ///< whether it is shown initially; the legend toggles it
};

/// Curves with a common time axis and a common value axis.
struct ReportPlot {
  std::string title = {};
  std::string unit = {};  ///< unit of the drawn values; empty or "1" for none
  std::vector<ReportSeries> series = {};
  double factor = 1;         ///< factor of the columns, e.g. 180/pi to show rad in "deg"
  bool logarithmic = false;  ///< whether the value axis is; values that are not positive are
                             ///< omitted
};

/// The column of the log with that name.
/// @throws InvalidInput  if the log has no such column
[[nodiscard]] const LogColumn& report_column(const LogTable& log, const std::string& name);

/// "plots" and "rows", the number of rows of the log; and if there is anything to draw, "kept", the
/// number of rows that are kept, "time" and "columns". Each column is stored once, with at most
/// 4000 rows (fewer for more than 80 columns), reduced by decimate(), as 32-bit floats in base64.
/// @throws InvalidInput  if a column is missing in the log or has another number of rows, or if the
///                       time does not increase
[[nodiscard]] nlohmann::json plots_json(const LogTable& log, const std::vector<ReportPlot>& plots);

/// A list of "time", "name" and "detail".
[[nodiscard]] nlohmann::json events_json(const std::vector<LogEvent>& events);

/// "" for the unit "1".
[[nodiscard]] std::string unit_text(const std::string& unit);

}  // namespace quadtune::report
