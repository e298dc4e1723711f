// SPDX-License-Identifier: Apache-2.0
/// Computation of disk margins.
#pragma once

#include "quadtune/synthesis/margins.hpp"

namespace quadtune::internal {

/// Computes the disk margin from the peak of S + (skew - 1)/2: Seiler, Packard, Gahinet 2020,
/// equations 8 and 13.
[[nodiscard]] DiskMargin disk_of_peak(double peak, double w, double skew);

/// Computes the disk margin of a stable loop with one channel.
[[nodiscard]] DiskMargin disk_margin(const OpenLoop& loop, double skew);

/// Whether the closed loop is stable, including the effect of a delay.
[[nodiscard]] bool closed_loop_is_stable(const OpenLoop& loop);

}  // namespace quadtune::internal
