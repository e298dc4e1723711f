// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/flight/sensor_words.hpp"

#include <fmt/format.h>

namespace quadtune {

std::string describe(const Sensors& sensors) {
  std::string text;
  const auto add = [&](const char* name, const SensorFaults& faults, double noise, const char* unit,
                       const std::string& more = "") {
    text += fmt::format("{}{} {:g} Hz {:g} {}{}", text.empty() ? "" : ", ", name, faults.rate,
                        noise, unit, more);
    if (faults.delay > 0) text += fmt::format(" {:g} s late", faults.delay);
  };
  if (sensors.accelerometer)
    add("accelerometer", *sensors.accelerometer, sensors.accelerometer->noise.maxCoeff(), "m/s2");
  if (sensors.gyroscope)
    add("gyroscope", *sensors.gyroscope, sensors.gyroscope->noise.maxCoeff(), "rad/s");
  if (sensors.magnetometer)
    add("magnetometer", *sensors.magnetometer, sensors.magnetometer->noise.maxCoeff(), "uT");
  if (sensors.barometer)
    add("barometer", sensors.barometer->faults, sensors.barometer->faults.noise(0), "Pa");
  if (sensors.sonar) add("sonar", sensors.sonar->faults, sensors.sonar->faults.noise(0), "m");
  if (sensors.flow)
    add("optical flow", sensors.flow->faults, sensors.flow->faults.noise.head<2>().maxCoeff(),
        "rad/s");
  if (sensors.gps)
    add("GPS", sensors.gps->position, sensors.gps->position.noise.maxCoeff(), "m",
        fmt::format(" {:g} m/s", sensors.gps->velocity_noise.maxCoeff()));
  if (sensors.vision) add("vision", *sensors.vision, sensors.vision->noise.maxCoeff(), "m");
  return text.empty() ? "none" : text;
}

}  // namespace quadtune
