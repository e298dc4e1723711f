// SPDX-License-Identifier: Apache-2.0
/// Bitwise comparison of numbers.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace quadtune::testing {

/// Whether two numbers have the same bits, including the sign of a zero; all NaN are equal.
[[nodiscard]] inline bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) ||
         (std::isnan(a) && std::isnan(b));
}

}  // namespace quadtune::testing
