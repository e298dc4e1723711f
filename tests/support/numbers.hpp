// SPDX-License-Identifier: Apache-2.0
/// Numbers that many tests use.
#pragma once

#include <limits>
#include <numbers>

namespace quadtune::testing {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kPi = std::numbers::pi;

}  // namespace quadtune::testing
