// SPDX-License-Identifier: Apache-2.0
/// What a suite of sensors can know of position and heading along a mission, whatever law is flown
/// and whatever estimator runs. Theory: docs/theory.md, "What the sensors can know".
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "quadtune/estimation/general_filter_settings.hpp"
#include "quadtune/model/sensors.hpp"
#include "quadtune/simulation/flight.hpp"
#include "quadtune/workbench/flight/error_quantiles.hpp"

namespace quadtune {

/// What a filter must allow for although no sensor file states it, as the general filter allows.
struct DriftAllowance {
  double gyro_walk = GeneralFilterNoise().gyro_walk;          ///< [rad/s/√s], ≥ 0
  double force_walk = GeneralFilterNoise().force_walk;        ///< [m/s²/√s], ≥ 0
  double pressure_walk = GeneralFilterNoise().pressure_walk;  ///< of the height [m/√s], ≥ 0
  /// With which the flight begins. The pressure at the ground is not known beforehand.
  StartDeviations start = {0, 0, 0, 0, 0, 0, StartDeviations().pressure_height};
};

/// The flight about which a suite is judged.
struct SensorBoundOptions {
  double height = 1.1;         ///< above the ground [m], > 0
  double gravity = 9.81;       ///< [m/s²], > 0
  double air_density = 1.225;  ///< [kg/m³], > 0
  double field = 20;           ///< horizontal part of the magnetic field [µT], ≥ 0
  double begin = 0;            ///< when the vehicle leaves the place that it knows [s], ≥ 0
  double duration = 0;         ///< of the flight [s], > 0
  /// How long it stood still to average its inertial sensors [s]; 0: their biases are known.
  double calibration = 0;
  DriftAllowance allowed;  ///< where the file states less
};

/// The best filter's error along a flight.
struct SensorBound {
  std::vector<double> time;             ///< of the outputs [s], equally spaced
  ErrorCovariance north, east, height;  ///< [m²]
  ErrorCovariance heading;              ///< [rad²]
  std::vector<std::string> used;        ///< the sensors that the filter has, in words
};

/// The middles of equal intervals of a flight, the last one its end [s].
[[nodiscard]] std::vector<double> bound_times(double duration);

/// The covariance of the best filter, linear about a hover with the heading north.
///
/// States: position, velocity, tilt, heading, and the biases of gyroscope and accelerometer, which
/// are the filter's inputs. It corrects them with sonar, barometer, optical flow, magnetometer,
/// GPS and vision, each with its noise, quantum, rate, delay, share of lost samples, bias drawn at
/// turn-on, bias walk and correlated error; what is slow of these are states too.
///
/// @return  none for a suite without a gyroscope or an accelerometer
/// @throws InvalidInput  for options out of range
[[nodiscard]] std::optional<SensorBound> sensor_bound(const Sensors& sensors,
                                                      const SensorBoundOptions& options);

/// The bound of a flight by what its mission is judged by.
struct MissionBound {
  SensorBoundOptions options;
  SensorBound bound;
  ErrorSize tracking;         ///< of the position, over the periods in which tracking is judged [m]
  ErrorSize height;           ///< its vertical part [m]
  ErrorSize heading;          ///< [rad]
  ErrorSize estimate;         ///< of the position over the whole flight [m]
  double horizontal_rms = 0;  ///< over the periods in which tracking is judged [m]
  double horizontal_end = 0;  ///< √E‖e‖² at the end [m]
  double height_end = 0;      ///< likewise [m]
  double heading_end = 0;     ///< likewise [rad]
  double final_rarely = 0;    ///< exceeded by the position's error at the end in one of 1000 [m]
  double drift_rarely = 0;    ///< and by its horizontal part [m]
  /// Of the mission's steps, along the step and as a share of it; of several the greatest.
  ErrorSize overshoot, yaw_overshoot;
};

/// @return  none for ideal sensors, the true state, a motor test, or a suite without inertial
///          sensors
[[nodiscard]] std::optional<MissionBound> mission_bound(const FlightSetup& setup);

}  // namespace quadtune
