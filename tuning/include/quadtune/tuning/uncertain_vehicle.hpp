// SPDX-License-Identifier: Apache-2.0
/// The hover of a vehicle with uncertain mass, inertia, thrust and delay, under constant gains.
#pragma once

#include <Eigen/Core>
#include <string>

#include "quadtune/cascade.hpp"
#include "quadtune/control/pid_method.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/synthesis/robustness.hpp"

namespace quadtune {

/// A range, low ≤ high.
struct UncertainRange {
  double low = 1;   ///< lower end
  double high = 1;  ///< upper end
};

/// Uncertainty of a vehicle, whose parameters are constant. Mass, inertia and thrust are ratios to
/// the values of its file.
struct VehicleUncertainty {
  UncertainRange mass;     ///< > 0, contains 1
  UncertainRange inertia;  ///< likewise, of each principal moment independently
  UncertainRange thrust;   ///< likewise: thrust and drag torque of all rotors at a given speed
  /// [s], ≥ 0, of the loop in addition to the hold: measuring, computing, acting
  UncertainRange delay{0, 0};
  /// Time constant of the rotor speeds [s], ≥ 0; {0, 0}: the speed equals the command. A low end of
  /// 0 with a positive high end is rejected, because the order of the model changes at 0.
  UncertainRange lag{0, 0};
};

/// The loop of a state feedback, integrals included, about the hover of a vehicle.
///
/// The parameters are mass, inertia x, y and z, thrust, lag and delay, in this order. Parameters
/// whose range has no width are included, so that a box names every number for which it holds. At
/// each point the vehicle hovers at its own trim: in any steady hover the rotors carry its true
/// weight, whatever the controller. Rotor speeds, commands and single thrusts then act with the
/// slope of the true curve at the true speed. A wrench acts with the ratio of the curves, since the
/// flight program distributes it by the nominal ones.
///
/// @param vehicle      equal rotors, balanced spins and positions, principal inertia
/// @param gains        dt > 0, hover; any convention, inputs and sign law
/// @param uncertainty  ranges of the vehicle's parameters
/// @throws InvalidInput  stating the input and what was expected, also for ranges that do not
///                       contain the nominal value
[[nodiscard]] LoopFamily uncertain_hover(const Vehicle& vehicle, const Gains& gains,
                                         const VehicleUncertainty& uncertainty);

/// The same for a cascade of PID loops, all of them closed, which commands a wrench.
/// @param vehicle      as above
/// @param cascade      with dt > 0
/// @param method       of the integrals
/// @param uncertainty  ranges of the vehicle's parameters
[[nodiscard]] LoopFamily uncertain_hover(const Vehicle& vehicle, const CascadeGains& cascade,
                                         PidMethod method, const VehicleUncertainty& uncertainty);

/// Tests whether the motors of the vehicle can hold the hover with these ratios of mass and thrust.
/// @return  "" if they can, otherwise the reason
[[nodiscard]] std::string cannot_hover(const Vehicle& vehicle, double mass, double thrust);

}  // namespace quadtune
