// SPDX-License-Identifier: Apache-2.0
/// The flown plant of one axis group of a hovering multirotor, as a problem for gains of a given
/// structure. Theory: docs/theory.md, "Gains of a given structure".
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "quadtune/synthesis/flown_plant.hpp"
#include "quadtune/synthesis/output_feedback.hpp"
#include "quadtune/synthesis/periodic_loop.hpp"

namespace quadtune {

/// Groups of axes that are independent of each other in a hover, up to couplings that an uneven
/// mass distribution causes.
enum class FlownAxis {
  north,     ///< px, u, pitch, q by tau_y
  east,      ///< py, v, roll, p by tau_x
  altitude,  ///< pz, w by T
  yaw,       ///< yaw, r by tau_z
};
/// All groups, in the order of FlownAxis.
inline constexpr std::array<FlownAxis, 4> kFlownAxes = {FlownAxis::north, FlownAxis::east,
                                                        FlownAxis::altitude, FlownAxis::yaw};
/// "north", "east", "altitude", "yaw".
[[nodiscard]] std::string to_string(FlownAxis axis);

/// Returns the states of ned_convention() that the law of a group uses, position or angle first.
[[nodiscard]] const std::vector<Eigen::Index>& states_of(FlownAxis axis);

/// The index of the group's component of the wrench [T τx τy τz].
[[nodiscard]] Eigen::Index wrench_of(FlownAxis axis);

/// The part of a flown plant between a group's component of the wrench and the estimates of its
/// states.
/// @throws InvalidInput  if the inputs of the plant are not the wrench
[[nodiscard]] PeriodicLti axis_part(const FlownPlant& plant, FlownAxis axis);

/// Weights of a quadratic cost per second of a group: of its states, of the integral of the first
/// state, and of the input.
struct AxisWeights {
  Eigen::VectorXd q;      ///< (states) 1/deviation² [1/unit²]
  double q_integral = 0;  ///< of the integral of the first state [1/(unit s)²]; 0: no integral
  double r = 0;           ///< of the input [1/unit²]
  double step = 0;        ///< initial step of the set point of the first state [unit]
  double impulse = 0;     ///< initial impulse of the input [unit s]
};

/// Formulates the cost of a group as an output feedback problem. The cost weights the true states
/// where the sensors observe them, and the estimates otherwise.
/// @param part     result of axis_part()
/// @param axis     the group
/// @param weights  of the states of the group, of its integral and of its input
/// @param now      see with_integrals(); the integral is present if weights.q_integral > 0
/// @throws InvalidInput  if the weights have the wrong size
[[nodiscard]] OutputFeedbackProblem axis_problem(const PeriodicLti& part, FlownAxis axis,
                                                 const AxisWeights& weights, double now);

/// Extends a plant for a law whose tilt loop has an integral: u[k] = v[k] + rate dt Σ_{i<k} v[i],
/// where v = -F y. The rate of the tilt, the last of states_of(), passes through the inverse of the
/// filter from v to u before it enters y. With the same F as without the integral, the tilt loop
/// then has the gains Kp and Ki = rate Kp on its error and Kd on the rate, so the law remains
/// linear in F.
/// @param plant  one input; outputs as axis_part() of north or east, integrals may follow
/// @param rate   [1/s], 0 < rate < 1/dt of the plant
/// @return       the plant with two more states: the integral, then the filter
/// @throws InvalidInput  if the plant has the wrong inputs or outputs, or rate is out of range
[[nodiscard]] PeriodicLti with_tilt_integral(const PeriodicLti& plant, double rate);

/// Extends a plant for a law with Kd on rate + gain (rate - f), where the low pass f[k+1] = f[k] +
/// share (rate[k] - f[k]): the output `rate` of the plant becomes this sum, so the law remains
/// linear in F.
/// @param plant  outputs as axis_part()
/// @param rate   index of the output
/// @param gain   as PidSettings::rate_lead
/// @param share  as PidSettings::rate_share
/// @return       the plant with one more state, the low pass
/// @throws InvalidInput  if the plant has no such output, or gain or share is out of range
[[nodiscard]] PeriodicLti with_rate_lead(const PeriodicLti& plant, Eigen::Index rate, double gain,
                                         double share);

/// Computes the initial state after a step of the set point of output `index` by 1: the steady
/// state in which this output is -1 and all others are 0. If no such state exists, the
/// least-squares solution is returned.
[[nodiscard]] Eigen::VectorXd rest_at(const PeriodicLti& plant, Eigen::Index index);

}  // namespace quadtune
