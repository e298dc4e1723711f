// SPDX-License-Identifier: Apache-2.0
/// Gains that were tuned over missions as one web page that needs nothing else: whether they are
/// taken, and what they are beside those of the start and published ones.
#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "quadtune/logs/log_table.hpp"
#include "report/page/report_page.hpp"
#include "report/page/report_plots.hpp"

namespace quadtune::report {

/// One quantity, a value a column. What is not finite is shown as "never" (infinite) or a dash.
struct PageCompared {
  std::string of = {};     ///< a mission, a loop; rows of one stand together
  std::string label = {};  ///< e.g. "tracking error, rms"
  std::string unit = {};
  std::vector<double> values = {};
  double limit = std::numeric_limits<double>::quiet_NaN();  ///< required; NaN: nothing is
  bool at_least = false;                                    ///< the limit is the least value
  std::vector<bool> broken = {};                            ///< by each value; empty: none
  bool binds = false;                                       ///< the limit held the search
  bool main = false;                                        ///< what was minimized
};

struct PageComparedTable {
  std::string id = {};  ///< of the section: letters
  std::string title = {}, hint = {};
  std::vector<PageCompared> rows = {};
};

/// The search: all of one size.
struct PageSearch {
  std::vector<double> evaluation = {};  ///< increasing
  std::vector<double> best = {};        ///< least cost so far
  std::vector<double> tried = {};       ///< cost of that point; NaN: it passes a limit
};

/// One mission as it was flown, a curve a column: over a time of its own.
struct PageFlown {
  LogTable log = {};  ///< as TuningPage::log
  ReportPlot plot = {};
};

/// All that the page tells. Any text but ids may hold any bytes.
struct GainsPage {
  std::string title = {};
  ReportVerdict verdict = ReportVerdict::none;
  std::string counts = {};                     ///< the cost before and after
  std::vector<std::string> reasons = {};       ///< what binds, and why not
  std::vector<std::string> columns = {};       ///< start, found, published
  std::vector<PageComparedTable> tables = {};  ///< missions, margins, gains
  PageSearch search = {};
  std::vector<PageFlown> flown = {};
  std::vector<std::pair<std::string, std::string>> about = {};  ///< what was asked for
  std::string command = {};                                     ///< empty for none
  std::string version = {};
  std::string seed = {};
};

/// The page as one HTML file, as safe as a flight's.
/// @throws InvalidInput  as plots_json()
[[nodiscard]] std::string html(const GainsPage& page);

}  // namespace quadtune::report
