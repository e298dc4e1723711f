// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/missions/mission_requirements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/limit_reader.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/toml_reader.hpp"
#include "quadtune/internal/uncertainty_reader.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"

namespace quadtune {
namespace {

using internal::Range;
using internal::TomlTable;

MarginLimits read_margins(const TomlTable& table) {
  table.allow({{"Ms_max"},
               {"phase_margin_min", "deg"},
               {"gain_margin_min", "dB"},
               {"delay_margin_min", "s"}});
  MarginLimits limits;
  const Range above_one{1, Range::Bound::open, 0, Range::Bound::none};
  if (table.has("Ms_max")) limits.Ms_max = table.number("Ms_max", above_one);
  if (table.has("phase_margin_min_deg"))
    limits.phase_min =
        table.number("phase_margin_min_deg", {0, Range::Bound::open, 180, Range::Bound::open}) *
        std::numbers::pi / 180;
  if (table.has("gain_margin_min_dB"))
    limits.gain_min = std::pow(
        10, table.number("gain_margin_min_dB", {0, Range::Bound::open, 100, Range::Bound::closed}) /
                20);
  if (table.has("delay_margin_min_s"))
    limits.delay_min = table.number("delay_margin_min_s", Range::positive());
  return limits;
}

std::vector<CostTerm> read_cost(const TomlTable& table, MissionRequirements& requirements) {
  std::vector<internal::TomlKey> keys = {{"measure"}, {"quantile"}, {"draws"}};
  for (const std::string& name : metric_names()) keys.push_back({name});
  table.allow(keys);
  if (table.has("measure"))
    requirements.measure = robust_measure(table.text("measure"), table.where("measure"));
  requirements.share =
      table.number_or("quantile", requirements.share,
                      {kMinTail, Range::Bound::closed, 1 - kMinTail, Range::Bound::closed});
  if (table.has("draws"))
    requirements.draws = static_cast<std::uint32_t>(table.integer("draws", 1, 100000));
  std::vector<CostTerm> cost;
  for (const std::string& name : metric_names())
    if (table.has(name))
      cost.push_back({*metric_of(name), table.number(name, Range::not_negative())});
  if (cost.empty()) return requirements.cost;
  if (std::all_of(cost.begin(), cost.end(), [](const CostTerm& t) { return t.weight == 0; }))
    throw InvalidInput(table.where(), "no metric of [cost] has a weight above 0");
  return cost;
}

std::vector<Limit> read_limits(const TomlTable& table) {
  std::vector<internal::TomlKey> keys;
  for (std::size_t m = 0; m < kMetrics; ++m)
    if (static_cast<Metric>(m) != Metric::duration)  // that of the mission
      keys.push_back({limit_key(static_cast<Metric>(m))});
  table.allow(keys);
  std::vector<Limit> limits;
  for (std::size_t m = 0; m < kMetrics; ++m) {
    const std::string key = limit_key(static_cast<Metric>(m));
    const auto metric = static_cast<Metric>(m);
    if (table.has(key))
      limits.push_back({metric, internal::read_limit(table, metric, Range::not_negative())});
  }
  return limits;
}

/// The mission's limits, replaced by those of the file with the same metric.
std::vector<Limit> with_limits(std::vector<Limit> limits, const std::vector<Limit>& instead) {
  for (const Limit& limit : instead) {
    const auto same = std::find_if(limits.begin(), limits.end(),
                                   [&](const Limit& l) { return l.metric == limit.metric; });
    if (same == limits.end())
      limits.push_back(limit);
    else
      *same = limit;
  }
  return limits;
}

void add_limits(const MarginLimits& limits, const NamedMargins& loop,
                std::vector<DesignLimit>& all) {
  const LoopMargins& m = loop.margins;
  const auto add = [&](const char* what, double value, const std::optional<double>& bound,
                       bool at_least, double min = 0) {
    if (bound)
      all.push_back({fmt::format("{} of {}", what, loop.name),
                     m.stable ? value : std::numeric_limits<double>::quiet_NaN(), *bound, at_least,
                     min});
  };
  add("Ms", m.Ms, limits.Ms_max, false, 1);
  add("phase margin", m.phase_margin, limits.phase_min, true);
  add("gain margin", m.gain_margin, limits.gain_min, true);
  add("delay margin", m.delay_margin, limits.delay_min, true);
}

}  // namespace

MissionRequirements read_requirements(const std::filesystem::path& path) {
  const TomlTable file = TomlTable::parse(
      internal::read_text_file(path.string(), internal::kTomlLimit), path.string());
  file.allow({{"cost"}, {"margins"}, {"loops"}, {"mission"}, {"vary"}, {"correlation"}});
  const std::filesystem::path folder = path.parent_path();
  MissionRequirements requirements;
  if (const auto cost = file.maybe_table("cost"))
    requirements.cost = read_cost(*cost, requirements);
  if (const auto margins = file.maybe_table("margins"))
    requirements.margins = read_margins(*margins);
  if (const auto loops = file.maybe_table("loops")) {
    requirements.where = loops->where();
    for (const std::string& name : loops->keys())
      requirements.loops[name] = read_margins(loops->table(name));
  }
  for (const TomlTable& table : file.tables("mission")) {
    CampaignMission mission = read_campaign_mission(table, folder, {{"limits"}});
    std::vector<Limit> limits;
    if (const auto written = table.maybe_table("limits")) limits = read_limits(*written);
    requirements.limits.push_back(with_limits(mission.mission.limits, limits));
    requirements.missions.push_back(std::move(mission));
  }
  requirements.uncertainty = internal::read_uncertainty(file, folder);
  return requirements;
}

void require_flight_words(const MissionWords& words) {
  FlightOptions flight;
  flight.estimator = words.estimator;
  flight.sensors = words.sensors;
  if (!words.wind.empty()) flight.wind = words.wind;
  require_flight_words(flight);
}

MissionRequirements mission_requirements(const MissionWords& words) {
  MissionRequirements requirements;
  if (!words.requirements.empty()) requirements = read_requirements(words.requirements);
  // The missions of the file have their own flights, so these words would be ignored.
  const std::pair<const char*, bool> given[] = {{"mission", !words.missions.empty()},
                                                {"estimator", !words.estimator.empty()},
                                                {"sensors", !words.sensors.empty()},
                                                {"wind", !words.wind.empty()},
                                                {"duration", words.duration.has_value()}};
  for (const auto& [key, came] : given)
    if (came && !requirements.missions.empty())
      throw OptionError(key, fmt::format("{} cannot be combined with requirements that have "
                                         "[[mission]]; set it there",
                                         key));
  for (const std::string& name : words.missions) {
    if (std::count(words.missions.begin(), words.missions.end(), name) > 1)
      throw OptionError("mission", fmt::format("mission {} is given twice, expected once",
                                               internal::printable(name)));
    CampaignMission mission;
    mission.mission = load_mission(name);
    mission.where = "--mission";
    mission.arguments.estimator = words.estimator;
    mission.arguments.sensors = words.sensors;
    if (!words.wind.empty()) mission.arguments.wind = words.wind;
    mission.arguments.duration = words.duration;
    requirements.limits.push_back(mission.mission.limits);
    requirements.missions.push_back(std::move(mission));
  }
  if (requirements.missions.empty())
    throw OptionError("mission",
                      "mission is missing, expected a mission, or requirements with [[mission]]");
  if (!words.measure.empty()) {
    try {
      requirements.measure = robust_measure(words.measure, "measure");
    } catch (const InvalidInput& error) {
      throw OptionError("measure", error.what());
    }
  }
  return requirements;
}

std::vector<DesignLimit> margin_limits(const MissionRequirements& requirements,
                                       const std::vector<NamedMargins>& loops,
                                       const std::vector<NamedMargins>& start) {
  std::vector<std::string> known;
  known.reserve(loops.size());
  for (const NamedMargins& loop : loops) known.push_back(loop.name);
  for (const auto& [name, limits] : requirements.loops)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw InvalidInput(
          requirements.where,
          fmt::format("no loop '{}'; expected one or more of {}{}", internal::printable(name),
                      internal::joined(known, ", "), internal::did_you_mean(name, known)));
  std::vector<DesignLimit> all;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    const auto own = requirements.loops.find(loops[i].name);
    if (requirements.margins) add_limits(*requirements.margins, loops[i], all);
    if (own != requirements.loops.end()) add_limits(own->second, loops[i], all);
    if (!requirements.margins && requirements.loops.empty()) {
      MarginLimits as_start;
      as_start.Ms_max = start[i].margins.Ms * (1 + 1e-6);
      add_limits(as_start, loops[i], all);
    }
  }
  return all;
}

}  // namespace quadtune
