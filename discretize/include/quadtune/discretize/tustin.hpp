// SPDX-License-Identifier: Apache-2.0
/// Tustin's method (bilinear transformation): the trapezoidal rule applied to a plant.
#pragma once

#include "quadtune/lti.hpp"

namespace quadtune {

/// Replaces s by (2/dt) (z - 1)/(z + 1). Keeps stability, and H_d(e^(jw dt)) = H(j (2/dt) tan(w
/// dt/2)).
///
/// With T = (I - A dt/2)⁻¹:
///   A_d = T (I + A dt/2), B_d = T B dt, C_d = C T, D_d = D + C T B dt/2.
/// The discrete state is not the plant's state at the samples, but x[k] - (dt/2) (A x[k] + B u[k]);
/// therefore C and D are always written out in the result, and a state-feedback gain that was
/// designed on it does not apply to measured states. Use discretize_zoh() for that.
///
/// @param plant  A (nx × nx), B (nx × nu); time in seconds.
/// @param dt     Sample period [s], 0 < dt < ∞.
/// @return       The transformed plant; states and inputs keep their names; outputs too, and are
///               the states by name when C was empty.
/// @throws InvalidInput  if dt is out of range, shapes disagree, an entry is not finite, or A has a
///                       pole at 2/dt, which the transformation sends to infinity.
/// Source: Tustin 1947; the realization is SciPy's and Octave's.
[[nodiscard]] DiscreteLti discretize_tustin(const ContinuousLti& plant, double dt);

}  // namespace quadtune
