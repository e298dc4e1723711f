// SPDX-License-Identifier: Apache-2.0
/// A campaign of many flights as one web page that needs nothing else: how many succeed, how their
/// figures are spread, what they depend on, which to look at.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "report/page/report_page.hpp"

namespace quadtune::report {

/// One figure of one case. What is not finite is shown as "never" (infinite) or a dash.
struct PageSpread {
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  std::string label = {};
  std::string unit = {};
  double p05 = kNaN, median = kNaN, p95 = kNaN, p99 = kNaN, limit = kNaN;
};

/// How the figures of one case go with what was drawn.
struct PageTrends {
  std::vector<std::string> figures = {};     ///< columns
  std::vector<std::string> quantities = {};  ///< rows
  /// Rank correlations, row by row; NaN where there is none, or none that is surely there.
  std::vector<std::vector<double>> values = {};
};

/// A flight to look at.
struct PageWorst {
  std::string why = {};
  std::string command = {};
};

struct PageCase {
  std::string design = {}, mission = {};
  std::string law = {};
  std::uint64_t flights = 0, passed = 0;
  double rate = 0, low = 0, high = 0;                            ///< of success, 0 … 1
  std::vector<std::pair<std::string, std::uint64_t>> ends = {};  ///< how flights ended
  std::vector<PageSpread> metrics = {};
  PageTrends trends = {};
  std::vector<PageWorst> worst = {};
};

/// The share of flights below a value, a curve a design.
struct PageDistribution {
  std::string label = {}, mission = {}, unit = {};
  double limit = std::numeric_limits<double>::quiet_NaN();
  struct Curve {
    std::string design = {};
    std::vector<double> x = {};  ///< increasing; share reached · i / (size - 1) is below x[i]
    double reached = 1;          ///< share of the flights for which it is finite
  };
  std::vector<Curve> curves = {};
};

/// One design less another on the same draws.
struct PageComparison {
  std::string title = {};   ///< e.g. "published less designed in hover"
  std::string passes = {};  ///< a sentence
  struct Difference {
    std::string label = {}, unit = {};
    double mean = 0, low = 0, high = 0;
    std::uint64_t draws = 0;  ///< in which both have the figure
  };
  std::vector<Difference> differences = {};
};

/// All that the page tells. Any text may hold any bytes.
struct CampaignPage {
  std::string title = {};
  std::vector<std::pair<std::string, std::string>> about = {};
  std::vector<PageCase> cases = {};
  std::vector<PageDistribution> distributions = {};
  std::vector<PageComparison> comparisons = {};
  std::string version = {};
  std::string seed = {};
};

/// The page as one HTML file, as safe as a flight's.
[[nodiscard]] std::string html(const CampaignPage& page);

}  // namespace quadtune::report
