/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The cascade of PID loops: position to attitude, attitude and heading to torques, height to
 * thrust.
 *
 *   roll_ref  = PID_y(error across the heading),   pitch_ref = PID_x(error along the heading)
 *   tau       = PID(angle_ref - angle; rate),       T = weight - PID_z(height error)
 *   PID       = Kp e + I - Kd rate,                 I[k] = I[k-1] + Ki dt (a e[k] + b e[k-1])
 *
 * with (a, b) = (0, 1) forward Euler, (1, 0) backward Euler, (1/2, 1/2) Tustin. An integral does
 * not grow in a direction in which the motors produced less than requested.
 */
#include "internal.h"

typedef struct {
  qt_real value;     /* within the loop's limits */
  qt_real unlimited; /* what it would be without them */
  bool finite;       /* false: an input was not; the value is the last one */
} loop_output_t;

static loop_output_t step_loop(const qt_loop_t *p, qt_loop_state_t *s, qt_real set_point,
                               qt_real measurement, qt_real rate, qt_real excess) {
  const qt_real error = set_point - measurement;
  const qt_real increment = p->Ki * p->dt * ((p->error_now * error) + (p->error_before * s->error));
  qt_real integral = ((excess * increment) > 0.0f) ? s->integral : (s->integral + increment);
#if QT_WITH_RATE_LEAD
  /* Kd acts on rate + lead, and s->rate is the low pass of the rate. */
  const qt_real ahead = rate - s->rate;
  const qt_real derivative = -p->Kd * (rate + (p->rate_lead * ahead));
#else
  const qt_real derivative = -p->Kd * rate;
#endif
  const qt_real proportional = p->Kp * ((p->set_point_weight * set_point) - measurement);
  loop_output_t result;
  qt_real output;
  integral = qt_clamp(integral, p->integral_min, p->integral_max);
  result.unlimited = proportional + integral + derivative;
  output = qt_clamp(result.unlimited, p->output_min, p->output_max);
  /* A NaN in the state would persist. */
  result.finite = qt_is_finite((result.unlimited + error) - measurement);
  if (result.finite) {
    s->integral = integral + (p->dt * p->back_calculation * (output - result.unlimited));
    s->error = error;
    s->output = output;
#if QT_WITH_RATE_LEAD
    s->rate += p->rate_share * ahead;
#endif
  }
  result.value = s->output;
  return result;
}

void qt_law_step(const qt_law_parameters_t *p, qt_law_state_t *s, const qt_estimate_t *x,
                 const qt_reference_t *reference, qt_real wrench[4]) {
  const bool takes_off = reference->phase == QT_TAKE_OFF;
  qt_real roll = reference->roll;
  qt_real pitch = reference->pitch;
  qt_real R[9];
  qt_real velocity[3];
  qt_rotation_of_euler(x->roll, x->pitch, x->yaw, R);
  qt_times3(R, x->velocity, velocity);
  if (p->velocity_feed_forward) {
    for (int i = 0; i < 3; ++i) {
      velocity[i] -= reference->velocity[i];
    }
  }
  if (reference->track_position && (!takes_off)) {
    /* Errors and velocities along and across the heading. */
    qt_real c;
    qt_real s_yaw;
    const qt_real north = reference->position[0] - x->position[0];
    const qt_real east = reference->position[1] - x->position[1];
    loop_output_t along;
    loop_output_t across;
    qt_sine_and_cosine(x->yaw, &s_yaw, &c);
    along = step_loop(&p->x, &s->x, (c * north) + (s_yaw * east), 0.0f,
                      (c * velocity[0]) + (s_yaw * velocity[1]), s->attitude_excess[0]);
    across = step_loop(&p->y, &s->y, (c * east) - (s_yaw * north), 0.0f,
                       (c * velocity[1]) - (s_yaw * velocity[0]), s->attitude_excess[1]);
    pitch = along.value;
    roll = across.value;
    if (p->conditional_integration) {
      s->attitude_excess[0] = along.finite ? (along.unlimited - along.value) : 0.0f;
      s->attitude_excess[1] = across.finite ? (across.unlimited - across.value) : 0.0f;
    }
  }
  roll = qt_clamp(roll, -p->attitude_limit, p->attitude_limit);
  pitch = qt_clamp(pitch, -p->attitude_limit, p->attitude_limit);
  wrench[1] = step_loop(&p->roll, &s->roll, roll, x->roll, x->rates[0], s->wrench_excess[1]).value;
  wrench[2] =
      step_loop(&p->pitch, &s->pitch, pitch, x->pitch, x->rates[1], s->wrench_excess[2]).value;
  wrench[3] =
      step_loop(&p->yaw, &s->yaw, reference->yaw, x->yaw, x->rates[2], s->wrench_excess[3]).value;
  if (takes_off) {
    wrench[0] = p->take_off_thrust;
  } else {
    /* The loop commands a downward force, in addition to the weight. */
    const qt_real down = step_loop(&p->altitude, &s->altitude, reference->position[2],
                                   x->position[2], velocity[2], -s->wrench_excess[0])
                             .value;
    wrench[0] = qt_clamp(p->weight - down, 0.0f, p->greatest_thrust);
  }
}

void qt_law_carried_out(const qt_law_parameters_t *p, qt_law_state_t *s, const qt_real asked[4],
                        const qt_real made[4]) {
  if (p->conditional_integration) {
    for (int i = 0; i < 4; ++i) {
      s->wrench_excess[i] = qt_is_finite(asked[i]) ? (asked[i] - made[i]) : 0.0f;
    }
  }
}
