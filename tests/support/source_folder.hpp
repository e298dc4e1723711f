// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace quadtune::testing {

/// The source tree that the tests were built from. One source file alone is compiled with its name,
/// so that the objects of all others are the same wherever the tree lies, as a compiler's cache
/// wants them.
[[nodiscard]] std::string source_folder();

}  // namespace quadtune::testing
