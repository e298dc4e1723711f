// SPDX-License-Identifier: Apache-2.0
/// How often the confidence intervals of a fit contain the true value.
#pragma once

namespace quadtune::bench {

/// Prints a table with the share of 95 % intervals that contain the true value, one row per
/// parameter, from 500 simulated logs of each built-in model. Takes a minute.
void print_coverage();

}  // namespace quadtune::bench
