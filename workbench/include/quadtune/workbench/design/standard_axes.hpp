// SPDX-License-Identifier: Apache-2.0
/// Weights by Bryson's rule for the designs on the flown plant, by groups of axes.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "quadtune/model/vehicle.hpp"
#include "quadtune/synthesis/actuator_lqi.hpp"
#include "quadtune/synthesis/flown_axis.hpp"

namespace quadtune {

/// Weights of the groups of axes, in the order of kFlownAxes.
using StandardAxes = std::array<AxisWeights, 4>;

/// Weights by Bryson's rule: a deviation at its limit costs 1. The limits are those of
/// standard_weights(). An integral reaches its limit after 3 s with its state at the limit.
/// @throws NoSolution  if the vehicle cannot hover or has no control authority
[[nodiscard]] StandardAxes standard_axes(const Vehicle& vehicle);

/// The same as weights of actuator_lqi().
/// @param axes       from standard_axes()
/// @param integrals  names of states of ned_convention(); the weight of an integral is that of its
///                   state, with the integration time of standard_axes()
/// @throws InvalidInput  if a name is not that of a state
[[nodiscard]] ActuatorLqiWeights lqi_weights(const StandardAxes& axes,
                                             const std::vector<std::string>& integrals);

/// The first state of each group: px, py, pz, yaw.
[[nodiscard]] std::vector<std::string> standard_integrals();

}  // namespace quadtune
