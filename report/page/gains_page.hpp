// SPDX-License-Identifier: Apache-2.0
/// Gains that were tuned over missions as one self-contained web page: whether they are accepted,
/// and a comparison with the gains of the start and the published ones.
#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "quadtune/logs/log_table.hpp"
#include "report/page/report_page.hpp"
#include "report/page/report_plots.hpp"

namespace quadtune::report {

/// One quantity with a value for each column. An infinite value is shown as "never", NaN as a dash.
struct PageCompared {
  std::string of = {};     ///< a mission or a loop; its rows are grouped
  std::string label = {};  ///< e.g. "tracking error, rms"
  std::string unit = {};
  std::vector<double> values = {};
  double limit = std::numeric_limits<double>::quiet_NaN();  ///< required limit; NaN: none
  bool at_least = false;                                    ///< whether the limit is a minimum
  std::vector<bool> broken = {};                            ///< whether each value violates the
                                                            ///< limit; empty: no limit
  bool binds = false;                                       ///< whether the limit is active at the
                                                            ///< result of the search
  bool main = false;                                        ///< whether it is the objective of the
                                                            ///< search
};

struct PageComparedTable {
  std::string id = {};  ///< id of the section, letters only
  std::string title = {}, hint = {};
  std::vector<PageCompared> rows = {};
};

/// The course of the search; the vectors have equal size.
struct PageSearch {
  std::vector<double> evaluation = {};  ///< increasing
  std::vector<double> best = {};        ///< minimum cost so far
  std::vector<double> tried = {};       ///< cost of that point; NaN: it exceeds a limit
};

/// One flown mission with a curve for each column, over its own time.
struct PageFlown {
  LogTable log = {};  ///< as TuningPage::log
  ReportPlot plot = {};
};

/// The data of the page. Texts except ids may contain any bytes.
struct GainsPage {
  std::string title = {};
  ReportVerdict verdict = ReportVerdict::none;
  std::string counts = {};                     ///< the cost before and after
  std::vector<std::string> reasons = {};       ///< active limits, and why the result was not
                                               ///< accepted
  std::vector<std::string> columns = {};       ///< start, found, published
  std::vector<PageComparedTable> tables = {};  ///< missions, margins, gains
  PageSearch search = {};
  std::vector<PageFlown> flown = {};
  std::vector<std::pair<std::string, std::string>> about = {};  ///< the request
  std::string command = {};                                     ///< empty for none
  std::string version = {};
  std::string seed = {};
};

/// The page as one HTML file, with the same protection as html(const FlightReport&).
/// @throws InvalidInput  as plots_json()
[[nodiscard]] std::string html(const GainsPage& page);

}  // namespace quadtune::report
