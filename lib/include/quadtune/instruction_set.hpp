// SPDX-License-Identifier: Apache-2.0
/// Which of the processor's vector instructions the kernels use.
#pragma once

#include <string_view>

namespace quadtune {

/// "AVX-512", "AVX2" or "baseline": what the loaded libraries' kernels were compiled for. On Linux
/// the dynamic loader chooses among three variants of each library.
[[nodiscard]] std::string_view instruction_set();

}  // namespace quadtune
