// SPDX-License-Identifier: Apache-2.0
/// The ends of a disk margin.
#pragma once

#include "quadtune/synthesis/margins.hpp"

namespace quadtune::internal {

/// The disk's ends from the peak of S + (skew - 1)/2: Seiler, Packard, Gahinet 2020, equations 8
/// and 13.
[[nodiscard]] DiskMargin disk_of_peak(double peak, double w, double skew);

/// Of a stable loop of one channel.
[[nodiscard]] DiskMargin disk_margin(const OpenLoop& loop, double skew);

/// Whether the loop is stable when closed; with a delay, too.
[[nodiscard]] bool closed_loop_is_stable(const OpenLoop& loop);

}  // namespace quadtune::internal
