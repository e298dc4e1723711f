// SPDX-License-Identifier: Apache-2.0
/// An error-state extended Kalman filter for arbitrary sensor suites. A gyroscope and an
/// accelerometer drive the prediction; optical flow, range, barometer, magnetometer, GPS and vision
/// correct it, each at the time of its measurement. Theory: "The general filter".
#pragma once

#include "quadtune/estimation/general_filter/general_filter_sensors.hpp"

namespace quadtune {

/// Standard deviations of the errors of an estimate.
template <class T>
struct Deviations {
  Vector3<T> position = Vector3<T>::Zero();  ///< world [m]
  Vector3<T> velocity = Vector3<T>::Zero();  ///< world [m/s]
  Vector3<T> attitude = Vector3<T>::Zero();  ///< roll, pitch, yaw [rad]
};

namespace general_filter_internal {

/// Predicts the present motion from that of the horizon with the inertial readings since then. Over
/// the lag of each sensor its newest reading is held.
template <class T>
[[nodiscard]] Motion9<T> motion_now(const GeneralFilterSettings& settings,
                                    const GeneralFilterState<T>& state, int horizon) {
  if (horizon == 0) return state.motion;
  // Mean over the time since the horizon of the interpolated readings.
  const auto mean = [&](double lag, auto member) {
    const double time = horizon * settings.dt;
    const double held = std::min(lag, time) / time;
    Vector3<T> sum = state.readings[0].*member * T(held);
    for (double left = time - lag, end = 0; left > 1e-12; ++end) {
      const double h = std::min(left, settings.dt), part = h / settings.dt;
      const auto j = static_cast<int>(end);
      sum += state.readings[j].*member * T((h - 0.5 * h * part) / time) +
             state.readings[j + 1].*member * T(0.5 * h * part / time);
      left -= h;
    }
    return sum;
  };
  const T time = T(horizon * settings.dt);
  const Vector3<T> rates =
      mean(settings.gyroscope.lag, &InertialReading<T>::rates) - state.gyro_bias;
  const Vector3<T> force =
      mean(settings.accelerometer.lag, &InertialReading<T>::force) - state.force_bias;
  Motion9<T> motion = state.motion;
  move<T>(motion, rates * time, force, T(settings.gravity), time);
  return motion;
}

/// Converts a motion to the 12 states of ned_convention().
/// @param yaw  previous yaw, not wrapped [rad]; receives the new yaw
template <class T>
void write_states(const Motion9<T>& motion, const Vector3<T>& rates, T& yaw, StateVector<T>& x) {
  using on_board_math::nearest;
  using std::atan2, std::sqrt;
  const Matrix3<T> R = rotation(motion.attitude);
  x.template segment<3>(kPosition) = motion.position;
  x(kAttitude) = atan2(R(2, 1), R(2, 2));
  x(kAttitude + 1) = atan2(T(-R(2, 0)), T(sqrt(R(0, 0) * R(0, 0) + R(1, 0) * R(1, 0))));
  const T turned = atan2(R(1, 0), R(0, 0));
  // Choose the turn that is nearest to the previous yaw.
  yaw =
      turned + T(2 * std::numbers::pi) * nearest(T((yaw - turned) * T(0.5 * std::numbers::inv_pi)));
  x(kAttitude + 2) = yaw;
  x.template segment<3>(kVelocity) = R.transpose() * motion.velocity;
  x.template segment<3>(kRates) = rates;
}

/// Inertial measurements of this period.
template <class T>
struct InertialSamples {
  /// scale factors divided out; a missing sample repeats the previous one
  Vector3<T> rates, force;
  MaskOf<T> rates_fresh, force_fresh;
};

/// Stores the newest readings.
template <class T>
InertialSamples<T> take_readings(const GeneralFilterSettings& settings,
                                 GeneralFilterState<T>& state, const SensorFrame<T>& frame) {
  const MaskOf<T> rates_fresh =
      logical_and(frame.rates.fresh, entries_are_finite<T>(frame.rates.value));
  const MaskOf<T> force_fresh =
      logical_and(frame.specific_force.fresh, entries_are_finite<T>(frame.specific_force.value));
  const InertialReading<T> before = state.readings[0];
  InertialReading<T>& newest = state.readings.advance();
  for (int i = 0; i < 3; ++i) {
    newest.rates(i) = select(
        rates_fresh, T(frame.rates.value(i) * T(1 / settings.gyroscope.scale(i))), before.rates(i));
    newest.force(i) = select(
        force_fresh, T(frame.specific_force.value(i) * T(1 / settings.accelerometer.scale(i))),
        before.force(i));
  }
  return {newest.rates, newest.force, rates_fresh, force_fresh};
}

/// Predicts the horizon's state over one period unless the vehicle is on the ground.
template <class T>
void predict_horizon(const Period<T>& period, const MaskOf<T>& standing) {
  const GeneralFilterSettings& settings = period.settings;
  GeneralFilterState<T>& state = period.state;
  const T dt = T(settings.dt);
  if (!all(standing)) {
    const Inputs<T> in = inputs_at(state, period.gyro, period.force, 0);
    Motion9<T> motion = state.motion;
    const Eigen::Matrix<T, 4, 1> middle =
        product(motion.attitude, small_rotation<T>(in.rates * (T(0.5) * dt)));
    const Matrix3<T> R = rotation(middle);
    move<T>(motion, in.rates * dt, in.force, T(settings.gravity), dt);
    restore_norm(motion.attitude);
    const Vector3<T> gained = R * in.force * dt;
    if (!any(standing)) {
      state.motion = motion;
      spread(state.P, R, gained, dt);
      add_noise(settings, state.P, R, settings.dt);
    } else {
      SymmetricMatrix<T, kErrorStates> P = state.P;
      spread(P, R, gained, dt);
      add_noise(settings, P, R, settings.dt);
      for (std::size_t i = 0; i < P.entries.size(); ++i)
        state.P.entries[i] = select(standing, state.P.entries[i], P.entries[i]);
      state.motion.position = select_entries<T>(standing, state.motion.position, motion.position);
      state.motion.velocity = select_entries<T>(standing, state.motion.velocity, motion.velocity);
      state.motion.attitude = select_entries<T>(standing, state.motion.attitude, motion.attitude);
    }
  }
  add_walks(settings, state.P, settings.dt);
  for (Rejections<T>& rejections : state.rejections) rejections.time += dt;
}

/// Corrects by every sample whose time the horizon has reached or passed.
template <class T>
void correct_by_samples(const Period<T>& period, const SensorFrame<T>& frame) {
  const GeneralFilterSettings& settings = period.settings;
  GeneralFilterState<T>& state = period.state;
  const auto vector = [&](auto& queue, const auto& sample, double lag) {
    using Value = std::decay_t<decltype(sample.value)>;
    return pass<Value, T>(queue, sample,
                          logical_and(sample.fresh, entries_are_finite<T>(sample.value)), lag,
                          settings.dt, period.horizon);
  };
  const auto scalar = [&](auto& queue, const Sample<T, T>& sample, double lag) {
    return pass<T, T>(queue, sample, logical_and(sample.fresh, is_finite(sample.value)), lag,
                      settings.dt, period.horizon);
  };
  if (settings.gps_position)
    use_vector<kP>(period, *settings.gps_position,
                   vector(state.gps_position, frame.gps_position, settings.gps_position->lag),
                   Scalar::gps_position);
  if (settings.gps_velocity)
    use_vector<kV>(period, *settings.gps_velocity,
                   vector(state.gps_velocity, frame.gps_velocity, settings.gps_velocity->lag),
                   Scalar::gps_velocity);
  if (settings.vision)
    use_vector<kP>(period, *settings.vision,
                   vector(state.vision, frame.vision, settings.vision->lag), Scalar::vision);
  if (settings.flow) use_flow(period, vector(state.flow, frame.flow, settings.flow->lag));
  if (settings.range) use_range(period, scalar(state.range, frame.sonar, settings.range->aid.lag));
  if (settings.pressure)
    use_pressure(period, scalar(state.pressure, frame.pressure, settings.pressure->aid.lag));
  if (settings.heading)
    use_heading(period, vector(state.field, frame.magnetic_field, settings.heading->aid.lag));
}

}  // namespace general_filter_internal

/// Processes one control period: predicts the horizon's state by one period, corrects it by every
/// sample whose time the horizon has reached or passed, and predicts the present estimate from it.
///
/// The horizon is the instant horizon_periods() before the present, to which the state refers.
/// Samples that are not finite count as not fresh.
/// @param settings  accepted by validate()
/// @param state     of the last period; receives the new one
/// @param frame     sensors as received in this period
/// @param standing  whether the vehicle stands on the ground: it does not move, and its biases and
///                  its tilt are estimated
template <class T>
Estimate<T> step(const GeneralFilterSettings& settings, GeneralFilterState<T>& state,
                 const SensorFrame<T>& frame, const MaskOf<T>& standing) {
  namespace internal = general_filter_internal;
  Estimate<T> estimate;
  const int horizon = horizon_periods(settings);
  const internal::Period<T> period = {
      settings,
      state,
      internal::reading_place(settings.gyroscope.lag, settings.dt, horizon),
      internal::reading_place(settings.accelerometer.lag, settings.dt, horizon),
      horizon,
      estimate};

  const internal::InertialSamples<T> inertial = internal::take_readings(settings, state, frame);
  internal::predict_horizon(period, standing);
  if (any(standing))
    internal::use_standing(period, inertial.rates, inertial.rates_fresh, inertial.force,
                           inertial.force_fresh, standing);
  internal::correct_by_samples(period, frame);

  Motion9<T> now = internal::motion_now(settings, state, horizon);
  Vector3<T> rates = inertial.rates - state.gyro_bias;
  if (any(standing)) {
    now.position = select_entries<T>(standing, state.motion.position, now.position);
    now.velocity = select_entries<T>(standing, state.motion.velocity, now.velocity);
    now.attitude = select_entries<T>(standing, state.motion.attitude, now.attitude);
    rates = select_entries<T>(standing, Vector3<T>(Vector3<T>::Zero()), rates);
  }
  internal::write_states(now, rates, state.yaw, estimate.x);
  estimate.finite = entries_are_finite<T>(estimate.x);
  return estimate;
}

/// Standard deviations of the newest estimate's position, velocity and attitude: those at the
/// horizon, increased by the unknown motion since then.
template <class T>
[[nodiscard]] Deviations<T> deviations(const GeneralFilterSettings& settings,
                                       const GeneralFilterState<T>& state) {
  namespace internal = general_filter_internal;
  using std::sqrt;
  const int horizon = horizon_periods(settings);
  const double time = horizon * settings.dt;
  const Motion9<T> motion = internal::motion_now(settings, state, horizon);
  const Matrix3<T> R = internal::rotation(motion.attitude);
  SymmetricMatrix<T, kErrorStates> P = state.P;
  if (horizon > 0) {
    Vector3<T> gained = motion.velocity - state.motion.velocity;
    gained.z() -= T(settings.gravity * time);
    internal::spread(P, R, gained, T(time));
    internal::add_noise(settings, P, R, time);
    const double turn = 0.5 * settings.angular_acceleration * time * time;
    const double speed = 0.5 * settings.jerk * time * time;
    for (int i = 0; i < 3; ++i) {
      P(kErrorTurn + i, kErrorTurn + i) += T(turn * turn);
      P(kErrorVelocity + i, kErrorVelocity + i) += T(speed * speed);
    }
  }
  Deviations<T> result;
  const auto root = [](const T& variance) { return T(sqrt(max_of(variance, T(0)))); };
  for (int i = 0; i < 3; ++i) {
    result.position(i) = root(P(kErrorPosition + i, kErrorPosition + i));
    result.velocity(i) = root(P(kErrorVelocity + i, kErrorVelocity + i));
  }
  // Converts a small rotation about the world axes to roll, pitch and yaw.
  const T cp2 = max_of(T(R(0, 0) * R(0, 0) + R(1, 0) * R(1, 0)), T(kMinCosPitch));
  Matrix3<T> J = Matrix3<T>::Zero();
  J(0, 0) = R(0, 0) / cp2;
  J(0, 1) = R(1, 0) / cp2;
  const T cp = sqrt(cp2);
  J(1, 0) = -R(1, 0) / cp;
  J(1, 1) = R(0, 0) / cp;
  J(2, 0) = -R(2, 0) * J(0, 0);
  J(2, 1) = -R(2, 0) * J(0, 1);
  J(2, 2) = T(1);
  for (int i = 0; i < 3; ++i) {
    T variance = T(0);
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) variance += J(i, j) * P(kErrorTurn + j, kErrorTurn + k) * J(i, k);
    result.attitude(i) = root(variance);
  }
  return result;
}

}  // namespace quadtune
