// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/campaign/campaign_statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "quadtune/internal/in_parallel.hpp"
#include "quadtune/internal/tails.hpp"

namespace quadtune {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kTail = 0.025;
constexpr double kQuantile = 1.959963984540054;  // of the standard normal distribution at 1 - kTail
constexpr std::size_t kWorst = 5;

/// A value and its index in the sample.
struct Placed {
  double value;
  std::uint32_t at;
};

/// Sorts a sample in increasing order.
std::vector<Placed> ordered(std::span<const double> x) {
  std::vector<Placed> order(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) order[i] = {x[i], static_cast<std::uint32_t>(i)};
  std::sort(order.begin(), order.end(),
            [](const Placed& a, const Placed& b) { return a.value < b.value; });
  return order;
}

/// Ranks of a sorted sample, from 1; ties get their mean rank.
std::vector<double> ranks(std::span<const Placed> order) {
  std::vector<double> rank(order.size());
  for (std::size_t i = 0; i < order.size();) {
    std::size_t end = i + 1;
    while (end < order.size() && order[end].value == order[i].value) ++end;
    for (std::size_t k = i; k < end; ++k)
      rank[order[k].at] = 0.5 * static_cast<double>(i + 1 + end);
    i = end;
  }
  return rank;
}

/// Correlation coefficient of two samples; NaN if one of them is constant.
double correlation(std::span<const double> x, std::span<const double> y) {
  const auto n = static_cast<double>(x.size());
  const double mx = std::accumulate(x.begin(), x.end(), 0.0) / n;
  const double my = std::accumulate(y.begin(), y.end(), 0.0) / n;
  double xx = 0, yy = 0, xy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mx) * (x[i] - mx);
    yy += (y[i] - my) * (y[i] - my);
    xy += (x[i] - mx) * (y[i] - my);
  }
  return xx > 0 && yy > 0 ? xy / std::sqrt(xx * yy) : kNaN;
}

/// Adds the interval of a rank correlation of n pairs.
Estimated with_interval(double r, std::size_t n) {
  if (n < 4 || std::isnan(r)) return {kNaN, kNaN, kNaN};
  // Fisher's transform of ±1 is infinite. Without ties, the largest correlation below 1 is
  // 1 - 12 / (n (n² - 1)); the middle between it and 1 takes the place of 1.
  const auto pairs = static_cast<double>(n);
  const double largest = 1 - 6 / (pairs * (pairs * pairs - 1));
  const double z = std::atanh(std::clamp(r, -largest, largest));
  const double width = kQuantile * std::sqrt((1 + r * r / 2) / (pairs - 3));
  return {r, std::tanh(z - width), std::tanh(z + width)};
}

/// Mean with the interval of Student's t distribution.
Estimated mean_of(std::span<const double> x, double& deviation) {
  const auto n = static_cast<double>(x.size());
  const double mean = std::accumulate(x.begin(), x.end(), 0.0) / n;
  double squares = 0;
  for (const double value : x) squares += (value - mean) * (value - mean);
  deviation = x.size() > 1 ? std::sqrt(squares / (n - 1)) : kNaN;
  if (x.size() < 2 || !std::isfinite(mean)) return {mean, -kInfinity, kInfinity};
  const double t = internal::student_quantile(1 - kTail, n - 1);
  const double width = t * deviation / std::sqrt(n);
  return {mean, mean - width, mean + width};
}

std::string end_of(const CampaignRecord& record) {
  if (record.end == FlightEnd::completed)
    return record.passed ? "completed" : "completed, limits exceeded";
  if (record.end == FlightEnd::diverged) return record.reason;
  return "safety exit: " + record.reason;
}

/// @param values  in the order of the flights, so that the sums do not depend on the order of the
///                values
/// @param order   the same values, sorted in increasing order
MetricSpread spread_of(Metric metric, std::span<const double> values,
                       std::span<const Placed> order) {
  MetricSpread spread;
  spread.metric = metric;
  spread.flights = values.size();
  const bool finite =
      std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
  spread.mean = kInfinity;
  spread.deviation = kInfinity;
  if (finite) spread.mean = mean_of(values, spread.deviation).value;
  std::vector<double> sorted(order.size());
  std::transform(order.begin(), order.end(), sorted.begin(),
                 [](const Placed& p) { return p.value; });
  spread.min = sorted.front();
  spread.max = sorted.back();
  spread.percentile_5 = quantile(sorted, 0.05);
  spread.median = quantile(sorted, 0.5);
  spread.percentile_95 = quantile(sorted, 0.95);
  spread.percentile_99 = quantile(sorted, 0.99);
  return spread;
}

/// View of the records of one case, draw by draw.
class CaseView {
 public:
  CaseView(std::span<const CampaignRecord> records, std::size_t cases, std::size_t of)
      : records_(records), cases_(cases), of_(of) {}

  [[nodiscard]] std::size_t size() const { return records_.size() / cases_; }
  const CampaignRecord& operator[](std::size_t draw) const { return records_[draw * cases_ + of_]; }

 private:
  std::span<const CampaignRecord> records_;
  std::size_t cases_, of_;
};

/// The limit with the largest ratio of value to limit; null if all ratios are 0.
struct WorstLimit {
  double share = 0;
  const Limit* limit = nullptr;
};
WorstLimit worst_limit(const FlightSetup& setup, const CampaignRecord& record) {
  WorstLimit worst;
  for (const Limit& limit : setup.mission.limits) {
    const double value = record.metrics[limit.metric];
    const double share = std::isnan(value) ? kInfinity : value / limit.max;
    if (share > worst.share) worst = {share, &limit};
  }
  return worst;
}

std::string words_of(const Limit& limit, const CampaignRecord& record) {
  const std::string unit = unit_of(limit.metric) == "1" ? "" : " " + unit_of(limit.metric);
  const double value = record.metrics[limit.metric];
  if (!std::isfinite(value))
    return fmt::format("{} {}, limit {:.3g}{}", name_of(limit.metric),
                       std::isnan(value) ? "not measured" : "never reached", limit.max, unit);
  return fmt::format("{} {:.3g}{}, limit {:.3g}{}", name_of(limit.metric), value, unit, limit.max,
                     unit);
}

std::vector<WorstFlight> worst_of(const FlightSetup& setup, const CaseView& view) {
  // Order: early end, then limits exceeded, then limits satisfied. Within these, earlier ends and
  // larger ratios are worse.
  struct Rank {
    int kind;
    double size;
    std::size_t draw;
    const Limit* limit;
  };
  std::vector<Rank> all;
  for (std::size_t draw = 0; draw < view.size(); ++draw) {
    const CampaignRecord& record = view[draw];
    if (record.end != FlightEnd::completed)
      all.push_back({0, record.end_time, draw, nullptr});
    else if (const WorstLimit worst = worst_limit(setup, record); worst.limit != nullptr)
      all.push_back({1, -worst.share, draw, worst.limit});
  }
  const std::size_t count = std::min(kWorst, all.size());
  std::partial_sort(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count), all.end(),
                    [](const Rank& a, const Rank& b) {
                      return std::tie(a.kind, a.size, a.draw) < std::tie(b.kind, b.size, b.draw);
                    });
  std::vector<WorstFlight> worst;
  for (std::size_t i = 0; i < count; ++i) {
    const CampaignRecord& record = view[all[i].draw];
    worst.push_back(
        {record.number, all[i].limit != nullptr
                            ? words_of(*all[i].limit, record)
                            : fmt::format("{} at {:.3g} s", end_of(record), record.end_time)});
  }
  return worst;
}

/// The drawn values of one quantity, ranked.
struct DrawnRanks {
  std::vector<double> rank;          ///< per flight
  std::vector<std::uint32_t> order;  ///< flights, sorted by increasing value
};

/// Ranks among a subset of the flights. Their order is that of the ranks among all flights, but
/// those are not evenly spaced within the subset.
/// @param place  index of each flight in the subset; kNotChosen for the others
constexpr std::uint32_t kNotChosen = 0xffffffff;
std::vector<double> ranks_among(const DrawnRanks& drawn, std::span<const std::uint32_t> place,
                                std::size_t chosen) {
  std::vector<Placed> order;
  order.reserve(chosen);
  for (const std::uint32_t flight : drawn.order)
    if (place[flight] != kNotChosen) order.push_back({drawn.rank[flight], place[flight]});
  return ranks(order);
}

/// One figure of a case: "failure" or a metric.
struct Figure {
  std::string name;
  /// Of the flights in which it is defined, in their order
  std::vector<double> values = {};
  std::vector<std::uint32_t> flights = {};  ///< numbers of these flights
  std::vector<Placed> order = {};           ///< of the values, sorted
};

/// Correlations of a figure with all drawn quantities, over the flights in which it is defined.
std::vector<Sensitivity> sensitivities_of(const Campaign& campaign,
                                          const std::vector<DrawnRanks>& drawn,
                                          const Figure& figure) {
  const std::size_t chosen = figure.values.size();
  const std::vector<double> of_figure = ranks(figure.order);
  const bool all = chosen == campaign.flights;
  std::vector<std::uint32_t> place;
  if (!all) {
    place.assign(campaign.flights, kNotChosen);
    for (std::size_t i = 0; i < chosen; ++i)
      place[figure.flights[i]] = static_cast<std::uint32_t>(i);
  }
  std::vector<Sensitivity> result;
  for (std::size_t q = 0; q < drawn.size(); ++q) {
    const double r = all ? correlation(drawn[q].rank, of_figure)
                         : correlation(ranks_among(drawn[q], place, chosen), of_figure);
    const Estimated estimated = with_interval(r, chosen);
    if (!std::isnan(estimated.value))
      result.push_back({campaign.uncertainty.numbers[q].quantity, figure.name, estimated});
  }
  return result;
}

/// Contribution of one figure to the statistics of a case.
struct FigureStatistics {
  std::optional<MetricSpread> spread;
  std::vector<Sensitivity> sensitivities;
};

/// @param index  0: "failure"; m + 1: metric m
FigureStatistics figure_statistics(const Campaign& campaign, const CaseView& view,
                                   const std::vector<DrawnRanks>& drawn, std::size_t index) {
  const auto metric = static_cast<Metric>(index - 1);
  Figure figure{index == 0 ? "failure" : name_of(metric)};
  for (std::size_t i = 0; i < view.size(); ++i) {
    const double passed = view[i].passed ? 0 : 1;
    const double value = index == 0 ? passed : view[i].metrics[metric];
    if (std::isnan(value)) continue;
    figure.values.push_back(value);
    figure.flights.push_back(static_cast<std::uint32_t>(i));
  }
  FigureStatistics result;
  if (figure.values.empty()) return result;
  figure.order = ordered(figure.values);
  if (index > 0) result.spread = spread_of(metric, figure.values, figure.order);
  result.sensitivities = sensitivities_of(campaign, drawn, figure);
  return result;
}

/// @param figures  of the case, "failure" first
CaseStatistics statistics_of(const Campaign& campaign, std::size_t of, const CaseView& view,
                             std::span<FigureStatistics> figures) {
  CaseStatistics statistics;
  statistics.design = campaign.cases[of].design;
  statistics.mission = campaign.cases[of].mission;
  statistics.flights = view.size();
  for (std::size_t i = 0; i < view.size(); ++i) {
    if (view[i].passed) ++statistics.passed;
    ++statistics.ends[end_of(view[i])];
  }
  statistics.success = success_rate(statistics.passed, statistics.flights);
  for (FigureStatistics& figure : figures) {
    if (figure.spread) statistics.metrics.push_back(*figure.spread);
    std::move(figure.sensitivities.begin(), figure.sensitivities.end(),
              std::back_inserter(statistics.sensitivities));
  }
  std::stable_sort(statistics.sensitivities.begin(), statistics.sensitivities.end(),
                   [](const Sensitivity& a, const Sensitivity& b) {
                     return std::abs(a.correlation.value) > std::abs(b.correlation.value);
                   });
  statistics.worst = worst_of(campaign.cases[of].setup, view);
  return statistics;
}

CaseComparison comparison_of(const Campaign& campaign, std::size_t a, std::size_t b,
                             std::span<const CampaignRecord> records) {
  const CaseView first(records, campaign.cases.size(), a),
      second(records, campaign.cases.size(), b);
  CaseComparison comparison;
  comparison.mission = campaign.cases[a].mission;
  comparison.first = campaign.cases[a].design;
  comparison.second = campaign.cases[b].design;
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (first[i].passed && !second[i].passed) ++comparison.only_first_passed;
    if (!first[i].passed && second[i].passed) ++comparison.only_second_passed;
  }
  for (std::size_t m = 0; m < kMetrics; ++m) {
    const auto metric = static_cast<Metric>(m);
    std::vector<double> differences;
    for (std::size_t i = 0; i < first.size(); ++i) {
      const double difference = second[i].metrics[metric] - first[i].metrics[metric];
      if (std::isfinite(difference)) differences.push_back(difference);
    }
    if (differences.size() < 2) continue;
    double deviation = 0;
    comparison.metrics.push_back({metric, differences.size(), mean_of(differences, deviation)});
  }
  return comparison;
}

/// Position of a quantile in a sorted sample, interpolated as in R's type 7.
struct Place {
  std::size_t below, above;
  double part;
};
Place place_of(double q, std::size_t n) {
  const double at = q * static_cast<double>(n - 1);
  const auto below = static_cast<std::size_t>(at);
  return {below, std::min(below + 1, n - 1), at - static_cast<double>(below)};
}

double between(double below, double above, double part) {
  if (part == 0 || above == below) return below;
  if (std::isinf(above) || std::isinf(below)) return above;
  return below + part * (above - below);
}

}  // namespace

Estimated success_rate(std::uint64_t successes, std::uint64_t all) {
  const auto k = static_cast<double>(successes), n = static_cast<double>(all);
  using boost::math::binomial;
  return {k / n, successes == 0 ? 0 : binomial::find_lower_bound_on_p(n, k, kTail),
          successes == all ? 1 : binomial::find_upper_bound_on_p(n, k, kTail)};
}

Estimated quantile(std::span<const double> sorted, double q) {
  const auto n = static_cast<double>(sorted.size());
  const Place at = place_of(q, sorted.size());
  Estimated result{between(sorted[at.below], sorted[at.above], at.part), -kInfinity, kInfinity};
  // The r-th smallest of n values lies below the quantile if at least r values do.
  const boost::math::binomial count(n, q);
  const auto at_most = [&](double k) { return k < 0 ? 0 : boost::math::cdf(count, k); };
  double low = std::floor(boost::math::quantile(count, kTail));
  while (low >= 0 && at_most(low) > kTail) --low;  // P(count ≤ low) ≤ 2.5 %
  if (low >= 0) result.low = sorted[static_cast<std::size_t>(low)];
  double high = std::ceil(boost::math::quantile(count, 1 - kTail));
  while (high < n && 1 - at_most(high) > kTail) ++high;  // P(count > high) ≤ 2.5 %
  if (high < n) result.high = sorted[static_cast<std::size_t>(high)];
  return result;
}

double sample_quantile(std::span<double> values, double q) {
  const Place at = place_of(q, values.size());
  const auto below = values.begin() + static_cast<std::ptrdiff_t>(at.below);
  std::nth_element(values.begin(), below, values.end());
  if (at.above == at.below) return *below;
  return between(*below, *std::min_element(below + 1, values.end()), at.part);
}

Estimated rank_correlation(std::span<const double> x, std::span<const double> y) {
  const std::vector<double> a = ranks(ordered(x)), b = ranks(ordered(y));
  return with_interval(x.size() < 4 ? kNaN : correlation(a, b), x.size());
}

CampaignStatistics campaign_statistics(const Campaign& campaign, const Eigen::MatrixXd& drawn,
                                       std::span<const CampaignRecord> records,
                                       std::size_t threads) {
  constexpr std::size_t kMaxThreads = 8;
  threads = std::min(internal::thread_count(threads), kMaxThreads);
  std::vector<DrawnRanks> quantities(static_cast<std::size_t>(drawn.rows()));
  const auto rank_quantity = [&](std::size_t q) {
    const Eigen::VectorXd values = drawn.row(static_cast<Eigen::Index>(q));
    const std::vector<Placed> order = ordered({values.data(), campaign.flights});
    quantities[q].rank = ranks(order);
    for (const Placed& placed : order) quantities[q].order.push_back(placed.at);
  };
  internal::in_parallel(quantities.size(), threads, [&] { return rank_quantity; }, {});

  const std::size_t cases = campaign.cases.size();
  constexpr std::size_t kFigures = kMetrics + 1;
  std::vector<FigureStatistics> figures(cases * kFigures);
  const auto work_out = [&](std::size_t part) {
    figures[part] = figure_statistics(campaign, CaseView(records, cases, part / kFigures),
                                      quantities, part % kFigures);
  };
  internal::in_parallel(figures.size(), threads, [&] { return work_out; }, {});

  CampaignStatistics statistics;
  for (std::size_t c = 0; c < cases; ++c)
    statistics.cases.push_back(statistics_of(campaign, c, CaseView(records, cases, c),
                                             std::span(figures).subspan(c * kFigures, kFigures)));
  for (std::size_t a = 0; a < cases; ++a)
    for (std::size_t b = a + 1; b < cases; ++b)
      if (campaign.cases[a].mission == campaign.cases[b].mission)
        statistics.comparisons.push_back(comparison_of(campaign, a, b, records));
  return statistics;
}

}  // namespace quadtune
