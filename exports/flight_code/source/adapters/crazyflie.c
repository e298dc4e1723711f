/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The control law as an out-of-tree controller of the Crazyflie firmware (written for 2026.08).
 * The firmware's own estimator gives the states; the thrusts of the four rotors go to its power
 * distribution as fractions of THRUST_MAX, in the order of its motors.
 *
 * Axes: the firmware's x is forward, y left, z up; the law's are forward, right, down. Its angles
 * and rates are in degrees; the attitude is taken from the quaternion, because the firmware's
 * `attitude.pitch` has the sign of an older convention. In a set point, `attitude.pitch` has that
 * sign as well: positive with the nose up.
 *
 * A set point may ask for positions or horizontal velocities with a height or a climb rate, or for
 * roll and pitch angles with these, and for a heading or its rate. Rates of roll and pitch, and
 * thrusts from a pilot, are not flown: the vehicle stays level and keeps its height. A thrust of 0
 * without a height stops the motors and resets the law.
 *
 * Forces beyond THRUST_MAX are cut: the vehicle's file should not give its motors more, because the
 * law shares out what they have.
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

/* The firmware calls the controller every millisecond; the law acts in every @STEPS@ calls. */
#define STEPS QT_STEPS_PER_PERIOD

/* Rotor of the law for the motors M1 front right, M2 back right, M3 back left, M4 front left. */
static const int rotor_of_motor[4] = {QT_ROTORS_OF_MOTORS};

static qt_state_t law;
static qt_estimate_t estimate;
static qt_reference_t reference;
static qt_output_t output;
static bool flying;

static qt_real radians(qt_real degrees) { return degrees * (QT_PI / 180.0f); }

/* `angle` plus the whole turns that bring it nearest to `to`. */
static qt_real near_to(qt_real angle, qt_real to) {
  return angle + ((2.0f * QT_PI) * qt_nearest((to - angle) / (2.0f * QT_PI)));
}

static void read_estimate(const state_t *from, const sensorData_t *sensors) {
  /* y and z change their signs, of the vector part of the quaternion as well. */
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
  estimate.position[0] = from->position.x;
  estimate.position[1] = -from->position.y;
  estimate.position[2] = -from->position.z;
  estimate.roll = atan2f(R[7], R[8]);
  estimate.pitch = -asinf(qt_clamp(R[6], -1.0f, 1.0f));
  estimate.yaw = near_to(atan2f(R[3], R[0]), estimate.yaw);
  for (int i = 0; i < 3; ++i) { /* the transpose takes world axes to body axes */
    estimate.velocity[i] =
        (R[i] * velocity[0]) + (R[3 + i] * velocity[1]) + (R[6 + i] * velocity[2]);
  }
  estimate.rates[0] = radians(sensors->gyro.x);
  estimate.rates[1] = -radians(sensors->gyro.y);
  estimate.rates[2] = -radians(sensors->gyro.z);
  estimate.finite = true;
}

static void hold(void) {
  (void)memcpy(reference.position, estimate.position, sizeof reference.position);
  reference.yaw = estimate.yaw;
}

/* The value of one axis: asked for, or moved on by the velocity that is asked for. */
static void follow(stab_mode_t mode, qt_real position, qt_real velocity, int axis) {
  reference.velocity[axis] = 0.0f;
  if (mode == modeAbs) {
    reference.position[axis] = position;
  } else if (mode == modeVelocity) {
    reference.position[axis] += velocity * QT_DT;
    reference.velocity[axis] = velocity;
  } else {
    /* The axis keeps its reference. */
  }
}

static void read_reference(const setpoint_t *from) {
  const bool tracked = (from->mode.x != modeDisable) && (from->mode.y != modeDisable);
  qt_real vx = from->velocity.x;
  qt_real vy = -from->velocity.y;
  if (from->velocity_body) { /* along the heading and to its left */
    const qt_real c = cosf(estimate.yaw);
    const qt_real s = sinf(estimate.yaw);
    vx = (c * from->velocity.x) + (s * from->velocity.y);
    vy = (s * from->velocity.x) - (c * from->velocity.y);
  }
  if (tracked && !reference.track_position) { /* from where it is now */
    reference.position[0] = estimate.position[0];
    reference.position[1] = estimate.position[1];
  }
  reference.phase = QT_FLYING;
  reference.track_position = tracked;
  follow(from->mode.x, from->position.x, vx, 0);
  follow(from->mode.y, -from->position.y, vy, 1);
  follow(from->mode.z, -from->position.z, -from->velocity.z, 2);
  reference.roll = (from->mode.roll == modeAbs) ? radians(from->attitude.roll) : 0.0f;
  reference.pitch = (from->mode.pitch == modeAbs) ? radians(from->attitude.pitch) : 0.0f;
  if (from->mode.yaw == modeAbs) {
    reference.yaw = near_to(-radians(from->attitude.yaw), estimate.yaw);
  } else if (from->mode.yaw == modeVelocity) {
    reference.yaw -= radians(from->attitudeRate.yaw) * QT_DT;
  } else {
    /* The heading keeps its reference. */
  }
}

static void send(control_t *control) {
  const qt_motors_t *motors = &qt_parameters.motors;
  control->controlMode = controlModeForce;
  for (int m = 0; m < 4; ++m) {
    const int i = rotor_of_motor[m];
    const qt_real w = output.speed[i];
    const qt_real thrust = ((motors->a2[i] * w) + motors->a1[i]) * w;
    control->normalizedForces[m] = qt_clamp(thrust / THRUST_MAX, 0.0f, 1.0f);
  }
}

void controllerOutOfTreeInit(void) {
  qt_start_t start;
  (void)memset(&start, 0, sizeof start);
  qt_initialize(&law, &start);
  (void)memset(&estimate, 0, sizeof estimate);
  (void)memset(&reference, 0, sizeof reference);
  flying = false;
}

bool controllerOutOfTreeTest(void) { return true; }

void controllerOutOfTree(control_t *control, const setpoint_t *setpoint,
                         const sensorData_t *sensors, const state_t *state,
                         const stabilizerStep_t stabilizerStep) {
  if ((stabilizerStep % STEPS) == 0u) { /* otherwise `control` keeps what it has */
    const bool off = (setpoint->mode.z == modeDisable) && !(setpoint->thrust > 0.0f);
    if (off) {
      controllerOutOfTreeInit();
      qt_terminate(&law, &output);
    } else {
      read_estimate(state, sensors);
      if (!flying) {
        hold();
        flying = true;
      }
      read_reference(setpoint);
      qt_control(&law, &estimate, &reference, &output);
    }
    send(control);
  }
}

void appMain(void) {
  while (true) {
    vTaskDelay(M2T(1000));
  }
}
