/* SPDX-License-Identifier: Apache-2.0 */
/* Lines of an exported flight.txt of a program `prog` without an estimator. */
#pragma once
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "prog.h"

typedef struct {
  double position[3], roll, pitch, yaw, velocity[3], rates[3]; /* of the estimate */
  prog_reference_t reference;
  double world[3];      /* velocity in world axes */
  double quaternion[4]; /* w, x, y, z from body to world */
} recorded_t;

static int next_recorded(FILE *file, recorded_t *to) {
  static char line[8192];
  double all[12 + 2 + 9 + PROG_ROTORS];
  do {
    if (!fgets(line, sizeof line, file)) return 0;
  } while (line[0] == '#' || line[0] == 's' || line[0] == '\n');
  char *rest = line;
  for (unsigned i = 0; i < sizeof all / sizeof all[0]; ++i) all[i] = strtod(rest, &rest);
  memcpy(to->position, all, 3 * sizeof(double));
  to->roll = all[3];
  to->pitch = all[4];
  to->yaw = all[5];
  memcpy(to->velocity, all + 6, 3 * sizeof(double));
  memcpy(to->rates, all + 9, 3 * sizeof(double));
  memset(&to->reference, 0, sizeof to->reference);
  to->reference.phase = all[12] > 0.5 ? PROG_FLYING : PROG_IDLE;
  to->reference.track_position = all[13] > 0.5;
  for (int i = 0; i < 3; ++i) {
    to->reference.position[i] = (prog_real)all[14 + i];
    to->reference.velocity[i] = (prog_real)all[17 + i];
  }
  to->reference.roll = (prog_real)all[20];
  to->reference.pitch = (prog_real)all[21];
  to->reference.yaw = (prog_real)all[22];
  const double cr = cos(to->roll / 2), sr = sin(to->roll / 2), cp = cos(to->pitch / 2);
  const double sp = sin(to->pitch / 2), cy = cos(to->yaw / 2), sy = sin(to->yaw / 2);
  double *q = to->quaternion;
  q[0] = cr * cp * cy + sr * sp * sy;
  q[1] = sr * cp * cy - cr * sp * sy;
  q[2] = cr * sp * cy + sr * cp * sy;
  q[3] = cr * cp * sy - sr * sp * cy;
  /* world = v + 2 w (u x v) + 2 u x (u x v) of the vector part u */
  const double *v = to->velocity, *u = q + 1;
  const double c[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                       u[0] * v[1] - u[1] * v[0]};
  const double d[3] = {u[1] * c[2] - u[2] * c[1], u[2] * c[0] - u[0] * c[2],
                       u[0] * c[1] - u[1] * c[0]};
  for (int i = 0; i < 3; ++i) to->world[i] = v[i] + 2 * q[0] * c[i] + 2 * d[i];
  return 1;
}

static void estimate_of(const recorded_t *from, prog_estimate_t *to) {
  memset(to, 0, sizeof *to);
  for (int i = 0; i < 3; ++i) {
    to->position[i] = (prog_real)from->position[i];
    to->velocity[i] = (prog_real)from->velocity[i];
    to->rates[i] = (prog_real)from->rates[i];
  }
  to->roll = (prog_real)from->roll;
  to->pitch = (prog_real)from->pitch;
  to->yaw = (prog_real)from->yaw;
  to->finite = true;
}

/* Thrusts that the law itself asks for in this period, over `unit` [N]. */
static void thrusts_of(prog_state_t *law, const recorded_t *from, const double a2,
                       const double unit, double thrusts[PROG_ROTORS]) {
  prog_estimate_t estimate;
  prog_output_t output;
  estimate_of(from, &estimate);
  prog_control(law, &estimate, &from->reference, &output);
  for (int i = 0; i < PROG_ROTORS; ++i) thrusts[i] = a2 * output.speed[i] * output.speed[i] / unit;
}
