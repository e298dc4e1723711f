// SPDX-License-Identifier: Apache-2.0
/// The cascade of PID loops as it runs on board: from position to attitude, from attitude and
/// heading to torques, from height to thrust. Near hover and within its limits it equals
/// cascade_law().
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "quadtune/cascade.hpp"
#include "quadtune/control/pid.hpp"
#include "quadtune/estimation/on_board.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// Settings of the cascade.
template <class T>
struct CascadedPidSettings {
  std::array<PidSettings<T>, kCascadeAxes> loops{};  ///< by CascadeAxis
  T attitude_limit = T(0);                           ///< of the references of roll and pitch [rad]
  /// m g, from which the altitude loop's command, a force along +z, is subtracted [N].
  T weight = T(0);
  T take_off_thrust = T(0);  ///< in FlightPhase::take_off [N]
  /// Maximum thrust that the altitude loop may command [N].
  T max_thrust = T(0);
  /// Whether the position and height loops damp the velocity relative to that of the reference. If
  /// false, they damp the velocity itself, as the source programs do, and lag behind a moving
  /// reference.
  bool velocity_feed_forward = false;
  /// Whether integrals stop growing in a direction in which the motors are saturated.
  bool conditional_integration = false;
};

/// Whether the rate has a lead in any loop.
[[nodiscard]] inline bool has_rate_lead(const CascadedPidSettings<double>& settings) {
  return std::any_of(settings.loops.begin(), settings.loops.end(),
                     [](const PidSettings<double>& loop) { return loop.rate_lead != 0; });
}

/// The state kept from one sample to the next.
template <class T>
struct CascadedPidState {
  std::array<PidState<T>, kCascadeAxes> loops{};  ///< state of each loop, by CascadeAxis
  T roll_reference = T(0);                        ///< of the last sample [rad]
  T pitch_reference = T(0);                       ///< [rad]
  /// Requested minus produced values of the last sample with conditional_integration; otherwise 0.
  Eigen::Matrix<T, 4, 1> wrench_excess = Eigen::Matrix<T, 4, 1>::Zero();    ///< [N, N m]
  Eigen::Matrix<T, 2, 1> attitude_excess = Eigen::Matrix<T, 2, 1>::Zero();  ///< x, y [rad]
};

/// The settings that fly a design on a vehicle.
/// @param vehicle           source of the weight and of the maximum thrust
/// @param gains             loops as in CascadeDesign; missing loops have zero gains
/// @param method            integration method of the integrals
/// @param attitude_limit    of the references of roll and pitch [rad]
/// @param integrator_limit  of the magnitude of each error integral [error · s]; infinite: none
/// @param back_calculation  as PidSettings::back_calculation; ignored by loops without Ki
/// @throws InvalidInput  as validate(PidSettings), with the name of the loop
[[nodiscard]] CascadedPidSettings<double> cascaded_pid_settings(
    const Vehicle& vehicle, const CascadeGains& gains, PidMethod method, double attitude_limit,
    double integrator_limit, double back_calculation);

/// One sample; returns the commanded wrench [T τx τy τz], T ≥ 0 along body -z.
///
/// In FlightPhase::take_off the thrust is constant, the position and height loops do not run, and
/// attitude and heading are controlled. If the reference does not track position, roll and pitch
/// follow it directly, and the x and y loops do not run. The state of a loop that does not run is
/// kept: its integral continues from the value that it had.
template <class T>
[[nodiscard]] Eigen::Matrix<T, 4, 1> step(const CascadedPidSettings<T>& settings,
                                          CascadedPidState<T>& state, const Estimate<T>& estimate,
                                          const Reference<T>& reference) {
  using std::cos, std::sin;
  const StateVector<T>& x = estimate.x;
  const auto loop = [&](CascadeAxis axis, const T& set_point, const T& measurement, const T& rate,
                        const T& excess) {
    const std::size_t i = index_of(axis);
    return step(settings.loops[i], state.loops[i], {set_point, measurement, rate, T(0), excess});
  };
  const bool takes_off = reference.phase == FlightPhase::take_off;
  const T yaw = x(5);
  T roll_reference = reference.roll;
  T pitch_reference = reference.pitch;
  const Matrix3<T> R_WB = rotation_of_euler(x(3), x(4), x(5));
  Vector3<T> velocity = R_WB * Vector3<T>(x.template segment<3>(kVelocity));
  if (settings.velocity_feed_forward) velocity -= reference.velocity;
  if (reference.track_position && !takes_off) {
    // Errors and velocities along and across the heading.
    const T c = cos(yaw), s = sin(yaw);
    const T north = reference.position(0) - x(0), east = reference.position(1) - x(1);
    const T ahead = c * north + s * east, right = c * east - s * north;
    const T speed_ahead = c * velocity(0) + s * velocity(1);
    const T speed_right = c * velocity(1) - s * velocity(0);
    const PidOutput<T> pitch =
        loop(CascadeAxis::x, ahead, T(0), speed_ahead, state.attitude_excess(0));
    const PidOutput<T> roll =
        loop(CascadeAxis::y, right, T(0), speed_right, state.attitude_excess(1));
    pitch_reference = pitch.value;
    roll_reference = roll.value;
    if (settings.conditional_integration)
      state.attitude_excess = {select(pitch.finite, pitch.unlimited - pitch.value, T(0)),
                               select(roll.finite, roll.unlimited - roll.value, T(0))};
  }
  state.roll_reference = clamped(roll_reference, -settings.attitude_limit, settings.attitude_limit);
  state.pitch_reference =
      clamped(pitch_reference, -settings.attitude_limit, settings.attitude_limit);
  Eigen::Matrix<T, 4, 1> wrench;
  wrench(1) =
      loop(CascadeAxis::roll, state.roll_reference, x(3), x(9), state.wrench_excess(1)).value;
  wrench(2) =
      loop(CascadeAxis::pitch, state.pitch_reference, x(4), x(10), state.wrench_excess(2)).value;
  wrench(3) = loop(CascadeAxis::yaw, reference.yaw, yaw, x(11), state.wrench_excess(3)).value;
  if (takes_off) {
    wrench(0) = settings.take_off_thrust;
  } else {
    // The loop commands a force along +z (down) that is added to the weight compensation.
    const T down = loop(CascadeAxis::altitude, reference.position(2), x(2), velocity(2),
                        T(-state.wrench_excess(0)))
                       .value;
    wrench(0) = clamped(settings.weight - down, T(0), settings.max_thrust);
  }
  return wrench;
}

/// Gives the law the wrench that the motors can produce, in response to that returned by step().
template <class T>
void on_realized(const CascadedPidSettings<T>& settings, CascadedPidState<T>& state,
                 const Eigen::Matrix<T, 4, 1>& asked, const Eigen::Matrix<T, 4, 1>& made) {
  if (!settings.conditional_integration) return;
  for (int i = 0; i < 4; ++i)
    state.wrench_excess(i) = select(is_finite(asked(i)), asked(i) - made(i), T(0));
}

}  // namespace quadtune
