// SPDX-License-Identifier: Apache-2.0
#include "report/page/campaign_page.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "report/page/page_text.hpp"

namespace quadtune::report {
namespace {

using nlohmann::json;

/// JSON has no infinity: a value that was not reached becomes "never".
json shown(double x) { return std::isinf(x) ? json("never") : json(x); }

json spread_json(const PageSpread& m) {
  return {{"label", m.label},          {"unit", m.unit},      {"p05", shown(m.p05)},
          {"median", shown(m.median)}, {"p95", shown(m.p95)}, {"p99", shown(m.p99)},
          {"limit", m.limit}};
}

json case_json(const PageCase& c) {
  json of = {{"design", c.design},
             {"mission", c.mission},
             {"law", c.law},
             {"flights", c.flights},
             {"passed", c.passed},
             {"rate", c.rate},
             {"low", c.low},
             {"high", c.high},
             {"ends", json::array()},
             {"metrics", json::array()},
             {"trends",
              {{"figures", c.trends.figures},
               {"quantities", c.trends.quantities},
               {"values", c.trends.values}}},
             {"worst", json::array()}};
  for (const auto& [end, count] : c.ends) of["ends"].push_back({end, count});
  for (const PageSpread& m : c.metrics) of["metrics"].push_back(spread_json(m));
  for (const PageWorst& w : c.worst)
    of["worst"].push_back({{"why", w.why}, {"command", w.command}});
  return of;
}

json distribution_json(const PageDistribution& d) {
  json of = {{"label", d.label},
             {"mission", d.mission},
             {"unit", d.unit},
             {"limit", d.limit},
             {"curves", json::array()}};
  for (const PageDistribution::Curve& curve : d.curves)
    of["curves"].push_back({{"design", curve.design}, {"x", curve.x}, {"reached", curve.reached}});
  return of;
}

json comparison_json(const PageComparison& c) {
  json of = {{"title", c.title}, {"passes", c.passes}, {"differences", json::array()}};
  for (const PageComparison::Difference& d : c.differences)
    of["differences"].push_back({{"label", d.label},
                                 {"unit", d.unit},
                                 {"mean", d.mean},
                                 {"low", d.low},
                                 {"high", d.high},
                                 {"draws", d.draws}});
  return of;
}

}  // namespace

std::string html(const CampaignPage& page) {
  json data = {{"title", page.title},
               {"verdict", "none"},
               {"reasons", json::array()},
               {"plots", json::array()},
               {"rows", 0},
               {"kept", 0},
               {"about", json::array()},
               {"cases", json::array()},
               {"distributions", json::array()},
               {"comparisons", json::array()},
               {"command", ""},
               {"version", page.version},
               {"seed", page.seed}};
  for (const auto& [key, value] : page.about) data["about"].push_back({key, value});
  for (const PageCase& c : page.cases) data["cases"].push_back(case_json(c));
  for (const PageDistribution& d : page.distributions)
    data["distributions"].push_back(distribution_json(d));
  for (const PageComparison& c : page.comparisons)
    data["comparisons"].push_back(comparison_json(c));
  return page_html({.title = page.title,
                    .libraries = {{"vendor/uplot.min.js", "vendor/uplot.LICENSE"}},
                    .scripts = {"page.js", "plots.js", "frame.js", "cells.js", "campaign.js"},
                    .data = script_json(data)});
}

}  // namespace quadtune::report
