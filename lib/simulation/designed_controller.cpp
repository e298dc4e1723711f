// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/designed_controller.hpp"

#include <limits>

namespace quadtune {

CascadeController cascade_controller(const CascadeDesign& design, const CascadeGains& gains) {
  CascadeController controller{gains};
  controller.method = design.method;
  controller.attitude_limit = design.attitude_limit;
  controller.integrator_limit = design.integrator_limit;
  controller.back_calculation = design.back_calculation;
  controller.velocity_feed_forward = design.velocity_feed_forward;
  controller.conditional_integration = design.conditional_integration;
  return controller;
}

StateFeedbackController feedback_controller(const Gains& gains, double dt) {
  StateFeedbackController controller{gains, gains.dt > 0 ? gains.dt : dt, {}};
  if (gains.convention == "uquad") controller.guards = uquad_integral_guards();
  // Far from the set point, where the proportional part dominates, the integral grows only as fast
  // as near it. It does not stop, since a vehicle that is heavier than assumed may settle that far
  // below.
  constexpr double kNear = 0.3, kInfinity = std::numeric_limits<double>::infinity();  // [m, rad]
  if (gains.convention == "ned")
    for (const Signal& integral : gains.integrals)
      controller.guards.push_back({integral.name, kInfinity, kNear * controller.dt, kInfinity});
  return controller;
}

}  // namespace quadtune
