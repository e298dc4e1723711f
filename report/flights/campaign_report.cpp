// SPDX-License-Identifier: Apache-2.0
#include "report/flights/campaign_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/campaign/campaign_scripts.hpp"
#include "report/flights/campaign_figures.hpp"
#include "report/flights/flight_text.hpp"
#include "report/text/rows.hpp"

namespace quadtune::report {
namespace {

using internal::finite_or_null;
using internal::Json;

/// A number that is not reached says so: JSON has no infinity.
Json reached_or_word(double x) {
  if (std::isinf(x)) return x > 0 ? "inf" : "-inf";
  return finite_or_null(x);
}

Json to_json(const Estimated& e) {
  return {{"value", reached_or_word(e.value)},
          {"low", reached_or_word(e.low)},
          {"high", reached_or_word(e.high)}};
}

Json to_json(const MetricSpread& m) {
  return {{"metric", name_of(m.metric)},
          {"unit", unit_of(m.metric)},
          {"flights", m.flights},
          {"mean", reached_or_word(m.mean)},
          {"deviation", reached_or_word(m.deviation)},
          {"least", reached_or_word(m.least)},
          {"greatest", reached_or_word(m.greatest)},
          {"p05", to_json(m.percentile_5)},
          {"median", to_json(m.median)},
          {"p95", to_json(m.percentile_95)},
          {"p99", to_json(m.percentile_99)}};
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
    cells.back().push_back(unit_shown(m.metric));
  }
  return aligned(cells, "<>>>>><") + "\n";
}

/// The strongest trends that are surely there.
std::string sensitivities_text(const CaseStatistics& of) {
  constexpr std::size_t kMost = 8;
  Cells cells = {{"  depends on", "figure", "rank correlation"}};
  for (const Sensitivity& s : of.sensitivities) {
    if (cells.size() > kMost) break;
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
      fmt::format("{} less {} in {}, on the same draws\n", c.second, c.first, c.mission);
  text += fmt::format("  {} flights pass with {} only, {} with {} only\n", c.only_second_passed,
                      c.second, c.only_first_passed, c.first);
  for (const CaseComparison::Difference& d : c.metrics) {
    if (!is_shown(d.metric) || !surely_not_zero(d.mean)) continue;
    const std::string unit = unit_shown(d.metric);
    text += fmt::format("  {:<36} {:+.3g}{}{} ({:+.3g} to {:+.3g})", label_of(d.metric),
                        d.mean.value, unit.empty() ? "" : " ", unit, d.mean.low, d.mean.high);
    // Where one of both has no figure the draw is left out, which may favour a design.
    if (d.flights < flights) text += fmt::format(", of {} draws", d.flights);
    text += "\n";
  }
  return text;
}

}  // namespace

std::string replay_command(const std::string& folder, std::uint64_t number) {
  return fmt::format("quadtune campaign replay {} --flight {} --report flight-{}.html",
                     shell_word(folder), number, number);
}

std::string to_text(const CampaignPlan& plan, const CampaignStatistics& statistics,
                    const std::string& folder) {
  std::string text =
      fmt::format("{}: {} draws of {} quantities, seed {}\n", plan.name, plan.campaign.flights,
                  plan.campaign.uncertainty.numbers.size(), plan.campaign.seed);
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
    Json entry = {
        {"design", of.design},    {"mission", of.mission},    {"law", plan.words[i].law},
        {"flights", of.flights},  {"passed", of.passed},      {"success", to_json(of.success)},
        {"ends", Json::object()}, {"metrics", Json::array()}, {"sensitivities", Json::array()},
        {"worst", Json::array()}};
    for (const auto& [end, count] : of.ends) entry["ends"][end] = count;
    for (const MetricSpread& m : of.metrics) entry["metrics"].push_back(to_json(m));
    for (const Sensitivity& s : of.sensitivities)
      entry["sensitivities"].push_back({{"quantity", s.quantity},
                                        {"figure", s.figure},
                                        {"correlation", to_json(s.correlation)}});
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
                                      {"mean", to_json(d.mean)}});
    json["comparisons"].push_back(std::move(entry));
  }
  return json;
}

}  // namespace quadtune::report
