// SPDX-License-Identifier: Apache-2.0
/// Whether the test runs under AddressSanitizer, or in a build that counts the lines that run: both
/// need additional time and memory.
#pragma once

namespace quadtune::testing {

#if defined(__SANITIZE_ADDRESS__) || defined(QUADTUNE_COUNTS_LINES)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace quadtune::testing
