// SPDX-License-Identifier: Apache-2.0
/// Measurement equations: each sensor's output as a function of the general filter's state. Theory:
/// "The general filter".
#pragma once

#include <limits>

#include "quadtune/estimation/angles.hpp"
#include "quadtune/estimation/general_filter/general_filter_correction.hpp"
#include "quadtune/estimation/uquad_filter.hpp"

namespace quadtune::general_filter_internal {

/// A sample whose time the horizon has reached.
template <class Value, class T>
struct Due {
  Value value{};
  T ago = T(0);  ///< time between the sample and the horizon [s]
  MaskOf<T> due{};
};

/// Stores this period's sample and returns the sample whose time the horizon has reached.
/// @param horizon  lag of the horizon [control periods]
template <class Value, class T, class Queue>
[[nodiscard]] Due<Value, T> pass(Queue& queue, const Sample<Value, T>& sample,
                                 const MaskOf<T>& fresh, double lag, double dt, int horizon) {
  const T age = sample.age + T(lag);
  if (horizon == 0) return {sample.value, age, fresh};
  Waiting<Value, T>& newest = queue.advance();
  newest.value = sample.value;
  newest.age = age;
  newest.came = fresh;
  Due<Value, T> due;
  due.value = sample.value;
  const double slack = 1e-9;  // shorter time differences are rounding [s]
  // of two samples that are due at once, the newer one is used
  for (int j = horizon; j >= 0; --j) {
    const Waiting<Value, T>& waiting = queue[j];
    if (!any(waiting.came)) continue;
    const T ago = waiting.age - T((horizon - j) * dt);
    MaskOf<T> now = logical_and(waiting.came, ago >= T(-slack));
    if (j > 0) now = logical_and(now, ago < T(dt - slack));
    if constexpr (std::is_same_v<Value, T>)
      due.value = select(now, waiting.value, due.value);
    else
      due.value = select_entries<T>(now, waiting.value, due.value);
    due.ago = select(now, max_of(ago, T(0)), due.ago);
    due.due = logical_or(due.due, now);
  }
  return due;
}

/// Data that all sensors use within one period.
template <class T>
struct Period {
  const GeneralFilterSettings& settings;
  GeneralFilterState<T>& state;
  ReadingPlace gyro, force;
  int horizon = 0;
  Estimate<T>& seen;

  [[nodiscard]] Past<T> past(const T& ago) const {
    // A sample time before the horizon by rounding only counts as that of the horizon.
    return past_motion(settings, state, gyro, force, select(ago > T(1e-9), ago, T(0)));
  }
};

/// Corrects by one scalar measured at the horizon or before it.
template <unsigned groups, class T>
void correct_at(const Period<T>& period, const Past<T>& past, Row<T> row, const T& e, const T& R,
                const MaskOf<T>& fresh, std::size_t scalar, int doubted, Correction<T>& correction,
                MaskOf<T>& used) {
  if (any(logical_and(past.past, fresh))) {
    carry(past, row);
    correct<kAll>(period.settings, period.state, row, e, R, fresh, scalar, doubted, correction,
                  period.seen, used);
  } else {
    correct<groups>(period.settings, period.state, row, e, R, fresh, scalar, doubted, correction,
                    period.seen, used);
  }
}

/// Optical flow: flow_x = (v_z d_x a - v_x d_z)/h - w_y (1 + a), flow_y = (v_z d_y b - v_y d_z)/h +
/// w_x (1 + b), with the velocity v and the unit vector d pointing down, both in body axes.
template <class T>
void use_flow(const Period<T>& period, const Due<Eigen::Matrix<T, 2, 1>, T>& sample) {
  if (!any(sample.due)) return;
  const FlowAid& aid = *period.settings.flow;
  const Past<T> past = period.past(sample.ago);
  const Matrix3<T> R = rotation(past.motion.attitude);
  const Vector3<T> v = R.transpose() * past.motion.velocity;
  const Vector3<T> d = R.row(2).transpose();
  const T height = -past.motion.position.z();
  const MaskOf<T> usable =
      logical_and(sample.due, logical_and(height >= T(aid.min_height), d.z() > T(0.5)));
  if (!any(usable)) return;
  const T inverse = T(1) / select(usable, height, T(1));
  Correction<T> correction;
  for (int axis = 0; axis < 2; ++axis) {
    const T c = T(aid.mean_square(axis));
    const int turning = 1 - axis;  // the axis whose rate moves the image in this direction
    const T sign = T(axis == 0 ? -1 : 1);
    const T translation = (v.z() * d(axis) * c - v(axis) * d.z()) * inverse;
    const T expected = translation + sign * past.rates(turning) * (T(1) + c);
    Vector3<T> by_velocity = Vector3<T>::Zero(), by_down = Vector3<T>::Zero();
    by_velocity(axis) = -d.z() * inverse;
    by_velocity(2) = d(axis) * c * inverse;
    by_down(axis) = v.z() * c * inverse;
    by_down(2) = -v(axis) * inverse;
    Row<T> row;
    row.position(2) = translation * inverse;
    row.velocity = R * by_velocity;
    row.turn = row.velocity.cross(past.motion.velocity);
    const Vector3<T> g = R * by_down;  // g × e_z
    row.turn(0) += g(1);
    row.turn(1) -= g(0);
    row.gyro(turning) = -sign * (T(1) + c);
    const T spread_of_rates =
        (T(1) + c) * (T(1) + c) * T(period.settings.gyroscope.variance(turning));
    correct_at<kP | kV | kTurn | kGyro>(
        period, past, row, T(sample.value(axis) * T(1 / aid.scale(axis)) - expected),
        T(T(aid.variance) + spread_of_rates), usable,
        static_cast<std::size_t>(Scalar::flow) + static_cast<std::size_t>(axis), kErrorVelocity,
        correction, period.seen.flow_used);
  }
  apply(correction, period.state);
}

/// Range along body z: height/d_z.
template <class T>
void use_range(const Period<T>& period, const Due<T, T>& sample) {
  if (!any(sample.due)) return;
  const RangeAid& aid = *period.settings.range;
  const T range = sample.value * T(1 / aid.aid.scale);
  const Past<T> past = period.past(sample.ago);
  const Matrix3<T> R = rotation(past.motion.attitude);
  const MaskOf<T> usable = logical_and(logical_and(sample.due, R(2, 2) >= T(aid.min_cosine)),
                                       logical_and(range >= T(aid.min), range <= T(aid.max)));
  if (!any(usable)) return;
  const T inverse = T(1) / select(usable, R(2, 2), T(1));
  const T expected = -past.motion.position.z() * inverse;
  Row<T> row;
  row.position(2) = -inverse;
  // The derivative with respect to d_z is -range/d_z, and the row is g × e_z for g = R (0, 0,
  // -range/d_z).
  const T slope = -expected * inverse;
  row.turn(0) = R(1, 2) * slope;
  row.turn(1) = -R(0, 2) * slope;
  Correction<T> correction;
  correct_at<kP | kTurn>(period, past, row, T(range - expected), T(aid.aid.variance), usable,
                         static_cast<std::size_t>(Scalar::range), kErrorPosition, correction,
                         period.seen.height_used);
  apply(correction, period.state);
}

/// Barometer: height plus the barometer's offset.
template <class T>
void use_pressure(const Period<T>& period, const Due<T, T>& sample) {
  if (!any(sample.due)) return;
  const PressureAid& aid = *period.settings.pressure;
  const T pressure = select(sample.due, sample.value * T(1 / aid.aid.scale), T(aid.zero));
  const MaskOf<T> usable = logical_and(sample.due, pressure > T(0));
  const T safe = select(usable, pressure, T(aid.zero));
  const T height = std::isfinite(aid.fall) ? T((safe - T(aid.zero)) * T(1 / aid.fall))
                                           : barometric_height(safe, T(aid.zero));
  const Past<T> past = period.past(sample.ago);
  Row<T> row;
  row.position(2) = T(-1);
  row.pressure = T(1);
  const T expected = period.state.pressure_height - past.motion.position.z();
  Correction<T> correction;
  correct_at<kP | kPressure>(period, past, row, T(height - expected), T(aid.aid.variance), usable,
                             static_cast<std::size_t>(Scalar::pressure), kErrorPosition, correction,
                             period.seen.height_used);
  apply(correction, period.state);
}

/// Magnetometer: the horizontal part of the field points to magnetic north. The row uses the
/// expected field, not the measured one: the noise of a row made of the measured field is
/// correlated with the innovation, which biases the tilt.
template <class T>
void use_heading(const Period<T>& period, const Due<Vector3<T>, T>& sample) {
  if (!any(sample.due)) return;
  using std::atan2;
  const HeadingAid& aid = *period.settings.heading;
  const Past<T> past = period.past(sample.ago);
  const Vector3<T> m = rotation(past.motion.attitude) * sample.value;
  const T square = m(0) * m(0) + m(1) * m(1);
  const MaskOf<T> usable = logical_and(sample.due, square > T(1e-6) * m.squaredNorm());
  if (!any(usable)) return;
  Row<T> row;
  row.turn << T(-aid.dip * std::cos(aid.declination)), T(-aid.dip * std::sin(aid.declination)),
      T(1);
  const T e = wrap_angle(T(T(aid.declination) - T(atan2(m(1), m(0)))));
  Correction<T> correction;
  MaskOf<T> used{};
  correct_at<kTurn>(period, past, row, e, T(aid.aid.variance), usable,
                    static_cast<std::size_t>(Scalar::heading), kErrorTurn, correction, used);
  apply(correction, period.state);
}

/// Position or velocity in world axes.
/// @tparam group  kP or kV
template <unsigned group, class T>
void use_vector(const Period<T>& period, const Aid& aid, const Due<Vector3<T>, T>& sample,
                Scalar scalar) {
  if (!any(sample.due)) return;
  const Past<T> past = period.past(sample.ago);
  Correction<T> correction;
  MaskOf<T> used{};
  for (int axis = 0; axis < 3; ++axis) {
    Row<T> row;
    (group == kP ? row.position : row.velocity)(axis) = T(1);
    const T expected = (group == kP ? past.motion.position : past.motion.velocity)(axis);
    correct_at<group>(period, past, row, T(sample.value(axis) * T(1 / aid.scale) - expected),
                      T(aid.variance), sample.due,
                      static_cast<std::size_t>(scalar) + static_cast<std::size_t>(axis),
                      group == kP ? kErrorPosition : kErrorVelocity, correction, used);
  }
  apply(correction, period.state);
}

/// Vehicle on the ground: velocity and rates are zero, and the accelerometer measures gravity.
template <class T>
void use_standing(const Period<T>& period, const Vector3<T>& rates, const MaskOf<T>& rates_fresh,
                  const Vector3<T>& force, const MaskOf<T>& force_fresh,
                  const MaskOf<T>& standing) {
  // The vehicle is known to stand still, so a large innovation means a large bias: nothing is
  // rejected.
  GeneralFilterSettings settings = period.settings;
  settings.gate = std::numeric_limits<double>::infinity();
  GeneralFilterState<T>& state = period.state;
  // These are not sensors and must not contribute to the innovation statistics of the estimate.
  Estimate<T> unseen;
  MaskOf<T> used{};
  Correction<T> correction;
  const Matrix3<T> R = rotation(state.motion.attitude);
  const Vector3<T> rest = R.row(2).transpose() * T(-settings.gravity);
  const Rejections<T> kept = state.rejections[0];
  state.rejections[0] = {};
  for (int i = 0; i < 3; ++i) {
    Row<T> still;
    still.velocity(i) = T(1);
    correct<kV>(settings, state, still, T(-state.motion.velocity(i)),
                T(settings.standing_velocity * settings.standing_velocity), standing, 0,
                kErrorVelocity, correction, unseen, used);
    Row<T> turning;
    turning.gyro(i) = T(1);
    correct<kGyro>(settings, state, turning, T(rates(i) - state.gyro_bias(i)),
                   T(settings.gyroscope.variance(i)), logical_and(standing, rates_fresh), 0,
                   kErrorVelocity, correction, unseen, used);
    // f = -g d + bias, d = Rᵀ e_z: δd = Rᵀ (e_z × turn)
    Row<T> felt;
    felt.force(i) = T(1);
    felt.turn(0) = T(-settings.gravity) * R(1, i);
    felt.turn(1) = T(settings.gravity) * R(0, i);
    correct<kTurn | kForce>(settings, state, felt, T(force(i) - rest(i) - state.force_bias(i)),
                            T(settings.accelerometer.variance(i)),
                            logical_and(standing, force_fresh), 0, kErrorVelocity, correction,
                            unseen, used);
  }
  state.rejections[0] = kept;
  apply(correction, state);
  const T min = T(settings.lift_off_velocity * settings.lift_off_velocity);
  T& vertical = state.P(kErrorVelocity + 2, kErrorVelocity + 2);
  vertical = select(logical_and(standing, vertical < min), min, vertical);
}

}  // namespace quadtune::general_filter_internal
