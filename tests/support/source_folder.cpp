// SPDX-License-Identifier: Apache-2.0
#include "source_folder.hpp"

namespace quadtune::testing {

std::string source_folder() { return QUADTUNE_SOURCE_DIR; }

}  // namespace quadtune::testing
