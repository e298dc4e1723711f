/* SPDX-License-Identifier: Apache-2.0 */
/* Feeds a recorded flight to the functions of the model project. mambo_fly flight.txt */
#include "adapter_mambo.h"
#include "recorded.h"

int main(int argc, char **argv) {
  (void)argc;
  FILE *file = fopen(argv[1], "r");
  static prog_state_t law;
  prog_start_t start;
  memset(&start, 0, sizeof start);
  prog_initialize(&law, &start);
  flightController_initialize();
  recorded_t one;
  double worst = 0;
  unsigned periods = 0;
  while (next_recorded(file, &one)) {
    if (one.reference.phase == PROG_IDLE) continue;
    one.reference.velocity[0] = one.reference.velocity[1] = one.reference.velocity[2] = 0;
    prog_estimate_t estimate;
    prog_output_t output;
    estimate_of(&one, &estimate);
    prog_control(&law, &estimate, &one.reference, &output);
    CommandBus *bus = &flightController_U.ReferenceValueServerBus;
    memset(bus, 0, sizeof *bus);
    bus->controlModePosVSOrient = one.reference.track_position;
    for (int i = 0; i < 3; ++i) bus->pos_ref[i] = one.reference.position[i];
    bus->orient_ref[0] = one.reference.yaw;
    bus->orient_ref[1] = one.reference.pitch;
    bus->orient_ref[2] = one.reference.roll;
    statesEstim_t *x = &flightController_U.states_estim;
    x->X = (float)one.position[0];
    x->Y = (float)one.position[1];
    x->Z = (float)one.position[2];
    x->roll = (float)one.roll;
    x->pitch = (float)one.pitch;
    x->yaw = (float)one.yaw;
    x->dx = (float)one.world[0];
    x->dy = (float)one.world[1];
    x->dz = (float)one.world[2];
    x->p = (float)one.rates[0];
    x->q = (float)one.rates[1];
    x->r = (float)one.rates[2];
    flightController_step();
    for (int i = 0; i < 4; ++i)
      worst = fmax(worst, fabs(flightController_Y.motors_refout[i] - output.command[i]) /
                              fmax(1, fabs(output.command[i])));
    ++periods;
  }
  flightController_terminate();
  for (int i = 0; i < 4; ++i)
    if (flightController_Y.motors_refout[i] != 0) return 4;
  printf("%u periods, commands apart by %.2e\n", periods, worst);
  return periods > 100 && worst < 1e-3 ? 0 : 1;
}
