// SPDX-License-Identifier: Apache-2.0
/// A cascade of PID loops as one linear law near hover, and the loop of a plant with such a law.
#pragma once

#include "quadtune/cascade.hpp"
#include "quadtune/control/pid.hpp"
#include "quadtune/lti.hpp"

namespace quadtune {

/// The number of set points of a cascade: x_sp, y_sp, z_sp [m] and yaw_sp [rad].
inline constexpr int kCascadeSetPoints = 4;

/// The linear law of the cascade about hover, with the heading along x and no limit active.
///
/// Inputs: the set points, then the 12 states of ned_convention(). Outputs: the deviation of the
/// thrust from the weight [N], then tau_x, tau_y, tau_z [N m]. Thrust acts along body -z, so its
/// deviation is the negated command of the altitude loop. States: first the integrals of the loops
/// with Ki, then, for each loop with rate_lead, the low-passed rate that its derivative is computed
/// from; both in the order of kAllCascadeAxes.
///
/// @param gains   loops named x, y, pitch, roll, yaw, altitude; a missing loop outputs 0
/// @param method  of the integrals
/// @throws InvalidInput  if a loop has another name, gains are not finite, a rate_lead or
///                       rate_filter is negative or not finite, or gains.dt is not positive and
///                       finite
[[nodiscard]] DiscreteLti cascade_law(const CascadeGains& gains, PidMethod method);
/// The same with continuous-time integrals; the period of the gains is not used.
/// @throws InvalidInput  likewise, except for gains.dt, and if rate_filter is 0 where rate_lead is
///                       not
[[nodiscard]] ContinuousLti cascade_law(const CascadeGains& gains);

/// The loop transfer cut at the plant's inputs, for negative feedback, with set points of 0.
/// @param plant  outputs: the law's inputs after `set_points`; inputs: the law's outputs; D = 0
/// @param law    inputs: `set_points` set points, then the plant's outputs
/// @param set_points  number of inputs of the law that are set points
/// @return       states of the plant, then of the law
/// @throws InvalidInput  if sizes or sample periods disagree or the plant has direct feedthrough
[[nodiscard]] DiscreteLti cut_at_inputs(const DiscreteLti& plant, const DiscreteLti& law,
                                        int set_points = kCascadeSetPoints);

/// The same for continuous systems.
[[nodiscard]] ContinuousLti cut_at_inputs(const ContinuousLti& plant, const ContinuousLti& law,
                                          int set_points = kCascadeSetPoints);

/// The closed loop from the set points to the plant's outputs. Arguments and errors as
/// cut_at_inputs().
/// @return  states of the plant, then of the law
[[nodiscard]] DiscreteLti closed_loop(const DiscreteLti& plant, const DiscreteLti& law,
                                      int set_points = kCascadeSetPoints);

/// The same for continuous systems.
[[nodiscard]] ContinuousLti closed_loop(const ContinuousLti& plant, const ContinuousLti& law,
                                        int set_points = kCascadeSetPoints);

}  // namespace quadtune
