// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/simulation/campaign/campaign_statistics.hpp"
#include "quadtune/simulation/metric.hpp"
#include "quadtune/simulation/mission.hpp"
#include "quadtune/version.hpp"
#include "quadtune/workbench/campaign/campaign_plan.hpp"
#include "quadtune/workbench/campaign/campaign_scripts.hpp"
#include "report/flights/flights.hpp"
#include "report/page/campaign_page.hpp"
#include "report/page/report_plots.hpp"
#include "report/text/rows.hpp"

namespace quadtune::report {
namespace {

/// Whether a metric is among those that readers need first; the others are in the database.
bool is_shown(Metric metric) {
  static constexpr Metric kShown[] = {
      Metric::settling_time, Metric::overshoot,    Metric::tracking_rms,   Metric::tracking_max,
      Metric::height_max,    Metric::yaw_max,      Metric::tilt_max,       Metric::saturation_time,
      Metric::energy,        Metric::estimate_rms, Metric::touchdown_speed};
  return std::find(std::begin(kShown), std::end(kShown), metric) != std::end(kShown);
}

/// The mission's limit on a metric; NaN without one.
double limit_of(const Mission& mission, Metric metric) {
  for (const Limit& limit : mission.limits)
    if (limit.metric == metric) return limit.max;
  return std::numeric_limits<double>::quiet_NaN();
}

/// Whether an interval does not contain 0.
bool surely_not_zero(const Estimated& e) { return e.low > 0 || e.high < 0; }

/// The command that flies one flight again.
std::string replay_command(const std::string& folder, std::uint64_t number) {
  return fmt::format("quadtune campaign replay {} --flight {} --report flight-{}.html",
                     shell_word(folder), number, number);
}

using internal::Json;

/// A number that is not reached becomes a word, since JSON has no infinity.
Json reached_or_word(double x) {
  if (std::isinf(x)) return x > 0 ? "inf" : "-inf";
  return x;
}

Json estimated_json(const Estimated& e) {
  return {{"value", reached_or_word(e.value)},
          {"low", reached_or_word(e.low)},
          {"high", reached_or_word(e.high)}};
}

Json spread_json(const MetricSpread& m) {
  return {{"metric", name_of(m.metric)},
          {"unit", unit_of(m.metric)},
          {"flights", m.flights},
          {"mean", reached_or_word(m.mean)},
          {"deviation", reached_or_word(m.deviation)},
          {"least", reached_or_word(m.min)},
          {"greatest", reached_or_word(m.max)},
          {"p05", estimated_json(m.percentile_5)},
          {"median", estimated_json(m.median)},
          {"p95", estimated_json(m.percentile_95)},
          {"p99", estimated_json(m.percentile_99)}};
}

std::string metrics_text(const CaseStatistics& of, const Mission& mission) {
  Cells cells = {{"", "5 %", "median", "95 %", "99 %", "limit", "unit"}};
  for (const MetricSpread& m : of.metrics) {
    if (!is_shown(m.metric)) continue;
    cells.push_back({"  " + label_of(m.metric)});
    for (const Estimated& e : {m.percentile_5, m.median, m.percentile_95, m.percentile_99})
      cells.back().push_back(reached(e.value, ".3g"));
    const double limit = limit_of(mission, m.metric);
    cells.back().push_back(std::isnan(limit) ? "" : reached(limit, ".3g"));
    cells.back().push_back(unit_text(unit_of(m.metric)));
  }
  return aligned(cells, "<>>>>><") + "\n";
}

/// The strongest significant trends.
std::string sensitivities_text(const CaseStatistics& of) {
  constexpr std::size_t kMax = 8;
  Cells cells = {{"  depends on", "metric", "rank correlation"}};
  for (const Sensitivity& s : of.sensitivities) {
    if (cells.size() > kMax) break;
    if (surely_not_zero(s.correlation))
      cells.push_back({"  " + s.quantity, s.figure,
                       fmt::format("{:+.2f}  ({:+.2f} to {:+.2f})", s.correlation.value,
                                   s.correlation.low, s.correlation.high)});
  }
  return cells.size() == 1 ? "" : aligned(cells, "<") + "\n";
}

std::string case_text(const CampaignPlan& plan, std::size_t index, const CaseStatistics& of,
                      const std::string& folder) {
  std::string text = fmt::format(
      "{} in {}: {} of {} flights pass, {:.4g} % ({:.4g} to {:.4g} %)\n  {}; {}\n", of.design,
      of.mission, of.passed, of.flights, 100 * of.success.value, 100 * of.success.low,
      100 * of.success.high, plan.words[index].law, surroundings(plan.words[index]));
  for (const auto& [end, count] : of.ends)
    if (of.ends.size() > 1 || of.passed < of.flights)
      text += fmt::format("  {:>8}  {}\n", count, end);
  text += "\n" + metrics_text(of, plan.campaign.cases[index].setup.mission);
  if (const std::string trends = sensitivities_text(of); !trends.empty()) text += "\n" + trends;
  if (!of.worst.empty()) text += "\n  worst\n";
  for (const WorstFlight& worst : of.worst)
    text += fmt::format("  {}\n    {}\n", worst.why, replay_command(folder, worst.number));
  return text;
}

std::string comparison_text(const CaseComparison& c, std::uint64_t flights) {
  std::string text =
      fmt::format("{} minus {} in {}, on the same draws\n", c.second, c.first, c.mission);
  text += fmt::format("  {} flights pass with {} only, {} with {} only\n", c.only_second_passed,
                      c.second, c.only_first_passed, c.first);
  for (const CaseComparison::Difference& d : c.metrics) {
    if (!is_shown(d.metric) || !surely_not_zero(d.mean)) continue;
    const std::string unit = unit_text(unit_of(d.metric));
    text += fmt::format("  {:<36} {:+.3g}{}{} ({:+.3g} to {:+.3g})", label_of(d.metric),
                        d.mean.value, unit.empty() ? "" : " ", unit, d.mean.low, d.mean.high);
    // A draw in which one of both has no value is omitted, which may favour one design.
    if (d.flights < flights) text += fmt::format(", in {} draws", d.flights);
    text += "\n";
  }
  return text;
}

}  // namespace

std::string to_text(const CampaignPlan& plan, const CampaignStatistics& statistics,
                    const std::string& folder) {
  std::string text = fmt::format(
      "{}: {} of {}, seed {}\n", plan.name, internal::counted(plan.campaign.flights, "draw"),
      internal::counted(plan.campaign.uncertainty.numbers.size(), "quantity", "quantities"),
      plan.campaign.seed);
  for (std::size_t i = 0; i < statistics.cases.size(); ++i)
    text += "\n" + case_text(plan, i, statistics.cases[i], folder);
  for (const CaseComparison& comparison : statistics.comparisons)
    text += "\n" + comparison_text(comparison, plan.campaign.flights);
  return text;
}

Json to_json(const CampaignPlan& plan, const CampaignStatistics& statistics,
             const std::string& folder) {
  Json json = {{"name", plan.name},          {"flights", plan.campaign.flights},
               {"seed", plan.campaign.seed}, {"quantities", Json::array()},
               {"cases", Json::array()},     {"comparisons", Json::array()}};
  for (const UncertainNumber& number : plan.campaign.uncertainty.numbers)
    json["quantities"].push_back(number.quantity);
  for (std::size_t i = 0; i < statistics.cases.size(); ++i) {
    const CaseStatistics& of = statistics.cases[i];
    Json entry = {{"design", of.design},
                  {"mission", of.mission},
                  {"law", plan.words[i].law},
                  {"flights", of.flights},
                  {"passed", of.passed},
                  {"success", estimated_json(of.success)},
                  {"ends", Json::object()},
                  {"metrics", Json::array()},
                  {"sensitivities", Json::array()},
                  {"worst", Json::array()}};
    for (const auto& [end, count] : of.ends) entry["ends"][end] = count;
    for (const MetricSpread& m : of.metrics) entry["metrics"].push_back(spread_json(m));
    for (const Sensitivity& s : of.sensitivities)
      entry["sensitivities"].push_back({{"quantity", s.quantity},
                                        {"figure", s.figure},
                                        {"correlation", estimated_json(s.correlation)}});
    for (const WorstFlight& worst : of.worst)
      entry["worst"].push_back({{"number", worst.number},
                                {"why", worst.why},
                                {"replay", replay_command(folder, worst.number)}});
    json["cases"].push_back(std::move(entry));
  }
  for (const CaseComparison& c : statistics.comparisons) {
    Json entry = {{"mission", c.mission},
                  {"first", c.first},
                  {"second", c.second},
                  {"only_first_passed", c.only_first_passed},
                  {"only_second_passed", c.only_second_passed},
                  {"differences", Json::array()}};
    for (const CaseComparison::Difference& d : c.metrics)
      entry["differences"].push_back({{"metric", name_of(d.metric)},
                                      {"unit", unit_of(d.metric)},
                                      {"flights", d.flights},
                                      {"mean", estimated_json(d.mean)}});
    json["comparisons"].push_back(std::move(entry));
  }
  return json;
}

namespace {

/// "normal, mean 1, deviation 0.05, minimum 0.9"
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
  if (std::isfinite(d.min)) text += fmt::format(", minimum {:.4g}", d.min);
  if (std::isfinite(d.max)) text += fmt::format(", maximum {:.4g}", d.max);
  return unit == "1" ? text : fmt::format("{} [{}]", text, unit);
}

/// Significant rank correlations: one row for each quantity, one column for each metric.
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
      page.metrics.push_back({label_of(m.metric), unit_text(unit_of(m.metric)),
                              m.percentile_5.value, m.median.value, m.percentile_95.value,
                              m.percentile_99.value,
                              limit_of(plan.campaign.cases[index].setup.mission, m.metric)});
  page.trends = trends_of(plan, of);
  for (const WorstFlight& worst : of.worst)
    page.worst.push_back({worst.why, replay_command(folder, worst.number)});
  return page;
}

/// The finite values of a metric at evenly spaced shares of the flights in which it is defined.
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
  constexpr std::size_t kMax = 200;
  if (values.size() <= kMax) {
    curve.x = std::move(values);
  } else {
    for (std::size_t i = 0; i <= kMax; ++i)
      curve.x.push_back(values[i * (values.size() - 1) / kMax]);
  }
  return curve;
}

/// One chart for each metric and mission, with a curve for each design.
std::vector<PageDistribution> distributions_of(const CampaignPlan& plan,
                                               std::span<const CampaignRecord> records) {
  std::vector<PageDistribution> all;
  const std::vector<CampaignCase>& cases = plan.campaign.cases;
  for (const Metric metric : {Metric::tracking_rms, Metric::tracking_max, Metric::height_max,
                              Metric::tilt_max, Metric::settling_time, Metric::energy})
    for (std::size_t first = 0; first < cases.size(); ++first) {
      // One chart for each mission, made at its first case.
      const auto same = [&](std::size_t c) { return cases[c].mission == cases[first].mission; };
      bool seen = false;
      for (std::size_t c = 0; c < first; ++c) seen = seen || same(c);
      if (seen) continue;
      PageDistribution chart{label_of(metric),
                             cases[first].mission,
                             unit_text(unit_of(metric)),
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
  page.title = fmt::format("{} minus {} in {}", c.second, c.first, c.mission);
  page.passes = fmt::format(
      "On the same draws; {} flights pass with {} only, {} with {} only. Metrics whose mean "
      "differs significantly:",
      c.only_second_passed, c.second, c.only_first_passed, c.first);
  for (const CaseComparison::Difference& d : c.metrics)
    if (is_shown(d.metric) && surely_not_zero(d.mean))
      page.differences.push_back({label_of(d.metric), unit_text(unit_of(d.metric)), d.mean.value,
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
