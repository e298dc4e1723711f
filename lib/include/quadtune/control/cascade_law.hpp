// SPDX-License-Identifier: Apache-2.0
/// A cascade of PID loops as one linear law near hover, and a plant with such a law around it.
#pragma once

#include "quadtune/cascade.hpp"
#include "quadtune/control/pid.hpp"
#include "quadtune/lti.hpp"

namespace quadtune {

/// How many set points a cascade has: x_sp, y_sp, z_sp [m] and yaw_sp [rad].
inline constexpr int kCascadeSetPoints = 4;

/// The law as it runs, about hover with the heading along x and no limit met.
///
/// Inputs: the set points, then the 12 states of ned_convention(). Outputs: the wrench T [N],
/// tau_x, tau_y, tau_z [N m], T along body -z, so that it is minus what the altitude loop commands.
/// States: the integrals of the loops with Ki, in the order of the loops.
///
/// @param gains   loops named x, y, pitch, roll, yaw, altitude; one that is missing gives 0
/// @param method  of the integrals
/// @throws InvalidInput  for a loop of another name or gains that are not finite
[[nodiscard]] DiscreteLti cascade_law(const CascadeGains& gains, PidMethod method);
/// The same with integrals in continuous time; the period of the gains is not used.
[[nodiscard]] ContinuousLti cascade_law(const CascadeGains& gains);

/// The loop cut at the plant's inputs, under negative feedback, set points at 0.
/// @param plant  outputs are the law's inputs after `set_points`; inputs are its outputs; no D
/// @return       states of the plant, then of the law
/// @throws InvalidInput  for other sizes, or feed-through of the plant
[[nodiscard]] DiscreteLti cut_at_inputs(const DiscreteLti& plant, const DiscreteLti& law,
                                        int set_points = kCascadeSetPoints);
[[nodiscard]] ContinuousLti cut_at_inputs(const ContinuousLti& plant, const ContinuousLti& law,
                                          int set_points = kCascadeSetPoints);

/// The loop closed: from the set points to the plant's outputs.
[[nodiscard]] DiscreteLti closed_loop(const DiscreteLti& plant, const DiscreteLti& law,
                                      int set_points = kCascadeSetPoints);
[[nodiscard]] ContinuousLti closed_loop(const ContinuousLti& plant, const ContinuousLti& law,
                                        int set_points = kCascadeSetPoints);

}  // namespace quadtune
