// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace quadtune::testing {

/// The source tree that the tests were built from. Only one source file is compiled with its name,
/// so that the objects of all others do not depend on its location, as a compiler cache requires.
[[nodiscard]] std::string source_folder();

}  // namespace quadtune::testing
