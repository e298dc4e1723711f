// SPDX-License-Identifier: Apache-2.0
/// How often the intervals of a fit hold the truth.
#pragma once

namespace quadtune::bench {

/// 500 simulated logs of each built-in model, a table with the share of intervals of 95 % that hold
/// the truth, a row a parameter. Takes a minute.
void print_coverage();

}  // namespace quadtune::bench
