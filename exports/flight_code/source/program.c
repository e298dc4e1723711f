/* SPDX-License-Identifier: Apache-2.0 */
/* One control period: estimate, control law, allocation, motor commands. */
#include "internal.h"

void qt_initialize(qt_state_t *state, const qt_start_t *start) {
  (void)memset(state, 0, sizeof *state);
#if QT_WITH_ESTIMATOR
  qt_estimator_initialize(&qt_parameters.estimator, &state->estimator, start);
#else
  (void)start;
#endif
}

/* Sends the commands of phase QT_IDLE. A law with a memory of its commands needs them. */
static void idle(qt_state_t *state, const qt_reference_t *reference, qt_output_t *output) {
  const qt_motors_t *motors = &qt_parameters.motors;
  (void)memcpy(output->command, reference->idle, sizeof output->command);
  qt_speeds_of_commands(motors, output->command, output->speed);
#if QT_WITH_MEMORY
  {
    qt_real told[QT_INPUTS];
    qt_inputs_of_speeds(motors, output->speed, told);
    qt_law_carried_out(&qt_parameters.law, &state->law, told, told);
  }
#else
  (void)state;
#endif
}

/* The law controls the motors. */
static void fly(qt_state_t *state, const qt_estimate_t *estimate, const qt_reference_t *reference,
                qt_output_t *output) {
  const qt_motors_t *motors = &qt_parameters.motors;
#if QT_WITH_CASCADE
  qt_real made[4];
  qt_law_step(&qt_parameters.law, &state->law, estimate, reference, output->wrench);
  output->limited = qt_prioritize(motors, output->wrench, made);
  qt_speeds_of_wrench(motors, made, output->speed);
  qt_commands_of_speeds(motors, output->speed, output->command);
  qt_law_carried_out(&qt_parameters.law, &state->law, output->wrench, made);
#else
  qt_real asked[QT_INPUTS];
  qt_real made[QT_INPUTS];
  qt_real wrench[4];
#if QT_WITH_WRENCH_INPUTS
  qt_law_step(&qt_parameters.law, &state->law, estimate, reference, asked);
  (void)memcpy(output->wrench, asked, sizeof output->wrench);
  output->limited = qt_prioritize(motors, asked, wrench);
  qt_speeds_of_wrench(motors, wrench, output->speed);
#else
  bool beyond;
  qt_law_step(&qt_parameters.law, &state->law, estimate, reference, asked);
  qt_speeds_of_inputs(motors, asked, output->speed);
  beyond = qt_wrench_of_speeds(motors, output->speed, output->wrench);
  output->limited = qt_prioritize(motors, output->wrench, wrench) || beyond;
  if (output->limited) {
    qt_speeds_of_wrench(motors, wrench, output->speed);
  }
#endif
  qt_commands_of_speeds(motors, output->speed, output->command);
  if (output->limited) {
    qt_inputs_of_speeds(motors, output->speed, made);
  } else {
    (void)memcpy(made, asked, sizeof made);
  }
  qt_law_carried_out(&qt_parameters.law, &state->law, asked, made);
#endif
}

static bool states_are_finite(const qt_estimate_t *e) {
  return qt_all_finite(e->position) && qt_is_finite(e->roll) && qt_is_finite(e->pitch) &&
         qt_is_finite(e->yaw) && qt_all_finite(e->velocity) && qt_all_finite(e->rates);
}

void qt_control(qt_state_t *state, const qt_estimate_t *estimate, const qt_reference_t *reference,
                qt_output_t *output) {
  qt_estimate_t used; /* a copy: `estimate` may be that in `output` */
  used = *estimate;
  used.finite = used.finite && states_are_finite(estimate);
  (void)memset(output, 0, sizeof *output);
  output->estimate = used;
  if (used.finite) {
    if (reference->phase == QT_IDLE) {
      idle(state, reference, output);
    } else {
      fly(state, &used, reference, output);
    }
  }
#if QT_WITH_UQUAD
  (void)memcpy(state->estimator.speeds, output->speed, sizeof state->estimator.speeds);
#endif
}
#if QT_WITH_ESTIMATOR

void qt_estimate(qt_state_t *state, const qt_sensors_t *sensors, qt_estimate_t *estimate) {
  qt_estimator_step(&qt_parameters.estimator, &state->estimator, sensors, estimate);
  estimate->finite = states_are_finite(estimate);
}

void qt_step(qt_state_t *state, const qt_sensors_t *sensors, const qt_reference_t *reference,
             qt_output_t *output) {
  qt_estimate_t estimate;
  qt_estimate(state, sensors, &estimate);
  qt_control(state, &estimate, reference, output);
}
#endif

void qt_terminate(qt_state_t *state, qt_output_t *output) {
  (void)memset(state, 0, sizeof *state);
  (void)memset(output, 0, sizeof *output);
}
