// SPDX-License-Identifier: Apache-2.0
#include "report/page/tuning_page.hpp"

#include <nlohmann/json.hpp>

#include "report/page/page_text.hpp"

namespace quadtune::report {
namespace {

using nlohmann::json;

// Values that are not finite become null, which the page shows as a dash.

json parameters_json(const std::vector<PageParameter>& parameters) {
  json list = json::array();
  for (const PageParameter& p : parameters)
    list.push_back({{"name", p.name},
                    {"unit", p.unit},
                    {"before", p.before},
                    {"value", p.value},
                    {"low", p.low},
                    {"high", p.high},
                    {"verdict", p.verdict},
                    {"doubtful", p.doubtful}});
  return list;
}

json checks_json(const std::vector<PageCheck>& checks) {
  json list = json::array();
  for (const PageCheck& c : checks)
    list.push_back({{"output", c.output},
                    {"samples", c.samples},
                    {"size_before", c.size_before},
                    {"size", c.size},
                    {"mean", c.mean},
                    {"correlation", c.correlation},
                    {"lag", c.lag > 0 ? json(c.lag) : json(nullptr)},
                    {"kurtosis", c.kurtosis},
                    {"failed", c.failed}});
  return list;
}

json correlations_json(const std::vector<PageCorrelation>& correlations) {
  json list = json::array();
  for (const PageCorrelation& c : correlations)
    list.push_back(
        {{"output", c.output}, {"band", c.band}, {"before", c.before}, {"after", c.after}});
  return list;
}

json profiles_json(const std::vector<PageProfile>& profiles) {
  json list = json::array();
  for (const PageProfile& p : profiles)
    list.push_back({{"name", p.name},
                    {"unit", p.unit},
                    {"logarithmic", p.logarithmic},
                    {"x", p.x},
                    {"y", p.y},
                    {"value", p.value},
                    {"low", p.low},
                    {"high", p.high},
                    {"before", p.before},
                    {"level", p.level}});
  return list;
}

}  // namespace

std::string html(const TuningPage& page) {
  json data = plots_json(page.log, page.plots);
  data["title"] = page.title;
  data["verdict"] = verdict_text(page.verdict);
  data["reasons"] = page.reasons;
  data["about"] = json::array();
  for (const auto& [key, value] : page.about) data["about"].push_back({key, value});
  data["parameters"] = parameters_json(page.parameters);
  data["unseen"] = page.unseen;
  data["checks"] = checks_json(page.checks);
  data["correlations"] = correlations_json(page.correlations);
  data["profiles"] = profiles_json(page.profiles);
  data["events"] = events_json(page.log.events);
  data["remarks"] = page.remarks;
  data["command"] = page.command;
  data["version"] = page.version;
  data["seed"] = page.seed;
  return page_html({.title = page.title,
                    .libraries = {{"vendor/uplot.min.js", "vendor/uplot.LICENSE"}},
                    .scripts = {"page.js", "plots.js", "frame.js", "cells.js", "tuning.js"},
                    .data = script_json(data)});
}

}  // namespace quadtune::report
