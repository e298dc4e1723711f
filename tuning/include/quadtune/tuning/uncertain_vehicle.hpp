// SPDX-License-Identifier: Apache-2.0
/// A vehicle's hover with the mass, inertia, thrust and delay that it may have, under gains that
/// stay what they are.
#pragma once

#include <Eigen/Core>
#include <string>

#include "quadtune/cascade.hpp"
#include "quadtune/control/pid_method.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/synthesis/robustness.hpp"

namespace quadtune {

/// low ≤ high.
struct UncertainRange {
  double low = 1;
  double high = 1;
};

/// What a vehicle may be, by ratios to its file's values; each is constant.
struct VehicleUncertainty {
  UncertainRange mass;     ///< > 0, about 1
  UncertainRange inertia;  ///< likewise, of each principal moment by itself
  UncertainRange thrust;   ///< likewise: thrust and drag torque of all rotors at a given speed
  UncertainRange delay{0,
                       0};  ///< [s], ≥ 0, of the loop beyond the hold: measuring, computing, acting
  /// Time constant of the rotors' speed [s], ≥ 0; {0, 0}: the speed is what is commanded. A low end
  /// of 0 below a high end is refused: there the model changes its order.
  UncertainRange lag{0, 0};
};

/// The loop of a state feedback, integrals included, about the hover of a vehicle.
///
/// The parameters are mass, inertia x, y and z, thrust, lag and delay, in this order, also those
/// whose range has no width: a box names every number that it holds for. At each of their values
/// the vehicle hovers at its own trim: in any steady hover the rotors carry its true weight,
/// whatever brings them there. Rotor speeds, commands and single thrusts then act by the slope of
/// the true curve at the true speed; a wrench by the ratio of the curves, as the flight program
/// shares it out by the nominal ones.
///
/// @param vehicle  rotors alike, spins and positions in balance, principal inertia
/// @param gains    dt > 0, hover; any convention, inputs and sign law
/// @throws InvalidInput  naming what came and what was expected, also for ranges that do not hold
///                       the nominal value
[[nodiscard]] LoopFamily uncertain_hover(const Vehicle& vehicle, const Gains& gains,
                                         const VehicleUncertainty& uncertainty);

/// The same under a cascade of PID loops, all of them closed, which commands a wrench.
/// @param method  of the integrals
[[nodiscard]] LoopFamily uncertain_hover(const Vehicle& vehicle, const CascadeGains& cascade,
                                         PidMethod method, const VehicleUncertainty& uncertainty);

/// Whether the vehicle's motors hold the hover of this mass and thrust, both ratios.
/// @return  "" if they do, else why not
[[nodiscard]] std::string cannot_hover(const Vehicle& vehicle, double mass, double thrust);

}  // namespace quadtune
