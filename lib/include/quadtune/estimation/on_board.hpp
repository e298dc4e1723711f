// SPDX-License-Identifier: Apache-2.0
/// What passes between the parts of a flight program: sensors, estimate, reference.
#pragma once

#include <Eigen/Core>

#include "quadtune/model/rigid_body.hpp"
#include "quadtune/scalar.hpp"

namespace quadtune {

/// The newest sample of one sensor, as it came.
template <class Value, class T>
struct Sample {
  Value value{};
  MaskOf<T> fresh{};  ///< true in the one control period in which it came; else value is older
  T age = T(0);       ///< time since it was taken [s]; grows while nothing new comes
};

/// All that the sensors have said. Body axes forward-right-down, world north-east-down.
template <class T>
struct SensorFrame {
  Sample<Vector3<T>, T> specific_force;    ///< accelerometer: (0, 0, -g) at rest, level [m/s²]
  Sample<Vector3<T>, T> rates;             ///< gyroscope [rad/s]
  Sample<Vector3<T>, T> magnetic_field;    ///< of the earth, body axes [µT]
  Sample<T, T> pressure;                   ///< of the air [Pa]
  Sample<T, T> sonar;                      ///< along body z down to the ground [m]; NaN: no echo
  Sample<Eigen::Matrix<T, 2, 1>, T> flow;  ///< mean image velocity over focal length [rad/s]
  Sample<Vector3<T>, T> gps_position;      ///< world [m]
  Sample<Vector3<T>, T> gps_velocity;      ///< world [m/s]
  Sample<Vector3<T>, T> vision;            ///< position from images, world [m]
};

/// What the flight program believes: the 12 states of ned_convention().
template <class T>
struct Estimate {
  StateVector<T> x = StateVector<T>::Zero();
  MaskOf<T> finite{true};       ///< false: an entry of x is not finite; it will not recover
  MaskOf<T> height_used{};      ///< whether sonar or barometer was believed in this period
  MaskOf<T> flow_used{};        ///< whether optical flow was believed in this period
  MaskOf<T> flow_disagrees{};   ///< its velocity is too far from the estimated one: a safety exit
  T innovation_square = T(0);   ///< Σ eᵀ S⁻¹ e over the measurements used in this period
  T innovation_freedom = T(0);  ///< how many those are: the expectation of that sum
};

/// What the motors shall do at this instant.
enum class FlightPhase {
  off,       ///< motors stand
  start_up,  ///< they run up to their least speed
  take_off,  ///< constant thrust (1 + takeoff_gain) m g, attitude held
  flying,    ///< the law has them
  motors,    ///< each by its own share of the range, without a law
};

/// What a mission asks for at one instant, the same for the cascade and the state feedback.
template <class T>
struct Reference {
  Vector3<T> position = Vector3<T>::Zero();  ///< world [m]
  Vector3<T> velocity = Vector3<T>::Zero();  ///< world [m/s], of the moving reference
  T yaw = T(0);                              ///< [rad], unwrapped
  T roll = T(0);                             ///< [rad]; used where track_position is false
  T pitch = T(0);                            ///< [rad]
  bool track_position = true;  ///< controlModePosVsOrient: position, or attitude and height
  FlightPhase phase = FlightPhase::flying;
  /// In FlightPhase::motors: 0 the least, 1 the greatest command; negative: the motor stands.
  Eigen::Matrix<double, kMaxRotors, 1> motors = Eigen::Matrix<double, kMaxRotors, 1>::Constant(-1);
};

/// Assigns a field of settings in another precision: a number, a vector, or what has no precision.
template <class To, class From>
void convert_field(To& to, const From& from) {
  if constexpr (requires { to.size(); })
    for (Eigen::Index i = 0; i < to.size(); ++i) convert_field(to(i), from(i));
  else
    to = To(from);
}

}  // namespace quadtune
