// SPDX-License-Identifier: Apache-2.0
/// Whether the test runs under AddressSanitizer, which takes time and memory of its own.
#pragma once

namespace quadtune::testing {

#ifdef __SANITIZE_ADDRESS__
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace quadtune::testing
