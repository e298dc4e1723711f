// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/campaign_statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/beta.hpp>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <numeric>

namespace quadtune {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kTail = 0.025;
constexpr double kQuantile = 1.959963984540054;  // of the normal distribution at 1 - kTail
constexpr std::size_t kWorst = 5;

/// Ranks from 1, ties at their mean.
std::vector<double> ranks(std::span<const double> x) {
  std::vector<std::size_t> order(x.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return x[a] < x[b]; });
  std::vector<double> rank(x.size());
  for (std::size_t i = 0; i < order.size();) {
    std::size_t end = i + 1;
    while (end < order.size() && x[order[end]] == x[order[i]]) ++end;
    for (std::size_t k = i; k < end; ++k) rank[order[k]] = 0.5 * static_cast<double>(i + 1 + end);
    i = end;
  }
  return rank;
}

/// Correlation of two samples; NaN where one does not vary.
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

/// Of ranks that are known.
Estimated with_interval(double r, std::size_t n) {
  if (n < 4 || std::isnan(r)) return {kNaN, kNaN, kNaN};
  const double z = std::atanh(std::clamp(r, -1.0, 1.0));
  const double width = kQuantile * std::sqrt((1 + r * r / 2) / (static_cast<double>(n) - 3));
  return {r, std::tanh(z - width), std::tanh(z + width)};
}

/// Mean with the interval of Student's distribution.
Estimated mean_of(std::span<const double> x, double& deviation) {
  const auto n = static_cast<double>(x.size());
  const double mean = std::accumulate(x.begin(), x.end(), 0.0) / n;
  double squares = 0;
  for (const double value : x) squares += (value - mean) * (value - mean);
  deviation = x.size() > 1 ? std::sqrt(squares / (n - 1)) : kNaN;
  if (x.size() < 2 || !std::isfinite(mean)) return {mean, -kInfinity, kInfinity};
  const double t = boost::math::quantile(boost::math::students_t(n - 1), 1 - kTail);
  const double width = t * deviation / std::sqrt(n);
  return {mean, mean - width, mean + width};
}

std::string end_of(const CampaignRecord& record) {
  if (record.end == FlightEnd::completed)
    return record.passed ? "completed" : "completed beyond limits";
  if (record.end == FlightEnd::diverged) return record.reason;
  return "safety exit: " + record.reason;
}

MetricSpread spread_of(Metric metric, std::vector<double> values) {
  MetricSpread spread;
  spread.metric = metric;
  spread.flights = values.size();
  const bool finite =
      std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
  spread.mean = kInfinity;
  spread.deviation = kInfinity;
  if (finite) spread.mean = mean_of(values, spread.deviation).value;
  std::sort(values.begin(), values.end());
  spread.least = values.front();
  spread.greatest = values.back();
  spread.percentile_5 = quantile(values, 0.05);
  spread.median = quantile(values, 0.5);
  spread.percentile_95 = quantile(values, 0.95);
  spread.percentile_99 = quantile(values, 0.99);
  return spread;
}

/// The records of one case, draw by draw.
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

/// How far the worst of the limits was passed, as a share of it, and in words.
std::pair<double, std::string> worst_limit(const FlightSetup& setup, const CampaignRecord& record) {
  std::pair<double, std::string> worst{0, ""};
  for (const Limit& limit : setup.mission.limits) {
    const double value = record.metrics[limit.metric];
    const double share = std::isnan(value) ? kInfinity : value / limit.most;
    if (!(share > worst.first)) continue;
    const std::string unit = unit_of(limit.metric) == "1" ? "" : " " + unit_of(limit.metric);
    worst = {share, fmt::format("{} {:.3g}{} of {:.3g}{}", name_of(limit.metric), value, unit,
                                limit.most, unit)};
  }
  return worst;
}

std::vector<WorstFlight> worst_of(const FlightSetup& setup, const CaseView& view) {
  // Ended early before beyond limits before within; the earlier, or the farther beyond, the worse.
  struct Rank {
    int kind;
    double size;
    std::size_t draw;
    std::string why;
  };
  std::vector<Rank> all;
  for (std::size_t draw = 0; draw < view.size(); ++draw) {
    const CampaignRecord& record = view[draw];
    if (record.end != FlightEnd::completed) {
      all.push_back({0, record.end_time, draw,
                     fmt::format("{} at {:.3g} s", end_of(record), record.end_time)});
    } else {
      auto [share, why] = worst_limit(setup, record);
      if (!why.empty()) all.push_back({1, -share, draw, std::move(why)});
    }
  }
  const std::size_t count = std::min(kWorst, all.size());
  std::partial_sort(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count), all.end(),
                    [](const Rank& a, const Rank& b) {
                      return std::tie(a.kind, a.size, a.draw) < std::tie(b.kind, b.size, b.draw);
                    });
  std::vector<WorstFlight> worst;
  for (std::size_t i = 0; i < count; ++i) worst.push_back({view[all[i].draw].number, all[i].why});
  return worst;
}

/// What was drawn, as ranks, quantity by quantity.
std::vector<std::vector<double>> drawn_ranks(const Campaign& campaign) {
  std::vector<std::vector<double>> drawn(campaign.uncertainty.numbers.size(),
                                         std::vector<double>(campaign.flights));
  for (std::uint32_t flight = 0; flight < campaign.flights; ++flight) {
    const Eigen::VectorXd now = draw(campaign.uncertainty, campaign.seed, flight);
    for (std::size_t i = 0; i < drawn.size(); ++i)
      drawn[i][flight] = now(static_cast<Eigen::Index>(i));
  }
  for (std::vector<double>& values : drawn) values = ranks(values);
  return drawn;
}

/// Correlations of one figure with all that was drawn, over the flights that have the figure.
void add_sensitivities(const Campaign& campaign, const std::vector<std::vector<double>>& drawn,
                       const std::string& figure, const std::vector<double>& values,
                       std::vector<Sensitivity>& result) {
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isnan(values[i])) chosen.push_back(i);
  std::vector<double> of_figure, x(chosen.size());
  for (const std::size_t i : chosen) of_figure.push_back(values[i]);
  of_figure = ranks(of_figure);
  for (std::size_t q = 0; q < drawn.size(); ++q) {
    for (std::size_t i = 0; i < chosen.size(); ++i) x[i] = drawn[q][chosen[i]];
    // Ranks among all order as ranks among the chosen, but are not evenly spaced.
    const std::vector<double> own = chosen.size() == values.size() ? x : ranks(x);
    const Estimated r = with_interval(correlation(own, of_figure), chosen.size());
    if (!std::isnan(r.value))
      result.push_back({campaign.uncertainty.numbers[q].quantity, figure, r});
  }
}

CaseStatistics statistics_of(const Campaign& campaign, std::size_t of, const CaseView& view,
                             const std::vector<std::vector<double>>& drawn) {
  CaseStatistics statistics;
  statistics.design = campaign.cases[of].design;
  statistics.mission = campaign.cases[of].mission;
  statistics.flights = view.size();
  std::vector<double> failed(view.size());
  for (std::size_t i = 0; i < view.size(); ++i) {
    if (view[i].passed) ++statistics.passed;
    failed[i] = view[i].passed ? 0 : 1;
    ++statistics.ends[end_of(view[i])];
  }
  statistics.success = success_rate(statistics.passed, statistics.flights);
  add_sensitivities(campaign, drawn, "failure", failed, statistics.sensitivities);
  for (std::size_t m = 0; m < kMetrics; ++m) {
    const auto metric = static_cast<Metric>(m);
    std::vector<double> values(view.size()), known;
    for (std::size_t i = 0; i < view.size(); ++i) {
      values[i] = view[i].metrics[metric];
      if (!std::isnan(values[i])) known.push_back(values[i]);
    }
    if (known.empty()) continue;
    statistics.metrics.push_back(spread_of(metric, std::move(known)));
    add_sensitivities(campaign, drawn, name_of(metric), values, statistics.sensitivities);
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

}  // namespace

Estimated success_rate(std::uint64_t successes, std::uint64_t all) {
  const auto k = static_cast<double>(successes), n = static_cast<double>(all);
  using boost::math::binomial;
  return {k / n, successes == 0 ? 0 : binomial::find_lower_bound_on_p(n, k, kTail),
          successes == all ? 1 : binomial::find_upper_bound_on_p(n, k, kTail)};
}

Estimated quantile(std::span<const double> sorted, double q) {
  const auto n = static_cast<double>(sorted.size());
  // Between neighbours as in R's type 7.
  const double at = q * (n - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  const double part = at - static_cast<double>(below);
  Estimated result{sorted[below], -kInfinity, kInfinity};
  if (part > 0 && sorted[above] != sorted[below])
    result.value = std::isinf(sorted[above]) || std::isinf(sorted[below])
                       ? sorted[above]
                       : sorted[below] + part * (sorted[above] - sorted[below]);
  // The r-th smallest of n lies below the quantile where at least r of them do.
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

Estimated rank_correlation(std::span<const double> x, std::span<const double> y) {
  const std::vector<double> a = ranks(x), b = ranks(y);
  return with_interval(x.size() < 4 ? kNaN : correlation(a, b), x.size());
}

CampaignStatistics campaign_statistics(const Campaign& campaign,
                                       std::span<const CampaignRecord> records) {
  const std::vector<std::vector<double>> drawn = drawn_ranks(campaign);
  CampaignStatistics statistics;
  const std::size_t cases = campaign.cases.size();
  for (std::size_t c = 0; c < cases; ++c)
    statistics.cases.push_back(statistics_of(campaign, c, CaseView(records, cases, c), drawn));
  for (std::size_t a = 0; a < cases; ++a)
    for (std::size_t b = a + 1; b < cases; ++b)
      if (campaign.cases[a].mission == campaign.cases[b].mission)
        statistics.comparisons.push_back(comparison_of(campaign, a, b, records));
  return statistics;
}

}  // namespace quadtune
