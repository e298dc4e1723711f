// SPDX-License-Identifier: Apache-2.0
/// A campaign of many flights as one self-contained web page: success rates, distributions of the
/// metrics, what they depend on, and the worst flights.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "report/page/report_page.hpp"

namespace quadtune::report {

/// The distribution of one metric in one case. An infinite value is shown as "never", NaN as a
/// dash.
struct PageSpread {
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  std::string label = {};
  std::string unit = {};
  double p05 = kNaN, median = kNaN, p95 = kNaN, p99 = kNaN, limit = kNaN;
};

/// Correlations of the metrics of one case with the drawn parameters.
struct PageTrends {
  std::vector<std::string> figures = {};     ///< columns
  std::vector<std::string> quantities = {};  ///< rows
  /// Rank correlations, row by row; NaN if undefined or not significant.
  std::vector<std::vector<double>> values = {};
};

/// A flight worth inspecting.
struct PageWorst {
  std::string why = {};
  std::string command = {};
};

struct PageCase {
  std::string design = {}, mission = {};
  std::string law = {};
  std::uint64_t flights = 0, passed = 0;
  double rate = 0, low = 0, high = 0;                            ///< success rate with its
                                                                 ///< interval, 0 … 1
  std::vector<std::pair<std::string, std::uint64_t>> ends = {};  ///< how many flights ended in
                                                                 ///< which way
  std::vector<PageSpread> metrics = {};
  PageTrends trends = {};
  std::vector<PageWorst> worst = {};
};

/// The cumulative distribution of a metric, one curve for each design.
struct PageDistribution {
  std::string label = {}, mission = {}, unit = {};
  double limit = std::numeric_limits<double>::quiet_NaN();
  struct Curve {
    std::string design = {};
    std::vector<double> x = {};  ///< increasing; the share reached · i / (size - 1) of the flights
                                 ///< is below x[i]
    double reached = 1;          ///< share of the flights whose metric is finite
  };
  std::vector<Curve> curves = {};
};

/// The difference of two designs on the same draws.
struct PageComparison {
  std::string title = {};   ///< e.g. "published less designed in hover"
  std::string passes = {};  ///< a sentence
  struct Difference {
    std::string label = {}, unit = {};
    double mean = 0, low = 0, high = 0;
    std::uint64_t draws = 0;  ///< in which the metric of both is defined
  };
  std::vector<Difference> differences = {};
};

/// The data of the page. Texts may contain any bytes.
struct CampaignPage {
  std::string title = {};
  std::vector<std::pair<std::string, std::string>> about = {};
  std::vector<PageCase> cases = {};
  std::vector<PageDistribution> distributions = {};
  std::vector<PageComparison> comparisons = {};
  std::string version = {};
  std::string seed = {};
};

/// The page as one HTML file, with the same protection as html(const FlightReport&).
[[nodiscard]] std::string html(const CampaignPage& page);

}  // namespace quadtune::report
