// SPDX-License-Identifier: Apache-2.0
/// Whether the test runs under AddressSanitizer, which needs additional time and memory.
#pragma once

namespace quadtune::testing {

#ifdef __SANITIZE_ADDRESS__
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace quadtune::testing
