// SPDX-License-Identifier: Apache-2.0
/// Checks that the settings of all estimators share.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "quadtune/errors.hpp"

namespace quadtune {

/// @param name  of the setting, @param unit  with a leading space, or empty
template <class T>
void require_positive(T value, const char* name, const char* unit, const std::string& where) {
  if (!(value > 0) || !std::isfinite(value))
    throw InvalidInput(where,
                       fmt::format("{} is {}{}, expected a positive number", name, value, unit));
}

/// Infinity is accepted and means no limit, or never.
template <class T>
void require_not_negative(T value, const char* name, const char* unit, const std::string& where) {
  if (!(value >= 0))
    throw InvalidInput(where, fmt::format("{} is {}{}, expected 0 or more", name, value, unit));
}

/// An infinite variance would lead to gains of NaN.
template <class T>
void require_variance(T value, const char* name, const char* unit, const std::string& where) {
  if (!(value >= 0) || !std::isfinite(value))
    throw InvalidInput(where, fmt::format("{} is {}{}, expected 0 or more and finite because it is "
                                          "a variance",
                                          name, value, unit));
}

}  // namespace quadtune
