// SPDX-License-Identifier: Apache-2.0
/// Data exchanged between the parts of a flight program: sensors, estimate, reference.
#pragma once

#include <Eigen/Core>

#include "quadtune/model/rigid_body.hpp"
#include "quadtune/scalar.hpp"

namespace quadtune {

/// Newest sample of one sensor, as received.
template <class Value, class T>
struct Sample {
  Value value{};      ///< as received
  MaskOf<T> fresh{};  ///< true only in the control period in which the value arrived
  T age = T(0);       ///< time since it was taken [s]; increases until a new one arrives
};

/// Newest samples of all sensors. Body axes forward-right-down, world axes north-east-down.
template <class T>
struct SensorFrame {
  Sample<Vector3<T>, T> specific_force;    ///< accelerometer: (0, 0, -g) at rest, level [m/s²]
  Sample<Vector3<T>, T> rates;             ///< gyroscope [rad/s]
  Sample<Vector3<T>, T> magnetic_field;    ///< magnetic field of the earth in body axes [µT]
  Sample<T, T> pressure;                   ///< of the air [Pa]
  Sample<T, T> sonar;                      ///< along body z down to the ground [m]; NaN: no echo
  Sample<Eigen::Matrix<T, 2, 1>, T> flow;  ///< mean image velocity over focal length [rad/s]
  Sample<Vector3<T>, T> gps_position;      ///< world [m]
  Sample<Vector3<T>, T> gps_velocity;      ///< world [m/s]
  Sample<Vector3<T>, T> vision;            ///< position from camera images, world [m]
};

/// State estimate of the flight program: the 12 states of ned_convention().
template <class T>
struct Estimate {
  StateVector<T> x = StateVector<T>::Zero();  ///< 12 states of ned_convention()
  /// false: an entry of x is not finite; the estimator does not recover
  MaskOf<T> finite{true};
  MaskOf<T> height_used{};  ///< whether sonar or barometer was used in this period
  MaskOf<T> flow_used{};    ///< whether optical flow was used in this period
  /// flow velocity too far from the estimated one: triggers a safety exit
  MaskOf<T> flow_disagrees{};
  T innovation_square = T(0);  ///< Σ eᵀ S⁻¹ e over the measurements used in this period
  /// number of those measurements: the expectation of innovation_square
  T innovation_freedom = T(0);
};

/// Mode of the motors at one instant.
enum class FlightPhase {
  off,       ///< motors stopped
  start_up,  ///< motors run up to their minimum speed
  take_off,  ///< constant thrust (1 + takeoff_gain) m g, attitude hold
  flying,    ///< the control law commands the motors
  motors,    ///< each motor is commanded directly as a fraction of its range, without a control law
};

/// Set point of a mission at one instant, the same for the cascade and the state feedback.
template <class T>
struct Reference {
  Vector3<T> position = Vector3<T>::Zero();  ///< world [m]
  Vector3<T> velocity = Vector3<T>::Zero();  ///< velocity of the moving reference, world [m/s]
  T yaw = T(0);                              ///< not wrapped [rad]
  T roll = T(0);                             ///< [rad]; used if track_position is false
  T pitch = T(0);                            ///< [rad]; used if track_position is false
  bool track_position = true;  ///< true: position is tracked; false: attitude and height
  FlightPhase phase = FlightPhase::flying;  ///< mode of the motors
  /// In FlightPhase::motors: 0 is the minimum command, 1 the maximum; negative: the motor is
  /// stopped.
  Eigen::Matrix<double, kMaxRotors, 1> motors = Eigen::Matrix<double, kMaxRotors, 1>::Constant(-1);
};

/// Converts one settings field to another precision: a number, a vector, or a value without
/// precision.
template <class To, class From>
void convert_field(To& to, const From& from) {
  if constexpr (requires { to.size(); })
    for (Eigen::Index i = 0; i < to.size(); ++i) convert_field(to(i), from(i));
  else
    to = To(from);
}

}  // namespace quadtune
