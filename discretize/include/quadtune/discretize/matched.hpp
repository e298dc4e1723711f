// SPDX-License-Identifier: Apache-2.0
/// Matched poles and zeros: each goes where the exponential takes it.
#pragma once

#include "quadtune/lti.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune {

/// Poles p and zeros q become e^(p dt) and e^(q dt). Of the zeros that G has at infinity, one stays
/// there, so that the computer has a sample to compute in, and the others go to z = -1, the highest
/// frequency there is.
///
/// The gain is that of G at low frequency: with n poles at 0 (n < 0 for zeros there),
/// ((z - 1)/dt)ⁿ G_d(z) at z → 1 equals sⁿ G(s) at s → 0. So 1/s becomes dt/(z - 1).
///
/// @param plant  one input, one output; no more zeros than poles; whole samples of delay
/// @param dt     Sample period [s], 0 < dt < ∞.
/// @throws InvalidInput  as validate(), for dt out of range, for a delay that is no whole number of
///                       samples, when a pole or zero goes beyond the range of a double, and when
///                       one other than 0 goes to z = 1 (±2πi/dt and its multiples).
/// Source: Franklin, Powell, Workman 1998, section 6.2.
[[nodiscard]] DiscreteTransferFunction discretize_matched(const ContinuousTransferFunction& plant,
                                                          double dt);

/// The same for a state-space model, by its poles and transmission zeros.
///
/// @param plant  A (nx × nx), B (nx × 1), C (1 × nx); time in seconds.
/// @return       Sections of first and second order in series, nx states without names; input and
///               output keep theirs.
/// @throws InvalidInput  likewise, and for more than one input or output.
[[nodiscard]] DiscreteLti discretize_matched(const ContinuousLti& plant, double dt);

}  // namespace quadtune
