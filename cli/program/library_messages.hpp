// SPDX-License-Identifier: Apache-2.0
/// What libraries would print beside the program.
#pragma once

namespace quadtune::cli {

/// From now on they print nothing but what ends the process: the error stream is the program's, and
/// `--quiet` holds for it.
void silence_libraries();

}  // namespace quadtune::cli
