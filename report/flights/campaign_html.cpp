// SPDX-License-Identifier: Apache-2.0
#include "report/flights/campaign_html.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "quadtune/version.hpp"
#include "report/flights/campaign_figures.hpp"
#include "report/flights/campaign_report.hpp"
#include "report/flights/flight_text.hpp"
#include "report/page/campaign_page.hpp"

namespace quadtune::report {
namespace {

/// "normal, mean 1, deviation 0.05, least 0.9"
std::string words_of(const UncertainNumber& number) {
  const Distribution& d = number.distribution;
  const std::string& unit = uncertain_quantity(number.quantity, "campaign").unit;
  const bool even = d.kind == DistributionKind::uniform;
  const bool logarithmic = d.kind == DistributionKind::log_normal;
  std::string text = fmt::format("{}, {} {:.4g}, {} {:.4g}",
                                 even          ? "uniform"
                                 : logarithmic ? "log-normal"
                                               : "normal",
                                 even          ? "from"
                                 : logarithmic ? "median"
                                               : "mean",
                                 d.first,
                                 even          ? "to"
                                 : logarithmic ? "deviation of the logarithm"
                                               : "deviation",
                                 d.second);
  if (std::isfinite(d.least)) text += fmt::format(", least {:.4g}", d.least);
  if (std::isfinite(d.most)) text += fmt::format(", most {:.4g}", d.most);
  return unit == "1" ? text : fmt::format("{} [{}]", text, unit);
}

/// Rank correlations that are surely there: quantities down, figures across.
PageTrends trends_of(const CampaignPlan& plan, const CaseStatistics& of) {
  PageTrends trends;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::string> keys;
  for (const UncertainNumber& number : plan.campaign.uncertainty.numbers)
    trends.quantities.push_back(number.quantity);
  for (const Sensitivity& s : of.sensitivities) {
    const auto metric = metric_of(s.figure);
    if (!surely_not_zero(s.correlation) || (metric && !is_shown(*metric)) ||
        std::find(keys.begin(), keys.end(), s.figure) != keys.end())
      continue;
    keys.push_back(s.figure);
    trends.figures.push_back(metric ? label_of(*metric) : "failure");
  }
  trends.values.assign(trends.quantities.size(), std::vector<double>(keys.size(), kNone));
  for (const Sensitivity& s : of.sensitivities) {
    const auto column = std::find(keys.begin(), keys.end(), s.figure);
    if (column == keys.end() || !surely_not_zero(s.correlation)) continue;
    const auto row = std::find(trends.quantities.begin(), trends.quantities.end(), s.quantity);
    trends.values[static_cast<std::size_t>(row - trends.quantities.begin())]
                 [static_cast<std::size_t>(column - keys.begin())] = s.correlation.value;
  }
  for (std::size_t i = trends.quantities.size(); i-- > 0;)
    if (std::all_of(trends.values[i].begin(), trends.values[i].end(),
                    [](double x) { return std::isnan(x); })) {
      trends.values.erase(trends.values.begin() + static_cast<std::ptrdiff_t>(i));
      trends.quantities.erase(trends.quantities.begin() + static_cast<std::ptrdiff_t>(i));
    }
  return trends;
}

PageCase page_case(const CampaignPlan& plan, std::size_t index, const CaseStatistics& of,
                   const std::string& folder) {
  PageCase page;
  page.design = of.design;
  page.mission = of.mission;
  page.law = plan.words[index].law + "; " + surroundings(plan.words[index]);
  page.flights = of.flights;
  page.passed = of.passed;
  page.rate = of.success.value;
  page.low = of.success.low;
  page.high = of.success.high;
  page.ends.assign(of.ends.begin(), of.ends.end());
  for (const MetricSpread& m : of.metrics)
    if (is_shown(m.metric))
      page.metrics.push_back({label_of(m.metric), unit_shown(m.metric), m.percentile_5.value,
                              m.median.value, m.percentile_95.value, m.percentile_99.value,
                              limit_of(plan.campaign.cases[index].setup.mission, m.metric)});
  page.trends = trends_of(plan, of);
  for (const WorstFlight& worst : of.worst)
    page.worst.push_back({worst.why, replay_command(folder, worst.number)});
  return page;
}

/// The finite values of a figure at evenly spread shares of the flights that have it.
PageDistribution::Curve curve_of(std::span<const CampaignRecord> records, std::size_t cases,
                                 std::size_t of, Metric metric) {
  std::vector<double> values;
  std::size_t known = 0;
  for (std::size_t i = of; i < records.size(); i += cases) {
    const double value = records[i].metrics[metric];
    if (!std::isnan(value)) ++known;
    if (std::isfinite(value)) values.push_back(value);
  }
  std::sort(values.begin(), values.end());
  PageDistribution::Curve curve;
  curve.reached = known > 0 ? static_cast<double>(values.size()) / static_cast<double>(known) : 0;
  constexpr std::size_t kMost = 200;
  if (values.size() <= kMost) {
    curve.x = std::move(values);
  } else {
    for (std::size_t i = 0; i <= kMost; ++i)
      curve.x.push_back(values[i * (values.size() - 1) / kMost]);
  }
  return curve;
}

/// One chart a figure and mission, with a curve a design.
std::vector<PageDistribution> distributions_of(const CampaignPlan& plan,
                                               std::span<const CampaignRecord> records) {
  std::vector<PageDistribution> all;
  const std::vector<CampaignCase>& cases = plan.campaign.cases;
  for (const Metric metric : {Metric::tracking_rms, Metric::tracking_max, Metric::height_max,
                              Metric::tilt_max, Metric::settling_time, Metric::energy})
    for (std::size_t first = 0; first < cases.size(); ++first) {
      // The first design of a mission speaks for all.
      const auto same = [&](std::size_t c) { return cases[c].mission == cases[first].mission; };
      bool seen = false;
      for (std::size_t c = 0; c < first; ++c) seen = seen || same(c);
      if (seen) continue;
      PageDistribution chart{label_of(metric),
                             cases[first].mission,
                             unit_shown(metric),
                             limit_of(cases[first].setup.mission, metric),
                             {}};
      for (std::size_t c = first; c < cases.size(); ++c) {
        if (!same(c)) continue;
        PageDistribution::Curve curve = curve_of(records, cases.size(), c, metric);
        curve.design = cases[c].design;
        if (curve.x.size() > 1) chart.curves.push_back(std::move(curve));
      }
      if (!chart.curves.empty()) all.push_back(std::move(chart));
    }
  return all;
}

PageComparison page_comparison(const CaseComparison& c) {
  PageComparison page;
  page.title = fmt::format("{} less {} in {}", c.second, c.first, c.mission);
  page.passes = fmt::format(
      "On the same draws; {} flights pass with {} only, {} with {} only. Figures whose mean surely "
      "differs:",
      c.only_second_passed, c.second, c.only_first_passed, c.first);
  for (const CaseComparison::Difference& d : c.metrics)
    if (is_shown(d.metric) && surely_not_zero(d.mean))
      page.differences.push_back({label_of(d.metric), unit_shown(d.metric), d.mean.value,
                                  d.mean.low, d.mean.high, d.flights});
  return page;
}

}  // namespace

std::string campaign_html(const CampaignPlan& plan, const CampaignStatistics& statistics,
                          std::span<const CampaignRecord> records, const std::string& folder) {
  CampaignPage page;
  page.title = fmt::format("{}: {} draws", plan.name, plan.campaign.flights);
  for (const UncertainNumber& number : plan.campaign.uncertainty.numbers)
    page.about.emplace_back(number.quantity, words_of(number));
  for (std::size_t i = 0; i < statistics.cases.size(); ++i)
    page.cases.push_back(page_case(plan, i, statistics.cases[i], folder));
  page.distributions = distributions_of(plan, records);
  for (const CaseComparison& comparison : statistics.comparisons)
    page.comparisons.push_back(page_comparison(comparison));
  page.version = std::string(kVersion);
  page.seed = fmt::format("{}", plan.campaign.seed);
  return html(page);
}

}  // namespace quadtune::report
