// SPDX-License-Identifier: Apache-2.0
/// Tustin's method (bilinear transformation): the trapezoidal rule applied to a plant.
#pragma once

#include <optional>

#include "quadtune/lti.hpp"

namespace quadtune {

/// Replaces s by (2/h) (z - 1)/(z + 1), h = dt. Preserves stability, and
/// H_d(e^(jw dt)) = H(j (2/h) tan(w dt/2)).
///
/// With T = (I - A h/2)⁻¹:
///   A_d = T (I + A h/2), B_d = T B h, C_d = C T, D_d = D + C T B h/2.
/// The discrete state is not the plant's state at the samples, but x[k] - (h/2) (A x[k] + B u[k]);
/// therefore C and D are always explicit in the result, and a state-feedback gain designed on it
/// does not apply to measured states. Use discretize_zoh() for that.
///
/// @param plant    A (nx × nx), B (nx × nu); time in seconds.
/// @param dt       Sample period [s], 0 < dt < ∞.
/// @param prewarp  Frequency w [rad/s], 0 < w < π/dt, at which the response equals that of the
///                 plant: h = (2/w) tan(w dt/2).
/// @return         The transformed plant. Names of states, inputs and outputs are kept; if C was
///                 empty, the outputs are named after the states.
/// @throws InvalidInput  if dt or prewarp is out of range, shapes disagree, an entry is not finite,
///                       or A has a pole at 2/h, which the transformation maps to infinity.
/// Source: Tustin 1947; the realization is that of SciPy.
[[nodiscard]] DiscreteLti discretize_tustin(const ContinuousLti& plant, double dt,
                                            std::optional<double> prewarp = {});

}  // namespace quadtune
