/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The control law as an out-of-tree controller of the Crazyflie firmware (written for 2026.08;
 * older releases need a power distribution that supports controlModeForce). The states are those of
 * the firmware's own estimator; the thrusts of the four rotors are passed to its power distribution
 * as fractions of THRUST_MAX, in the order of its motors.
 *
 * Axes: the firmware's x is forward, y left, z up; the law's are forward, right, down. Its angles
 * and rates are in degrees; the attitude is computed from the quaternion, because the firmware's
 * `attitude.pitch` has the sign of an older convention. The `attitude.pitch` of a set point has
 * that sign as well: positive with the nose up.
 *
 * A set point may contain positions, or velocities, or roll and pitch angles with a height or a
 * climb rate; and a heading or its rate. An axis without a set point holds its last value. Rates of
 * roll and pitch are ignored. If a pilot gives thrust instead of a height, half of it holds the
 * height, more climbs and less descends, by at most 0.5 m/s; it does not start a flight. A thrust
 * of 0 without a height stops the motors, also in the air, and resets the law.
 */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "FreeRTOS.h"
#include "app.h"
#include "controller.h"
#include "internal.h"
#include "platform_defaults.h"
#include "stabilizer_types.h"
#include "task.h"

/* The firmware calls the controller every millisecond. */
#define STEPS QT_STEPS_PER_PERIOD
/* Periods for which the last commands are kept while the estimate is not finite: 0.1 s. */
#define BRIDGED (100u / STEPS)
/* Maximum distance between a moving reference and the vehicle. */
#define POSITION_LEASH 1.0f /* [m] */
#define YAW_LEASH 1.0f      /* [rad] */
#define PILOT_CLIMB 0.5f    /* [m/s] */

/* Rotor of the law for the motors M1 front right, M2 back right, M3 back left, M4 front left. */
static const int rotor_of_motor[4] = {QT_ROTORS_OF_MOTORS};

static qt_state_t law;
static qt_estimate_t estimate;
static qt_reference_t reference;
static qt_output_t output;
static bool flying;
static uint32_t bad_periods;
static stab_mode_t last_mode[4]; /* of x, y, z and yaw */

static qt_real radians(qt_real degrees) { return degrees * (QT_PI / 180.0f); }

/* `angle` plus the whole turns that bring it nearest to `to`. */
static qt_real near_to(qt_real angle, qt_real to) {
  return angle + ((2.0f * QT_PI) * qt_nearest((to - angle) / (2.0f * QT_PI)));
}

/* The heading of a quaternion of the firmware, with the sign of the law. */
static qt_real heading_of(const quaternion_t *q) {
  return -atan2f(2.0f * ((q->w * q->z) + (q->x * q->y)),
                 1.0f - (2.0f * ((q->y * q->y) + (q->z * q->z))));
}

static bool all_finite(const qt_estimate_t *e) {
  return qt_all_finite(e->position) && qt_all_finite(e->velocity) && qt_all_finite(e->rates) &&
         qt_is_finite(e->roll) && qt_is_finite(e->pitch) && qt_is_finite(e->yaw);
}

/* Returns whether the estimate is finite; otherwise `estimate` is not changed. */
static bool read_estimate(const state_t *from, const sensorData_t *sensors) {
  /* y and z change their signs, also in the vector part of the quaternion. */
  const qt_real w = from->attitudeQuaternion.w;
  const qt_real x = from->attitudeQuaternion.x;
  const qt_real y = -from->attitudeQuaternion.y;
  const qt_real z = -from->attitudeQuaternion.z;
  const qt_real R[9] = {1.0f - (2.0f * ((y * y) + (z * z))), 2.0f * ((x * y) - (w * z)),
                        2.0f * ((x * z) + (w * y)),          2.0f * ((x * y) + (w * z)),
                        1.0f - (2.0f * ((x * x) + (z * z))), 2.0f * ((y * z) - (w * x)),
                        2.0f * ((x * z) - (w * y)),          2.0f * ((y * z) + (w * x)),
                        1.0f - (2.0f * ((x * x) + (y * y)))};
  const qt_real velocity[3] = {from->velocity.x, -from->velocity.y, -from->velocity.z};
  qt_estimate_t next;
  bool finite;
  (void)memset(&next, 0, sizeof next);
  next.position[0] = from->position.x;
  next.position[1] = -from->position.y;
  next.position[2] = -from->position.z;
  next.roll = atan2f(R[7], R[8]);
  next.pitch = -asinf(qt_clamp(R[6], -1.0f, 1.0f));
  next.yaw = near_to(atan2f(R[3], R[0]), estimate.yaw);
  for (int i = 0; i < 3; ++i) { /* the transpose takes world axes to body axes */
    next.velocity[i] = (R[i] * velocity[0]) + (R[3 + i] * velocity[1]) + (R[6 + i] * velocity[2]);
  }
  next.rates[0] = radians(sensors->gyro.x);
  next.rates[1] = -radians(sensors->gyro.y);
  next.rates[2] = -radians(sensors->gyro.z);
  next.finite = true;
  finite = qt_is_finite(w + x + y + z) && all_finite(&next);
  if (finite) {
    estimate = next;
  }
  return finite;
}

static void hold_here(void) {
  (void)memcpy(reference.position, estimate.position, sizeof reference.position);
  reference.yaw = estimate.yaw;
  for (int i = 0; i < 4; ++i) {
    last_mode[i] = modeDisable;
  }
}

/* One axis of the position: as commanded, or advanced by the commanded velocity. */
static void follow(stab_mode_t mode, qt_real position, qt_real velocity, int axis) {
  qt_real *to = &reference.position[axis];
  const qt_real here = estimate.position[axis];
  if (mode != last_mode[axis]) {
    *to = here; /* discards an older target */
  }
  last_mode[axis] = mode;
  reference.velocity[axis] = 0.0f;
  if ((mode == modeAbs) && qt_is_finite(position)) {
    *to = position;
    reference.velocity[axis] = qt_is_finite(velocity) ? velocity : 0.0f;
  } else if ((mode == modeVelocity) && qt_is_finite(velocity)) {
    *to = qt_clamp(*to + (velocity * QT_DT), here - POSITION_LEASH, here + POSITION_LEASH);
    reference.velocity[axis] = velocity;
  } else {
    /* The axis holds its last value. */
  }
}

static void turn(const setpoint_t *from) {
  const bool by_quaternion = from->mode.quat == modeAbs;
  const stab_mode_t mode = by_quaternion ? modeAbs : from->mode.yaw;
  const qt_real yaw =
      by_quaternion ? heading_of(&from->attitudeQuaternion) : -radians(from->attitude.yaw);
  const qt_real rate = -radians(from->attitudeRate.yaw);
  if (mode != last_mode[3]) {
    reference.yaw = estimate.yaw;
  }
  last_mode[3] = mode;
  if ((mode == modeAbs) && qt_is_finite(yaw)) {
    reference.yaw = near_to(yaw, estimate.yaw);
  } else if ((mode == modeVelocity) && qt_is_finite(rate)) {
    reference.yaw = qt_clamp(reference.yaw + (rate * QT_DT), estimate.yaw - YAW_LEASH,
                             estimate.yaw + YAW_LEASH);
  } else {
    /* The heading holds its last value. */
  }
}

static void read_reference(const setpoint_t *from) {
  qt_real vx = from->velocity.x;
  qt_real vy = -from->velocity.y;
  stab_mode_t height_mode = from->mode.z;
  qt_real climb = from->velocity.z;
  if (from->velocity_body) { /* along the heading and to its left */
    const qt_real c = cosf(estimate.yaw);
    const qt_real s = sinf(estimate.yaw);
    vx = (c * from->velocity.x) + (s * from->velocity.y);
    vy = (s * from->velocity.x) - (c * from->velocity.y);
  }
  if (height_mode == modeDisable) {
    height_mode = modeVelocity;
    climb = PILOT_CLIMB * qt_clamp((from->thrust - 32767.5f) / 32767.5f, -1.0f, 1.0f);
  }
  reference.phase = QT_FLYING;
  reference.track_position = (from->mode.x != modeDisable) && (from->mode.y != modeDisable);
  follow(from->mode.x, from->position.x, vx, 0);
  follow(from->mode.y, -from->position.y, vy, 1);
  follow(height_mode, -from->position.z, -climb, 2);
  reference.roll = (from->mode.roll == modeAbs) ? radians(from->attitude.roll) : 0.0f;
  reference.pitch = (from->mode.pitch == modeAbs) ? radians(from->attitude.pitch) : 0.0f;
  if (!qt_is_finite(reference.roll) || !qt_is_finite(reference.pitch)) {
    reference.roll = 0.0f;
    reference.pitch = 0.0f;
  }
  turn(from);
}

/* More than THRUST_MAX is left to the firmware, which then reduces all motors equally. */
static void send(control_t *control) {
  const qt_motors_t *motors = &qt_parameters.motors;
  control->controlMode = controlModeForce;
  for (int m = 0; m < 4; ++m) {
    const int i = rotor_of_motor[m];
    const qt_real w = output.speed[i];
    const qt_real thrust = ((motors->a2[i] * w) + motors->a1[i]) * w;
    control->normalizedForces[m] = qt_max(thrust / THRUST_MAX, 0.0f);
  }
}

static void stop(void) {
  controllerOutOfTreeInit();
  qt_terminate(&law, &output);
}

static void fly(const setpoint_t *setpoint, const sensorData_t *sensors, const state_t *state) {
  if (read_estimate(state, sensors)) {
    bad_periods = 0u;
    if (!flying) {
      hold_here();
      flying = true;
    }
    read_reference(setpoint);
    qt_control(&law, &estimate, &reference, &output);
  } else if (bad_periods < BRIDGED) {
    ++bad_periods; /* the last commands once more */
  } else {
    stop();
  }
}

void controllerOutOfTreeInit(void) {
  qt_start_t start;
  (void)memset(&start, 0, sizeof start);
  qt_initialize(&law, &start);
  (void)memset(&estimate, 0, sizeof estimate);
  (void)memset(&reference, 0, sizeof reference);
  (void)memset(&output, 0, sizeof output);
  flying = false;
  bad_periods = 0u;
}

bool controllerOutOfTreeTest(void) { return true; }

void controllerOutOfTree(control_t *control, const setpoint_t *setpoint,
                         const sensorData_t *sensors, const state_t *state,
                         const stabilizerStep_t stabilizerStep) {
  if ((stabilizerStep % STEPS) == 0u) { /* otherwise `control` keeps what it has */
    const bool by_pilot = setpoint->mode.z == modeDisable;
    const bool off = by_pilot && (!flying || !(setpoint->thrust > 0.0f));
    if (off) {
      stop();
    } else {
      fly(setpoint, sensors, state);
    }
    send(control);
  }
}

void appMain(void) {
  while (true) {
    vTaskDelay(M2T(1000));
  }
}
