// SPDX-License-Identifier: Apache-2.0
/// One door to all methods of discretization.
#pragma once

#include <string>

#include "quadtune/lti.hpp"

namespace quadtune {

/// How a continuous plant becomes a discrete one.
enum class DiscretizationMethod {
  zoh,     ///< exact for inputs held between samples, discretize_zoh()
  euler,   ///< forward Euler, discretize_euler()
  tustin,  ///< bilinear transformation, discretize_tustin()
};

/// "zoh", "euler" or "tustin", and back.
/// @throws InvalidInput  naming the word, the methods that exist, and the nearest.
[[nodiscard]] std::string to_string(DiscretizationMethod method);
[[nodiscard]] DiscretizationMethod discretization_method(const std::string& name,
                                                         const std::string& where);

/// @param plant  A (nx × nx), B (nx × nu); time in seconds.
/// @param dt     Sample period [s], 0 < dt < ∞.
/// @throws InvalidInput  as the method's own function.
[[nodiscard]] DiscreteLti discretize(const ContinuousLti& plant, double dt,
                                     DiscretizationMethod method);

}  // namespace quadtune
