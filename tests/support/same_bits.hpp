// SPDX-License-Identifier: Apache-2.0
/// Numbers that are the same to the last bit.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace quadtune::testing {

/// Whether two numbers have the same bits, the sign of a zero with them; all NaN are one.
[[nodiscard]] inline bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) ||
         (std::isnan(a) && std::isnan(b));
}

}  // namespace quadtune::testing
