// SPDX-License-Identifier: Apache-2.0
/// Limits of a flight in files: a limit of an angle above pi was probably given in degrees.
#pragma once

#include <fmt/format.h>

#include <numbers>

#include "quadtune/errors.hpp"
#include "quadtune/internal/toml_reader.hpp"
#include "quadtune/simulation/metric.hpp"

namespace quadtune::internal {

/// The limit of a metric from a table that has its key.
/// @throws InvalidInput  if it is not in the range, or the limit of an angle and above pi
[[nodiscard]] inline double read_limit(const TomlTable& table, Metric metric, const Range& range) {
  const std::string key = limit_key(metric);
  const double limit = table.number(key, range);
  if (unit_of(metric) != "rad" || !(limit > std::numbers::pi)) return limit;
  throw InvalidInput(
      table.where(key),
      fmt::format("{} is {:.6g} rad, expected at most 3.14159 rad, because no angle is larger; "
                  "{:.6g} degrees are {:.4g} rad",
                  key, limit, limit, limit * std::numbers::pi / 180));
}

}  // namespace quadtune::internal
