// SPDX-License-Identifier: Apache-2.0
/// The control laws of a design as they are flown.
#pragma once

#include "quadtune/design.hpp"
#include "quadtune/simulation/flight.hpp"

namespace quadtune {

/// A cascade of a design file as it is flown.
/// @param gains  designed where the file asks for them
[[nodiscard]] CascadeController cascade_controller(const CascadeDesign& design,
                                                   const CascadeGains& gains);

/// A state feedback as it is flown: with the guards of the uquad's program in its convention.
/// @param dt  control period [s]; that of the gains where they have one
[[nodiscard]] StateFeedbackController feedback_controller(const Gains& gains, double dt);

}  // namespace quadtune
