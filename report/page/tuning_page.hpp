// SPDX-License-Identifier: Apache-2.0
/// The tuning of a filter as one self-contained web page: verdict, covariances before and after,
/// innovations, autocorrelations, profiles of the likelihood, states.
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

/// An estimated parameter. A value that is not finite is unknown.
struct PageParameter {
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  std::string name = {};
  std::string unit = {};
  double before = kNaN, value = kNaN, low = kNaN, high = kNaN;
  std::string verdict = {};  ///< in words; empty if there is nothing to report
  bool doubtful = false;     ///< whether the value must not be used
};

/// Statistics of the innovations of one output.
struct PageCheck {
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  std::string output = {};
  std::int64_t samples = 0;
  double size_before = kNaN, size = kNaN, mean = kNaN, correlation = kNaN, kurtosis = kNaN;
  int lag = 0;                           ///< lag of `correlation`
  std::vector<std::string> failed = {};  ///< names of the checks that did not pass
};

/// Autocorrelation at lags 1, 2, ….
struct PageCorrelation {
  std::string output = {};
  double band = 0;  ///< half width of the band for white noise
  std::vector<double> before = {}, after = {};
};

/// Log-likelihood over a parameter, relative to its maximum.
struct PageProfile {
  std::string name = {};
  std::string unit = {};
  bool logarithmic = true;
  std::vector<double> x = {}, y = {};  ///< x increasing
  double value = 0, low = 0, high = 0, before = 0;
  double level = 0;  ///< decrease at the ends of the interval, > 0
};

/// The data of the page. Texts may contain any bytes.
struct TuningPage {
  std::string title = {};
  ReportVerdict verdict = ReportVerdict::none;
  std::vector<std::string> reasons = {};
  std::vector<std::pair<std::string, std::string>> about = {};  ///< logs, fit
  std::vector<PageParameter> parameters = {};
  std::vector<std::string> unseen = {};  ///< combinations of parameters that the logs do not
                                         ///< determine, in words
  std::vector<PageCheck> checks = {};
  std::vector<PageCorrelation> correlations = {};
  std::vector<PageProfile> profiles = {};
  /// The series over time; the first column is the time. Events are drawn as lines in all plots.
  LogTable log = {};
  std::vector<ReportPlot> plots = {};
  std::vector<std::string> remarks = {};  ///< sentences above the plots
  std::string command = {};               ///< the command line that produced it; empty for none
  std::string version = {};
  std::string seed = {};
};

/// The page as one HTML file, with the same protection as html(const FlightReport&).
/// @throws InvalidInput  as plots_json()
[[nodiscard]] std::string html(const TuningPage& page);

}  // namespace quadtune::report
