// SPDX-License-Identifier: Apache-2.0
/// Whether two flights have the same bytes.
#pragma once

#include "quadtune/simulation/flight.hpp"
#include "same_bits.hpp"

namespace quadtune::testing {

[[nodiscard]] inline const char* first_difference(const FlightResult& a, const FlightResult& b) {
  if (a.end != b.end) return "end";
  if (!same_bits(a.end_time, b.end_time)) return "end_time";
  if (a.culprit != b.culprit) return "culprit";
  if (a.steps != b.steps) return "steps";
  if (a.events.size() != b.events.size()) return "number of events";
  for (std::size_t i = 0; i < a.events.size(); ++i)
    if (!same_bits(a.events[i].time, b.events[i].time) || a.events[i].name != b.events[i].name ||
        a.events[i].detail != b.events[i].detail)
      return "an event";
  for (int i = 0; i < 12; ++i) {
    if (!same_bits(a.final_state(i), b.final_state(i))) return "final_state";
    if (!same_bits(a.final_estimate(i), b.final_estimate(i))) return "final_estimate";
  }
  for (std::size_t i = 0; i < kMetrics; ++i)
    if (!same_bits(a.metrics.value[i], b.metrics.value[i]))
      return name_of(static_cast<Metric>(i)).c_str();
  if (a.log.columns.size() != b.log.columns.size()) return "the log's columns";
  for (std::size_t i = 0; i < a.log.columns.size(); ++i) {
    if (a.log.columns[i].values.size() != b.log.columns[i].values.size()) return "the log's length";
    for (std::size_t k = 0; k < a.log.columns[i].values.size(); ++k)
      if (!same_bits(a.log.columns[i].values[k], b.log.columns[i].values[k]))
        return a.log.columns[i].name.c_str();
  }
  return "";
}

}  // namespace quadtune::testing
