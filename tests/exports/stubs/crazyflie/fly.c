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

static control_t control;
static state_t state;
static sensorData_t sensors;
static uint32_t step_now;

/* Mean of the forces in `periods` control periods of 4 ms; `of_roll` and `of_pitch`: left less
 * right, and front less back. */
static float fly_on(const setpoint_t *sp, int periods, float *of_roll, float *of_pitch) {
  for (int i = 0; i < 4 * periods; ++i)
    controllerOutOfTree(&control, sp, &sensors, &state, step_now++);
  const float *f = control.normalizedForces; /* M1 FR, M2 BR, M3 BL, M4 FL */
  *of_roll = (f[2] + f[3]) - (f[0] + f[1]);
  *of_pitch = (f[0] + f[3]) - (f[1] + f[2]);
  return (f[0] + f[1] + f[2] + f[3]) / 4;
}

#define REQUIRE(condition)                           \
  do {                                               \
    if (!(condition)) {                              \
      printf("line %d: " #condition "\n", __LINE__); \
      return 1;                                      \
    }                                                \
  } while (0)

/* A vehicle that is held at 1 m, level, whatever the motors do. */
static int in_other_modes(unsigned periods) {
  float roll, pitch;
  setpoint_t sp;
  memset(&sp, 0, sizeof sp);
  memset(&state, 0, sizeof state);
  memset(&sensors, 0, sizeof sensors);
  state.attitudeQuaternion.w = 1;
  state.position.z = 1;
  step_now = 0;
  REQUIRE(fly_on(&sp, 1, &roll, &pitch) == 0); /* no height and no thrust */
  sp.thrust = 40000;
  REQUIRE(fly_on(&sp, 5, &roll, &pitch) == 0); /* thrust of a pilot starts no flight */
  sp.thrust = 0;
  sp.mode.z = sp.mode.yaw = modeAbs;
  sp.position.z = 1;
  const float hover = fly_on(&sp, 50, &roll, &pitch);
  REQUIRE(hover > 0.3f && hover < 0.9f && fabsf(roll) < 0.01f && fabsf(pitch) < 0.01f);
  /* Roll to the right lifts the left side; a positive pitch of the firmware lifts the nose. */
  sp.mode.roll = sp.mode.pitch = modeAbs;
  sp.attitude.roll = 5;
  (void)fly_on(&sp, 1, &roll, &pitch);
  REQUIRE(roll > 0.01f && fabsf(pitch) < 0.005f);
  sp.attitude.roll = 0;
  sp.attitude.pitch = 5;
  (void)fly_on(&sp, 20, &roll, &pitch);
  REQUIRE(pitch > 0.01f);
  sp.attitude.pitch = 0;
  sp.mode.roll = sp.mode.pitch = modeDisable;
  (void)fly_on(&sp, 50, &roll, &pitch);
  /* A goal 5 m above is forgotten once a climb rate of 0 is asked for. */
  sp.position.z = 6;
  REQUIRE(fly_on(&sp, 1, &roll, &pitch) > hover + 0.02f);
  sp.mode.z = modeVelocity;
  (void)fly_on(&sp, 100, &roll, &pitch);
  REQUIRE(fabsf(fly_on(&sp, 1, &roll, &pitch) - hover) < 0.1f);
  /* Forward velocity needs the nose down, to the left the left side down. */
  sp.mode.x = sp.mode.y = modeVelocity;
  sp.velocity.x = 0.5f;
  (void)fly_on(&sp, 5, &roll, &pitch);
  REQUIRE(pitch < -0.002f);
  sp.velocity.x = 0;
  sp.velocity.y = 0.5f;
  (void)fly_on(&sp, 5, &roll, &pitch);
  REQUIRE(roll < -0.002f);
  sp.velocity.y = 0;
  /* Held fast, its reference does not run away: the forces do not grow with time. */
  sp.velocity.z = -0.3f;
  (void)fly_on(&sp, 1500, &roll, &pitch);
  sp.velocity.z = 0;
  sp.mode.z = modeAbs;
  sp.position.z = 1;
  (void)fly_on(&sp, 2, &roll, &pitch);
  REQUIRE(isfinite(fly_on(&sp, 1, &roll, &pitch)));
  /* One estimate that is not finite is bridged; half a second of them is not; it recovers. */
  controllerOutOfTreeInit();
  (void)fly_on(&sp, 10, &roll, &pitch);
  const float before = fly_on(&sp, 1, &roll, &pitch);
  state.attitudeQuaternion.z = NAN;
  REQUIRE(fly_on(&sp, 1, &roll, &pitch) == before);
  state.attitudeQuaternion.z = 0;
  REQUIRE(fabsf(fly_on(&sp, 1, &roll, &pitch) - before) < 0.02f);
  state.position.z = NAN;
  REQUIRE(fly_on(&sp, 125, &roll, &pitch) == 0);
  state.position.z = 1;
  REQUIRE(fly_on(&sp, 5, &roll, &pitch) > 0.3f);
  /* A pilot's thrust in flight: half of it holds the height, none of it stops. */
  sp.mode.z = modeDisable;
  sp.thrust = 32768;
  REQUIRE(fabsf(fly_on(&sp, 20, &roll, &pitch) - hover) < 0.1f);
  sp.thrust = 0;
  REQUIRE(fly_on(&sp, 1, &roll, &pitch) == 0);
  printf("%u periods as the law\n", periods);
  return 0;
}

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
      if (!(fabs(control.normalizedForces[m] - expected[kRotor[m]]) <= worst))
        worst = fabs(control.normalizedForces[m] - expected[kRotor[m]]);
    ++periods;
  }
  if (!(periods > 100 && worst < 1e-3)) return printf("forces apart by %.2e\n", worst), 1;
  return in_other_modes(periods);
}
