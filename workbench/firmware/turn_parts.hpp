// SPDX-License-Identifier: Apache-2.0
/// Helpers shared by the files of this folder.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "quadtune/exports/firmware.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune::internal {

/// Whether a loop controls an angle.
[[nodiscard]] inline bool turns(CascadeAxis axis) {
  return axis == CascadeAxis::roll || axis == CascadeAxis::pitch || axis == CascadeAxis::yaw;
}

/// The body axis of a rotation loop.
[[nodiscard]] inline Eigen::Index body_axis(CascadeAxis axis) {
  return axis == CascadeAxis::roll ? 0 : axis == CascadeAxis::pitch ? 1 : 2;
}

/// The lag of the slowest rotor [s].
[[nodiscard]] inline double rotor_lag(const Vehicle& vehicle) {
  double lag = 0;
  for (const Rotor& rotor : vehicle.rotors) lag = std::max(lag, slower_lag(rotor));
  return lag;
}

/// The usual lead of the rate [s], half the motor lag. This is near the ratio of the defaults of
/// PX4 and ArduPilot, D/P of 20 to 27 ms for motors of 40 to 60 ms. A larger lead amplifies more of
/// the gyroscope's noise.
[[nodiscard]] inline double usual_rate_lead(const Vehicle& vehicle) {
  return 0.5 * rotor_lag(vehicle);
}

/// Whether the lag of the motors limits how fast and how well damped the tilt loops are, so that a
/// lead of the rate helps.
[[nodiscard]] inline bool has_slow_motors(const Vehicle& vehicle) {
  constexpr double kSlow = 0.02;  // [s], four periods: a shorter lead is lost in sampling
  return rotor_lag(vehicle) >= kSlow;
}

}  // namespace quadtune::internal

namespace quadtune {
/// Delay from a rotation to the torque that responds to it, without filters and motor lag [s].
[[nodiscard]] double firmware_delay(const Firmware& firmware, const Vehicle& vehicle,
                                    const std::vector<Parameter>& values);

/// The torque about a body axis that the air on the turning rotors opposes to a rotation, divided
/// by its rate, at hover [N m s]. The air also links the rotation to the velocity of the body; this
/// acts below the crossover of the loops and is left out.
[[nodiscard]] double turn_damping(const Vehicle& vehicle, CascadeAxis axis);
}  // namespace quadtune
