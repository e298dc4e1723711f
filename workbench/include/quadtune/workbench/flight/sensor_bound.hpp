// SPDX-License-Identifier: Apache-2.0
/// The accuracy of position and heading that a set of sensors allows along a mission, for any law
/// and any estimator. Theory: docs/theory.md, "What the sensors can know".
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "quadtune/estimation/general_filter_settings.hpp"
#include "quadtune/model/sensors.hpp"
#include "quadtune/simulation/flight.hpp"
#include "quadtune/workbench/flight/error_quantiles.hpp"

namespace quadtune {

/// Drifts that a filter must assume although no sensor file states them; as in the general filter.
struct DriftAllowance {
  double gyro_walk = GeneralFilterNoise().gyro_walk;          ///< [rad/s/√s], ≥ 0
  double force_walk = GeneralFilterNoise().force_walk;        ///< [m/s²/√s], ≥ 0
  double pressure_walk = GeneralFilterNoise().pressure_walk;  ///< of the height [m/√s], ≥ 0
  /// Standard deviations at the beginning of the flight. The pressure at the ground is unknown.
  StartDeviations start = {0, 0, 0, 0, 0, 0, StartDeviations().pressure_height};
};

/// The flight for which the bound is computed.
struct SensorBoundOptions {
  double height = 1.1;         ///< above the ground [m], > 0
  double gravity = 9.81;       ///< [m/s²], > 0
  double air_density = 1.225;  ///< [kg/m³], > 0
  double field = 20;           ///< horizontal part of the magnetic field [µT], ≥ 0
  double begin = 0;            ///< time at which the vehicle leaves its known position [s], ≥ 0
  double duration = 0;         ///< of the flight [s], > 0
  /// Duration of the average of its inertial sensors while stationary [s]; 0: their biases are
  /// known.
  double calibration = 0;
  DriftAllowance allowed;  ///< lower limits of the drifts; larger ones in the file prevail
};

/// The error of the optimal filter along a flight.
struct SensorBound {
  std::vector<double> time;       ///< of the outputs [s], equally spaced
  ErrorCovariance north,          ///< position, north axis [m²]
      east,                       ///< position, east axis [m²]
      height;                     ///< height [m²]
  ErrorCovariance heading;        ///< [rad²]
  std::vector<std::string> used;  ///< descriptions of the sensors that the filter uses
};

/// The midpoints of equal intervals of a flight; the last time is its end [s].
[[nodiscard]] std::vector<double> bound_times(double duration);

/// The covariance of the optimal filter, linearized about a hover with the heading north.
///
/// States: position, velocity, tilt, heading, and the biases of gyroscope and accelerometer, which
/// are the inputs of the filter. The filter uses sonar, barometer, optical flow, magnetometer, GPS
/// and vision, each with its noise, quantization, rate, delay, share of lost samples, bias drawn at
/// turn-on, bias walk and correlated error; the slow errors among these are states too.
///
/// @return  no value if there is no gyroscope or no accelerometer
/// @throws InvalidInput  if an option is out of range
[[nodiscard]] std::optional<SensorBound> sensor_bound(const Sensors& sensors,
                                                      const SensorBoundOptions& options);

/// The bound in terms of the metrics of a mission.
struct MissionBound {
  SensorBoundOptions options;  ///< sensors, rates and path of the bound
  SensorBound bound;           ///< error covariances over time
  ErrorSize tracking;          ///< of the position, over the periods in which tracking is evaluated
                               ///< [m]
  ErrorSize height;            ///< its vertical part [m]
  ErrorSize heading;           ///< [rad]
  ErrorSize estimate;          ///< of the position over the whole flight [m]
  double horizontal_rms = 0;   ///< over the periods in which tracking is evaluated [m]
  double horizontal_end = 0;   ///< √E‖e‖² at the end [m]
  double height_end = 0;       ///< likewise [m]
  double heading_end = 0;      ///< likewise [rad]
  double final_rarely = 0;     ///< exceeded by the position error at the end in one of 1000 flights
                               ///< [m]
  double drift_rarely = 0;     ///< exceeded by its horizontal part likewise [m]
  /// Relative to the mission's steps, along the step; the maximum over several steps.
  ErrorSize overshoot,  ///< of the position
      yaw_overshoot;    ///< of the yaw
};

/// @return  no value for ideal sensors, the true state, a motor test, or without inertial sensors
[[nodiscard]] std::optional<MissionBound> mission_bound(const FlightSetup& setup);

}  // namespace quadtune
