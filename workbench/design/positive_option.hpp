// SPDX-License-Identifier: Apache-2.0
/// Validates options that are positive numbers.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "quadtune/errors.hpp"

namespace quadtune {

/// @throws OptionError  unless 0 < value < ∞.
inline void require_positive_option(const std::string& key, double value, const char* unit) {
  if (!(value > 0) || !std::isfinite(value))
    throw OptionError(key,
                      fmt::format("{} is {}, expected a positive number of {}", key, value, unit));
}

}  // namespace quadtune
