// SPDX-License-Identifier: Apache-2.0
/// Settings of the general filter: which sensors it has, how late and how noisy they are.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>

#include "quadtune/model/sensors.hpp"

namespace quadtune {

/// The maximum number of control periods over which a measurement is carried back in time. An older
/// measurement is carried back over the rest of its age with the oldest stored readings.
inline constexpr int kMostHistoryPeriods = 40;
/// The maximum lag of the gyroscope and of the accelerometer, in control periods.
inline constexpr int kMostHorizonPeriods = 16;

/// A gyroscope or an accelerometer that drives the prediction.
struct InertialAid {
  /// From the motion to its reading: delay plus the lag of the response at low frequency [s], ≥ 0.
  double lag = 0;
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();  ///< reading = scale · truth + bias + noise
  /// Of the white noise: deviation of a sample times √(sample period) [unit/√Hz], ≥ 0.
  Eigen::Vector3d density = Eigen::Vector3d::Zero();
  Eigen::Vector3d variance = Eigen::Vector3d::Ones();  ///< of the noise of one reading [unit²], > 0
  double walk = 0;  ///< of the bias, which is a random walk [unit/√s], ≥ 0

  friend bool operator==(const InertialAid&, const InertialAid&) = default;
};

/// A sensor whose samples correct the state.
struct Aid {
  double lag = 0;       ///< of its response, in addition to Sample::age [s], ≥ 0
  double variance = 1;  ///< of the noise of one sample, per axis [unit²], > 0
  double scale = 1;     ///< reading = scale · truth, > 0

  friend bool operator==(const Aid&, const Aid&) = default;
};

/// Optical flow: the motion field averaged over the image.
struct FlowAid {
  double lag = 0;                                   ///< as Aid::lag [s]
  double variance = 1;                              ///< per axis [rad²/s²], > 0
  Eigen::Vector2d scale = Eigen::Vector2d::Ones();  ///< > 0
  /// A third of the square of the tangent of half the field of view, along body x and y [1], ≥ 0.
  Eigen::Vector2d mean_square = Eigen::Vector2d::Zero();
  double least_height = 0.1;  ///< estimated height below which the flow is not used [m], > 0

  friend bool operator==(const FlowAid&, const FlowAid&) = default;
};

/// Range along body z to the level ground.
struct RangeAid {
  Aid aid;                                                    ///< [m]
  double least = 0;                                           ///< shortest range used [m]
  double greatest = std::numeric_limits<double>::infinity();  ///< longest [m]
  double least_cosine = 0.5;  ///< of the tilt beyond which the range is not used

  friend bool operator==(const RangeAid&, const RangeAid&) = default;
};

/// Barometer. Its variance is that of the height [m²].
struct PressureAid {
  Aid aid;
  double zero = 101325;  ///< pressure at the world's origin [Pa], > 0
  /// d(pressure)/d(height) [Pa/m], < 0; NaN: the standard atmosphere.
  double fall = std::numeric_limits<double>::quiet_NaN();
  double walk = 0.01;  ///< of the offset of the height, which is a random walk [m/√s], ≥ 0

  /// d(pressure)/d(height) at the world's origin [Pa/m].
  [[nodiscard]] double slope() const { return fall == fall ? fall : -zero / (0.190295 * 44330); }
  friend bool operator==(const PressureAid& a, const PressureAid& b) {
    const bool same_fall = a.fall == b.fall || (a.fall != a.fall && b.fall != b.fall);
    return a.aid == b.aid && a.zero == b.zero && same_fall && a.walk == b.walk;
  }
};

/// Magnetometer, of which the heading is used. Its variance is that of the heading [rad²].
struct HeadingAid {
  Aid aid;
  double declination = 0;  ///< of magnetic north, east positive [rad]
  double dip = 0;          ///< of the expected field: down over level, tan of the inclination [1]

  friend bool operator==(const HeadingAid&, const HeadingAid&) = default;
};

/// Standard deviations of the errors of the state with which the filter starts.
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

/// Set once; validate() checks them and step() does not. A sensor that is absent is not used.
struct GeneralFilterSettings {
  double dt = 0.005;      ///< control period [s], > 0
  double gravity = 9.81;  ///< [m/s²], > 0
  InertialAid gyroscope;
  InertialAid accelerometer;
  std::optional<FlowAid> flow;
  std::optional<RangeAid> range;
  std::optional<PressureAid> pressure;
  std::optional<HeadingAid> heading;
  std::optional<Aid> gps_position;
  std::optional<Aid> gps_velocity;
  std::optional<Aid> vision;
  StartDeviations start;

  /// A measurement with e²/s above this is rejected: 25 is five standard deviations. > 0.
  double gate = 25;
  /// A sensor that was rejected for so long, and at least three times in a row, is believed again
  /// [s], ≥ 0.
  double recovery_time = 1;
  /// While the vehicle stands, its velocity and rates are 0 up to these deviations.
  double standing_velocity = 0.02;  ///< [m/s], > 0
  /// Least deviation of the vertical velocity when it stops standing [m/s], ≥ 0: the springs of the
  /// landing gear push it off between two samples of the accelerometer.
  double lift_off_velocity = 0.05;
  /// Deviations of what is unknown over the lag of the inertial sensors, for deviations() only.
  double angular_acceleration = 5;  ///< [rad/s²], ≥ 0
  double jerk = 10;                 ///< [m/s³], ≥ 0

  friend bool operator==(const GeneralFilterSettings&, const GeneralFilterSettings&) = default;
};

/// What the filter assumes in addition to the numbers of a sensor file. Set to 0 what the file has
/// in full.
struct GeneralFilterNoise {
  // Floors of the noise of one sample, for a file that states less.
  double gyroscope = 5e-4;      ///< [rad/s]
  double accelerometer = 0.02;  ///< [m/s²]
  double flow = 0.01;           ///< [rad/s]
  double range = 0.005;         ///< [m]
  double pressure = 1;          ///< [Pa]
  double field = 0.2;           ///< [µT]
  double gps_position = 0.05;   ///< [m]
  double gps_velocity = 0.02;   ///< [m/s]
  double vision = 0.005;        ///< [m]
  // Process noise of what the model omits: vibration, scale errors, response of the sensors.
  double omitted_rate = 2e-5;          ///< [rad/s/√Hz]
  double omitted_acceleration = 2e-3;  ///< [m/s²/√Hz]
  double gyro_walk = 2e-5;             ///< of the gyroscope's bias [rad/s/√s]
  double force_walk = 1e-4;            ///< of the accelerometer's bias [m/s²/√s]
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

/// Settings for a suite of sensors: lags, variances (noise² + quantum²/12) and scale factors are
/// those of the sensors' file.
/// @param sensors  with an accelerometer and a gyroscope
/// @param dt       control period [s]
/// @param gravity  [m/s²]
/// @param magnetic_field  of the earth in the world [µT], for the heading
/// @throws InvalidInput  if the accelerometer or the gyroscope is missing or too late
[[nodiscard]] GeneralFilterSettings general_filter_settings(const Sensors& sensors, double dt,
                                                            double gravity,
                                                            const Eigen::Vector3d& magnetic_field,
                                                            const GeneralFilterNoise& noise = {});

/// What keeps a suite of sensors from feeding the general filter, e.g. "no accelerometer"; empty if
/// it does. It needs an accelerometer, a gyroscope, and a sensor of the horizontal motion: optical
/// flow with a sonar or a barometer, GPS or vision.
[[nodiscard]] std::string general_filter_lacks(const Sensors& sensors);

/// Control periods by which the state of the filter is older than the present: the larger lag of
/// gyroscope and accelerometer, rounded up.
[[nodiscard]] int horizon_periods(const GeneralFilterSettings& settings);

/// Checks that step() may run with these settings.
/// @throws InvalidInput  "where: flow.variance is 0 rad2/s2, expected a positive number"
void validate(const GeneralFilterSettings& settings, const std::string& where);

}  // namespace quadtune
