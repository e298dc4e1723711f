/* SPDX-License-Identifier: Apache-2.0 */
/* Feeds a recorded flight to the controller in the firmware's units and axes, and compares its
 * forces with those of the law itself. fly flight.txt A2 STEPS_PER_PERIOD */
#include "../recorded.h"
#include "controller.h"

void vTaskDelay(uint32_t ticks);
void vTaskDelay(uint32_t ticks) { (void)ticks; }

static const double kDegrees = 57.29577951308232;
/* Rotors of the vehicle: 1 front left, 2 front right, 3 back right, 4 back left. Motors of the
 * firmware: 1 front right, 2 back right, 3 back left, 4 front left. */
static const int kRotor[4] = {1, 2, 3, 0};

int main(int argc, char **argv) {
  (void)argc;
  FILE *file = fopen(argv[1], "r");
  const double a2 = atof(argv[2]);
  const unsigned steps = (unsigned)atoi(argv[3]);
  static prog_state_t law;
  prog_start_t start;
  memset(&start, 0, sizeof start);
  prog_initialize(&law, &start);
  controllerOutOfTreeInit();
  recorded_t one;
  control_t control;
  memset(&control, 0, sizeof control);
  double worst = 0, expected[PROG_ROTORS];
  unsigned periods = 0;
  for (uint32_t step = 0; next_recorded(file, &one); step += steps) {
    if (one.reference.phase == PROG_IDLE) continue;
    one.reference.track_position = true;
    const prog_reference_t *r = &one.reference;
    setpoint_t sp;
    memset(&sp, 0, sizeof sp);
    sp.mode.x = sp.mode.y = sp.mode.z = sp.mode.yaw = modeAbs;
    sp.position.x = r->position[0];
    sp.position.y = -r->position[1];
    sp.position.z = -r->position[2];
    sp.attitude.yaw = (float)(-r->yaw * kDegrees);
    one.reference.velocity[0] = one.reference.velocity[1] = one.reference.velocity[2] = 0;
    thrusts_of(&law, &one, a2, 0.12, expected);
    state_t state;
    sensorData_t sensors;
    memset(&state, 0, sizeof state);
    memset(&sensors, 0, sizeof sensors);
    state.position.x = (float)one.position[0];
    state.position.y = (float)-one.position[1];
    state.position.z = (float)-one.position[2];
    state.velocity.x = (float)one.world[0];
    state.velocity.y = (float)-one.world[1];
    state.velocity.z = (float)-one.world[2];
    state.attitudeQuaternion.w = (float)one.quaternion[0];
    state.attitudeQuaternion.x = (float)one.quaternion[1];
    state.attitudeQuaternion.y = (float)-one.quaternion[2];
    state.attitudeQuaternion.z = (float)-one.quaternion[3];
    sensors.gyro.x = (float)(one.rates[0] * kDegrees);
    sensors.gyro.y = (float)(-one.rates[1] * kDegrees);
    sensors.gyro.z = (float)(-one.rates[2] * kDegrees);
    for (unsigned i = 0; i < steps; ++i)
      controllerOutOfTree(&control, &sp, &sensors, &state, step + i);
    if (control.controlMode != controlModeForce) return 3;
    for (int m = 0; m < 4; ++m)
      worst = fmax(worst, fabs(control.normalizedForces[m] - fmin(expected[kRotor[m]], 1)));
    ++periods;
  }
  setpoint_t off;
  memset(&off, 0, sizeof off);
  state_t state;
  sensorData_t sensors;
  memset(&state, 0, sizeof state);
  memset(&sensors, 0, sizeof sensors);
  controllerOutOfTree(&control, &off, &sensors, &state, 0);
  for (int m = 0; m < 4; ++m)
    if (control.normalizedForces[m] != 0) return 4;
  printf("%u periods, forces apart by %.2e\n", periods, worst);
  return periods > 100 && worst < 1e-3 ? 0 : 1;
}
