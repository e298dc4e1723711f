// SPDX-License-Identifier: Apache-2.0
/// The way back: the continuous plant of which a discrete one is the picture.
#pragma once

#include <optional>

#include "quadtune/discretize/discretize.hpp"
#include "quadtune/lti.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune {

/// The plant whose zero-order hold is the given one: A = log(A_d)/dt, and B from
/// ∫₀^dt e^(Aτ) dτ B = B_d. Of the many plants with these samples it is the one whose modes turn by
/// less than half a circle in a sample, |Im p| < π/dt.
///
/// @param plant  A (nx × nx), B (nx × nu), dt [s]
/// @return       C, D, names and units unchanged
/// @throws InvalidInput  as validate(), and for a pole at 0 or on the negative real axis, which no
///                       hold of a real plant has; or where rounding leaves no real logarithm whose
///                       exponential is A to 1e-6.
/// Source: Higham 2008, chapter 11 (what is computed, by Eigen).
[[nodiscard]] ContinuousLti to_continuous_zoh(const DiscreteLti& plant);

/// The plant of which Tustin's rule makes the given one: with S = (A_d + I)⁻¹ and h = dt or as
/// discretize_tustin() says for prewarping,
///   A = (2/h) S (A_d - I), B = (2/h) S B_d, C = 2 C_d S, D = D_d - C_d S B_d.
///
/// @param plant    A (nx × nx), B (nx × nu), dt [s]
/// @param prewarp  [rad/s], 0 < prewarp < π/dt
/// @return         C and D written out; names and units unchanged
/// @throws InvalidInput  as validate(), for prewarp out of range, and for a pole at -1, which comes
///                       from infinity.
[[nodiscard]] ContinuousLti to_continuous_tustin(const DiscreteLti& plant,
                                                 std::optional<double> prewarp = {});

/// Either of them by name.
/// @throws InvalidInput  likewise; for other methods, and for prewarping with another than tustin.
[[nodiscard]] ContinuousLti to_continuous(const DiscreteLti& plant, DiscretizationMethod method,
                                          std::optional<double> prewarp = {});

/// The same for a transfer function; its delay becomes delay · dt seconds. A coefficient of num
/// that the plant does not have is what rounding leaves: about 1e-15 of the largest when the powers
/// of s are counted in 1/dt.
[[nodiscard]] ContinuousTransferFunction to_continuous(const DiscreteTransferFunction& plant,
                                                       DiscretizationMethod method,
                                                       std::optional<double> prewarp = {});

}  // namespace quadtune
