// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/metric.hpp"

#include <algorithm>

namespace quadtune {
namespace {

struct NameAndUnit {
  std::string name;
  std::string unit;
};

// In the order of the enumeration.
const std::array<NameAndUnit, kMetrics>& table() {
  static const std::array<NameAndUnit, kMetrics> all = {
      {{"duration", "s"},          {"settling_time", "s"},  {"overshoot", "1"},
       {"yaw_overshoot", "1"},     {"tracking_rms", "m"},   {"tracking_max", "m"},
       {"height_rms", "m"},        {"height_max", "m"},     {"yaw_rms", "rad"},
       {"yaw_max", "rad"},         {"tilt_max", "rad"},     {"speed_max", "m/s"},
       {"saturation_time", "s"},   {"energy", "J"},         {"estimate_rms", "m"},
       {"estimate_max", "m"},      {"position_drift", "m"}, {"final_distance", "m"},
       {"touchdown_speed", "m/s"}, {"height_peak", "m"}}};
  return all;
}

}  // namespace

const std::string& name_of(Metric metric) { return table()[static_cast<std::size_t>(metric)].name; }
const std::string& unit_of(Metric metric) { return table()[static_cast<std::size_t>(metric)].unit; }

std::vector<std::string> metric_names() {
  std::vector<std::string> names;
  names.reserve(kMetrics);
  for (const NameAndUnit& entry : table()) names.push_back(entry.name);
  return names;
}

std::optional<Metric> metric_of(const std::string& name) {
  for (std::size_t i = 0; i < kMetrics; ++i)
    if (table()[i].name == name) return static_cast<Metric>(i);
  return std::nullopt;
}

std::string limit_key(Metric metric) {
  std::string key = name_of(metric);
  if (!key.ends_with("_max")) key += "_max";
  std::string unit = unit_of(metric);
  if (unit == "1") return key;
  if (unit == "m/s") unit = "m_per_s";
  return key + "_" + unit;
}

}  // namespace quadtune
