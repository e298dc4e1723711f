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

/// In the order of kFlownAxes.
using StandardAxes = std::array<AxisWeights, 4>;

/// Weights by Bryson's rule, a deviation at its limit costs 1: those of standard_weights(). An
/// integral reaches its limit after 3 s at the limit of its state.
/// @throws NoSolution  for a vehicle that cannot hover or has no authority
[[nodiscard]] StandardAxes standard_axes(const Vehicle& vehicle);

/// The same as weights of actuator_lqi().
/// @param integrals  names of states of ned_convention(); the weight of an integral is that of its
///                   state, with the time that standard_axes() gives to integrals
/// @throws InvalidInput  for a name of no state
[[nodiscard]] ActuatorLqiWeights lqi_weights(const StandardAxes& axes,
                                             const std::vector<std::string>& integrals);

/// The first state of each group: px, py, pz, yaw.
[[nodiscard]] std::vector<std::string> standard_integrals();

}  // namespace quadtune
