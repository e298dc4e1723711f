// SPDX-License-Identifier: Apache-2.0
/// A flight as one self-contained web page: verdict, metrics, a replay in space, plots over time,
/// gains and margins.
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

/// A metric of the flight.
struct ReportMetric {
  std::string name = {};   ///< one word, as in JSON, e.g. "position_rms"
  std::string label = {};  ///< for a person, e.g. "position error, rms"; empty to show the name
  double value = std::numeric_limits<double>::quiet_NaN();  ///< [unit]; a value that is not finite
                                                            ///< is shown in words
  std::string unit = {};                                    ///< empty or "1" for none
  std::optional<double> limit = {};                         ///< [unit]
  bool limit_is_minimum = false;  ///< whether the limit is a minimum; else a maximum
  bool ok = true;                 ///< whether the limit is met; meaningless without a limit
};

struct ReportRotor {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< body forward-right-down [m]
  int spin = 1;  ///< +1 clockwise seen from above, that is about body +z; -1 the other
  std::string speed_column = {};  ///< its speed, in any unit in which 0 means at rest; empty for
                                  ///< none
};

/// What the replay in space shows. Columns are given by their names in the log.
struct ReportReplay {
  /// World coordinates north, east, down [m]; the ground is at down = 0.
  std::array<std::string, 3> position = {};
  /// Roll, pitch, yaw [rad], or a quaternion w, x, y, z that transforms body to world components.
  std::vector<std::string> attitude = {};
  std::optional<std::array<std::string, 3>> reference = {};  ///< as position
  std::optional<std::array<std::string, 3>> estimate = {};   ///< as position
  std::vector<ReportRotor> rotors = {};
  double arm = 0;           ///< distance from the centre to a rotor [m]; 0: that of the farthest
                            ///< rotor
  double rotor_radius = 0;  ///< [m]; 0: the largest radius without overlap, for the picture only
};

/// A matrix with names of its rows and columns.
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

/// The data of a report. Texts may contain any bytes.
struct FlightReport {
  std::string title = {};
  ReportVerdict verdict = ReportVerdict::none;
  std::vector<std::string> reasons = {};  ///< reasons of the verdict, one sentence each
  std::vector<ReportMetric> metrics = {};
  /// Its `about` describes the flight. Only the columns that plots and replay name are shown.
  LogTable log = {};
  std::vector<ReportPlot> plots = {};
  std::optional<ReportReplay> replay = {};
  std::vector<GainTable> gains = {};
  std::vector<MarginRow> margins = {};
  std::string command = {};  ///< the command line that produced it; empty for none
  std::string version = {};  ///< of the program
  std::string seed = {};     ///< empty for none
};

/// The report as one HTML file. It loads nothing: its content security policy allows only its own
/// scripts and style, by their hashes. No text of the report can become markup or a script.
///
/// Plots contain at most 4000 rows of each column (fewer for more than 80 columns), reduced by
/// decimate(); the replay contains at most 3000 of the recorded rows. Values are stored as 32-bit
/// floats.
///
/// @throws InvalidInput  if a column is missing in the log or has another number of rows, a time
///                       does not increase, an attitude has neither 3 nor 4 columns, or the names
///                       of a table do not match its matrix
[[nodiscard]] std::string html(const FlightReport& report);

}  // namespace quadtune::report
