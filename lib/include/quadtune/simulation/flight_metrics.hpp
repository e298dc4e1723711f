// SPDX-License-Identifier: Apache-2.0
/// Computes the metrics of a flight during the simulation. add() is called once per control period
/// with the values at its beginning t; each period has the weight dt. One template over the scalar:
/// a Pack evaluates several flights.
///
/// Let p be the true position, r the position of the reference, ψ the yaw angles, ‖·‖ the Euclidean
/// norm. In periods of FlightPhase::flying the error is e = p - r; while the reference asks for
/// attitude and height instead of position, e is its vertical part only. Yaw errors are wrapped to
/// ±π.
///
/// **Steps and holds.** A *step* is a period in which flying begins, or in which r differs from the
/// previous r, extrapolated by its velocity, by more than the band (SettlingRule), or the yaw
/// reference differs from the previous one by more than its band. The reference *moves* in a period
/// in which it has a velocity or differs from the previous one by more than 1e-9 m or rad. It
/// *holds* from a step, or from the period after it last moved, to the last period before it moves
/// again, position is no longer requested, or flying or the flight ends. Only holds that last at
/// least the window are evaluated. Here and below, 1 µs is subtracted from the window because of
/// rounding.
///
/// | settling_time    | from the beginning of the hold to the end of the last period with
/// |                  | ‖e‖ > band or |yaw error| > yaw band (the settled bands if they are
/// |                  | wider), 0 if there is no such period; the maximum over all holds; infinite
/// |                  | if the last period of a hold is such a period
/// | overshoot        | max of (p - r)·d / s over holds that began with a step, where d is the
/// |                  | direction and s the distance from p in the period of the step to r; 0 if r
/// |                  | was never passed; only for s > band
/// | yaw_overshoot    | the same for the yaw
///
/// **Tracking**, over periods that begin at least the window after the last step:
///
/// | tracking_rms, _max | of ‖e‖
/// | height_rms, _max   | of the vertical part of p - r
/// | yaw_rms, _max      | of the yaw error
///
/// **All periods:**
///
/// | duration         | Σ dt
/// | tilt_max         | of the angle between body z and world z, arccos(cos roll cos pitch)
/// | speed_max        | of the speed
/// | saturation_time  | Σ dt of periods in which a motor was at a limit
/// | energy           | Σ power dt
/// | estimate_rms, _max | of ‖estimated - true position‖
/// | position_drift   | horizontal distance of (estimated - true position) in the last period from
/// |                  | that in the first
/// | final_distance   | ‖p - r‖ in the last period
/// | touchdown_speed  | maximum over all touchdowns, where the height decreases to kGroundHeight or
/// |                  | below after it exceeded kAirborneHeight: the mean downward speed between
/// |                  | the last two periods before the touchdown
/// | height_peak      | max of (height - highest reference so far) over periods of
/// |                  | FlightPhase::take_off and flying, at least 0: the overshoot of a take-off
///
/// A root mean square is √(Σ ‖·‖² dt / Σ dt). A metric without any period to compute it from is
/// NaN. After a state, an estimate or the power was not finite, all metrics except the duration are
/// NaN.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>

#include "quadtune/estimation/on_board.hpp"
#include "quadtune/model/rigid_body.hpp"
#include "quadtune/scalar.hpp"
#include "quadtune/simulation/metric.hpp"

namespace quadtune {

/// Heights of the centre of mass [m] relative to its height at rest on the ground. The vehicle is
/// on the ground at or below the first, and airborne above the second.
inline constexpr double kGroundHeight = 0.02;
inline constexpr double kAirborneHeight = 0.1;

/// The metrics of one flight, or of one flight per lane. Lanes are independent of each other.
template <class T>
class FlightMetrics {
 public:
  static_assert(!std::is_same_v<T, float>, "angles are wrapped in double precision");
  using Mask = MaskOf<T>;

  explicit FlightMetrics(const SettlingRule& rule = {}) : rule_(rule) {}

  /// Processes one control period.
  /// @param t          its beginning [s];  @param dt  its length [s], > 0
  /// @param x          true state;  @param estimate  of the flight program
  /// @param reference  set point; phase and kind are the same in every lane
  /// @param saturated  whether a motor is at a limit
  /// @param power      of the motors [W]
  /// @param counts     false in a lane whose flight has ended; its metrics do not change any more
  /// @param motors_off  true in a lane whose flight has ended while other lanes continue
  void add(double t, double dt, const StateVector<T>& x, const Estimate<T>& estimate,
           const Reference<T>& reference, const Mask& saturated, const T& power,
           const Mask& counts = Mask(true), const Mask& motors_off = Mask(false));

  /// The metrics of one lane so far.
  [[nodiscard]] MetricValues values(int which = 0) const;

 private:
  // Integral of squares over time, and the maximum square.
  struct Squares {
    T sum = T(0);
    T max_square = T(0);
    T time = T(0);

    void add(const Mask& counts, const T& square, double dt) {
      sum += select(counts, square * T(dt), T(0));
      max_square = select(logical_and(counts, square > max_square), square, max_square);
      time += select(counts, T(dt), T(0));
    }
    [[nodiscard]] double rms(int i) const {
      return lane(time, i) > 0 ? std::sqrt(lane(sum, i) / lane(time, i)) : kNone;
    }
    [[nodiscard]] double max(int i) const {
      return lane(time, i) > 0 ? std::sqrt(lane(max_square, i)) : kNone;
    }
  };

  // Tolerance when a sum of control periods is compared with the window [s].
  static constexpr double kRounding = 1e-6;
  // A reference that moves by less than this per period counts as constant [m, rad].
  static constexpr double kStill = 1e-9;
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  [[nodiscard]] static T squared(const T& x, const T& y, const T& z) {
    return x * x + y * y + z * z;
  }
  // The angle wrapped to ±π, for |angle| < 2⁵⁰; at ±π either sign is possible.
  [[nodiscard]] static T wrap_angle(const T& angle) {
    constexpr double kMagic = 6755399441055744.0;  // 1.5 · 2⁵²: adding it rounds to an integer
    const T turns = (angle * T(0.5 / std::numbers::pi) + T(kMagic)) - T(kMagic);
    return angle - turns * T(2 * std::numbers::pi);
  }
  static void keep_greater(const Mask& counts, const T& value, T& max) {
    max = select(logical_and(counts, value > max), value, max);
  }

  void add_hold(double t, double dt, const StateVector<T>& x, const Reference<T>& reference,
                const Mask& flying, const Mask& counts);
  void add_tracking(double t, double dt, const StateVector<T>& x, const Reference<T>& reference,
                    const Mask& flying);
  void add_estimate(double dt, const StateVector<T>& x, const Estimate<T>& estimate,
                    const Mask& counts);
  void add_ground(double dt, const T& height, const Mask& counts);
  void add_tilt(const T& roll, const T& pitch, const Mask& counts);
  void add_peak(const T& height, const Reference<T>& reference, const Mask& counts);
  void close_hold(const Mask& closes);

  SettlingRule rule_;
  T duration_ = T(0);
  Mask spoilt_ = Mask(false);  ///< a value was not finite

  // The current hold, and the worst values of all holds so far.
  Mask flew_ = Mask(false);  ///< whether the previous period was one of flying
  Vector3<T> reference_ = Vector3<T>::Zero();
  T reference_yaw_ = T(0);
  Mask holds_ = Mask(false);
  Mask from_step_ = Mask(false);
  T hold_begin_ = T(0);
  T hold_end_ = T(0);           ///< of the latest period
  T outside_until_ = T(0);      ///< end of the last period outside the band
  Mask outside_ = Mask(false);  ///< whether the latest period is outside the band
  Vector3<T> direction_ = Vector3<T>::Zero();
  T step_ = T(0);
  T passed_ = T(0);
  T yaw_step_ = T(0);
  T yaw_passed_ = T(0);
  Mask judged_ = Mask(false);
  T settling_ = T(0);
  Mask stepped_ = Mask(false);
  T overshoot_ = T(0);
  Mask yaw_stepped_ = Mask(false);
  T yaw_overshoot_ = T(0);

  T last_step_ = T(0);
  Squares tracking_, height_, yaw_, estimate_;

  T tilt_ = T(0);
  T speed_squared_ = T(0);
  T saturation_ = T(0);
  T energy_ = T(0);
  Mask begun_ = Mask(false);
  Eigen::Matrix<T, 2, 1> first_error_ = Eigen::Matrix<T, 2, 1>::Zero();
  T drift_squared_ = T(0);
  T final_squared_ = T(0);

  Mask airborne_ = Mask(false);
  T height_before_ = T(0);
  T sinking_ = T(0);  ///< mean downward speed between the previous two periods
  Mask touched_ = Mask(false);
  T touchdown_ = T(0);

  Mask rises_ = Mask(false);    ///< whether the vehicle has taken off or flown
  T highest_reference_ = T(0);  ///< since take-off
  T peak_ = T(0);
};

template <class T>
void FlightMetrics<T>::add(double t, double dt, const StateVector<T>& x,
                           const Estimate<T>& estimate, const Reference<T>& reference,
                           const Mask& saturated, const T& power, const Mask& counts,
                           const Mask& motors_off) {
  T sum = power;
  // NaN if any entry is not finite
  for (int i = 0; i < 12; ++i) sum += x(i) * T(0) + estimate.x(i) * T(0);
  spoilt_ = logical_or(spoilt_, logical_and(counts, logical_not(is_finite(sum))));

  const Mask flying = logical_and(logical_and(counts, logical_not(motors_off)),
                                  Mask(reference.phase == FlightPhase::flying));
  add_hold(t, dt, x, reference, flying, counts);
  add_tracking(t, dt, x, reference, flying);
  flew_ = select(counts, flying, flew_);
  for (int i = 0; i < 3; ++i) reference_(i) = select(counts, reference.position(i), reference_(i));
  reference_yaw_ = select(counts, reference.yaw, reference_yaw_);

  add_estimate(dt, x, estimate, counts);
  add_ground(dt, -x(kPosition + 2), counts);
  add_tilt(x(kAttitude), x(kAttitude + 1), counts);
  if (reference.phase == FlightPhase::take_off || reference.phase == FlightPhase::flying)
    add_peak(-x(kPosition + 2), reference, logical_and(counts, logical_not(motors_off)));
  keep_greater(counts, squared(x(kVelocity), x(kVelocity + 1), x(kVelocity + 2)), speed_squared_);
  const Vector3<T> off = x.template segment<3>(kPosition) - reference.position;
  final_squared_ = select(counts, squared(off(0), off(1), off(2)), final_squared_);
  saturation_ += select(logical_and(counts, saturated), T(dt), T(0));
  energy_ += select(counts, power * T(dt), T(0));
  duration_ += select(counts, T(dt), T(0));
  begun_ = logical_or(begun_, counts);
}

template <class T>
void FlightMetrics<T>::add_hold(double t, double dt, const StateVector<T>& x,
                                const Reference<T>& reference, const Mask& flying,
                                const Mask& counts) {
  using std::sqrt;
  const T band = T(rule_.band), yaw_band = T(rule_.yaw_band);
  const Vector3<T> change = reference.position - reference_;
  const Vector3<T> unforeseen = change - reference.velocity * T(dt);
  const T turned = abs_of(reference.yaw - reference_yaw_);
  const T jump_squared = squared(unforeseen(0), unforeseen(1), unforeseen(2));
  const Mask jumped = logical_or(jump_squared > band * band, turned > yaw_band);
  const Mask step = logical_and(flying, logical_or(logical_not(flew_), jumped));
  const Vector3<T>& speed = reference.velocity;
  const Mask goes = logical_or(squared(change(0), change(1), change(2)) > T(kStill * kStill),
                               squared(speed(0), speed(1), speed(2)) > T(0));
  const Mask moved = logical_or(goes, turned > T(kStill));
  const Mask asked = logical_and(flying, Mask(reference.track_position));
  const Mask ends = logical_and(logical_and(counts, holds_),
                                logical_or(logical_not(asked), logical_or(step, moved)));
  close_hold(ends);
  const Mask begins =
      logical_and(asked, logical_or(step, logical_and(logical_not(moved), logical_not(holds_))));
  holds_ = logical_and(logical_or(begins, holds_), logical_or(begins, logical_not(ends)));

  // p and r in the first period of the hold.
  const Vector3<T> off = x.template segment<3>(kPosition) - reference.position;
  const T distance = sqrt(squared(off(0), off(1), off(2)));
  const T yaw_off = wrap_angle(x(kAttitude + 2) - reference.yaw);
  from_step_ = select(begins, step, from_step_);
  hold_begin_ = select(begins, T(t), hold_begin_);
  outside_until_ = select(begins, T(t), outside_until_);
  step_ = select(begins, distance, step_);
  for (int i = 0; i < 3; ++i)
    direction_(i) =
        select(begins, select(distance > T(0), -off(i) / distance, T(0)), direction_(i));
  yaw_step_ = select(begins, -yaw_off, yaw_step_);
  passed_ = select(begins, T(0), passed_);
  yaw_passed_ = select(begins, T(0), yaw_passed_);

  last_step_ = select(step, T(t), last_step_);

  const Mask goes_on = logical_and(counts, holds_);
  const T end = T(t + dt);
  hold_end_ = select(goes_on, end, hold_end_);
  const T settled = T(std::max(rule_.band, rule_.settled_band));
  const T yaw_settled = T(std::max(rule_.yaw_band, rule_.settled_yaw_band));
  outside_ =
      select(goes_on, logical_or(distance > settled, abs_of(yaw_off) > yaw_settled), outside_);
  outside_until_ = select(logical_and(goes_on, outside_), end, outside_until_);
  const T along = off(0) * direction_(0) + off(1) * direction_(1) + off(2) * direction_(2);
  keep_greater(goes_on, along, passed_);
  keep_greater(goes_on, select(yaw_step_ < T(0), -yaw_off, yaw_off), yaw_passed_);
}

template <class T>
void FlightMetrics<T>::close_hold(const Mask& closes) {
  const Mask judged = logical_and(closes, hold_end_ - hold_begin_ >= T(rule_.window - kRounding));
  const T settling = select(outside_, T(kNever), outside_until_ - hold_begin_);
  keep_greater(judged, settling, settling_);
  judged_ = logical_or(judged_, judged);
  const Mask stepped = logical_and(judged, logical_and(from_step_, step_ > T(rule_.band)));
  keep_greater(stepped, passed_ / step_, overshoot_);
  stepped_ = logical_or(stepped_, stepped);
  const T yaw_step = abs_of(yaw_step_);
  const Mask yaw_stepped =
      logical_and(judged, logical_and(from_step_, yaw_step > T(rule_.yaw_band)));
  keep_greater(yaw_stepped, yaw_passed_ / yaw_step, yaw_overshoot_);
  yaw_stepped_ = logical_or(yaw_stepped_, yaw_stepped);
}

template <class T>
void FlightMetrics<T>::add_tracking(double t, double dt, const StateVector<T>& x,
                                    const Reference<T>& reference, const Mask& flying) {
  const Mask counted = logical_and(flying, T(t) - last_step_ >= T(rule_.window - kRounding));
  const Vector3<T> off = x.template segment<3>(kPosition) - reference.position;
  const T vertical = off(2) * off(2);
  const T whole = squared(off(0), off(1), off(2));
  tracking_.add(counted, reference.track_position ? whole : vertical, dt);
  height_.add(counted, vertical, dt);
  const T yaw_off = wrap_angle(x(kAttitude + 2) - reference.yaw);
  yaw_.add(counted, yaw_off * yaw_off, dt);
}

template <class T>
void FlightMetrics<T>::add_estimate(double dt, const StateVector<T>& x, const Estimate<T>& estimate,
                                    const Mask& counts) {
  const Vector3<T> error =
      estimate.x.template segment<3>(kPosition) - x.template segment<3>(kPosition);
  estimate_.add(counts, squared(error(0), error(1), error(2)), dt);
  const Mask first = logical_and(counts, logical_not(begun_));
  for (int i = 0; i < 2; ++i) first_error_(i) = select(first, error(i), first_error_(i));
  const T north = error(0) - first_error_(0), east = error(1) - first_error_(1);
  drift_squared_ = select(counts, north * north + east * east, drift_squared_);
}

template <class T>
void FlightMetrics<T>::add_ground(double dt, const T& height, const Mask& counts) {
  const Mask touches = logical_and(logical_and(counts, airborne_), height <= T(kGroundHeight));
  keep_greater(touches, sinking_, touchdown_);
  touched_ = logical_or(touched_, touches);
  const Mask up =
      logical_or(logical_and(airborne_, logical_not(touches)), height > T(kAirborneHeight));
  airborne_ = select(counts, up, airborne_);
  const T sunk = select(begun_, (height_before_ - height) / T(dt), T(0));
  sinking_ = select(counts, sunk, sinking_);
  height_before_ = select(counts, height, height_before_);
}

template <class T>
void FlightMetrics<T>::add_tilt(const T& roll, const T& pitch, const Mask& counts) {
  // The angle between the axes is at most √(roll² + pitch²): on a sphere the hypotenuse of a right
  // triangle is not longer than in the plane. A new maximum is therefore rare, and its sines need
  // not be computed in lanes.
  const Mask may_be_greater = logical_and(counts, roll * roll + pitch * pitch > tilt_ * tilt_);
  if (!any(may_be_greater)) return;
  for (int i = 0; i < kLanesOf<T>; ++i) {
    if (!lane(may_be_greater, i)) continue;
    const double cp = std::cos(lane(pitch, i)), sp = std::sin(lane(pitch, i));
    const double cr = std::cos(lane(roll, i)), sr = std::sin(lane(roll, i));
    const double tilt = std::atan2(std::sqrt(sp * sp + cp * cp * sr * sr), cr * cp);
    if (tilt > lane(tilt_, i)) set_lane(tilt_, i, tilt);
  }
}

template <class T>
void FlightMetrics<T>::add_peak(const T& height, const Reference<T>& reference,
                                const Mask& counts) {
  const T asked = -reference.position(2);
  const Mask begins = logical_and(counts, logical_not(rises_));
  highest_reference_ = select(begins, asked, highest_reference_);
  keep_greater(counts, asked, highest_reference_);
  keep_greater(counts, T(height - highest_reference_), peak_);
  rises_ = logical_or(rises_, counts);
}

template <class T>
MetricValues FlightMetrics<T>::values(int which) const {
  const int i = which;
  MetricValues figures;
  figures[Metric::duration] = lane(duration_, i);
  if (!lane(begun_, i) || lane(spoilt_, i)) return figures;
  FlightMetrics<T> ended = *this;
  ended.close_hold(holds_);
  if (lane(ended.judged_, i)) figures[Metric::settling_time] = lane(ended.settling_, i);
  if (lane(ended.stepped_, i)) figures[Metric::overshoot] = lane(ended.overshoot_, i);
  if (lane(ended.yaw_stepped_, i)) figures[Metric::yaw_overshoot] = lane(ended.yaw_overshoot_, i);
  figures[Metric::tracking_rms] = tracking_.rms(i);
  figures[Metric::tracking_max] = tracking_.max(i);
  figures[Metric::height_rms] = height_.rms(i);
  figures[Metric::height_max] = height_.max(i);
  figures[Metric::yaw_rms] = yaw_.rms(i);
  figures[Metric::yaw_max] = yaw_.max(i);
  figures[Metric::tilt_max] = lane(tilt_, i);
  figures[Metric::speed_max] = std::sqrt(lane(speed_squared_, i));
  figures[Metric::saturation_time] = lane(saturation_, i);
  figures[Metric::energy] = lane(energy_, i);
  figures[Metric::estimate_rms] = estimate_.rms(i);
  figures[Metric::estimate_max] = estimate_.max(i);
  figures[Metric::position_drift] = std::sqrt(lane(drift_squared_, i));
  figures[Metric::final_distance] = std::sqrt(lane(final_squared_, i));
  if (lane(touched_, i)) figures[Metric::touchdown_speed] = lane(touchdown_, i);
  if (lane(rises_, i)) figures[Metric::height_peak] = lane(peak_, i);
  return figures;
}

}  // namespace quadtune
