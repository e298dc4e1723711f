// SPDX-License-Identifier: Apache-2.0
/// What a vehicle's sensors measure, how often, how late and how wrong.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>

namespace quadtune {

/// The faults and the clock of a sensor of one to three axes, in its own unit.
///
/// A sample is taken every 1/rate seconds: what is true, through the second-order response, times
/// scale, plus bias, plus noise, within ±limit, to the nearest quantum. It arrives `delay` later,
/// or never.
struct SensorFaults {
  double rate = 0;   ///< [Hz], > 0
  double delay = 0;  ///< from taking a sample to having it [s], ≥ 0
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();  ///< [1]
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();   ///< [unit]
  Eigen::Vector3d noise = Eigen::Vector3d::Zero();  ///< standard deviation of a sample [unit]
  double natural_frequency = 0;                     ///< of the response [rad/s]; 0: none
  double damping = 0.707;                           ///< of the response, > 0
  double limit = std::numeric_limits<double>::infinity();  ///< [unit], > 0
  double quantum = 0;                                      ///< [unit], ≥ 0; 0: none
  double dropout = 0;  ///< probability that a sample is lost, 0 … 1
  // Errors that change slowly. No estimator is told of them. theory.md, "Simulated flight".
  Eigen::Vector3d turn_on_bias =
      Eigen::Vector3d::Zero();                          ///< standard deviation, per flight [unit]
  Eigen::Vector3d bias_walk = Eigen::Vector3d::Zero();  ///< random walk [unit/√s]
  Eigen::Vector3d correlated_noise = Eigen::Vector3d::Zero();  ///< of a Gauss-Markov error [unit]
  double correlation = 0;  ///< its time constant [s]; > 0 where correlated_noise is
  /// Of accelerometer and gyroscope: amplitude of a rotor's vibration over its speed squared
  /// [unit s²/rad²].
  Eigen::Vector3d vibration = Eigen::Vector3d::Zero();
};

/// Ultrasonic height: along body z down to level ground. No echo outside its gates.
struct SonarSensor {
  SensorFaults faults;                                              ///< [m]
  double least_range = 0;                                           ///< [m]
  double greatest_range = std::numeric_limits<double>::infinity();  ///< [m]
  double greatest_tilt = 0.6;  ///< beyond it the echo misses the sensor [rad]
};

/// The motion field averaged over the image of a camera that looks down.
struct FlowSensor {
  SensorFaults faults;        ///< [rad/s]
  double half_field_x = 0.4;  ///< half the field of view along body x [rad]
  double half_field_y = 0.3;  ///< along body y [rad]
  double least_height = 0.4;  ///< below it the image shows no motion that can be followed [m]
  double greatest_height = std::numeric_limits<double>::infinity();  ///< nor above it [m]
  double noise_per_height = 0;  ///< noise that grows with height, added in quadrature [rad/s/m]
  double simplified_rate_gain = 0.8;  ///< of the package's simplified sensor, eq. 6.8 of its source
};

/// Barometer.
struct BarometerSensor {
  SensorFaults faults;  ///< [Pa]
  /// Pressure at the world's origin [Pa] and its fall with height [Pa/m]; where the fall is NaN,
  /// that of the standard atmosphere.
  double ground_pressure = 101325;
  double fall = std::numeric_limits<double>::quiet_NaN();
};

/// Position and velocity by satellite, world axes.
struct GpsSensor {
  SensorFaults position;                                          ///< [m]
  Eigen::Vector3d velocity_noise = Eigen::Vector3d::Constant(0);  ///< [m/s]
};

/// All sensors; one that is absent says nothing.
struct Sensors {
  std::optional<SensorFaults> accelerometer;  ///< specific force, body axes [m/s²]
  std::optional<SensorFaults> gyroscope;      ///< body rates [rad/s]
  std::optional<SensorFaults> magnetometer;   ///< body axes [µT]
  std::optional<BarometerSensor> barometer;
  std::optional<SonarSensor> sonar;
  std::optional<FlowSensor> flow;
  std::optional<GpsSensor> gps;
  /// Rates that the gyroscope shows per specific force, body axes [rad/s per m/s²].
  Eigen::Vector3d g_sensitivity = Eigen::Vector3d::Zero();
  /// Position from a camera's images of marks whose places are known, world axes [m].
  std::optional<SensorFaults> vision;
};

/// Sensors that say what is true, at the rates of `sensors`, at once.
[[nodiscard]] Sensors ideal(Sensors sensors);

/// What small vehicles carry whose own numbers are not known: inertial sensors at 200 Hz,
/// magnetometer at 100 Hz, barometer at 50 Hz, sonar at 20 Hz, flow at 60 Hz, satellite at 1 Hz.
[[nodiscard]] Sensors typical_sensors();

}  // namespace quadtune
