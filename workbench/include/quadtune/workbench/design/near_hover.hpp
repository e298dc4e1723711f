// SPDX-License-Identifier: Apache-2.0
/// The bounds within which a linear state feedback may be trusted with any reference.
#pragma once

#include "quadtune/gains.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// The tilt that a state feedback designed here may command for an error of position [rad].
inline constexpr double kMostCommandedTilt = 0.35;

/// Lets the law see the position error in heading axes, bounds that error to the length for which
/// the vehicle comes to rest at a tilt of kMostCommandedTilt, and stops integrals at the motors'
/// limits. Gains that do not tilt the vehicle for an error of position keep theirs unbounded.
/// @param gains  of the vehicle, in the 12 states of any convention
/// @throws InvalidInput  as state_feedback_settings()
void keep_near_hover(const Vehicle& vehicle, Gains& gains);

}  // namespace quadtune
