// SPDX-License-Identifier: Apache-2.0
/// Records one flight of a pack, one row per control period.
#pragma once

#include <string>
#include <vector>

#include "quadtune/estimation/on_board.hpp"
#include "quadtune/logs/log_table.hpp"
#include "quadtune/model/battery.hpp"
#include "quadtune/model/sensors.hpp"
#include "quadtune/simulation/flight.hpp"
#include "quadtune/simulation/plant.hpp"

namespace quadtune::internal {

class FlightRecorder {
 public:
  /// @param rows  estimated number of rows
  FlightRecorder(const FlightSetup& setup, const Sensors& sensors, int rotors, std::size_t rows);

  /// Adds a row from lane `l` of each argument; the columns are filled in the order of their
  /// creation.
  template <class P, class State>
  void add(double t, int l, const State& x, const RotorSpeeds<P>& turning,
           const SensorFrame<P>& frame, const Estimate<P>& estimate,
           const Reference<double>& reference, const Eigen::Matrix<P, 4, 1>& wrench,
           const Eigen::Matrix<P, 4, 1>& made, const RotorSpeeds<P>& told,
           const BatteryState<P>& battery, const Vector3<P>& wind) {
    next_ = 0;
    put(t);
    for (int i = 0; i < kRotorSpeeds; ++i) put(lane(x(i), l));
    const Eigen::Quaterniond q(lane(x(3), l), lane(x(4), l), lane(x(5), l), lane(x(6), l));
    const Eigen::Vector3d angles = euler_of_quaternion<double>(q);
    for (int i = 0; i < 3; ++i) put(angles(i));
    for (Eigen::Index i = 0; i < turning.size(); ++i) put(lane(turning(i), l));
    for (int i = 0; i < 12; ++i) put(lane(estimate.x(i), l));
    for (int i = 0; i < 3; ++i) put(reference.position(i));
    for (int i = 0; i < 3; ++i) put(reference.velocity(i));
    for (const double angle : {reference.roll, reference.pitch, reference.yaw}) put(angle);
    put(reference.track_position ? 1 : 0);
    put(static_cast<double>(reference.phase));
    for (int i = 0; i < 4; ++i) put(lane(wrench(i), l));
    for (int i = 0; i < 4; ++i) put(lane(made(i), l));
    for (Eigen::Index i = 0; i < told.size(); ++i) put(lane(told(i), l));
    put_vector(has_.accelerometer, frame.specific_force, l);
    put_vector(has_.gyroscope, frame.rates, l);
    put_vector(has_.magnetometer, frame.magnetic_field, l);
    put_number(has_.barometer, frame.pressure, l);
    put_number(has_.sonar, frame.sonar, l);
    put_vector(has_.flow, frame.flow, l);
    put_vector(has_.gps, frame.gps_position, l);
    put_vector(has_.gps, frame.gps_velocity, l);
    put_vector(has_.vision, frame.vision, l);
    if (has_.battery)
      for (const P& value : {battery.voltage, battery.current, battery.charge}) put(lane(value, l));
    if (has_.wind)
      for (int i = 0; i < 3; ++i) put(lane(wind(i), l));
  }

  /// The recorded table, with the events of the flight.
  [[nodiscard]] LogTable table(const std::vector<LogEvent>& events);

 private:
  struct Parts {
    bool accelerometer, gyroscope, magnetometer, barometer, sonar, flow, gps, vision, battery, wind;
  };

  void column(const std::string& name, const std::string& unit);
  void columns(const std::string& group, const std::vector<std::pair<std::string, std::string>>&);
  void put(double value) { table_.columns[next_++].values.push_back(value); }

  // A row without a new sample contains NaN.
  template <class Value, class P>
  void put_vector(bool present, const Sample<Value, P>& sample, int l) {
    if (!present) return;
    for (Eigen::Index i = 0; i < sample.value.size(); ++i)
      put(lane(sample.fresh, l) ? lane(sample.value(i), l)
                                : std::numeric_limits<double>::quiet_NaN());
  }
  template <class P>
  void put_number(bool present, const Sample<P, P>& sample, int l) {
    if (present)
      put(lane(sample.fresh, l) ? lane(sample.value, l) : std::numeric_limits<double>::quiet_NaN());
  }

  Parts has_;
  LogTable table_;
  std::size_t rows_ = 0;
  std::size_t next_ = 0;
};

}  // namespace quadtune::internal
