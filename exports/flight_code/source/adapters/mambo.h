/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The control law behind the interface of the Mambo's model project: the functions and global
 * structures that Embedded Coder generates for a model `flightController` (except
 * flightController_M, which reports errors and time), whose inputs are a reference and the states
 * of the model project's own estimator.
 */
#ifndef ADAPTER_MAMBO_H
#define ADAPTER_MAMBO_H

#include <stdint.h>

typedef unsigned char boolean_T;
typedef float real32_T;
typedef uint32_t uint32_T;

typedef struct {
  boolean_T controlModePosVSOrient; /* true: position and heading; false: roll, pitch, heading */
  real32_T pos_ref[3];              /* world [m], z down */
  boolean_T takeoff_flag;           /* during take-off */
  real32_T orient_ref[3];           /* yaw, pitch, roll [rad] */
  uint32_T live_time_ticks;         /* control periods since the start */
} CommandBus;

typedef struct {
  real32_T X, Y, Z;          /* world [m], z down */
  real32_T yaw, pitch, roll; /* [rad] */
  real32_T dx, dy, dz; /* velocity in world axes [m/s]; with -DMAMBO_BODY_VELOCITY in body axes */
  real32_T p, q, r;    /* body rates [rad/s] */
} statesEstim_t;

typedef struct {
  CommandBus ReferenceValueServerBus;
  statesEstim_t states_estim;
} ExtU_flightController_T;

typedef struct {
  real32_T motors_refout[4]; /* @COMMAND@ */
} ExtY_flightController_T;

extern ExtU_flightController_T flightController_U;
extern ExtY_flightController_T flightController_Y;

void flightController_initialize(void);
void flightController_step(void); /* every @DT@ s */
void flightController_terminate(void);

#endif /* ADAPTER_MAMBO_H */
