// SPDX-License-Identifier: Apache-2.0
/// Forward Euler: the first-order approximation that many flight codes use.
#pragma once

#include "quadtune/lti.hpp"

namespace quadtune {

/// Replaces the derivative by (x[k+1] - x[k]) / dt. First order: a stable plant may become unstable
/// if dt is long compared with its time constants.
///
/// @param plant  A (nx × nx), B (nx × nu); time in seconds.
/// @param dt     Sample period [s], 0 < dt < ∞.
/// @return       A_d = I + A dt, B_d = B dt; C, D, names and units unchanged.
/// @throws InvalidInput  if dt is out of range, shapes disagree, an entry is not finite, or an
///                       entry of the result exceeds the range of a double.
[[nodiscard]] DiscreteLti discretize_euler(const ContinuousLti& plant, double dt);

}  // namespace quadtune
