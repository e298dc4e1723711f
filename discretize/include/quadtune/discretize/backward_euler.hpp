// SPDX-License-Identifier: Apache-2.0
/// Backward Euler: the derivative at the end of the sample is what moves the state.
#pragma once

#include "quadtune/lti.hpp"

namespace quadtune {

/// Replaces the derivative by (x[k] - x[k-1]) / dt, that is s by (z - 1)/(z dt). Of first order.
/// Keeps stability at any dt, and makes stable what is unstable and fast: the left half-plane
/// becomes the disk around z = 1/2 that touches 0 and 1.
///
/// With T = (I - A dt)⁻¹:
///   A_d = T, B_d = T B dt, C_d = C T, D_d = D + C T B dt.
/// The discrete state is x[k] - dt (A x[k] + B u[k]), not the plant's state at the samples;
/// therefore C and D are always written out.
///
/// @param plant  A (nx × nx), B (nx × nu); time in seconds.
/// @param dt     Sample period [s], 0 < dt < ∞.
/// @return       The transformed plant; states and inputs keep their names; outputs too, and are
///               the states by name when C was empty.
/// @throws InvalidInput  if dt is out of range, shapes disagree, an entry is not finite, or A has a
///                       pole at 1/dt, which the transformation sends to infinity.
/// Source: Franklin, Powell, Workman 1998, section 6.1; the realization is SciPy's.
[[nodiscard]] DiscreteLti discretize_backward_euler(const ContinuousLti& plant, double dt);

}  // namespace quadtune
