// SPDX-License-Identifier: Apache-2.0
/// What many flights say: how often they succeed, how their figures are spread, what they depend
/// on, which design is better. Every figure has an interval of 95 %.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "quadtune/simulation/campaign.hpp"

namespace quadtune {

/// A number and where it lies with 95 % probability.
struct Estimated {
  double value = 0;
  double low = 0;
  double high = 0;
};

/// The share of successes, with the interval of Clopper and Pearson, which holds at least 95 %.
/// @param all  ≥ 1
[[nodiscard]] Estimated success_rate(std::uint64_t successes, std::uint64_t all);

/// The q-quantile of a sample in order, with an interval between two of its values that holds
/// whatever the distribution (by the binomial distribution of how many lie below).
/// @param sorted  n ≥ 1 values in increasing order, infinite ones allowed, no NaN; the interval
///                ends at ±∞ where n is too small for one of 95 %
/// @param q       0 < q < 1
[[nodiscard]] Estimated quantile(std::span<const double> sorted, double q);

/// The same without its interval, of values in any order, which it changes.
[[nodiscard]] double sample_quantile(std::span<double> values, double q);

/// Spearman's rank correlation, ties at their mean rank, with an interval by Fisher's transform and
/// the variance of Bonett and Wright (2000). NaN where one of both does not vary, or n < 4.
/// @param x, y  n values each, infinite ones allowed, no NaN
[[nodiscard]] Estimated rank_correlation(std::span<const double> x, std::span<const double> y);

/// One figure over the flights that have it.
struct MetricSpread {
  Metric metric = Metric::duration;
  std::uint64_t flights = 0;  ///< in which it is a number; infinite where it was not reached
  double mean = 0;            ///< infinite where one is
  double deviation = 0;       ///< standard, of the flights; infinite likewise, NaN of one flight
  double least = 0, greatest = 0;
  Estimated median, percentile_5, percentile_95, percentile_99;
};

/// How a figure goes with what was drawn.
struct Sensitivity {
  std::string quantity;
  std::string figure;     ///< name of a metric, or "failure"
  Estimated correlation;  ///< of ranks
};

/// A flight that is worth looking at.
struct WorstFlight {
  std::uint64_t number = 0;
  std::string why;  ///< e.g. "safety exit: tilt at 3.2 s", "tracking_max 0.41 m of 0.3 m"
};

/// All of one case.
struct CaseStatistics {
  std::string design, mission;
  std::uint64_t flights = 0, passed = 0;
  Estimated success;
  std::map<std::string, std::uint64_t> ends;  ///< "completed", "safety exit: tilt", …
  std::vector<MetricSpread> metrics;          ///< those that some flight has
  std::vector<Sensitivity> sensitivities;     ///< strongest first
  std::vector<WorstFlight> worst;             ///< worst first, at most 5
};

/// One design against another in the same mission, on the same draws.
struct CaseComparison {
  std::string mission, first, second;
  std::uint64_t only_first_passed = 0, only_second_passed = 0;
  struct Difference {
    Metric metric = Metric::duration;
    std::uint64_t flights = 0;  ///< in which both have it, finite
    Estimated mean;             ///< of second - first
  };
  std::vector<Difference> metrics;
};

struct CampaignStatistics {
  std::vector<CaseStatistics> cases;
  std::vector<CaseComparison> comparisons;
};

/// @param drawn    all_draws() of the campaign
/// @param records  all of the campaign, in order
/// @param threads  as fly_all(), but no more than a few, as each holds a figure of all flights
[[nodiscard]] CampaignStatistics campaign_statistics(const Campaign& campaign,
                                                     const Eigen::MatrixXd& drawn,
                                                     std::span<const CampaignRecord> records,
                                                     std::size_t threads = 0);

}  // namespace quadtune
