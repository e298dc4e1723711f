// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/design/near_hover.hpp"

#include <algorithm>

#include "quadtune/control/state_feedback_law.hpp"

namespace quadtune {

void keep_near_hover(const Vehicle& vehicle, Gains& gains) {
  constexpr double kAnyPeriod = 0.01;  // K does not depend on it
  const StateFeedbackSettings<double> law =
      state_feedback_settings(vehicle, gains, gains.dt > 0 ? gains.dt : kAnyPeriod, {});
  gains.axes = PositionAxes::heading;
  gains.limits.conditional_integration = true;
  // Roll responds to py and pitch to px. At rest K_p e + K_angle angle = 0 in the torque of the
  // axis.
  constexpr int kPx = 0, kPy = 1, kRoll = 3, kPitch = 4;
  for (const auto& [position, angle] : {std::pair(kPx, kPitch), std::pair(kPy, kRoll)}) {
    const double of_position = law.K.col(position).norm(), of_angle = law.K.col(angle).norm();
    if (of_position > 0 && of_angle > 0)
      gains.limits.position_error =
          std::min(gains.limits.position_error, kMaxCommandedTilt * of_angle / of_position);
  }
}

}  // namespace quadtune
