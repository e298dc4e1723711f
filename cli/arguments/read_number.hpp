// SPDX-License-Identifier: Apache-2.0
/// Numbers of the command line, read as in files.
#pragma once

#include "quadtune/internal/words.hpp"

namespace quadtune::cli {

using internal::read_number;

}  // namespace quadtune::cli
