// SPDX-License-Identifier: Apache-2.0
/// The inverse of discretization: the continuous plant of a discrete one.
#pragma once

#include <optional>

#include "quadtune/discretize/discretize.hpp"
#include "quadtune/lti.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune {

/// The plant whose zero-order hold is the given one: A = log(A_d)/dt, and B from ∫₀^dt e^(Aτ) dτ B
/// = B_d. Among the plants with these samples it is the one whose modes rotate by less than half a
/// turn per sample, |Im p| < π/dt.
///
/// @param plant  A (nx × nx), B (nx × nu), dt [s]
/// @return       C, D, names and units unchanged
/// @throws InvalidInput  as validate(); if a pole is at 0 or on the negative real axis, which is
///                       impossible for the hold of a real plant; or if, because of rounding, no
///                       real logarithm has an exponential that matches A to 1e-6.
/// Source: Higham 2008, chapter 11 (definition; computed by Eigen).
[[nodiscard]] ContinuousLti to_continuous_zoh(const DiscreteLti& plant);

/// The plant from which Tustin's rule produces the given one: with S = (A_d + I)⁻¹ and h = dt, or h
/// as in discretize_tustin() for prewarping,
///   A = (2/h) S (A_d - I), B = (2/h) S B_d, C = 2 C_d S, D = D_d - C_d S B_d.
///
/// @param plant    A (nx × nx), B (nx × nu), dt [s]
/// @param prewarp  [rad/s], 0 < prewarp < π/dt
/// @return         the plant with explicit C and D; names and units unchanged
/// @throws InvalidInput  as validate(); if prewarp is out of range or there is a pole at -1, which
///                       corresponds to infinity.
[[nodiscard]] ContinuousLti to_continuous_tustin(const DiscreteLti& plant,
                                                 std::optional<double> prewarp = {});

/// Converts by the method of that name.
/// @throws InvalidInput  likewise; for other methods, and for prewarping with a method other than
///                       tustin.
[[nodiscard]] ContinuousLti to_continuous(const DiscreteLti& plant, DiscretizationMethod method,
                                          std::optional<double> prewarp = {});

/// The same for a transfer function; its delay becomes delay · dt seconds. A coefficient of num
/// that should be 0 is at rounding level: about 1e-15 of the largest if s is measured in units of
/// 1/dt.
[[nodiscard]] ContinuousTransferFunction to_continuous(const DiscreteTransferFunction& plant,
                                                       DiscretizationMethod method,
                                                       std::optional<double> prewarp = {});

}  // namespace quadtune
