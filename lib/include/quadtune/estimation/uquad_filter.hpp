// SPDX-License-Identifier: Apache-2.0
/// The uquad's extended Kalman filter in quadtune's convention: 12 states of the rigid body and
/// three accelerometer biases. Theory: "Estimators on board".
#pragma once

#include <cstdint>
#include <string>

#include "quadtune/estimation/angles.hpp"
#include "quadtune/estimation/kalman_filter.hpp"
#include "quadtune/estimation/on_board.hpp"
#include "quadtune/model/rigid_body_jacobian.hpp"

namespace quadtune {

/// The 12 states of ned_convention(), then the accelerometer biases in body axes [m/s²].
inline constexpr int kUquadStates = 15;
inline constexpr int kForceBias = 12;  ///< index of the first bias

/// A value for each state of the filter.
template <class T>
using UquadVector = Eigen::Matrix<T, kUquadStates, 1>;

/// Variances added per period, in the order of the states: position [m²], angles [rad²], body
/// velocity [m²/s²], rates [rad²/s²], biases [m²/s⁴]. The uquad's own signs and axes do not matter
/// for a diagonal whose three entries are equal.
template <class T>
[[nodiscard]] UquadVector<T> uquad_variances(double position, double angles, double velocity,
                                             double rates, double bias) {
  UquadVector<T> result;
  for (int i = 0; i < 3; ++i) {
    result(kPosition + i) = T(position);
    result(kAttitude + i) = T(angles);
    result(kVelocity + i) = T(velocity);
    result(kRates + i) = T(rates);
    result(kForceBias + i) = T(bias);
  }
  return result;
}

/// Constant settings. validate() checks them; step() does not. The variances are those of the
/// public uquad program: per period, independent of its length, and much larger than the actual
/// process noise. With them and dt = 0.01 s, the tilt follows the accelerometer with a time
/// constant of 32 ms, although in flight the accelerometer hardly measures the tilt; use
/// uquad_filter_in_si() for flights other than hover.
template <class T>
struct UquadFilterSettings {
  double dt = 0.01;             ///< control period [s], > 0
  double calibration_time = 0;  ///< stationary interval at the start, see step() [s]; 0: none

  UquadVector<T> Q = uquad_variances<T>(100, 1, 100, 10, 1);  ///< process noise
  UquadVector<T> P0 = uquad_variances<T>(1, 1, 1, 1, 1);      ///< of the initial state
  T R_tilt = T(10);           ///< roll and pitch from the accelerometer [rad²] (uquad: psi, phi)
  T R_yaw = T(1000);          ///< from the magnetometer [rad²] (uquad: theta)
  T R_force = T(1e4);         ///< accelerometer, per axis [m²/s⁴]
  T R_rates = T(100);         ///< gyroscope, per axis [rad²/s²]
  T R_height = T(1000);       ///< barometer [m²]
  T R_gps_position = T(100);  ///< per axis [m²]
  T R_gps_velocity = T(100);  ///< per axis [m²/s²]
  T R_vision = T(0.01);       ///< position from images, per axis [m²]
  T gate = no_gate<T>();      ///< largest accepted e²/S of a scalar measurement

  /// false: the 8 states of the program without GPS. px and py are constant, u and v are 0, all
  /// four without error; GPS and vision are ignored.
  bool position = true;
  bool biases = true;  ///< false: the accelerometer's biases are 0

  /// Tilt with which the field is projected on the horizontal plane: that of the accelerometer
  /// (false), as in the original, or the estimate (true), which is better in flight, where the
  /// accelerometer mainly measures the motion.
  bool yaw_by_estimated_tilt = false;

  /// Multiplies the variances of tilt and yaw by 1 + (d/band)², with d the relative difference of
  /// |f| from g and, for the yaw, also that of |field| from its expected value.
  bool dynamic_covariance = false;
  T force_band = T(0.1);  ///< fraction of g, > 0
  T field_band = T(0.1);  ///< fraction of field_norm, > 0
  T field_norm = T(0);    ///< [µT]; 0: the mean during calibration, or no test without calibration
  T declination = T(0);   ///< of magnetic north, positive to the east [rad]
  /// [Pa] at z = 0. The calibration replaces it by its mean, which refers to the z of the initial
  /// state.
  T reference_pressure = T(101325);
  /// Time without GPS and vision after which u and v are measured as 0 with
  /// zero_velocity_variance in every period [s]. No other sensor observes them, and their
  /// covariance would grow without bound.
  T gps_timeout = T(3);
  /// [m²/s²]; 100 at 100 Hz is equivalent to 0 ± 1 m/s about once per second
  T zero_velocity_variance = T(100);
  /// Variance of the zero velocity while the vehicle stands on the ground [m²/s²]
  T standing_variance = T(0.01);

  /// Calls f("name", field of each of `s`) for every field, in the order above. The settings may
  /// differ in precision: one visitor converts, compares and serializes. The names are those of
  /// stored files and messages; that of zero_velocity_variance is "still_variance".
  template <class F, class... Settings>
  static void each_field(F&& f, Settings&... s) {
    f("dt", s.dt...);
    f("calibration_time", s.calibration_time...);
    f("Q", s.Q...);
    f("P0", s.P0...);
    f("R_tilt", s.R_tilt...);
    f("R_yaw", s.R_yaw...);
    f("R_force", s.R_force...);
    f("R_rates", s.R_rates...);
    f("R_height", s.R_height...);
    f("R_gps_position", s.R_gps_position...);
    f("R_gps_velocity", s.R_gps_velocity...);
    f("R_vision", s.R_vision...);
    f("gate", s.gate...);
    f("position", s.position...);
    f("biases", s.biases...);
    f("yaw_by_estimated_tilt", s.yaw_by_estimated_tilt...);
    f("dynamic_covariance", s.dynamic_covariance...);
    f("force_band", s.force_band...);
    f("field_band", s.field_band...);
    f("field_norm", s.field_norm...);
    f("declination", s.declination...);
    f("reference_pressure", s.reference_pressure...);
    f("gps_timeout", s.gps_timeout...);
    f("still_variance", s.zero_velocity_variance...);
    f("standing_variance", s.standing_variance...);
  }

  friend bool operator==(const UquadFilterSettings&, const UquadFilterSettings&) = default;
};

/// The same settings in another precision.
template <class To, class From>
[[nodiscard]] UquadFilterSettings<To> uquad_filter_cast(const UquadFilterSettings<From>& from) {
  UquadFilterSettings<To> to;
  to.each_field([](const char*, auto& a, const auto& b) { convert_field(a, b); }, to, from);
  return to;
}

/// The same filter with variances for a small multirotor with MEMS sensors. Standard deviations: 1
/// m/s² and 10 rad/s² of white acceleration at 100 Hz for the model, 0.02 rad/s for the gyroscope,
/// 0.3 m/s² for the accelerometer, 0.5 m for the barometer, 1 m and 0.3 m/s for GPS. Tilt from the
/// accelerometer has 0.5 rad, since in flight it is dominated by acceleration. These values are a
/// choice of this project, not of the uquad's.
template <class T>
[[nodiscard]] UquadFilterSettings<T> uquad_filter_in_si() {
  UquadFilterSettings<T> settings;
  settings.Q = uquad_variances<T>(0, 1e-8, 1e-4, 1e-2, 1e-7);
  settings.P0 = uquad_variances<T>(1, 0.01, 0.1, 0.01, 0.1);
  settings.R_tilt = T(0.25);
  settings.R_yaw = T(0.05);
  settings.R_force = T(0.1);
  settings.R_rates = T(4e-4);
  settings.R_height = T(0.25);
  settings.R_gps_position = T(1);
  settings.R_gps_velocity = T(0.1);
  settings.yaw_by_estimated_tilt = true;
  settings.dynamic_covariance = true;
  return settings;
}

/// Filter state between control periods. A copy resumes identically.
template <class T>
struct UquadFilterState {
  KalmanState<T, kUquadStates> kalman;          ///< estimate and covariance
  Vector3<T> gyro_offset = Vector3<T>::Zero();  ///< computed by the calibration [rad/s]
  T pressure_zero = T(0);                       ///< pressure at start_z [Pa]
  T start_z = T(0);                             ///< [m]
  T field_norm = T(0);                          ///< expected [µT]; 0: unknown
  Tilt<T> tilt;                                 ///< newest tilt of the accelerometer
  T force_excess = T(0);                        ///< newest | |f|/g - 1 |
  T gps_age = T(0);                             ///< since GPS or vision was last accepted [s]

  std::int64_t periods = 0;                   ///< since the start
  Vector3<T> gyro_sum = Vector3<T>::Zero();   ///< during the calibration
  Vector3<T> force_sum = Vector3<T>::Zero();  ///< of the specific force [m/s²]
  Vector3<T> field_sum = Vector3<T>::Zero();  ///< of the magnetic field [µT]
  T pressure_sum = T(0);                      ///< of the pressure [Pa]
  T gyro_count = T(0);                        ///< number of gyroscope samples
  T force_count = T(0);                       ///< number of accelerometer samples
  T field_count = T(0);                       ///< number of magnetometer samples
  T pressure_count = T(0);                    ///< number of barometer samples
};

/// The uquad's measurement vector of one period, with flags for fresh entries.
template <class T>
struct UquadMeasurement {
  Tilt<T> tilt;                                  ///< [rad]
  T yaw = T(0);                                  ///< in any turn [rad]
  Vector3<T> force = Vector3<T>::Zero();         ///< specific force, bias included [m/s²]
  Vector3<T> rates = Vector3<T>::Zero();         ///< [rad/s]
  T height = T(0);                               ///< above z = 0 [m]
  Vector3<T> gps_position = Vector3<T>::Zero();  ///< world [m]
  Vector3<T> gps_velocity = Vector3<T>::Zero();  ///< world [m/s]
  Vector3<T> vision = Vector3<T>::Zero();        ///< world [m], propagated to the present
  T tilt_variance_factor = T(1);                 ///< factor of R_tilt
  T yaw_variance_factor = T(1);                  ///< factor of R_yaw
  MaskOf<T> tilt_fresh{};                        ///< whether `tilt` is a new measurement
  MaskOf<T> yaw_fresh{};                         ///< whether `yaw` is a new measurement
  MaskOf<T> force_fresh{};                       ///< whether `force` is a new measurement
  MaskOf<T> rates_fresh{};                       ///< whether `rates` is a new measurement
  MaskOf<T> height_fresh{};                      ///< whether `height` is a new measurement
  MaskOf<T> gps_position_fresh{};                ///< whether `gps_position` is a new measurement
  MaskOf<T> gps_velocity_fresh{};                ///< whether `gps_velocity` is a new measurement
  MaskOf<T> vision_fresh{};                      ///< whether `vision` is a new measurement
};

/// Height above the level with pressure p0, in a standard troposphere [m].
/// @param pressure, p0  [Pa], > 0
template <class T>
[[nodiscard]] T barometric_height(const T& pressure, const T& p0) {
  using std::exp, std::log;
  // 44330 (1 - (p/p0)^0.190295)
  return T(44330) * (T(1) - T(exp(T(0.190295) * T(log(pressure / p0)))));
}

/// Pressure at a height [m], the inverse of barometric_height() [Pa].
template <class T>
[[nodiscard]] T barometric_pressure(const T& height, const T& p0) {
  using std::exp, std::log;
  return p0 * T(exp(T(log(T(1) - height / T(44330))) / T(0.190295)));
}

namespace uquad_filter_internal {

/// Sets errors and motion of states that the filter does not estimate to zero.
template <class T>
void leave_out(const UquadFilterSettings<T>& settings, KalmanState<T, kUquadStates>& kalman) {
  const auto clear = [&kalman](int i) {
    kalman.P.row(i).setConstant(T(0));
    kalman.P.col(i).setConstant(T(0));
  };
  if (!settings.position) {
    for (const int i : {kPosition, kPosition + 1, kVelocity, kVelocity + 1}) clear(i);
    kalman.x(kVelocity) = T(0);
    kalman.x(kVelocity + 1) = T(0);
  }
  if (!settings.biases)
    for (int i = kForceBias; i < kUquadStates; ++i) clear(i);
}

/// M = (I + h A) M by block rows; M is (15 × 15).
template <class T>
void advance_rows(const StateJacobian<T>& A, const T& h,
                  Eigen::Matrix<T, kUquadStates, kUquadStates>& M) {
  using Rows = Eigen::Matrix<T, 3, kUquadStates>;
  const Rows a = M.template middleRows<3>(kAttitude);
  const Rows v = M.template middleRows<3>(kVelocity);
  const Rows w = M.template middleRows<3>(kRates);
  M.template middleRows<3>(kPosition) +=
      (A.position_attitude.lazyProduct(a) + A.position_velocity.lazyProduct(v)) * h;
  M.template middleRows<3>(kAttitude) +=
      (A.attitude_attitude.lazyProduct(a) + A.attitude_rates.lazyProduct(w)) * h;
  M.template middleRows<3>(kVelocity) +=
      (A.velocity_attitude.lazyProduct(a) + A.velocity_velocity.lazyProduct(v) +
       A.velocity_rates.lazyProduct(w)) *
      h;
  M.template middleRows<3>(kRates) += A.rates_rates.lazyProduct(w) * h;
}

}  // namespace uquad_filter_internal

/// x ← x + dt f(x, u),  P ← F P Fᵀ + Q with F = I + dt ∂f/∂x.
/// @param settings  accepted by validate()
/// @param kalman    receives the predicted state
/// @param body      constants of the vehicle
/// @param loads     rotor loads at the speeds of the period that ends now
/// @param standing  whether the vehicle stands on the ground: nothing moves, F = I
template <class T>
void predict(const UquadFilterSettings<T>& settings, KalmanState<T, kUquadStates>& kalman,
             const RigidBody& body, const RotorLoads<T>& loads, const MaskOf<T>& standing) {
  namespace internal = uquad_filter_internal;
  const T h = select(standing, T(0), T(settings.dt));
  const StateVector<T> x = kalman.x.template head<12>();
  const StateJacobian<T> A = state_jacobian(body, x, loads);
  kalman.x.template head<12>() += state_derivative(body, x, loads) * h;
  if (!settings.position) kalman.x.template head<2>() = x.template head<2>();

  // F P Fᵀ = (F (F P)ᵀ)ᵀ since P is symmetric.
  internal::advance_rows(A, h, kalman.P);
  kalman.P.transposeInPlace();
  internal::advance_rows(A, h, kalman.P);
  for (int i = 0; i < kUquadStates; ++i) kalman.P(i, i) += settings.Q(i);
  symmetrize(kalman.P);
  internal::leave_out(settings, kalman);
}

/// Corrects by all fresh entries of a measurement, one scalar at a time, so that no matrix is
/// inverted. Rows that depend on the state are linearized once per group, which gives the same
/// result as a simultaneous correction by all three scalars of the group.
/// @param settings     accepted by validate()
/// @param kalman       receives the corrected state
/// @param body         constants of the vehicle
/// @param loads        rotor loads at the speeds of the period
/// @param measurement  of this period
/// @param seen         accumulates height_used, innovation_square and innovation_freedom
/// @return  whether GPS or vision was accepted
template <class T>
MaskOf<T> correct(const UquadFilterSettings<T>& settings, KalmanState<T, kUquadStates>& kalman,
                  const RigidBody& body, const RotorLoads<T>& loads,
                  const UquadMeasurement<T>& measurement, Estimate<T>& seen) {
  const UquadVector<T>& x = kalman.x;
  const auto use = [&](const auto& C, const T& e, const T& R, const MaskOf<T>& fresh) {
    const KalmanUpdate<T> result = update(kalman, C, e, R, fresh, settings.gate);
    seen.innovation_square += select(result.used, result.innovation_square, T(0));
    seen.innovation_freedom += select(result.used, T(1), T(0));
    return result.used;
  };
  const auto entry = [](int i) { return SparseRow<T, 1>{{i}, {T(1)}}; };

  // Angles: each innovation is wrapped to half a turn, so that the state's yaw is continuous over
  // turns.
  const MaskOf<T>& tilt_fresh = measurement.tilt_fresh;
  const T R_tilt = settings.R_tilt * measurement.tilt_variance_factor;
  use(entry(kAttitude), wrap_angle(T(measurement.tilt.roll - x(kAttitude))), R_tilt, tilt_fresh);
  use(entry(kAttitude + 1), T(measurement.tilt.pitch - x(kAttitude + 1)), R_tilt, tilt_fresh);
  use(entry(kAttitude + 2), wrap_angle(T(measurement.yaw - x(kAttitude + 2))),
      T(settings.R_yaw * measurement.yaw_variance_factor), measurement.yaw_fresh);

  // Specific force: (rotors + drag)/m + bias.
  if (any(measurement.force_fresh)) {
    using std::abs;
    const Vector3<T> v0 = x.template segment<3>(kVelocity);
    const Vector3<T> felt = (loads.force + drag_force(body, v0)) * T(1 / body.mass);
    for (int i = 0; i < 3; ++i) {
      const T slope =
          -(T(body.air_density * body.cda(i)) * T(abs(v0(i))) + T(body.linear_drag(i))) *
          T(1 / body.mass);
      const T expected = felt(i) + slope * (x(kVelocity + i) - v0(i)) + x(kForceBias + i);
      use(SparseRow<T, 2>{{kVelocity + i, kForceBias + i}, {slope, T(1)}},
          T(measurement.force(i) - expected), settings.R_force, measurement.force_fresh);
    }
  }

  for (int i = 0; i < 3; ++i)
    use(entry(kRates + i), T(measurement.rates(i) - x(kRates + i)), settings.R_rates,
        measurement.rates_fresh);

  seen.height_used = use(entry(kPosition + 2), T(-measurement.height - x(kPosition + 2)),
                         settings.R_height, measurement.height_fresh);

  MaskOf<T> believed{};
  if (settings.position && any(measurement.gps_position_fresh))
    for (int i = 0; i < 3; ++i)
      believed = logical_or(
          believed, use(entry(kPosition + i), T(measurement.gps_position(i) - x(kPosition + i)),
                        settings.R_gps_position, measurement.gps_position_fresh));
  if (settings.position && any(measurement.vision_fresh))
    for (int i = 0; i < 3; ++i)
      believed = logical_or(believed,
                            use(entry(kPosition + i), T(measurement.vision(i) - x(kPosition + i)),
                                settings.R_vision, measurement.vision_fresh));
  if (settings.position && any(measurement.gps_velocity_fresh)) {
    // R_WB v
    const UquadVector<T> x0 = x;
    const StateJacobian<T> A = state_jacobian(body, StateVector<T>(x0.template head<12>()), loads);
    const Vector3<T> v0 = A.position_velocity * x0.template segment<3>(kVelocity);
    for (int i = 0; i < 3; ++i) {
      const SparseRow<T, 6> C = {
          {kAttitude, kAttitude + 1, kAttitude + 2, kVelocity, kVelocity + 1, kVelocity + 2},
          {A.position_attitude(i, 0), A.position_attitude(i, 1), A.position_attitude(i, 2),
           A.position_velocity(i, 0), A.position_velocity(i, 1), A.position_velocity(i, 2)}};
      T expected = v0(i);
      for (std::size_t k = 0; k < 6; ++k)
        expected += C.value[k] * (x(C.column[k]) - x0(C.column[k]));
      believed = logical_or(believed, use(C, T(measurement.gps_velocity(i) - expected),
                                          settings.R_gps_velocity, measurement.gps_velocity_fresh));
    }
  }
  symmetrize(kalman.P);
  return believed;
}

/// Initial state of a filter for a known motion.
/// @param settings  accepted by validate()
/// @param x  the 12 states of ned_convention(); settings.P0 are the variances of their errors
template <class T>
[[nodiscard]] UquadFilterState<T> uquad_filter_start(const UquadFilterSettings<T>& settings,
                                                     const StateVector<T>& x) {
  UquadFilterState<T> state;
  state.kalman.x << x, Vector3<T>::Zero();
  state.kalman.P = settings.P0.asDiagonal();
  uquad_filter_internal::leave_out(settings, state.kalman);
  state.pressure_zero = settings.reference_pressure;
  state.field_norm = settings.field_norm;
  state.tilt = {x(kAttitude), x(kAttitude + 1)};
  return state;
}

/// The oldest image whose position is used [s]: the vehicle moves on while the image is processed.
inline constexpr double kMaxVisionAge = 1;

/// Converts the samples of one period to the filter's measurement. Tilt is computed from the
/// accelerometer minus its estimated bias, yaw from the field and the newest tilt. Samples that are
/// not finite count as not fresh.
template <class T>
[[nodiscard]] UquadMeasurement<T> uquad_measurement(const UquadFilterSettings<T>& settings,
                                                    UquadFilterState<T>& state,
                                                    const SensorFrame<T>& frame, const T& gravity) {
  using std::sqrt;
  const auto fresh = [](const auto& sample) {
    return logical_and(sample.fresh, entries_are_finite<T>(sample.value));
  };
  UquadMeasurement<T> m;
  m.force_fresh = fresh(frame.specific_force);
  m.rates_fresh = fresh(frame.rates);
  m.yaw_fresh = fresh(frame.magnetic_field);
  m.gps_position_fresh = fresh(frame.gps_position);
  m.gps_velocity_fresh = fresh(frame.gps_velocity);
  m.force = frame.specific_force.value;
  m.rates = frame.rates.value - state.gyro_offset;
  m.gps_position = frame.gps_position.value;
  m.gps_velocity = frame.gps_velocity.value;
  m.vision_fresh =
      logical_and(fresh(frame.vision),
                  logical_and(T(0) <= frame.vision.age, frame.vision.age <= T(kMaxVisionAge)));
  if (any(m.vision_fresh)) {
    // Image processing takes time, during which the vehicle has moved on.
    const UquadVector<T>& x = state.kalman.x;
    const Matrix3<T> R_WB = rotation_of_euler(x(kAttitude), x(kAttitude + 1), x(kAttitude + 2));
    m.vision = frame.vision.value + R_WB * x.template segment<3>(kVelocity) * frame.vision.age;
  }

  const Vector3<T> f = m.force - state.kalman.x.template tail<3>();
  const Tilt<T> tilt = tilt_from_force(f);
  const T f_norm = sqrt(f.squaredNorm());
  // In free fall the specific force is near zero and its direction carries no information.
  m.tilt_fresh = logical_and(m.force_fresh, f_norm > T(0.1) * gravity);
  state.tilt.roll = select(m.tilt_fresh, tilt.roll, state.tilt.roll);
  state.tilt.pitch = select(m.tilt_fresh, tilt.pitch, state.tilt.pitch);
  state.force_excess =
      select(m.force_fresh, abs_of(T(f_norm / gravity - T(1))), state.force_excess);
  m.tilt = state.tilt;

  const Vector3<T>& field = frame.magnetic_field.value;
  const Tilt<T> estimated = {state.kalman.x(kAttitude), state.kalman.x(kAttitude + 1)};
  m.yaw = yaw_from_field(field, settings.yaw_by_estimated_tilt ? estimated : state.tilt,
                         settings.declination);
  if (settings.dynamic_covariance) {
    const T field_excess =
        select(state.field_norm > T(0),
               abs_of(T(T(sqrt(field.squaredNorm())) / state.field_norm - T(1))), T(0));
    const T by_force = state.force_excess / settings.force_band;
    const T by_field = field_excess / settings.field_band;
    m.tilt_variance_factor = T(1) + by_force * by_force;
    m.yaw_variance_factor = m.tilt_variance_factor + by_field * by_field;
  }

  const T& pressure = frame.pressure.value;
  m.height_fresh =
      logical_and(logical_and(frame.pressure.fresh, is_finite(pressure)), pressure > T(0));
  const T safe_pressure = select(m.height_fresh, pressure, state.pressure_zero);
  m.height = barometric_height(safe_pressure, state.pressure_zero) - state.start_z;
  return m;
}

/// Processes one control period: prediction by the rotor speeds of the period that ends now,
/// correction by the samples that arrived in it.
///
/// During settings.calibration_time the vehicle is stationary. The means over that time give the
/// gyroscope offset, the pressure at the start, the attitude and, unless it is set, the expected
/// field; the estimate keeps its initial value. The initial accelerometer bias is subtracted from
/// the mean of the accelerometer. A sensor without samples changes nothing.
/// @param settings  accepted by validate()
/// @param state     of the last period; receives the new one
/// @param frame     sensors as received in this period
/// @param body      constants of the vehicle
/// @param speeds    one per rotor [rad/s]
/// @param standing  whether the vehicle stands on the ground, where gravity does not accelerate it:
///                  velocity is measured as 0, and the accelerometer is used for its tilt only
template <class T>
Estimate<T> step(const UquadFilterSettings<T>& settings, UquadFilterState<T>& state,
                 const SensorFrame<T>& frame, const RigidBody& body, const RotorSpeeds<T>& speeds,
                 const MaskOf<T>& standing) {
  const T gravity = T(body.gravity);
  UquadVector<T>& x = state.kalman.x;
  Estimate<T> estimate;
  const auto elapsed = [&] { return (static_cast<double>(state.periods) + 0.5) * settings.dt; };
  const bool calibrating = elapsed() < settings.calibration_time;
  if (state.periods == 0) state.start_z = calibrating ? x(kPosition + 2) : T(0);
  UquadMeasurement<T> m = uquad_measurement(settings, state, frame, gravity);

  if (calibrating) {
    ++state.periods;
    const auto add = [](const MaskOf<T>& fresh, const Vector3<T>& value, Vector3<T>& sum,
                        T& count) {
      for (int i = 0; i < 3; ++i) sum(i) += select(fresh, value(i), T(0));
      count += select(fresh, T(1), T(0));
    };
    add(m.rates_fresh, frame.rates.value, state.gyro_sum, state.gyro_count);
    add(m.force_fresh, m.force, state.force_sum, state.force_count);
    add(m.yaw_fresh, frame.magnetic_field.value, state.field_sum, state.field_count);
    state.pressure_sum += select(m.height_fresh, frame.pressure.value, T(0));
    state.pressure_count += select(m.height_fresh, T(1), T(0));
    if (elapsed() >= settings.calibration_time) {
      using std::sqrt;
      const auto mean = [](const Vector3<T>& sum, const T& count) {
        return Vector3<T>(sum / max_of(count, T(1)));
      };
      const Vector3<T> offset = mean(state.gyro_sum, state.gyro_count);
      const MaskOf<T> turning = state.gyro_count > T(0);
      for (int i = 0; i < 3; ++i)
        state.gyro_offset(i) = select(turning, offset(i), state.gyro_offset(i));
      const MaskOf<T> pressed = state.pressure_count > T(0);
      state.pressure_zero = select(
          pressed, T(state.pressure_sum / max_of(state.pressure_count, T(1))), state.pressure_zero);
      state.start_z = select(pressed, state.start_z, T(0));
      const Tilt<T> tilt = tilt_from_force(
          Vector3<T>(mean(state.force_sum, state.force_count) - x.template tail<3>()));
      const MaskOf<T> felt = state.force_count > T(0);
      x(kAttitude) = select(felt, tilt.roll, x(kAttitude));
      x(kAttitude + 1) = select(felt, tilt.pitch, x(kAttitude + 1));
      const Vector3<T> field = mean(state.field_sum, state.field_count);
      const MaskOf<T> turned = state.field_count > T(0);
      const T yaw =
          yaw_from_field(field, Tilt<T>{x(kAttitude), x(kAttitude + 1)}, settings.declination);
      const T before = x(kAttitude + 2);
      x(kAttitude + 2) = select(turned, T(before + wrap_angle(T(yaw - before))), before);
      state.field_norm = select(logical_and(turned, logical_not(settings.field_norm > T(0))),
                                T(sqrt(field.squaredNorm())), state.field_norm);
    }
    estimate.x = x.template head<12>();
    estimate.finite = entries_are_finite<T>(estimate.x);
    return estimate;
  }

  const RotorLoads<T> loads = rotor_loads(body, speeds);
  predict(settings, state.kalman, body, loads, standing);
  m.force_fresh = logical_and(m.force_fresh, logical_not(standing));
  const MaskOf<T> believed = correct(settings, state.kalman, body, loads, m, estimate);
  state.gps_age = select(believed, T(0), T(state.gps_age + T(settings.dt)));
  const MaskOf<T> lost =
      logical_and(MaskOf<T>(settings.position), state.gps_age > settings.gps_timeout);
  for (int i = 0; i < 3; ++i)
    update(state.kalman, SparseRow<T, 1>{{kVelocity + i}, {T(1)}}, T(-x(kVelocity + i)),
           select(standing, settings.standing_variance, settings.zero_velocity_variance),
           i < 2 ? logical_or(lost, standing) : standing);
  symmetrize(state.kalman.P);
  ++state.periods;
  estimate.x = x.template head<12>();
  estimate.finite = entries_are_finite<T>(estimate.x);
  return estimate;
}

/// Validates the settings: dt > 0, variances ≥ 0 with every R > 0, bands > 0, pressure > 0.
/// @throws InvalidInput  "where: R_tilt is 0 rad2, expected a positive number"
void validate(const UquadFilterSettings<double>& settings, const std::string& where);

/// The same for single precision.
void validate(const UquadFilterSettings<float>& settings, const std::string& where);

}  // namespace quadtune
