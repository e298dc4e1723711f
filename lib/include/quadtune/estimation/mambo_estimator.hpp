// SPDX-License-Identifier: Apache-2.0
/// The Mambo's estimator: attitude by a complementary filter, height from sonar and horizontal
/// velocity from optical flow by two small Kalman filters. Theory: "Estimators on board".
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "quadtune/estimation/complementary_filter.hpp"
#include "quadtune/estimation/kalman_filter.hpp"
#include "quadtune/estimation/on_board.hpp"

namespace quadtune {

/// Maximum of MamboEstimatorSettings::aligned_periods.
inline constexpr int kMaxAlignedPeriods = 32;

/// The velocity that is integrated to the horizontal position.
enum class MamboPosition {
  filtered_velocity,  ///< estimate of the Kalman filter, as in the original
  /// unfiltered velocity of the optical flow, to quantify the benefit of the filter
  flow_velocity,
};

/// Constant settings. validate() checks them; step() does not. The defaults are those of Oliveira
/// 2020, tables 3.1 and 3.2, and of the Mambo project where it defines them.
template <class T>
struct MamboEstimatorSettings {
  double dt = 0.005;    ///< control period [s], > 0
  T gravity = T(9.81);  ///< [m/s²], > 0
  /// Duration of the initial calibration [s]. Meanwhile the vehicle is stationary in the attitude
  /// given to mambo_estimator_start(); the mean errors of gyroscope and accelerometer are
  /// subtracted from then on. 0: no calibration.
  double calibration_time = 0;

  T attitude_time_constant = T(1);  ///< ComplementaryFilterSettings::time_constant [s]
  T force_band = T(0.25);           ///< ComplementaryFilterSettings::force_band
  /// ComplementaryFilterSettings::bias_time_constant [s]; infinite: off
  T bias_time_constant = T(std::numeric_limits<double>::infinity());

  T altitude_Q = T(0.0005);    ///< process noise of vz per period [m²/s²], table 3.1
  T altitude_R = T(0.1);       ///< measurement noise of the sonar [m²]
  T sonar_min = T(0.1);        ///< shortest accepted echo [m]
  T sonar_max = T(5);          ///< longest accepted echo [m]
  T sonar_jump = T(0.3);       ///< largest accepted difference between consecutive echoes [m]
  T sonar_deviation = T(0.4);  ///< largest accepted difference from the estimated height [m]
  /// After this time without an echo that passes both gates, an echo that agrees with the previous
  /// one restarts the height estimate [s]. Otherwise the gates would reject every echo for ever
  /// above a table.
  T sonar_recovery_time = T(1);

  T velocity_Q = T(0.09);  ///< process noise per axis and period [m²/s²], table 3.2
  T velocity_R = T(5);     ///< measurement noise of the flow velocity, per axis [m²/s²]
  /// Correction factor of the original. 1 is right for a flow without scale error.
  T flow_scale = T(1.15);
  /// Fraction of the flow due to body rates that is subtracted, for x and for y. 0 subtracts
  /// nothing, as in the original; 1 + a²/3 and 1 + b²/3 compensate the mean over an image with half
  /// fields of view a and b.
  T flow_compensation_x = T(0);
  T flow_compensation_y = T(0);  ///< likewise for y
  /// Total lag of a gyroscope reading: delay plus the lag of its response [s], ≥ 0.
  T gyro_lag = T(0);
  /// Number of control periods for which flows and gyroscope readings are stored, so that each flow
  /// is corrected by the body rates at the time of its image; see flow_alignment_periods(). 0: each
  /// flow is corrected by the newest reading, as in the original, which destabilizes a vehicle with
  /// a delayed gyroscope at height.
  int aligned_periods = 0;
  T flow_min_height = T(0.4);  ///< estimated height below which the flow is not used [m]
  T flow_timeout = T(0.1);     ///< age at which the newest flow is no longer used [s]
  /// true: the newest flow corrects in every period until the next one arrives, as in the original;
  /// false: only once.
  bool hold_flow = true;
  T flow_disagreement = T(1);  ///< difference above which Estimate::flow_disagrees is set [m/s]

  MamboPosition position = MamboPosition::filtered_velocity;  ///< source of the horizontal position
  /// process noise of px and py per period, for velocity errors that last seconds [m²]
  T position_Q = T(1e-6);
  T vision_R = T(0.0025);  ///< measurement noise of a vision position, per axis [m²]

  /// Calls f("name", field of each of `s`) for every field, in the order above. The settings may
  /// differ in precision: one visitor converts, compares and serializes. The names are those of
  /// stored files and messages; those of sonar_min, sonar_max and flow_min_height are
  /// "sonar_least", "sonar_greatest" and "flow_least_height".
  template <class F, class... Settings>
  static void each_field(F&& f, Settings&... s) {
    f("dt", s.dt...);
    f("gravity", s.gravity...);
    f("calibration_time", s.calibration_time...);
    f("attitude_time_constant", s.attitude_time_constant...);
    f("force_band", s.force_band...);
    f("bias_time_constant", s.bias_time_constant...);
    f("altitude_Q", s.altitude_Q...);
    f("altitude_R", s.altitude_R...);
    f("sonar_least", s.sonar_min...);
    f("sonar_greatest", s.sonar_max...);
    f("sonar_jump", s.sonar_jump...);
    f("sonar_deviation", s.sonar_deviation...);
    f("sonar_recovery_time", s.sonar_recovery_time...);
    f("velocity_Q", s.velocity_Q...);
    f("velocity_R", s.velocity_R...);
    f("flow_scale", s.flow_scale...);
    f("flow_compensation_x", s.flow_compensation_x...);
    f("flow_compensation_y", s.flow_compensation_y...);
    f("gyro_lag", s.gyro_lag...);
    f("aligned_periods", s.aligned_periods...);
    f("flow_least_height", s.flow_min_height...);
    f("flow_timeout", s.flow_timeout...);
    f("hold_flow", s.hold_flow...);
    f("flow_disagreement", s.flow_disagreement...);
    f("position", s.position...);
    f("position_Q", s.position_Q...);
    f("vision_R", s.vision_R...);
  }

  friend bool operator==(const MamboEstimatorSettings&, const MamboEstimatorSettings&) = default;
};

/// The settings of the complementary filter.
template <class T>
[[nodiscard]] ComplementaryFilterSettings<T> attitude_settings(
    const MamboEstimatorSettings<T>& settings) {
  return {settings.dt, settings.gravity, settings.attitude_time_constant, settings.force_band,
          settings.bias_time_constant};
}

/// Flow and gyroscope reading of one control period, stored for alignment in time.
template <class T>
struct FlowMoment {
  Eigen::Matrix<T, 2, 1> rates = Eigen::Matrix<T, 2, 1>::Zero();  ///< p, q as measured [rad/s]
  Eigen::Matrix<T, 2, 1> flow = Eigen::Matrix<T, 2, 1>::Zero();   ///< newest flow [rad/s]
  T age = T(0);      ///< age of the flow's image when the flow arrived [s]
  MaskOf<T> came{};  ///< whether a flow arrived in this period
};

/// Estimator state between control periods. A copy resumes identically.
template <class T>
struct MamboEstimatorState {
  ComplementaryFilterState<T> attitude;        ///< angles and gyroscope bias
  Vector3<T> force = Vector3<T>::Zero();       ///< newest specific force [m/s²]
  Vector3<T> force_bias = Vector3<T>::Zero();  ///< computed by the calibration [m/s²]
  KalmanState<T, 2> altitude;                  ///< z, vz, predicted for the next period
  /// vx, vy in world axes, predicted for the next period
  KalmanState<T, 2> velocity;
  Eigen::Matrix<T, 2, 1> position = Eigen::Matrix<T, 2, 1>::Zero();  ///< ∫ filtered velocity [m]
  Eigen::Matrix<T, 2, 1> flow_position = Eigen::Matrix<T, 2, 1>::Zero();  ///< ∫ flow velocity [m]
  T position_variance = T(0);  ///< of either position, per axis [m²]

  T echo_height = T(0);    ///< of the last echo in range, accepted or not [m]
  T rejected_time = T(0);  ///< since the last accepted echo [s]
  Eigen::Matrix<T, 2, 1> flow = Eigen::Matrix<T, 2, 1>::Zero();  ///< newest, compensated [rad/s]
  T flow_age = T(0);                                             ///< [s]
  /// whether any flow has arrived yet
  MaskOf<T> flow_seen{};
  /// newest first, aligned_periods entries in use
  std::array<FlowMoment<T>, kMaxAlignedPeriods> moments{};

  std::int64_t periods = 0;                   ///< since the start
  Vector3<T> gyro_sum = Vector3<T>::Zero();   ///< during the calibration
  Vector3<T> force_sum = Vector3<T>::Zero();  ///< likewise
  T gyro_count = T(0);                        ///< number of gyroscope samples in the sum
  T force_count = T(0);                       ///< number of accelerometer samples in the sum
};

/// Minimum of cos roll · cos pitch at which sonar and flow are used: 60° of tilt.
inline constexpr double kMinTiltCosine = 0.5;

/// Initial state of an estimator for a known motion.
/// @param settings  accepted by validate()
/// @param x         the 12 states of ned_convention()
template <class T>
[[nodiscard]] MamboEstimatorState<T> mambo_estimator_start(
    const MamboEstimatorSettings<T>& settings, const StateVector<T>& x) {
  MamboEstimatorState<T> state;
  const Matrix3<T> R_WB = rotation_of_euler(x(3), x(4), x(5));
  const Vector3<T> velocity = R_WB * x.template segment<3>(kVelocity);
  state.attitude.angles = x.template segment<3>(kAttitude);
  state.attitude.gyro = x.template segment<3>(kRates);
  state.force = R_WB.row(2).transpose() * T(-settings.gravity);
  state.altitude.x << x(2), velocity.z();
  state.velocity.x = velocity.template head<2>();
  state.position = x.template head<2>();
  state.flow_position = state.position;
  state.echo_height = -x(2);
  return state;
}

/// Horizontal velocity in world axes that corresponds to a flow.
/// @param flow    mean image velocity over focal length, rotation compensated [rad/s]
/// @param height  of the camera above the ground [m]
/// @param down_velocity  vz, which cannot be computed from the flow [m/s]
/// @param R_WB    body to world; the camera looks along body z
template <class T>
[[nodiscard]] Eigen::Matrix<T, 2, 1> velocity_of_flow(const Eigen::Matrix<T, 2, 1>& flow,
                                                      const T& height, const T& down_velocity,
                                                      const Matrix3<T>& R_WB) {
  // Distance to the ground along body z; flow = -velocity / depth.
  const T cosine = max_of(R_WB(2, 2), T(kMinTiltCosine));
  const T depth = height / cosine;
  const T u = -flow(0) * depth;
  const T v = -flow(1) * depth;
  // The third component follows from vz = (R_WB (u, v, w))_z.
  const T w = (down_velocity - R_WB(2, 0) * u - R_WB(2, 1) * v) / cosine;
  return {R_WB(0, 0) * u + R_WB(0, 1) * v + R_WB(0, 2) * w,
          R_WB(1, 0) * u + R_WB(1, 1) * v + R_WB(1, 2) * w};
}

/// A flow corrected by the body rates at the time of its image.
template <class T>
struct AlignedFlow {
  Eigen::Matrix<T, 2, 1> translation = Eigen::Matrix<T, 2, 1>::Zero();  ///< [rad/s]
  MaskOf<T> due{};  ///< whether a corrected flow became available in this period
};

/// Stores this period's reading and flow, and returns the flow that can be corrected now. That is
/// the first period in which the gyroscope readings cover the time of the flow's image: the period
/// of its arrival, or up to aligned_periods - 1 periods later.
template <class T>
[[nodiscard]] AlignedFlow<T> aligned_flow(const MamboEstimatorSettings<T>& settings,
                                          MamboEstimatorState<T>& state, const Vector3<T>& rates,
                                          const Sample<Eigen::Matrix<T, 2, 1>, T>& flow,
                                          const MaskOf<T>& fresh) {
  const int n = settings.aligned_periods;
  const T dt = T(settings.dt);
  auto& moments = state.moments;
  for (int j = n - 1; j > 0; --j)
    moments[static_cast<std::size_t>(j)] = moments[static_cast<std::size_t>(j - 1)];
  moments[0] = {{rates.x(), rates.y()}, flow.value, flow.age, fresh};
  AlignedFlow<T> result;
  for (int j = n - 1; j >= 0; --j) {
    const FlowMoment<T>& moment = moments[static_cast<std::size_t>(j)];
    // Control periods since the gyroscope readings first covered the time of the image, up to
    // rounding.
    const T ago = (moment.age - settings.gyro_lag) / dt + T(j);
    const MaskOf<T> told = ago > T(-1e-6);
    const MaskOf<T> now = j == 0 ? told : logical_and(told, logical_not(ago > T(1 - 1e-6)));
    const MaskOf<T> due = logical_and(moment.came, now);
    if (!any(due)) continue;
    Eigen::Matrix<T, 2, 1> turning = Eigen::Matrix<T, 2, 1>::Zero();
    const T back = clamped(ago, T(0), T(n - 1));
    for (int i = 0; i < n; ++i) {
      // Linear interpolation between two readings.
      const T weight = max_of(T(T(1) - abs_of(T(back - T(i)))), T(0));
      turning += moments[static_cast<std::size_t>(i)].rates * weight;
    }
    const Eigen::Matrix<T, 2, 1> translation = {
        moment.flow(0) + settings.flow_compensation_x * turning.y(),
        moment.flow(1) - settings.flow_compensation_y * turning.x()};
    result.translation = select_entries<T>(due, translation, result.translation);
    result.due = logical_or(result.due, due);
  }
  return result;
}

/// The number of control periods that aligned_flow() must store.
/// @param gyro_lag    [s], ≥ 0
/// @param flow_delay  from the image to the arrival of its flow [s], ≥ 0
/// @param dt          control period [s], > 0
[[nodiscard]] int flow_alignment_periods(double gyro_lag, double flow_delay, double dt);

namespace mambo_internal {

template <class T>
using Vector2 = Eigen::Matrix<T, 2, 1>;

/// Time since the start plus half a period, which guards comparisons against rounding [s].
template <class T>
[[nodiscard]] double elapsed(const MamboEstimatorSettings<T>& settings,
                             const MamboEstimatorState<T>& state) {
  return (static_cast<double>(state.periods) + 0.5) * settings.dt;
}

/// One period of calibration: the vehicle does not move; at the end the means of the sensors become
/// their offsets.
template <class T>
void stand(const MamboEstimatorSettings<T>& settings, MamboEstimatorState<T>& state,
           const Vector3<T>& gyro, const MaskOf<T>& gyro_fresh, const MaskOf<T>& force_fresh,
           Estimate<T>& estimate) {
  ++state.periods;
  state.gyro_sum += select_entries<T>(gyro_fresh, gyro, Vector3<T>(Vector3<T>::Zero()));
  state.force_sum += select_entries<T>(force_fresh, state.force, Vector3<T>(Vector3<T>::Zero()));
  state.gyro_count += select(gyro_fresh, T(1), T(0));
  state.force_count += select(force_fresh, T(1), T(0));
  const Vector3<T>& angles = state.attitude.angles;
  const Matrix3<T> R_WB = rotation_of_euler(angles.x(), angles.y(), angles.z());
  if (elapsed(settings, state) >= settings.calibration_time) {
    const Vector3<T> rest = R_WB.row(2).transpose() * T(-settings.gravity);
    state.attitude.gyro_bias = state.gyro_sum / max_of(state.gyro_count, T(1));
    state.attitude.gyro = gyro;
    state.force_bias = select_entries<T>(
        state.force_count > T(0),
        Vector3<T>(state.force_sum / max_of(state.force_count, T(1)) - rest), state.force_bias);
  }
  estimate.x << state.position, state.altitude.x(0), angles, Vector3<T>::Zero(), Vector3<T>::Zero();
  estimate.finite = entries_are_finite<T>(estimate.x);
}

/// Estimates height and vertical speed by the sonar. After sonar_recovery_time without an echo near
/// the estimate, two consistent echoes restart the filter.
/// @param upright  whether the sonar points to the ground
template <class T>
void correct_height(const MamboEstimatorSettings<T>& settings, MamboEstimatorState<T>& state,
                    const Sample<T, T>& sonar, const Matrix3<T>& R_WB, const MaskOf<T>& upright,
                    Estimate<T>& estimate) {
  // NaN means no echo; comparisons with NaN are false.
  const T range = sonar.value;
  const T echo_height = range * R_WB(2, 2);
  const MaskOf<T> echo =
      logical_and(logical_and(sonar.fresh, upright),
                  logical_and(range >= settings.sonar_min, range <= settings.sonar_max));
  const MaskOf<T> steady =
      logical_and(echo, abs_of(T(echo_height - state.echo_height)) <= settings.sonar_jump);
  const MaskOf<T> near = abs_of(T(echo_height + state.altitude.x(0))) <= settings.sonar_deviation;
  const MaskOf<T> anew = logical_and(logical_and(steady, logical_not(near)),
                                     state.rejected_time >= settings.sonar_recovery_time);
  KalmanState<T, 2> restarted = state.altitude;
  restarted.x(0) = -echo_height;
  restarted.P << settings.altitude_R, T(0), T(0), T(1);  // the speed is known to 1 m/s
  state.altitude.x = select_entries<T>(anew, restarted.x, state.altitude.x);
  state.altitude.P = select_entries<T>(anew, restarted.P, state.altitude.P);
  const KalmanUpdate<T> height_update =
      update(state.altitude, Eigen::Matrix<T, 1, 2>(T(1), T(0)), -echo_height, settings.altitude_R,
             logical_and(steady, near));
  estimate.height_used = logical_or(height_update.used, anew);
  estimate.innovation_square += height_update.innovation_square;
  estimate.innovation_freedom += select(height_update.used, T(1), T(0));
  state.echo_height = select(echo, echo_height, state.echo_height);
  state.rejected_time = select(estimate.height_used, T(0), T(state.rejected_time + T(settings.dt)));
}

/// Horizontal velocity computed from the newest flow, and whether it is used.
template <class T>
struct FlowVelocity {
  Vector2<T> value;  ///< world [m/s]
  MaskOf<T> valid;
};

/// Estimates the horizontal velocity by optical flow. The flow is compensated for rotation on
/// arrival, because the correction depends on the body rates at that time.
template <class T>
FlowVelocity<T> correct_velocity(const MamboEstimatorSettings<T>& settings,
                                 MamboEstimatorState<T>& state, const Sample<Vector2<T>, T>& flow,
                                 const Vector3<T>& rates, const Matrix3<T>& R_WB,
                                 const MaskOf<T>& upright, Estimate<T>& estimate) {
  using Matrix2 = Eigen::Matrix<T, 2, 2>;
  const MaskOf<T> fresh = logical_and(flow.fresh, entries_are_finite<T>(flow.value));
  AlignedFlow<T> come = {{flow.value(0) + settings.flow_compensation_x * rates.y(),
                          flow.value(1) - settings.flow_compensation_y * rates.x()},
                         fresh};
  if (settings.aligned_periods > 0) come = aligned_flow(settings, state, rates, flow, fresh);
  state.flow = select_entries<T>(come.due, come.translation, state.flow);
  state.flow_age = select(come.due, T(0), T(state.flow_age + T(settings.dt)));
  state.flow_seen = logical_or(state.flow_seen, come.due);
  const T z = state.altitude.x(0), vz = state.altitude.x(1);
  FlowVelocity<T> measured;
  measured.value = velocity_of_flow<T>(state.flow * settings.flow_scale, -z, vz, R_WB);
  measured.valid =
      logical_and(logical_and(state.flow_seen, state.flow_age <= settings.flow_timeout),
                  logical_and(upright, -z >= settings.flow_min_height));
  const Vector2<T> difference = measured.value - state.velocity.x;
  estimate.flow_disagrees =
      logical_and(measured.valid, difference(0) * difference(0) + difference(1) * difference(1) >
                                      settings.flow_disagreement * settings.flow_disagreement);
  const KalmanUpdate<T> flow_update =
      update(state.velocity, Matrix2(Matrix2::Identity()), measured.value,
             Matrix2(Matrix2::Identity() * settings.velocity_R),
             settings.hold_flow ? measured.valid : logical_and(measured.valid, come.due));
  estimate.flow_used = flow_update.used;
  estimate.innovation_square += flow_update.innovation_square;
  estimate.innovation_freedom += select(flow_update.used, T(2), T(0));
  return measured;
}

/// Corrects the horizontal position by vision, propagated over the processing time of the image.
template <class T>
void correct_position(const MamboEstimatorSettings<T>& settings, MamboEstimatorState<T>& state,
                      const Sample<Vector3<T>, T>& vision) {
  const MaskOf<T> seen = logical_and(vision.fresh, entries_are_finite<T>(vision.value));
  if (!any(seen)) return;
  const T& P = state.position_variance;
  const T gain = select(seen, T(P / (P + settings.vision_R)), T(0));
  const Vector2<T> fix = select_entries<T>(
      seen, Vector2<T>(vision.value.template head<2>() + state.velocity.x * vision.age),
      state.position);
  state.flow_position += select_entries<T>(seen, Vector2<T>(fix - state.flow_position),
                                           Vector2<T>(Vector2<T>::Zero())) *
                         gain;
  state.position += (fix - state.position) * gain;
  state.position_variance -= gain * P;
}

/// Predicts the state for the next period.
/// @param acceleration  in world axes, gravity added [m/s²]
template <class T>
void predict_next(const MamboEstimatorSettings<T>& settings, MamboEstimatorState<T>& state,
                  const FlowVelocity<T>& flow, const Vector3<T>& acceleration) {
  const T dt = T(settings.dt);
  state.position += state.velocity.x * dt;
  state.position_variance += settings.position_Q;
  state.flow_position +=
      select_entries<T>(flow.valid, Vector2<T>(flow.value * dt), Vector2<T>(Vector2<T>::Zero()));
  KalmanModel<T, 2, 1> altitude;
  altitude.F(0, 1) = dt;
  altitude.G(1, 0) = dt;
  altitude.Q(1, 1) = settings.altitude_Q;
  predict(altitude, state.altitude, Eigen::Matrix<T, 1, 1>(acceleration.z()));
  KalmanModel<T, 2, 2> horizontal;
  horizontal.G(0, 0) = dt;
  horizontal.G(1, 1) = dt;
  horizontal.Q(0, 0) = settings.velocity_Q;
  horizontal.Q(1, 1) = settings.velocity_Q;
  predict(horizontal, state.velocity, Vector2<T>(acceleration.template head<2>()));
  ++state.periods;
}

}  // namespace mambo_internal

/// Processes one control period: computes the estimate from the newest samples.
///
/// The filters correct with this period's measurement (tables 3.1 and 3.2, measurement and update),
/// output their estimate, and predict the next period with this period's acceleration. The position
/// is the sum of the previous velocities times dt. If a camera provides positions, they correct px
/// and py, propagated by the estimated velocity over the age of the image. Inputs that are not
/// finite count as not fresh.
template <class T>
Estimate<T> step(const MamboEstimatorSettings<T>& settings, MamboEstimatorState<T>& state,
                 const SensorFrame<T>& frame) {
  namespace internal = mambo_internal;
  Estimate<T> estimate;
  const MaskOf<T> gyro_fresh =
      logical_and(frame.rates.fresh, entries_are_finite<T>(frame.rates.value));
  const MaskOf<T> force_fresh =
      logical_and(frame.specific_force.fresh, entries_are_finite<T>(frame.specific_force.value));
  const Vector3<T> gyro = select_entries<T>(gyro_fresh, frame.rates.value, state.attitude.gyro);
  state.force = select_entries<T>(force_fresh, frame.specific_force.value, state.force);
  if (internal::elapsed(settings, state) < settings.calibration_time) {
    internal::stand(settings, state, gyro, gyro_fresh, force_fresh, estimate);
    return estimate;
  }

  const Vector3<T> force = state.force - state.force_bias;
  step(attitude_settings(settings), state.attitude, gyro, force, force_fresh);
  const Vector3<T>& angles = state.attitude.angles;
  const Vector3<T> rates = gyro - state.attitude.gyro_bias;
  const Matrix3<T> R_WB = rotation_of_euler(angles.x(), angles.y(), angles.z());
  Vector3<T> acceleration = R_WB * force;
  acceleration.z() += settings.gravity;
  const MaskOf<T> upright = R_WB(2, 2) > T(kMinTiltCosine);

  internal::correct_height(settings, state, frame.sonar, R_WB, upright, estimate);
  const internal::FlowVelocity<T> flow =
      internal::correct_velocity(settings, state, frame.flow, rates, R_WB, upright, estimate);
  internal::correct_position(settings, state, frame.vision);

  const Vector3<T> velocity = {state.velocity.x(0), state.velocity.x(1), state.altitude.x(1)};
  const bool raw = settings.position == MamboPosition::flow_velocity;
  estimate.x << (raw ? state.flow_position : state.position), state.altitude.x(0), angles,
      Vector3<T>(R_WB.transpose() * velocity), rates;
  estimate.finite = entries_are_finite<T>(estimate.x);
  internal::predict_next(settings, state, flow, acceleration);
  return estimate;
}

/// The same settings in another precision.
template <class To, class From>
[[nodiscard]] MamboEstimatorSettings<To> mambo_estimator_cast(
    const MamboEstimatorSettings<From>& from) {
  MamboEstimatorSettings<To> to;
  to.each_field([](const char*, auto& a, const auto& b) { convert_field(a, b); }, to, from);
  return to;
}

/// Validates the settings: dt and gravity > 0, times and gates ≥ 0, covariances ≥ 0 with R > 0,
/// limits in order, and complementary filter settings that their own validate() accepts.
/// @throws InvalidInput  "where: altitude_R is 0 m2, expected …"
void validate(const MamboEstimatorSettings<double>& settings, const std::string& where);

/// The same for single precision.
void validate(const MamboEstimatorSettings<float>& settings, const std::string& where);

}  // namespace quadtune
