// SPDX-License-Identifier: Apache-2.0
/// Settings of the general filter: its sensors with their lags and noise.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>

#include "quadtune/model/sensors.hpp"

namespace quadtune {

/// Maximum number of control periods over which the filter propagates a measurement back in time.
/// For an older measurement, the oldest stored readings are used over the rest of its age.
inline constexpr int kMaxHistoryPeriods = 40;
/// Maximum lag of the gyroscope and of the accelerometer, in control periods.
inline constexpr int kMaxHorizonPeriods = 16;

/// Gyroscope or accelerometer that drives the prediction.
struct InertialAid {
  /// Time from the motion to its reading: delay plus the low-frequency lag of the response [s], ≥
  /// 0.
  double lag = 0;
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();  ///< reading = scale · truth + bias + noise
  /// Density of the white noise: standard deviation of a sample times √(sample period) [unit/√Hz],
  /// ≥ 0.
  Eigen::Vector3d density = Eigen::Vector3d::Zero();
  /// noise variance of one reading [unit²], > 0
  Eigen::Vector3d variance = Eigen::Vector3d::Ones();
  double walk = 0;  ///< random walk of the bias [unit/√s], ≥ 0

  friend bool operator==(const InertialAid&, const InertialAid&) = default;
};

/// Sensor whose samples correct the state.
struct Aid {
  double lag = 0;       ///< lag of the response, in addition to Sample::age [s], ≥ 0
  double variance = 1;  ///< noise variance of one sample, per axis [unit²], > 0
  double scale = 1;     ///< reading = scale · truth, > 0

  friend bool operator==(const Aid&, const Aid&) = default;
};

/// Optical flow: the motion field averaged over the image.
struct FlowAid {
  double lag = 0;                                   ///< as Aid::lag [s]
  double variance = 1;                              ///< per axis [rad²/s²], > 0
  Eigen::Vector2d scale = Eigen::Vector2d::Ones();  ///< > 0
  /// One third of the squared tangent of half the field of view, along body x and y [1], ≥ 0.
  Eigen::Vector2d mean_square = Eigen::Vector2d::Zero();
  double min_height = 0.1;  ///< estimated height below which the flow is not used [m], > 0

  friend bool operator==(const FlowAid&, const FlowAid&) = default;
};

/// Range along body z to the level ground.
struct RangeAid {
  Aid aid;                                               ///< [m]
  double min = 0;                                        ///< shortest range that is used [m]
  double max = std::numeric_limits<double>::infinity();  ///< longest range that is used [m]
  double min_cosine = 0.5;  ///< cosine of the largest tilt at which the range is used, (0, 1]

  friend bool operator==(const RangeAid&, const RangeAid&) = default;
};

/// Barometer. The variance refers to the height [m²].
struct PressureAid {
  Aid aid;               ///< lag and scale of the pressure reading, variance of the height [m²]
  double zero = 101325;  ///< pressure at the world's origin [Pa], > 0
  /// d(pressure)/d(height) [Pa/m], < 0; NaN: the standard atmosphere.
  double fall = std::numeric_limits<double>::quiet_NaN();
  double walk = 0.01;  ///< random walk of the height offset [m/√s], ≥ 0

  /// d(pressure)/d(height) at the world's origin [Pa/m].
  [[nodiscard]] double slope() const { return fall == fall ? fall : -zero / (0.190295 * 44330); }
  /// Whether all members are equal; NaN counts as equal to NaN.
  friend bool operator==(const PressureAid& a, const PressureAid& b) {
    const bool same_fall = a.fall == b.fall || (a.fall != a.fall && b.fall != b.fall);
    return a.aid == b.aid && a.zero == b.zero && same_fall && a.walk == b.walk;
  }
};

/// Magnetometer, used for the heading only. The variance refers to the heading [rad²].
struct HeadingAid {
  Aid aid;                 ///< lag and scale of the reading, variance of the heading [rad²]
  double declination = 0;  ///< of magnetic north, positive to the east [rad]
  /// Of the expected field: vertical over horizontal part, tan(inclination) [1]
  double dip = 0;

  friend bool operator==(const HeadingAid&, const HeadingAid&) = default;
};

/// Standard deviations of the initial errors.
struct StartDeviations {
  double position = 0.01;      ///< [m]
  double velocity = 0.01;      ///< [m/s]
  double tilt = 0.003;         ///< roll and pitch [rad]
  double yaw = 0.01;           ///< [rad]
  double gyro_bias = 0.03;     ///< [rad/s]
  double force_bias = 0.5;     ///< of the accelerometer [m/s²]
  double pressure_height = 2;  ///< offset of the barometer's height [m]

  friend bool operator==(const StartDeviations&, const StartDeviations&) = default;
};

/// Constant settings; validate() checks them and step() does not. A sensor that is absent is not
/// used.
struct GeneralFilterSettings {
  double dt = 0.005;                    ///< control period [s], > 0
  double gravity = 9.81;                ///< [m/s²], > 0
  InertialAid gyroscope;                ///< predicts the attitude; required
  InertialAid accelerometer;            ///< predicts the velocity; required
  std::optional<FlowAid> flow;          ///< empty: no optical flow
  std::optional<RangeAid> range;        ///< empty: no range sensor
  std::optional<PressureAid> pressure;  ///< empty: no barometer
  std::optional<HeadingAid> heading;    ///< empty: no magnetometer
  std::optional<Aid> gps_position;      ///< world position from GPS [m]; empty: none
  std::optional<Aid> gps_velocity;      ///< world velocity from GPS [m/s]; empty: none
  std::optional<Aid> vision;            ///< world position from a vision system [m]; empty: none
  StartDeviations start;                ///< standard deviations of the errors of the initial state

  /// A measurement with e²/S above this value is rejected; 25 is five standard deviations. > 0.
  double gate = 25;
  /// A sensor that was rejected for this time, and at least three times in a row, is accepted again
  /// [s], ≥ 0.
  double recovery_time = 1;
  /// Standard deviation of the assumed zero velocity while the vehicle stands on the ground. That
  /// of the zero rates is the noise of the gyroscope.
  double standing_velocity = 0.02;  ///< [m/s], > 0
  /// Minimum standard deviation of the vertical velocity at lift-off [m/s], ≥ 0: the springs of the
  /// landing gear accelerate the vehicle between two samples of the accelerometer.
  double lift_off_velocity = 0.05;
  /// Standard deviations of the unknown motion during the lag of the inertial sensors, used by
  /// deviations() only.
  double angular_acceleration = 5;  ///< [rad/s²], ≥ 0
  double jerk = 10;                 ///< [m/s³], ≥ 0

  friend bool operator==(const GeneralFilterSettings&, const GeneralFilterSettings&) = default;
};

/// Noise that the filter assumes in addition to the values in a sensor file. Set a field to 0 if
/// the file already includes it.
struct GeneralFilterNoise {
  // Minimum noise of one sample, used if the sensor file states less.
  double gyroscope = 5e-4;      ///< [rad/s]
  double accelerometer = 0.02;  ///< [m/s²]
  double flow = 0.01;           ///< [rad/s]
  double range = 0.005;         ///< [m]
  double pressure = 1;          ///< [Pa]
  double field = 0.2;           ///< [µT]
  double gps_position = 0.05;   ///< [m]
  double gps_velocity = 0.02;   ///< [m/s]
  double vision = 0.005;        ///< [m]
  // Process noise for what the model omits: vibration, scale errors, sensor dynamics.
  double omitted_rate = 2e-5;          ///< [rad/s/√Hz]
  double omitted_acceleration = 2e-3;  ///< [m/s²/√Hz]
  double gyro_walk = 2e-5;             ///< random walk of the gyroscope bias [rad/s/√s]
  double force_walk = 1e-4;            ///< random walk of the accelerometer bias [m/s²/√s]
  double pressure_walk = 0.01;         ///< of the offset of the barometer's height [m/√s]

  /// Calls f("name", field) for every field.
  template <class F, class... Noise>
  static void each_field(F&& f, Noise&... s) {
    f("gyroscope", s.gyroscope...);
    f("accelerometer", s.accelerometer...);
    f("flow", s.flow...);
    f("range", s.range...);
    f("pressure", s.pressure...);
    f("field", s.field...);
    f("gps_position", s.gps_position...);
    f("gps_velocity", s.gps_velocity...);
    f("vision", s.vision...);
    f("omitted_rate", s.omitted_rate...);
    f("omitted_acceleration", s.omitted_acceleration...);
    f("gyro_walk", s.gyro_walk...);
    f("force_walk", s.force_walk...);
    f("pressure_walk", s.pressure_walk...);
  }

  friend bool operator==(const GeneralFilterNoise&, const GeneralFilterNoise&) = default;
};

/// Settings for a sensor suite, with lags, variances (noise² + quantum²/12) and scale factors from
/// the sensor file.
/// @param sensors  including an accelerometer and a gyroscope
/// @param dt       control period [s]
/// @param gravity  [m/s²]
/// @param magnetic_field  magnetic field of the earth in world axes [µT], for the heading
/// @param noise    process noise, and minimum noise of a sample, used where `sensors` states less
/// @throws InvalidInput  if the accelerometer or the gyroscope is missing or its lag is too large
[[nodiscard]] GeneralFilterSettings general_filter_settings(const Sensors& sensors, double dt,
                                                            double gravity,
                                                            const Eigen::Vector3d& magnetic_field,
                                                            const GeneralFilterNoise& noise = {});

/// Explains why a sensor suite cannot feed the general filter, e.g. "no accelerometer"; empty if it
/// can. Required are an accelerometer, a gyroscope and a sensor of the horizontal motion: optical
/// flow with a sonar or a barometer, GPS, or vision.
[[nodiscard]] std::string general_filter_lacks(const Sensors& sensors);

/// Number of control periods by which the filter state lags behind the present: the larger lag of
/// gyroscope and accelerometer, rounded up.
[[nodiscard]] int horizon_periods(const GeneralFilterSettings& settings);

/// Checks that step() may run with these settings.
/// @throws InvalidInput  "where: flow.variance is 0 rad2/s2, expected a positive number"
void validate(const GeneralFilterSettings& settings, const std::string& where);

}  // namespace quadtune
