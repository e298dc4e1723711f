// SPDX-License-Identifier: Apache-2.0
/// What a benchmark ran on: printed above its figures, because figures without it mean nothing.
#pragma once

#include <string>

namespace quadtune::bench {

/// Processor, compiler, vector instructions, Eigen, and the BLAS and LAPACK that are really loaded,
/// one fact a line.
[[nodiscard]] std::string describe_machine();

/// OpenBLAS, where it is the BLAS, gets one thread; the reference BLAS has no more anyway.
void use_one_thread();

}  // namespace quadtune::bench
