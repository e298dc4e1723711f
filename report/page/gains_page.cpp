// SPDX-License-Identifier: Apache-2.0
#include "report/page/gains_page.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "report/page/page_text.hpp"

namespace quadtune::report {
namespace {

using nlohmann::json;

/// JSON has no infinity: a value that was not reached becomes "never".
json shown_gain(double x) { return std::isinf(x) ? json("never") : json(x); }

json table_json(const PageComparedTable& table) {
  json rows = json::array();
  for (const PageCompared& r : table.rows) {
    json values = json::array();
    for (const double x : r.values) values.push_back(shown_gain(x));
    rows.push_back({{"of", r.of},
                    {"label", r.label},
                    {"unit", r.unit},
                    {"values", std::move(values)},
                    {"limit", shown_gain(r.limit)},
                    {"at_least", r.at_least},
                    {"broken", r.broken},
                    {"binds", r.binds},
                    {"main", r.main}});
  }
  return {
      {"id", table.id}, {"title", table.title}, {"hint", table.hint}, {"rows", std::move(rows)}};
}

}  // namespace

std::string html(const GainsPage& page) {
  json data = {{"rows", 0}, {"kept", 0}, {"flown", json::array()}};
  for (const PageFlown& flown : page.flown) {
    json plots = plots_json(flown.log, {flown.plot});
    if (plots["plots"].empty()) continue;
    for (const char* count : {"rows", "kept"})
      data[count] = data[count].get<std::size_t>() + plots[count].get<std::size_t>();
    plots["events"] = events_json(flown.log.events);
    data["flown"].push_back(std::move(plots));
  }
  data["title"] = page.title;
  data["verdict"] = verdict_text(page.verdict);
  data["counts"] = page.counts;
  data["reasons"] = page.reasons;
  data["columns_of"] = page.columns;
  data["tables"] = json::array();
  for (const PageComparedTable& table : page.tables) data["tables"].push_back(table_json(table));
  data["search"] = {{"evaluation", page.search.evaluation},
                    {"best", page.search.best},
                    {"tried", page.search.tried}};
  data["about"] = json::array();
  for (const auto& [key, value] : page.about) data["about"].push_back({key, value});
  data["command"] = page.command;
  data["version"] = page.version;
  data["seed"] = page.seed;
  return page_html({.title = page.title,
                    .libraries = {{"vendor/uplot.min.js", "vendor/uplot.LICENSE"}},
                    .scripts = {"page.js", "plots.js", "frame.js", "cells.js", "gains.js"},
                    .data = script_json(data)});
}

}  // namespace quadtune::report
