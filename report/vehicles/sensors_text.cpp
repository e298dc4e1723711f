// SPDX-License-Identifier: Apache-2.0
#include "report/vehicles/sensors_text.hpp"

#include <fmt/format.h>

#include <cmath>

#include "quadtune/model/sensors.hpp"
#include "report/text/print.hpp"

namespace quadtune::report {
namespace {

/// One number where all axes have the same, else one for each of them.
std::string of_axes(const Eigen::Vector3d& v, int axes) {
  return (v.head(axes).array() == v(0)).all() ? number(v(0)) : numbers(v.head(axes));
}

/// "gyroscope     200 Hz, noise 0.01 rad/s, delay 0.005 s"
std::string line_of(const char* name, const SensorFaults& f, int axes, const char* unit) {
  const auto values = [axes](const Eigen::Vector3d& v) { return of_axes(v, axes); };
  std::string text =
      fmt::format("{:<14}{} Hz, noise {} {}", name, number(f.rate), values(f.noise), unit);
  if (f.delay > 0) text += fmt::format(", delay {} s", number(f.delay));
  if (!f.bias.isZero(0)) text += fmt::format(", bias {} {}", values(f.bias), unit);
  if (!f.scale.isOnes(0)) text += fmt::format(", scale {}", values(f.scale));
  if (f.natural_frequency > 0)
    text += fmt::format(", response {} rad/s damped {}", number(f.natural_frequency),
                        number(f.damping));
  if (std::isfinite(f.limit)) text += fmt::format(", limit {} {}", number(f.limit), unit);
  if (f.quantum > 0) text += fmt::format(", steps of {} {}", number(f.quantum), unit);
  if (f.dropout > 0) text += fmt::format(", {} lost", number(f.dropout));
  if (!f.turn_on_bias.isZero(0))
    text += fmt::format(", bias at turn-on {} {}", values(f.turn_on_bias), unit);
  if (!f.bias_walk.isZero(0))
    text += fmt::format(", bias walk {} {}/sqrt(s)", values(f.bias_walk), unit);
  if (!f.correlated_noise.isZero(0))
    text += fmt::format(", correlated over {} s {} {}", number(f.correlation),
                        values(f.correlated_noise), unit);
  if (!f.vibration.isZero(0))
    text += fmt::format(", vibration {} {} s2/rad2", values(f.vibration), unit);
  return text;
}

std::string gyroscope_text(const SensorFaults& faults, const Eigen::Vector3d& g_sensitivity) {
  std::string text = line_of("gyroscope", faults, 3, "rad/s");
  if (!g_sensitivity.isZero(0)) text += fmt::format(", {} rad/s per m/s2", numbers(g_sensitivity));
  return text;
}

std::string barometer_text(const BarometerSensor& barometer) {
  std::string text = line_of("barometer", barometer.faults, 1, "Pa");
  text += fmt::format(", {} Pa at the ground", number(barometer.ground_pressure));
  if (!std::isnan(barometer.fall)) text += fmt::format(", {} Pa/m", number(barometer.fall));
  return text;
}

std::string sonar_text(const SonarSensor& sonar) {
  return line_of("sonar", sonar.faults, 1, "m") +
         fmt::format(", range {} ... {} m, tilt up to {} rad", number(sonar.least_range),
                     number(sonar.greatest_range), number(sonar.greatest_tilt));
}

std::string flow_text(const FlowSensor& flow) {
  std::string text = line_of("flow", flow.faults, 2, "rad/s");
  text += fmt::format(", half field {} {} rad, above {} m", number(flow.half_field_x),
                      number(flow.half_field_y), number(flow.least_height));
  if (std::isfinite(flow.greatest_height))
    text += fmt::format(" and below {} m", number(flow.greatest_height));
  if (flow.noise_per_height > 0)
    text += fmt::format(", noise {} rad/s/m more with height", number(flow.noise_per_height));
  return text;
}

}  // namespace

std::string sensors_text(const Vehicle& vehicle) {
  const Sensors& s = vehicle.sensors;
  std::string text;
  const auto add = [&](const std::string& line) { text += (text.empty() ? "" : "\n") + line; };
  if (s.accelerometer) add(line_of("accelerometer", *s.accelerometer, 3, "m/s2"));
  if (s.gyroscope) add(gyroscope_text(*s.gyroscope, s.g_sensitivity));
  if (s.magnetometer) add(line_of("magnetometer", *s.magnetometer, 3, "uT"));
  if (s.barometer) add(barometer_text(*s.barometer));
  if (s.sonar) add(sonar_text(*s.sonar));
  if (s.flow) add(flow_text(*s.flow));
  if (s.gps)
    add(line_of("gps", s.gps->position, 3, "m") +
        fmt::format(", velocity noise {} m/s", number(s.gps->velocity_noise.x())));
  if (s.vision) add(line_of("vision", *s.vision, 3, "m"));
  if (text.empty()) return "none";
  return vehicle.sensors_known ? text : text + "\nassumed: the file has no [sensors]";
}

}  // namespace quadtune::report
