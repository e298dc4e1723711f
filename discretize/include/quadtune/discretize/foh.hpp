// SPDX-License-Identifier: Apache-2.0
/// First-order hold: the plant when its input runs straight from sample to sample.
#pragma once

#include "quadtune/lti.hpp"

namespace quadtune {

/// Samples ẋ = Ax + Bu exactly for inputs that are linear between samples (triangle hold). A may be
/// singular.
///
/// With B₁ = ∫₀^dt e^(A(dt-τ)) (τ/dt) dτ B and B₀ = ∫₀^dt e^(Aτ) dτ B - B₁, the samples obey
/// x[k+1] = A_d x[k] + B₀ u[k] + B₁ u[k+1]. The input of the next sample is taken out by the state
/// x[k] - B₁ u[k]:
///   A_d = e^(A dt), B_d = B₀ + A_d B₁, C_d = C, D_d = D + C B₁.
/// Therefore C and D are always written out, and a state-feedback gain designed on the result does
/// not apply to measured states. A computer does not make such inputs (discretize_zoh() is for
/// that): this is for measured inputs and for controllers that are carried over.
///
/// @param plant  A (nx × nx), B (nx × nu); time in seconds.
/// @param dt     Sample period [s], 0 < dt < ∞.
/// @return       The sampled plant; states and inputs keep their names; outputs too, and are the
///               states by name when C was empty.
/// @throws InvalidInput  if dt is out of range, shapes disagree, an entry is not finite, or dt is
///                       so long that an entry of the result exceeds the range of a double.
/// Source: Franklin, Powell, Workman 1998, section 6.3.2.
[[nodiscard]] DiscreteLti discretize_foh(const ContinuousLti& plant, double dt);

}  // namespace quadtune
