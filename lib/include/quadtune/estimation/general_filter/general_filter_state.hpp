// SPDX-License-Identifier: Apache-2.0
/// State of the general filter between control periods.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "quadtune/estimation/general_filter_settings.hpp"
#include "quadtune/estimation/on_board.hpp"

namespace quadtune {

/// Indices of the error states: position and velocity in world axes, a small rotation about the
/// world axes, gyroscope and accelerometer biases in body axes, offset of the barometer's height.
inline constexpr int kErrorPosition = 0;
inline constexpr int kErrorVelocity = 3;         ///< velocity, world axes [m/s]
inline constexpr int kErrorTurn = 6;             ///< small rotation about the world axes [rad]
inline constexpr int kErrorGyroBias = 9;         ///< bias of the gyroscope, body axes [rad/s]
inline constexpr int kErrorForceBias = 12;       ///< bias of the accelerometer, body axes [m/s²]
inline constexpr int kErrorPressureHeight = 15;  ///< offset of the barometer's height [m]
inline constexpr int kErrorStates = 16;          ///< number of error states

/// A symmetric matrix, of which only the lower triangle is stored, row by row.
template <class T, int n>
struct SymmetricMatrix {
  /// Row by row: (0,0), (1,0), (1,1), (2,0) ….
  std::array<T, static_cast<std::size_t>(n*(n + 1) / 2)> entries{};

  /// Index into `entries`; (i, j) and (j, i) are the same entry.
  [[nodiscard]] static constexpr std::size_t place(int i, int j) {
    return static_cast<std::size_t>(i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i);
  }
  T& operator()(int i, int j) { return entries[place(i, j)]; }  ///< entry (i, j), 0 ≤ i, j < n
  /// Entry (i, j), 0 ≤ i, j < n.
  const T& operator()(int i, int j) const { return entries[place(i, j)]; }
};

/// The n newest values, newest first, in a ring buffer.
template <class Value, int n>
struct History {
  std::array<Value, static_cast<std::size_t>(n)> values{};  ///< in ring order
  int newest = 0;                                           ///< index of the newest value

  /// @param age  in control periods, 0 ≤ age < n
  [[nodiscard]] const Value& operator[](int age) const { return values[place(age)]; }
  Value& operator[](int age) { return values[place(age)]; }  ///< likewise, for changes
  /// Advances the ring and returns the slot of the newest value; the caller overwrites its old
  /// content.
  Value& advance() {
    newest = newest == 0 ? n - 1 : newest - 1;
    return values[static_cast<std::size_t>(newest)];
  }
  void fill(const Value& value) { values.fill(value); }  ///< sets all n values

 private:
  [[nodiscard]] std::size_t place(int age) const {
    const int i = newest + age;
    return static_cast<std::size_t>(i < n ? i : i - n);
  }
};

/// Gyroscope and accelerometer readings of one control period, scale factors divided out.
template <class T>
struct InertialReading {
  Vector3<T> rates = Vector3<T>::Zero();  ///< bias included [rad/s]
  Vector3<T> force = Vector3<T>::Zero();  ///< bias included [m/s²]
};

/// A sample that waits until the horizon reaches its time.
template <class Value, class T>
struct Waiting {
  Value value{};     ///< the sample
  T age = T(0);      ///< age at its arrival [s]
  MaskOf<T> came{};  ///< whether a sample arrived in that period
};

/// The scalar measurements, in the order of GeneralFilterState::rejections.
enum class Scalar {
  flow = 0,
  range = 2,
  pressure = 3,
  heading = 4,
  gps_position = 5,
  gps_velocity = 8,
  vision = 11,
};
inline constexpr std::size_t kScalars = 14;  ///< number of scalar measurements

/// Rejections of a scalar measurement since it was last accepted.
template <class T>
struct Rejections {
  T time = T(0);   ///< since the last accepted one [s]
  T count = T(0);  ///< number of consecutive rejections
};

/// Position, velocity and attitude at one time.
template <class T>
struct Motion9 {
  Vector3<T> position = Vector3<T>::Zero();                           ///< world [m]
  Vector3<T> velocity = Vector3<T>::Zero();                           ///< world [m/s]
  Eigen::Matrix<T, 4, 1> attitude = Eigen::Matrix<T, 4, 1>::UnitX();  ///< (w, x, y, z) of R_WB
};

/// Filter state between control periods. A copy resumes identically.
///
/// The motion and its covariance refer to the horizon, horizon_periods() before the newest period.
template <class T>
struct GeneralFilterState {
  Motion9<T> motion;                           ///< at the horizon
  Vector3<T> gyro_bias = Vector3<T>::Zero();   ///< [rad/s]
  Vector3<T> force_bias = Vector3<T>::Zero();  ///< of the accelerometer [m/s²]
  T pressure_height = T(0);                    ///< offset of the barometer's height [m]
  SymmetricMatrix<T, kErrorStates> P;          ///< covariance of the errors, in their order
  T yaw = T(0);                                ///< last estimate, not wrapped [rad]

  /// Inertial readings, newest first.
  History<InertialReading<T>, kMaxHistoryPeriods + kMaxHorizonPeriods + 4> readings;
  /// Samples of a sensor that wait for the horizon, newest first.
  template <class Value>
  using Queue = History<Waiting<Value, T>, kMaxHorizonPeriods + 2>;
  Queue<Eigen::Matrix<T, 2, 1>> flow;                ///< as SensorFrame::flow
  Queue<T> range;                                    ///< as SensorFrame::sonar
  Queue<T> pressure;                                 ///< as SensorFrame::pressure
  Queue<Vector3<T>> field;                           ///< as SensorFrame::magnetic_field
  Queue<Vector3<T>> gps_position;                    ///< as SensorFrame::gps_position
  Queue<Vector3<T>> gps_velocity;                    ///< as SensorFrame::gps_velocity
  Queue<Vector3<T>> vision;                          ///< as SensorFrame::vision
  std::array<Rejections<T>, kScalars> rejections{};  ///< by Scalar
};

/// Initial state for a known motion, with the standard deviations settings.start.
/// @param settings  accepted by validate(); `start` gives the variances
/// @param x         the 12 states of ned_convention()
template <class T>
[[nodiscard]] GeneralFilterState<T> general_filter_start(const GeneralFilterSettings& settings,
                                                         const StateVector<T>& x) {
  GeneralFilterState<T> state;
  const Eigen::Quaternion<T> q = quaternion_of_euler(x(3), x(4), x(5));
  const Matrix3<T> R_WB = rotation_of_euler(x(3), x(4), x(5));
  state.motion.position = x.template segment<3>(kPosition);
  state.motion.velocity = R_WB * x.template segment<3>(kVelocity);
  state.motion.attitude << q.w(), q.x(), q.y(), q.z();
  state.yaw = x(kAttitude + 2);
  InertialReading<T> rest;
  rest.rates = x.template segment<3>(kRates);
  rest.force = R_WB.row(2).transpose() * T(-settings.gravity);
  state.readings.fill(rest);

  for (T& entry : state.P.entries) entry = T(0);
  const StartDeviations& s = settings.start;
  const auto set = [&](int first, double deviation) {
    for (int i = first; i < first + 3; ++i) state.P(i, i) = T(deviation * deviation);
  };
  set(kErrorPosition, s.position);
  set(kErrorVelocity, s.velocity);
  set(kErrorTurn, s.tilt);
  state.P(kErrorTurn + 2, kErrorTurn + 2) = T(s.yaw * s.yaw);
  set(kErrorGyroBias, s.gyro_bias);
  set(kErrorForceBias, s.force_bias);
  if (settings.pressure)
    state.P(kErrorPressureHeight, kErrorPressureHeight) = T(s.pressure_height * s.pressure_height);
  return state;
}

/// Sets biases that were estimated before the flight; the filter subtracts them from the first
/// period on.
template <class T>
void set_biases(GeneralFilterState<T>& state, const Vector3<T>& gyro_bias,
                const Vector3<T>& force_bias) {
  for (auto& reading : state.readings.values) {
    reading.rates += gyro_bias - state.gyro_bias;
    reading.force += force_bias - state.force_bias;
  }
  state.gyro_bias = gyro_bias;
  state.force_bias = force_bias;
}

}  // namespace quadtune
