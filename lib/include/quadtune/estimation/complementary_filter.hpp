// SPDX-License-Identifier: Apache-2.0
/// Attitude by integration of a gyroscope, slowly corrected toward the tilt that the accelerometer
/// measures. Theory: "Estimators on board".
#pragma once

#include <limits>
#include <numbers>
#include <string>

#include "quadtune/estimation/angles.hpp"
#include "quadtune/estimation/kalman_filter.hpp"
#include "quadtune/model/rotation.hpp"
#include "quadtune/scalar.hpp"

namespace quadtune {

/// Constant settings. validate() checks them; step() does not.
template <class T>
struct ComplementaryFilterSettings {
  double dt = 0.005;    ///< sample period [s], > 0
  T gravity = T(9.81);  ///< [m/s²], > 0
  /// of the correction by the accelerometer [s], ≥ 0; infinite: no correction
  T time_constant = T(1);
  /// Relative difference of |f| from g at which the correction is switched off; its weight
  /// decreases linearly from 1 at |f| = g to 0. > 0; infinite: the weight is always 1.
  T force_band = T(0.25);
  /// Time constant of the gyroscope bias estimate [s], at least 4 times time_constant; infinite:
  /// the bias is not estimated.
  T bias_time_constant = T(std::numeric_limits<double>::infinity());
};

/// The state kept from one sample to the next.
template <class T>
struct ComplementaryFilterState {
  Vector3<T> angles = Vector3<T>::Zero();     ///< roll and pitch within ±π; yaw not wrapped [rad]
  Vector3<T> gyro_bias = Vector3<T>::Zero();  ///< body axes [rad/s]
  Vector3<T> gyro = Vector3<T>::Zero();       ///< the last sample, bias included [rad/s]
};

/// (roll', pitch', yaw') from body rates. Like euler_rate_matrix(), but finite in every attitude:
/// the magnitude of cos(pitch) is bounded below by 0.05. Near ±90° of pitch the result is therefore
/// wrong, and the filter recovers afterwards.
template <class T>
[[nodiscard]] Vector3<T> bounded_euler_rates(const T& roll, const T& pitch,
                                             const Vector3<T>& rates) {
  using std::cos, std::sin;
  const T min = T(0.05);
  const T sr = sin(roll), cr = cos(roll), cp = cos(pitch);
  const T held = select(cp < T(0), min_of(cp, T(-min)), max_of(cp, min));
  const T yaw_rate = (rates.y() * sr + rates.z() * cr) / held;
  return {rates.x() + sin(pitch) * yaw_rate, rates.y() * cr - rates.z() * sr, yaw_rate};
}

/// Processes one sample. With w the mean of this and the previous gyroscope sample, bias
/// subtracted,
///
///     angles ← angles + dt E(angles half way) w,   E = bounded_euler_rates()
///     (roll, pitch) ← (roll, pitch) + α weight (accelerometer tilt - (roll, pitch)),
///                     α = dt/(τ + dt), τ = time_constant
///
/// While the angles are constant, a tilt error decays by the factor τ/(τ + dt) per sample, and a
/// gyroscope bias b causes a steady tilt error of b τ. The yaw is only integrated.
/// @param settings  accepted by validate()
/// @param state     of the last sample; receives the new one
/// @param gyro      [rad/s], finite
/// @param force     specific force [m/s²], finite
/// @param force_fresh  whether the force is a new sample; otherwise the angles are not corrected
template <class T>
void step(const ComplementaryFilterSettings<T>& settings, ComplementaryFilterState<T>& state,
          const Vector3<T>& gyro, const Vector3<T>& force, const MaskOf<T>& force_fresh) {
  using std::cos, std::sin, std::sqrt;
  const T dt = T(settings.dt);
  const Vector3<T> rates = (gyro + state.gyro) * T(0.5) - state.gyro_bias;
  state.gyro = gyro;
  const Vector3<T> before = bounded_euler_rates(state.angles.x(), state.angles.y(), rates);
  const Vector3<T> half_way = state.angles + before * (dt * T(0.5));
  state.angles += bounded_euler_rates(half_way.x(), half_way.y(), rates) * dt;

  const T norm = sqrt(force.squaredNorm());
  const T excess = abs_of(T(norm / settings.gravity - T(1))) / settings.force_band;
  // In free fall the specific force is near zero and its direction carries no information.
  const MaskOf<T> felt = logical_and(force_fresh, norm > T(0.1) * settings.gravity);
  const T weight = select(felt, max_of(T(T(1) - excess), T(0)), T(0));
  const Tilt<T> tilt = tilt_from_force(force);
  const T alpha = dt / (settings.time_constant + dt) * weight;
  const T roll_error = wrap_angle(T(tilt.roll - state.angles.x()));
  const T pitch_error = tilt.pitch - state.angles.y();
  state.angles.x() = wrap_angle(T(state.angles.x() + alpha * roll_error));
  state.angles.y() = wrap_angle(T(state.angles.y() + alpha * pitch_error));

  // Projects the tilt error on the body axes: body_rate_matrix() · (roll, pitch, 0).
  const T beta = alpha / settings.bias_time_constant;
  const T sr = sin(state.angles.x()), cr = cos(state.angles.x());
  state.gyro_bias.x() -= beta * roll_error;
  state.gyro_bias.y() -= beta * cr * pitch_error;
  state.gyro_bias.z() += beta * sr * pitch_error;
}

/// Validates the settings: dt and gravity > 0 and finite, time_constant ≥ 0, force_band > 0,
/// bias_time_constant ≥ 4 time_constant. The last keeps the bias estimate and the tilt correction
/// from oscillating against each other.
/// @throws InvalidInput  "where: force_band is 0, expected …"
void validate(const ComplementaryFilterSettings<double>& settings, const std::string& where);

/// The same for single precision.
void validate(const ComplementaryFilterSettings<float>& settings, const std::string& where);

}  // namespace quadtune
