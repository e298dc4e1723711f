/* SPDX-License-Identifier: Apache-2.0 */
/*
 * State feedback:
 *
 *   u = u0 + K (sp - x) + K_int x_int - K_lag (a - u0) - K_past [u[k-1] - u0; u[k-2] - u0; ...]
 *
 * with the set point sp of the 12 states x = (position, roll, pitch, yaw, body velocity, rates),
 * the integral x_int of the errors, and the state a of the actuators, which follow the past
 * commands with their lag. Terms that this law does not have are removed from the code. An integral
 * does not grow while the motors produce less than it requests.
 */
#include "internal.h"

/* Indices of the states. */
#define NORTH 0
#define EAST 1
#define DOWN 2
#define ROLL 3
#define PITCH 4
#define YAW 5
#define SPEED 6
#define RATE 9

static void states_of(const qt_estimate_t *e, qt_real x[12]) {
  for (int i = 0; i < 3; ++i) {
    x[i] = e->position[i];
    x[SPEED + i] = e->velocity[i];
    x[RATE + i] = e->rates[i];
  }
  x[ROLL] = e->roll;
  x[PITCH] = e->pitch;
  x[YAW] = e->yaw;
}

/* The set point of the 12 states; states that the reference does not contain are those of x0. */
static void set_point(const qt_law_parameters_t *p, const qt_real x[12],
                      const qt_reference_t *reference, qt_real sp[12]) {
  qt_real R[9];
  qt_real velocity[3];
  (void)memcpy(sp, p->x0, sizeof p->x0);
  qt_rotation_of_euler(x[ROLL], x[PITCH], x[YAW], R);
  qt_transposed_times3(R, reference->velocity, velocity);
  for (int i = 0; i < 3; ++i) {
    sp[SPEED + i] += velocity[i];
  }
  sp[YAW] = reference->yaw;
  sp[DOWN] = reference->position[2];
  if (reference->track_position) {
    sp[NORTH] = reference->position[0];
    sp[EAST] = reference->position[1];
  } else { /* position across has no say */
    for (int i = 0; i < 2; ++i) {
      sp[i] = x[i];
      sp[SPEED + i] = x[SPEED + i];
    }
    sp[ROLL] = reference->roll;
    sp[PITCH] = reference->pitch;
  }
}

/* Rotates (north, east) from the heading of the trim to that of the vehicle, or copies it. */
static void in_position_axes(const qt_law_parameters_t *p, qt_real c, qt_real s, qt_real along[2]) {
  if (p->heading_axes) {
    const qt_real north = along[0];
    const qt_real east = along[1];
    along[0] = (c * north) + (s * east);
    along[1] = (c * east) - (s * north);
  }
}

#if QT_WITH_INTEGRALS
/* The part of the requested inputs of this integral that the motors do not produce, > 0. */
static qt_real pushes(const qt_law_parameters_t *p, const qt_law_state_t *s, int j,
                      const qt_real error[12], qt_real c, qt_real sine) {
  const int of = p->integrated[j];
  qt_real turned[2] = {0.0f, 0.0f};
  qt_real sum = 0.0f;
  if (of < 2) { /* an error to the north is one along and one across the heading */
    turned[of] = error[of];
    in_position_axes(p, c, sine, turned);
  }
  for (int i = 0; i < QT_INPUTS; ++i) {
    qt_real answer = 0.0f;
    if (of >= 2) {
      answer = p->K_int[i][j] * error[of];
    } else {
      for (int axis = 0; axis < 2; ++axis) {
        if (p->of_position[axis] >= 0) {
          answer += p->K_int[i][p->of_position[axis]] * turned[axis];
        }
      }
    }
    sum += qt_max(s->excess[i] * answer, 0.0f);
  }
  return sum;
}

static qt_real step_integral(const qt_guard_t *p, qt_real dt, qt_real integral, qt_real error) {
  qt_real result = integral;
  if (qt_abs(error) <= p->error_limit) { /* false for NaN */
    const qt_real increment = qt_clamp(error * dt, -p->increment_limit, p->increment_limit);
    result = qt_clamp(integral + increment, -p->integral_limit, p->integral_limit);
  }
  return result;
}

#endif
void qt_law_step(const qt_law_parameters_t *p, qt_law_state_t *s, const qt_estimate_t *estimate,
                 const qt_reference_t *reference, qt_real u[QT_INPUTS]) {
  qt_real x[12];
  qt_real sp[12];
  qt_real error[12];
#if QT_WITH_INTEGRALS
  qt_real whole[12]; /* before it is limited and turned */
  qt_real integrals[QT_INTEGRALS];
#endif
  qt_real distance;
  qt_real c;
  qt_real sine;
#if QT_WITH_STATELESS_LAW
  (void)s; /* this law has no state */
#endif
  states_of(estimate, x);
  set_point(p, x, reference, sp);
  for (int i = 0; i < 12; ++i) {
    error[i] = sp[i] - x[i];
  }
#if QT_WITH_INTEGRALS
  (void)memcpy(whole, error, sizeof whole);
#endif
  qt_sine_and_cosine(x[YAW] - p->x0[YAW], &sine, &c);
  distance = qt_sqrt((error[0] * error[0]) + (error[1] * error[1]));
  if (distance > p->position_error_limit) {
    for (int i = 0; i < 2; ++i) {
      error[i] = error[i] * (p->position_error_limit / distance);
    }
  }
  in_position_axes(p, c, sine, error);
  (void)memcpy(u, p->u0, sizeof p->u0);
  for (int j = 0; j < 12; ++j) {
    for (int i = 0; i < QT_INPUTS; ++i) {
      u[i] += p->K[i][j] * error[j];
    }
  }
#if QT_WITH_INTEGRALS
  /* Integrals are kept in world axes, in which a steady wind is steady. */
  for (int j = 0; j < QT_INTEGRALS; ++j) {
    const bool winds_up = p->conditional_integration && (pushes(p, s, j, whole, c, sine) > 0.0f);
    if (!winds_up) {
      s->integral[j] = step_integral(&p->guard[j], p->dt, s->integral[j], whole[p->integrated[j]]);
    }
    integrals[j] = s->integral[j];
  }
  if (p->heading_axes) {
    qt_real turned[2] = {0.0f, 0.0f};
    for (int axis = 0; axis < 2; ++axis) {
      if (p->of_position[axis] >= 0) {
        turned[axis] = integrals[p->of_position[axis]];
      }
    }
    in_position_axes(p, c, sine, turned);
    for (int axis = 0; axis < 2; ++axis) {
      if (p->of_position[axis] >= 0) {
        integrals[p->of_position[axis]] = turned[axis];
      }
    }
  }
  for (int j = 0; j < QT_INTEGRALS; ++j) {
    for (int i = 0; i < QT_INPUTS; ++i) {
      u[i] += p->K_int[i][j] * integrals[j];
    }
  }
#endif
#if QT_WITH_MEMORY
  for (int j = 0; j < QT_INPUTS; ++j) {
    for (int i = 0; i < QT_INPUTS; ++i) {
      u[i] -= p->K_lag[i][j] * s->actuators[j];
    }
  }
#endif
#if QT_WITH_PAST
  for (int j = 0; j < (QT_PAST * QT_INPUTS); ++j) {
    for (int i = 0; i < QT_INPUTS; ++i) {
      u[i] -= p->K_past[i][j] * s->commands[j];
    }
  }
#endif
}

void qt_law_carried_out(const qt_law_parameters_t *p, qt_law_state_t *s,
                        const qt_real asked[QT_INPUTS], const qt_real made[QT_INPUTS]) {
  if (p->conditional_integration) {
    for (int i = 0; i < QT_INPUTS; ++i) {
      s->excess[i] = qt_is_finite(asked[i]) ? (asked[i] - made[i]) : 0.0f;
    }
  }
#if QT_WITH_MEMORY
  for (int i = 0; i < QT_INPUTS; ++i) {
#if QT_WITH_PAST
    const qt_real arrives = s->commands[((QT_PAST - 1) * QT_INPUTS) + i];
#else
    const qt_real arrives = made[i] - p->u0[i];
#endif
    s->actuators[i] += p->lag_share[i] * (arrives - s->actuators[i]);
  }
#endif
#if QT_WITH_PAST
  for (int j = (QT_PAST * QT_INPUTS) - 1; j >= QT_INPUTS; --j) {
    s->commands[j] = s->commands[j - QT_INPUTS];
  }
  for (int i = 0; i < QT_INPUTS; ++i) {
    s->commands[i] = made[i] - p->u0[i];
  }
#endif
}
