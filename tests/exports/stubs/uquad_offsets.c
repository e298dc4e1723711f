/* SPDX-License-Identifier: Apache-2.0
 *
 * Starts the uquad's filter with offsets that are known already, lets it calibrate at rest, and
 * prints roll, pitch and the estimated rates: once without gyroscope samples during the calibration
 * and once with an image of an age that no image has. Arguments: periods of the calibration. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "prog.h"

static const prog_real kRoll = 0.03f, kPitch = -0.02f;

static void at_rest(prog_sensors_t *sensors) {
  const double g = 9.81;
  memset(sensors, 0, sizeof *sensors);
  sensors->on_ground = true;
  sensors->specific_force.fresh = true;
  sensors->specific_force.value[0] = (prog_real)(g * sin(kPitch) + 0.4);
  sensors->specific_force.value[1] = (prog_real)(-g * cos(kPitch) * sin(kRoll) - 0.3);
  sensors->specific_force.value[2] = (prog_real)(-g * cos(kPitch) * cos(kRoll) + 0.2);
}

int main(int argc, char **argv) {
  const int periods = (argc > 1) ? atoi(argv[1]) : 50;
  prog_state_t state;
  prog_start_t start;
  prog_sensors_t sensors;
  prog_estimate_t estimate;
  memset(&start, 0, sizeof start);
  start.force_bias[0] = 0.4f;
  start.force_bias[1] = -0.3f;
  start.force_bias[2] = 0.2f;
  start.gyro_bias[0] = 0.05f;
  prog_initialize(&state, &start);
  for (int k = 0; k < periods; ++k) {
    at_rest(&sensors);
    prog_estimate(&state, &sensors, &estimate);
  }
  printf("roll %.4f pitch %.4f\n", (double)estimate.roll, (double)estimate.pitch);
  /* The gyroscope reads its offset: the vehicle does not turn. */
  for (int k = 0; k < 200; ++k) {
    at_rest(&sensors);
    sensors.rates.fresh = true;
    sensors.rates.value[0] = 0.05f;
    prog_estimate(&state, &sensors, &estimate);
  }
  printf("p %.3f\n", fabs((double)estimate.rates[0]));
  at_rest(&sensors);
  sensors.vision.fresh = true;
  sensors.vision.value[0] = 5.0f;
  sensors.vision.age = 2.0f;
  prog_estimate(&state, &sensors, &estimate);
  printf("x %.3f\n", fabs((double)estimate.position[0]));
  return 0;
}
