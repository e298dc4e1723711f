// SPDX-License-Identifier: Apache-2.0
#include "flown/flown_noise.hpp"

#include <cmath>

namespace quadtune::internal {
namespace {

ReadingNoise noise_of(const SensorFaults& faults) {
  ReadingNoise noise;
  // Quantization by q adds an error that is uniformly distributed over ±q/2, with variance q²/12.
  const double rounding = faults.quantum * faults.quantum / 12;
  noise.white = (faults.noise.array().square() + rounding).sqrt();
  noise.walk = faults.bias_walk;
  noise.correlated = faults.correlated_noise;
  noise.correlation = faults.correlation;
  return noise;
}

}  // namespace

ReadingNoise reading_noise(const Sensors& sensors, Reading reading, double height) {
  switch (reading) {
    case Reading::specific_force:
      return noise_of(*sensors.accelerometer);
    case Reading::rates:
      return noise_of(*sensors.gyroscope);
    case Reading::magnetic_field:
      return noise_of(*sensors.magnetometer);
    case Reading::pressure:
      return noise_of(sensors.barometer->faults);
    case Reading::sonar:
      return noise_of(sensors.sonar->faults);
    case Reading::flow: {
      ReadingNoise noise = noise_of(sensors.flow->faults);
      const double grown = sensors.flow->noise_per_height * height;
      noise.white = (noise.white.array().square() + grown * grown).sqrt();
      return noise;
    }
    case Reading::gps_position:
      return noise_of(sensors.gps->position);
    case Reading::gps_velocity: {
      ReadingNoise noise;
      noise.white = sensors.gps->velocity_noise;
      return noise;
    }
    case Reading::vision:
      break;
  }
  return noise_of(*sensors.vision);
}

}  // namespace quadtune::internal
