// SPDX-License-Identifier: Apache-2.0
/// Bounds within which a linear state feedback remains valid for any reference.
#pragma once

#include "quadtune/gains.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// Maximum tilt that a state feedback designed here commands for a position error [rad].
inline constexpr double kMaxCommandedTilt = 0.35;

/// Expresses the position error of the law in heading axes, limits this error to the length that
/// is in balance with a tilt of kMaxCommandedTilt, and stops integrals at the
/// motors' limits. The error stays unlimited if the gains do not tilt the vehicle for a position
/// error.
/// @param vehicle  valid
/// @param gains    of the vehicle, in the 12 states of any convention
/// @throws InvalidInput  as state_feedback_settings()
void keep_near_hover(const Vehicle& vehicle, Gains& gains);

}  // namespace quadtune
