// SPDX-License-Identifier: Apache-2.0
/// The machine of a benchmark: printed above its results, which have no meaning without it.
#pragma once

#include <string>

namespace quadtune::bench {

/// Processor, compiler, vector instructions, Eigen, and the BLAS and LAPACK that are actually
/// loaded, one fact per line.
[[nodiscard]] std::string describe_machine();

/// If OpenBLAS is the BLAS, limits it to one thread; the reference BLAS has only one.
void use_one_thread();

}  // namespace quadtune::bench
