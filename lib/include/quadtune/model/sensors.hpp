// SPDX-License-Identifier: Apache-2.0
/// Sensor models of a vehicle: measured quantities, rates, delays and errors.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>

namespace quadtune {

/// The errors and the timing of a sensor of one to three axes, in its own unit.
///
/// A sample is taken every 1/rate seconds: the true value, filtered by the second-order response,
/// times scale, plus bias, plus noise, limited to ±limit, rounded to a multiple of quantum. It
/// arrives after `delay`, or is lost.
struct SensorFaults {
  double rate = 0;                                  ///< [Hz], > 0
  double delay = 0;                                 ///< from sampling to availability [s], ≥ 0
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();  ///< [1]
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();   ///< [unit]
  Eigen::Vector3d noise = Eigen::Vector3d::Zero();  ///< standard deviation of a sample [unit]
  double natural_frequency = 0;                     ///< of the response [rad/s]; 0: none
  double damping = 0.707;                           ///< of the response, > 0
  double limit = std::numeric_limits<double>::infinity();  ///< [unit], > 0
  double quantum = 0;                                      ///< [unit], ≥ 0; 0: none
  double dropout = 0;  ///< probability that a sample is lost, 0 … 1
  // Slowly varying errors, which no estimator is given. theory.md, "Simulated flight".
  Eigen::Vector3d turn_on_bias =
      Eigen::Vector3d::Zero();                          ///< standard deviation, per flight [unit]
  Eigen::Vector3d bias_walk = Eigen::Vector3d::Zero();  ///< random walk [unit/√s]
  /// Standard deviation of a Gauss-Markov error [unit].
  Eigen::Vector3d correlated_noise = Eigen::Vector3d::Zero();
  double correlation = 0;  ///< its time constant [s]; > 0 if correlated_noise is set
  /// Accelerometer and gyroscope only: amplitude of the vibration of one rotor divided by its
  /// squared speed [unit s²/rad²].
  Eigen::Vector3d vibration = Eigen::Vector3d::Zero();
};

/// Ultrasonic range along body z to level ground. No echo outside its limits.
struct SonarSensor {
  SensorFaults faults;                                         ///< [m]
  double min_range = 0;                                        ///< [m]
  double max_range = std::numeric_limits<double>::infinity();  ///< [m]
  double max_tilt = 0.6;  ///< at larger tilts the echo misses the sensor [rad]
};

/// Optical flow: the motion field averaged over the image of a downward-looking camera.
struct FlowSensor {
  SensorFaults faults;        ///< [rad/s]
  double half_field_x = 0.4;  ///< half the field of view along body x [rad]
  double half_field_y = 0.3;  ///< along body y [rad]
  double min_height = 0.4;    ///< minimum height at which the motion can be tracked [m]
  double max_height = std::numeric_limits<double>::infinity();  ///< maximum height [m]
  /// Noise that is proportional to the height, added in quadrature [rad/s/m].
  double noise_per_height = 0;
  /// Gain of the body rates in FlowModel::simplified [1], eq. 6.8 of the thesis on the Mambo.
  double simplified_rate_gain = 0.8;
};

/// Barometer.
struct BarometerSensor {
  SensorFaults faults;  ///< [Pa]
  /// Pressure at the world's origin [Pa].
  double ground_pressure = 101325;
  /// d(pressure)/d(height) [Pa/m], < 0; NaN: that of the standard atmosphere.
  double fall = std::numeric_limits<double>::quiet_NaN();
};

/// Position and velocity from satellite navigation, world axes.
struct GpsSensor {
  SensorFaults position;                                          ///< [m]
  Eigen::Vector3d velocity_noise = Eigen::Vector3d::Constant(0);  ///< [m/s]
};

/// All sensors; an empty one is not on board.
struct Sensors {
  std::optional<SensorFaults> accelerometer;  ///< specific force, body axes [m/s²]
  std::optional<SensorFaults> gyroscope;      ///< body rates [rad/s]
  std::optional<SensorFaults> magnetometer;   ///< body axes [µT]
  std::optional<BarometerSensor> barometer;   ///< empty: none
  std::optional<SonarSensor> sonar;           ///< empty: none
  std::optional<FlowSensor> flow;             ///< empty: none
  std::optional<GpsSensor> gps;               ///< empty: none
  /// Gyroscope error per specific force, body axes [rad/s per m/s²].
  Eigen::Vector3d g_sensitivity = Eigen::Vector3d::Zero();
  /// Position from camera images of markers at known places, world axes [m].
  std::optional<SensorFaults> vision;
};

/// Error-free sensors without delay, at the rates of `sensors`.
[[nodiscard]] Sensors ideal(Sensors sensors);

/// Typical sensors of small vehicles, for vehicles without sensor data: inertial sensors at 200 Hz,
/// magnetometer at 100 Hz, barometer at 50 Hz, sonar at 20 Hz, flow at 60 Hz, satellite at 1 Hz.
[[nodiscard]] Sensors typical_sensors();

}  // namespace quadtune
