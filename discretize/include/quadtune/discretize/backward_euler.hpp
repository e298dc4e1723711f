// SPDX-License-Identifier: Apache-2.0
/// Backward Euler: the state advances with the derivative at the end of the sample.
#pragma once

#include "quadtune/lti.hpp"

namespace quadtune {

/// Replaces the derivative by (x[k] - x[k-1]) / dt, that is s by (z - 1)/(z dt). First order. A
/// stable plant stays stable for any dt, and fast unstable poles become stable: the left half-plane
/// is mapped to the disk with centre z = 1/2 that touches 0 and 1.
///
/// With T = (I - A dt)⁻¹:
///   A_d = T, B_d = T B dt, C_d = C T, D_d = D + C T B dt.
/// The discrete state is x[k] - dt (A x[k] + B u[k]), not the plant's state at the samples;
/// therefore C and D are always explicit.
///
/// @param plant  A (nx × nx), B (nx × nu); time in seconds.
/// @param dt     Sample period [s], 0 < dt < ∞.
/// @return       The transformed plant. Names of states, inputs and outputs are kept; if C was
///               empty, the outputs are named after the states.
/// @throws InvalidInput  if dt is out of range, shapes disagree, an entry is not finite, or A has a
///                       pole at 1/dt, which the transformation maps to infinity.
/// Source: Franklin, Powell, Workman 1998, section 6.1; the realization is that of SciPy.
[[nodiscard]] DiscreteLti discretize_backward_euler(const ContinuousLti& plant, double dt);

}  // namespace quadtune
