// SPDX-License-Identifier: Apache-2.0
/// A flight as one web page that needs nothing else: verdict, metrics, a replay in space, plots
/// over time, gains and margins.
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/logs/log_table.hpp"
#include "report/page/report_page.hpp"
#include "report/page/report_plots.hpp"

namespace quadtune::report {

/// One number that tells how good the flight was.
struct ReportMetric {
  std::string name = {};   ///< one word, as in JSON, e.g. "position_rms"
  std::string label = {};  ///< for a person, e.g. "position error, rms"; empty to show the name
  double value = std::numeric_limits<double>::quiet_NaN();  ///< [unit]; what is not finite is said
  std::string unit = {};                                    ///< empty or "1" for none
  std::optional<double> limit = {};                         ///< [unit]
  bool limit_is_least = false;  ///< the value shall be at least the limit; else at most
  bool ok = true;               ///< the limit is kept; of no meaning without one
};

struct ReportRotor {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< body forward-right-down [m]
  int spin = 1;  ///< +1 clockwise seen from above, that is about body +z; -1 the other
  std::string speed_column = {};  ///< its speed, in any unit of which 0 is standing; empty for none
};

/// What the replay in space shows. Columns are names of the log.
struct ReportReplay {
  /// World north, east, down [m]; the ground is at down = 0.
  std::array<std::string, 3> position = {};
  /// Roll, pitch, yaw [rad], or a quaternion w, x, y, z that takes body to world components.
  std::vector<std::string> attitude = {};
  std::optional<std::array<std::string, 3>> reference = {};  ///< as position
  std::optional<std::array<std::string, 3>> estimate = {};   ///< as position
  std::vector<ReportRotor> rotors = {};
  double arm = 0;           ///< from the centre to a rotor [m]; 0: the farthest rotor's
  double rotor_radius = 0;  ///< [m]; 0: as large as goes without overlap, for the picture alone
};

/// A matrix with names.
struct GainTable {
  std::string title = {};
  std::vector<std::string> rows = {}, columns = {};
  Eigen::MatrixXd values = {};  ///< rows × columns
};

struct MarginValue {
  std::string name = {};  ///< e.g. "gain margin"
  std::string unit = {};  ///< e.g. "dB"
  double value = std::numeric_limits<double>::quiet_NaN();
};

/// The margins of one loop.
struct MarginRow {
  std::string loop = {};
  std::vector<MarginValue> values = {};
};

/// All that a report tells. Any text may hold any bytes.
struct FlightReport {
  std::string title = {};
  ReportVerdict verdict = ReportVerdict::none;
  std::vector<std::string> reasons = {};  ///< why, a sentence each
  std::vector<ReportMetric> metrics = {};
  /// Its `about` says what was flown. Of its columns only those that are asked for are shown.
  LogTable log = {};
  std::vector<ReportPlot> plots = {};
  std::optional<ReportReplay> replay = {};
  std::vector<GainTable> gains = {};
  std::vector<MarginRow> margins = {};
  std::string command = {};  ///< the command line that made it; empty for none
  std::string version = {};  ///< of the program
  std::string seed = {};     ///< empty for none
};

/// The report as one HTML file. It loads nothing: a content security policy in it allows its own
/// scripts and style alone, by their hashes. No text of the report can become markup or a script.
///
/// Plots get at most 4000 rows of each column (fewer where there are more than 80 columns), by
/// decimate(); the replay gets at most 3000 rows as they were recorded. Values are 32-bit floats.
///
/// @throws InvalidInput  for a column that the log does not have or that has another number of
///                       rows, a time that does not increase, an attitude of neither 3 nor 4
///                       columns, or a table whose names do not fit its matrix
[[nodiscard]] std::string html(const FlightReport& report);

}  // namespace quadtune::report
