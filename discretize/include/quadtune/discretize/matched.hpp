// SPDX-License-Identifier: Apache-2.0
/// Matched poles and zeros: each is mapped by the exponential.
#pragma once

#include "quadtune/lti.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune {

/// Poles p and zeros q become e^(p dt) and e^(q dt). Of the zeros of G at infinity, one is kept,
/// which leaves the computer one sample for its computation; the others are mapped to z = -1, the
/// Nyquist frequency.
///
/// The gain matches that of G at low frequency: if G has n poles at 0 (n < 0 for zeros), the limit
/// of ((z - 1)/dt)ⁿ G_d(z) for z → 1 equals that of sⁿ G(s) for s → 0. For example 1/s becomes
/// dt/(z - 1).
///
/// @param plant  one input, one output; not more zeros than poles; a whole number of samples of
///               delay
/// @param dt     Sample period [s], 0 < dt < ∞.
/// @throws InvalidInput  as validate(); if dt is out of range, the delay is not a whole number of
///                       samples, a pole or zero is mapped beyond the range of a double, or one
///                       other than 0 is mapped to z = 1 (multiples of ±2πi/dt).
/// Source: Franklin, Powell, Workman 1998, section 6.2.
[[nodiscard]] DiscreteTransferFunction discretize_matched(const ContinuousTransferFunction& plant,
                                                          double dt);

/// The same for a state-space model, from its poles and transmission zeros.
///
/// @param plant  A (nx × nx), B (nx × 1), C (1 × nx); time in seconds.
/// @param dt     Sample period [s], 0 < dt < ∞.
/// @return       First- and second-order sections in series, nx states without names; input and
///               output keep their names.
/// @throws InvalidInput  likewise, or if there is more than one input or output.
[[nodiscard]] DiscreteLti discretize_matched(const ContinuousLti& plant, double dt);

}  // namespace quadtune
