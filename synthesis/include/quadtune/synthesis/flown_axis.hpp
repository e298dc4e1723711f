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
inline constexpr std::array<FlownAxis, 4> kFlownAxes = {FlownAxis::north, FlownAxis::east,
                                                        FlownAxis::altitude, FlownAxis::yaw};
/// "north", "east", "altitude", "yaw".
[[nodiscard]] std::string to_string(FlownAxis axis);

/// The states of ned_convention() that a group's law uses, position or angle first, and the index
/// of its component of the wrench.
[[nodiscard]] const std::vector<Eigen::Index>& states_of(FlownAxis axis);
[[nodiscard]] Eigen::Index wrench_of(FlownAxis axis);

/// The part of a flown plant between a group's component of the wrench and the estimates of its
/// states.
/// @throws InvalidInput  for a plant that does not command the wrench
[[nodiscard]] PeriodicLti axis_part(const FlownPlant& plant, FlownAxis axis);

/// A quadratic cost per second of a group: of its states, the integral of the first, and the input.
struct AxisWeights {
  Eigen::VectorXd q;      ///< (states) 1/deviation² [1/unit²]
  double q_integral = 0;  ///< of ∫ of the first state [1/(unit s)²]; 0: the law has no integral
  double r = 0;           ///< of the input [1/unit²]
  double step = 0;        ///< of the set point of the first state, from which the cost starts
  double impulse = 0;     ///< of the input [unit s], from which it starts as well
};

/// The cost of a group as a problem of output feedback. The true states count where the sensors
/// observe them, otherwise the estimates.
/// @param part  axis_part()
/// @param now   as with_integrals(); the integral is there if weights.q_integral > 0
/// @throws InvalidInput  for weights of another size
[[nodiscard]] OutputFeedbackProblem axis_problem(const PeriodicLti& part, FlownAxis axis,
                                                 const AxisWeights& weights, double now);

/// The plant of a law whose tilt loop has an integral: u[k] = v[k] + rate dt Σ_{i<k} v[i] for
/// v = -F y, where the last of the states_of() the group, the tilt's rate, passes the inverse of
/// this filter before it enters y. With F as without the integral, the tilt loop then has the gains
/// Kp and Ki = rate Kp of its error and Kd of the rate: the law stays linear in F.
/// @param plant  one input; outputs as axis_part() of north or east, integrals may follow
/// @param rate   [1/s], > 0
/// @return       two more states: the integral, then the filter's
/// @throws InvalidInput  for another plant or rate
[[nodiscard]] PeriodicLti with_tilt_integral(const PeriodicLti& plant, double rate);

/// The initial state after the set point of output `index` moved by 1: the state of a plant that
/// rests where this output is -1 and all others are 0. In the least-squares sense if there is none.
[[nodiscard]] Eigen::VectorXd rest_at(const PeriodicLti& plant, Eigen::Index index);

}  // namespace quadtune
