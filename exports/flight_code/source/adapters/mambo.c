/* SPDX-License-Identifier: Apache-2.0 */
/*
 * See adapter_mambo.h. As a shared object for the Mambo's Cortex-A9, in this folder:
 *
 *   arm-linux-gnueabihf-gcc -std=c99 -ffp-contract=off -O2 -mcpu=cortex-a9 -fPIC -shared
 *     -o flightController.so adapter_mambo.c @NAME@.c @NAME@_*.c -lm
 *
 * or with the compiler of the model project, whose floating-point ABI it must share.
 */
#include "adapter_mambo.h"
#include "internal.h"

ExtU_flightController_T flightController_U;
ExtY_flightController_T flightController_Y;

/* Rotor of the law for the motors 1 front left, 2 front right, 3 back right, 4 back left. */
static const int rotor_of_motor[4] = {QT_ROTORS_OF_MOTORS};

static qt_state_t law;
static qt_output_t output;
static qt_real last_yaw; /* unwrapped [rad] */

/* `angle` plus the whole turns that bring it nearest to `to`. */
static qt_real near_to(qt_real angle, qt_real to) {
  return angle + ((2.0f * QT_PI) * qt_nearest((to - angle) / (2.0f * QT_PI)));
}

static void read_estimate(const statesEstim_t *from, qt_estimate_t *to) {
  const qt_real velocity[3] = {from->dx, from->dy, from->dz};
  const qt_real yaw = near_to(from->yaw, last_yaw);
  to->position[0] = from->X;
  to->position[1] = from->Y;
  to->position[2] = from->Z;
  to->roll = from->roll;
  to->pitch = from->pitch;
  to->yaw = yaw;
  to->rates[0] = from->p;
  to->rates[1] = from->q;
  to->rates[2] = from->r;
  to->finite = true;
  if (qt_is_finite(yaw)) {
    last_yaw = yaw;
  }
#ifdef MAMBO_BODY_VELOCITY
  (void)memcpy(to->velocity, velocity, sizeof to->velocity);
#else
  {
    qt_real R[9]; /* from body axes to world axes */
    qt_rotation_of_euler(from->roll, from->pitch, from->yaw, R);
    for (int i = 0; i < 3; ++i) {
      to->velocity[i] = (R[i] * velocity[0]) + (R[3 + i] * velocity[1]) + (R[6 + i] * velocity[2]);
    }
  }
#endif
}

static void read_reference(const CommandBus *from, qt_reference_t *to) {
  to->phase = (from->takeoff_flag != 0u) ? QT_TAKE_OFF : QT_FLYING;
  to->track_position = from->controlModePosVSOrient != 0u;
  (void)memcpy(to->position, from->pos_ref, sizeof to->position);
  to->yaw = near_to(from->orient_ref[0], last_yaw);
  to->pitch = from->orient_ref[1];
  to->roll = from->orient_ref[2];
}

void flightController_initialize(void) {
  qt_start_t start;
  (void)memset(&start, 0, sizeof start);
  qt_initialize(&law, &start);
  last_yaw = 0.0f;
  (void)memset(&flightController_Y, 0, sizeof flightController_Y);
}

void flightController_step(void) {
  qt_estimate_t estimate;
  qt_reference_t reference;
  (void)memset(&estimate, 0, sizeof estimate);
  (void)memset(&reference, 0, sizeof reference);
  read_estimate(&flightController_U.states_estim, &estimate);
  read_reference(&flightController_U.ReferenceValueServerBus, &reference);
  qt_control(&law, &estimate, &reference, &output);
  for (int m = 0; m < 4; ++m) {
    flightController_Y.motors_refout[m] = output.command[rotor_of_motor[m]];
  }
}

void flightController_terminate(void) {
  qt_terminate(&law, &output);
  (void)memset(&flightController_Y, 0, sizeof flightController_Y);
}
