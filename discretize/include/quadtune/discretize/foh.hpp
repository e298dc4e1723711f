// SPDX-License-Identifier: Apache-2.0
/// First-order hold: the exact discrete model of a plant whose inputs are linear between samples.
#pragma once

#include "quadtune/lti.hpp"

namespace quadtune {

/// Samples ẋ = Ax + Bu exactly for inputs that are linear between samples (triangle hold). A may be
/// singular.
///
/// With B₁ = ∫₀^dt e^(A(dt-τ)) (τ/dt) dτ B and B₀ = ∫₀^dt e^(Aτ) dτ B - B₁, the samples satisfy
/// x[k+1] = A_d x[k] + B₀ u[k] + B₁ u[k+1]. The state x[k] - B₁ u[k] eliminates the input of the
/// next sample:
///   A_d = e^(A dt), B_d = B₀ + A_d B₁, C_d = C, D_d = D + C B₁.
/// Therefore C and D are always explicit, and a state-feedback gain designed on the result does not
/// apply to measured states. A computer does not produce such inputs (use discretize_zoh() for
/// those): this method is for measured inputs and for discretizing continuous controllers.
///
/// @param plant  A (nx × nx), B (nx × nu); time in seconds.
/// @param dt     Sample period [s], 0 < dt < ∞.
/// @return       The sampled plant. Names of states, inputs and outputs are kept; if C was empty,
///               the outputs are named after the states.
/// @throws InvalidInput  if dt is out of range, shapes disagree, an entry is not finite, or dt is
///                       so long that an entry of the result exceeds the range of a double.
/// Source: Franklin, Powell, Workman 1998, section 6.3.2.
[[nodiscard]] DiscreteLti discretize_foh(const ContinuousLti& plant, double dt);

}  // namespace quadtune
