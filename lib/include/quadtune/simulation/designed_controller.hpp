// SPDX-License-Identifier: Apache-2.0
/// Controllers for the simulation from designs.
#pragma once

#include "quadtune/design.hpp"
#include "quadtune/simulation/flight.hpp"

namespace quadtune {

/// Controller for a cascade from a design file.
/// @param design  source of the limits, the anti-windup and the integration method
/// @param gains   loops and control period: those of the file, or computed if it requests a design
[[nodiscard]] CascadeController cascade_controller(const CascadeDesign& design,
                                                   const CascadeGains& gains);

/// Controller for a state feedback, with integral guards if its convention is uquad or ned.
/// @param gains  in any convention
/// @param dt     control period [s]; that of the gains if they have one
[[nodiscard]] StateFeedbackController feedback_controller(const Gains& gains, double dt);

}  // namespace quadtune
