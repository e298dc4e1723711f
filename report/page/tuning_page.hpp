// SPDX-License-Identifier: Apache-2.0
/// A filter's tuning as one web page that needs nothing else: verdict, covariances before and
/// after, innovations, autocorrelation, profile of the likelihood, states.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "quadtune/logs/log_table.hpp"
#include "report/page/report_page.hpp"
#include "report/page/report_plots.hpp"

namespace quadtune::report {

/// A number that was to be found. What is not finite is not known.
struct PageParameter {
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  std::string name = {};
  std::string unit = {};
  double before = kNaN, value = kNaN, low = kNaN, high = kNaN;
  std::string verdict = {};  ///< in words; empty where there is nothing to say
  bool doubtful = false;     ///< the value is not to be used
};

/// How one output's innovations look.
struct PageCheck {
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  std::string output = {};
  std::int64_t samples = 0;
  double size_before = kNaN, size = kNaN, mean = kNaN, correlation = kNaN, kurtosis = kNaN;
  int lag = 0;                           ///< of that correlation
  std::vector<std::string> failed = {};  ///< names of the checks that did not pass
};

/// Autocorrelation at lags 1, 2, ….
struct PageCorrelation {
  std::string output = {};
  double band = 0;  ///< to either side, of white noise
  std::vector<double> before = {}, after = {};
};

/// Log-likelihood over a parameter, less its greatest value.
struct PageProfile {
  std::string name = {};
  std::string unit = {};
  bool logarithmic = true;
  std::vector<double> x = {}, y = {};  ///< x increasing
  double value = 0, low = 0, high = 0, before = 0;
  double level = 0;  ///< fall at the ends of the interval, > 0
};

/// All that the page tells. Any text may hold any bytes.
struct TuningPage {
  std::string title = {};
  ReportVerdict verdict = ReportVerdict::none;
  std::vector<std::string> reasons = {};
  std::vector<std::pair<std::string, std::string>> about = {};  ///< logs, fit
  std::vector<PageParameter> parameters = {};
  std::vector<std::string> unseen = {};  ///< directions that the logs do not tell, in words
  std::vector<PageCheck> checks = {};
  std::vector<PageCorrelation> correlations = {};
  std::vector<PageProfile> profiles = {};
  /// What is over time: the first column is the time. Events are lines in all plots.
  LogTable log = {};
  std::vector<ReportPlot> plots = {};
  std::vector<std::string> remarks = {};  ///< sentences above the plots
  std::string command = {};               ///< the command line that made it; empty for none
  std::string version = {};
  std::string seed = {};
};

/// The page as one HTML file, as safe as a flight's.
/// @throws InvalidInput  as plots_json()
[[nodiscard]] std::string html(const TuningPage& page);

}  // namespace quadtune::report
