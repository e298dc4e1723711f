// SPDX-License-Identifier: Apache-2.0
#include "quadtune/model/sensors.hpp"

namespace quadtune {
namespace {

void make_ideal(SensorFaults& faults) {
  SensorFaults clean;
  clean.rate = faults.rate;
  faults = clean;
}

SensorFaults faults_of(double rate, double noise, double delay) {
  SensorFaults faults;
  faults.rate = rate;
  faults.noise.setConstant(noise);
  faults.delay = delay;
  return faults;
}

}  // namespace

Sensors ideal(Sensors sensors) {
  if (sensors.accelerometer) make_ideal(*sensors.accelerometer);
  if (sensors.gyroscope) make_ideal(*sensors.gyroscope);
  if (sensors.magnetometer) make_ideal(*sensors.magnetometer);
  if (sensors.barometer) make_ideal(sensors.barometer->faults);
  if (sensors.sonar) make_ideal(sensors.sonar->faults);
  if (sensors.flow) {
    make_ideal(sensors.flow->faults);
    sensors.flow->noise_per_height = 0;
  }
  sensors.g_sensitivity.setZero();
  if (sensors.gps) {
    make_ideal(sensors.gps->position);
    sensors.gps->velocity_noise.setZero();
  }
  if (sensors.vision) make_ideal(*sensors.vision);
  return sensors;
}

Sensors typical_sensors() {
  Sensors sensors;
  sensors.accelerometer = faults_of(200, 0.05, 0.0);
  sensors.gyroscope = faults_of(200, 0.003, 0.0);
  sensors.magnetometer = faults_of(100, 0.5, 0.0);
  sensors.barometer = BarometerSensor{faults_of(50, 2.5, 0.0)};
  sensors.sonar = SonarSensor{faults_of(20, 0.01, 0.0), 0.03, 5, 0.6};
  sensors.flow = FlowSensor{faults_of(60, 0.02, 0.0)};
  GpsSensor gps;
  gps.position = faults_of(1, 1.0, 0.2);
  gps.velocity_noise.setConstant(0.1);
  sensors.gps = gps;
  return sensors;
}

}  // namespace quadtune
