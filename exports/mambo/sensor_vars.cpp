// SPDX-License-Identifier: Apache-2.0
// sensorsVars.m: the errors that the virtual sensors of the model project add to the true values.
#include "mambo/sensor_vars.hpp"

#include <cmath>

#include "mambo/m_file.hpp"

namespace quadtune::exports {
namespace {

/// @param axes  number of axes of the sensor, 1 to 3
void add_faults(MFile& m, const std::string& name, const SensorFaults& faults, int axes,
                const std::string& unit) {
  const std::string prefix = "Sensors." + name + ".";
  const auto vector = [&](const char* key, const Eigen::Vector3d& value, const std::string& about) {
    m.matrix(prefix + key, value.head(axes).transpose(), about);
  };
  m.comment("");
  m.number(prefix + "rate", faults.rate, "Hz");
  m.number(prefix + "delay", faults.delay, "s, from a sample to its arrival");
  vector("scale", faults.scale, "reading over truth");
  vector("bias", faults.bias, unit);
  vector("noise", faults.noise, unit + ", standard deviation of a sample");
  vector("turnOnBias", faults.turn_on_bias, unit + ", standard deviation from flight to flight");
  vector("biasWalk", faults.bias_walk, unit + "/sqrt(s)");
  if (faults.natural_frequency > 0) {
    m.number(prefix + "naturalFrequency", faults.natural_frequency, "rad/s");
    m.number(prefix + "damping", faults.damping);
  }
  if (std::isfinite(faults.limit)) m.number(prefix + "limit", faults.limit, unit);
  if (faults.quantum > 0) m.number(prefix + "quantum", faults.quantum, unit);
  if (faults.dropout > 0) m.number(prefix + "dropout", faults.dropout, "share of lost samples");
}

}  // namespace

std::string sensor_vars(const Vehicle& vehicle) {
  const Sensors& sensors = vehicle.sensors;
  MFile m;
  m.comment("sensorsVars.m: " + vehicle.name + ", written by quadtune. SI units, body axes.");
  m.comment(
      "The names are quadtune's. Compare them with those of your model before you replace its "
      "file.");
  m.comment("A sample is the truth, through the response, times scale, plus bias, plus noise.");
  if (sensors.accelerometer) add_faults(m, "accelerometer", *sensors.accelerometer, 3, "m/s^2");
  if (sensors.gyroscope) add_faults(m, "gyroscope", *sensors.gyroscope, 3, "rad/s");
  if (sensors.magnetometer) add_faults(m, "magnetometer", *sensors.magnetometer, 3, "uT");
  if (sensors.barometer) {
    add_faults(m, "barometer", sensors.barometer->faults, 1, "Pa");
    m.number("Sensors.barometer.groundPressure", sensors.barometer->ground_pressure, "Pa");
  }
  if (sensors.sonar) {
    add_faults(m, "sonar", sensors.sonar->faults, 1, "m");
    m.number("Sensors.sonar.leastRange", sensors.sonar->min_range, "m");
    if (std::isfinite(sensors.sonar->max_range))
      m.number("Sensors.sonar.greatestRange", sensors.sonar->max_range, "m");
    m.number("Sensors.sonar.greatestTilt", sensors.sonar->max_tilt, "rad");
  }
  if (sensors.flow) {
    add_faults(m, "flow", sensors.flow->faults, 2, "rad/s");
    m.matrix("Sensors.flow.halfField",
             Eigen::RowVector2d(sensors.flow->half_field_x, sensors.flow->half_field_y),
             "rad, half the field of view along x and y");
    m.number("Sensors.flow.leastHeight", sensors.flow->min_height, "m");
    m.number("Sensors.flow.rateGain", sensors.flow->simplified_rate_gain,
             "of the simplified model of the flow");
  }
  return m.text();
}

}  // namespace quadtune::exports
