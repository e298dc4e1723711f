// SPDX-License-Identifier: Apache-2.0
/// Tustin's method and backward Euler as one rule with different weights.
#pragma once

#include <string>

#include "quadtune/lti.hpp"

namespace quadtune::internal {

/// x[k+1] = x[k] + h ((1 - α) ẋ[k] + α ẋ[k+1]): s becomes (z - 1) / (h (α z + 1 - α)).
struct ImplicitRule {
  double alpha;           ///< 1/2 or 1
  double step;            ///< h [s], > 0: dt, or a prewarped step
  std::string forbidden;  ///< text of 1/(α h) in messages, e.g. "2/dt"
};

/// With T = (I - α A h)⁻¹ and the state x - α h (A x + B u):
///   A_d = T (I + (1 - α) A h), B_d = T B h, C_d = C T, D_d = D + α C T B h.
///
/// @throws InvalidInput  if A has a pole at 1/(α h), or an entry of the result exceeds the range of
///                       a double.
[[nodiscard]] DiscreteLti discretize_by_rule(const ContinuousLti& plant, double dt,
                                             const ImplicitRule& rule, const std::string& where);

}  // namespace quadtune::internal
