// SPDX-License-Identifier: Apache-2.0
/// Statistics of many flights: success rates, distributions of metrics, sensitivities to the drawn
/// parameters, comparisons of designs. Every value has a 95 % confidence interval.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "quadtune/simulation/campaign/campaign.hpp"

namespace quadtune {

/// An estimate with its 95 % confidence interval.
struct Estimated {
  double value = 0;  ///< the estimate
  double low = 0;    ///< lower end of the interval
  double high = 0;   ///< upper end of the interval
};

/// Fraction of successes with the Clopper-Pearson interval, whose coverage is at least 95 %.
/// @param successes  ≤ `all`
/// @param all        ≥ 1
[[nodiscard]] Estimated success_rate(std::uint64_t successes, std::uint64_t all);

/// The q-quantile of a sorted sample, with a distribution-free interval between two order
/// statistics (from the binomial distribution of the number of values below the quantile).
/// @param sorted  n ≥ 1 values in increasing order, infinite values allowed, no NaN; an end of the
///                interval is ±∞ if n is too small for 95 %
/// @param q       0 < q < 1
[[nodiscard]] Estimated quantile(std::span<const double> sorted, double q);

/// The q-quantile without its interval. The values may have any order, and the function changes it.
[[nodiscard]] double sample_quantile(std::span<double> values, double q);

/// Spearman's rank correlation, with mean ranks for ties and an interval by Fisher's transform with
/// the variance of Bonett and Wright (2000). NaN if x or y is constant or n < 4.
/// @param x, y  n values each, infinite values allowed, no NaN
[[nodiscard]] Estimated rank_correlation(std::span<const double> x, std::span<const double> y);

/// Distribution of one metric over the flights in which it is defined.
struct MetricSpread {
  Metric metric = Metric::duration;  ///< the metric
  std::uint64_t flights = 0;         ///< in which it is not NaN; infinite values count
  double mean = 0;                   ///< infinite if any value is
  /// Standard deviation over the flights; infinite if any value is, NaN for one flight
  double deviation = 0;
  double min = 0,     ///< smallest value
      max = 0;        ///< largest value
  Estimated median,   ///< half of the flights are below it
      percentile_5,   ///< 5 % of the flights are below it
      percentile_95,  ///< 95 % of the flights are below it
      percentile_99;  ///< 99 % of the flights are below it
};

/// Correlation of a metric with a drawn quantity.
struct Sensitivity {
  std::string quantity;   ///< name of an UncertainQuantity
  std::string figure;     ///< name of a metric, or "failure"
  Estimated correlation;  ///< rank correlation
};

/// A flight that deserves inspection.
struct WorstFlight {
  std::uint64_t number = 0;  ///< of the flight
  std::string why;  ///< e.g. "safety exit: tilt at 3.2 s", "tracking_max 0.41 m, limit 0.3 m"
};

/// Statistics of one case.
struct CaseStatistics {
  std::string design,                         ///< name of the design
      mission;                                ///< name of the mission
  std::uint64_t flights = 0,                  ///< number of flights
      passed = 0;                             ///< number of flights that passed
  Estimated success;                          ///< success rate
  std::map<std::string, std::uint64_t> ends;  ///< "completed", "safety exit: tilt", …
  std::vector<MetricSpread> metrics;          ///< metrics that are defined in at least one flight
  std::vector<Sensitivity> sensitivities;     ///< strongest first
  std::vector<WorstFlight> worst;             ///< worst first, at most 5
};

/// Comparison of two designs in the same mission on the same draws.
struct CaseComparison {
  std::string mission,                  ///< name of the mission
      first,                            ///< name of the first design
      second;                           ///< name of the second design
  std::uint64_t only_first_passed = 0,  ///< number of draws that only the first design passed
      only_second_passed = 0;           ///< likewise the second
  /// Difference of one metric on the same draws.
  struct Difference {
    Metric metric = Metric::duration;  ///< the metric
    std::uint64_t flights = 0;         ///< in which both values are defined and finite
    Estimated mean;                    ///< of second - first
  };
  std::vector<Difference> metrics;  ///< metrics that both designs have
};

/// The statistics of a campaign.
struct CampaignStatistics {
  std::vector<CaseStatistics> cases;        ///< in the order of the campaign's cases
  std::vector<CaseComparison> comparisons;  ///< each pair of designs in the same mission
};

/// Computes the statistics of a campaign.
/// @param campaign  that was flown
/// @param drawn    all_draws() of the campaign
/// @param records  all records of the campaign, in order
/// @param threads  as fly_all(), limited to a small number because each thread stores one metric of
///                 all flights
[[nodiscard]] CampaignStatistics campaign_statistics(const Campaign& campaign,
                                                     const Eigen::MatrixXd& drawn,
                                                     std::span<const CampaignRecord> records,
                                                     std::size_t threads = 0);

}  // namespace quadtune
