/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Conversion from the wrench (thrust along body -z, torques about body x, y, z) to motor commands.
 *
 *   thrust_i = thrust0_i + P_i (wrench - wrench0)
 *   speed_i  = larger root w of a2 w^2 + a1 w = thrust_i
 *
 * If the rotors cannot produce the wrench: roll and pitch torque are multiplied by the largest
 * factor for which some thrust keeps all rotors within their limits, the thrust is moved into that
 * range, and the yaw torque is multiplied by the largest factor that is then feasible.
 */
#include "internal.h"

static void thrusts_of_wrench(const qt_motors_t *p, const qt_real wrench[4],
                              qt_real thrusts[QT_ROTORS]) {
  qt_real change[4];
  for (int j = 0; j < 4; ++j) {
    change[j] = wrench[j] - p->wrench0[j];
  }
  for (int i = 0; i < QT_ROTORS; ++i) {
    thrusts[i] = p->thrust0[i];
    for (int j = 0; j < 4; ++j) {
      thrusts[i] += p->P[i][j] * change[j];
    }
  }
}

static qt_real speed_for_thrust(qt_real thrust, qt_real a2, qt_real a1) {
  const qt_real t = qt_max(thrust, 0.0f);
  return qt_max((qt_sqrt((a1 * a1) + (4.0f * a2 * t)) - a1) / (2.0f * a2), 0.0f);
}

/* The collective thrust at which rotor i reaches `limit` if it carries the share s of roll and
 * pitch torque. */
static qt_real collective_at(const qt_motors_t *p, int i, qt_real limit, qt_real b, qt_real d,
                             qt_real share) {
  return (limit - b - (share * d)) / p->P[i][0];
}

static bool feasible(const qt_motors_t *p, const qt_real wrench[4]) {
  qt_real thrusts[QT_ROTORS];
  const qt_real slack = 1e-9f * p->wrench0[0]; /* beside rounding */
  bool within = wrench[0] >= p->floor;
  thrusts_of_wrench(p, wrench, thrusts);
  for (int i = 0; i < QT_ROTORS; ++i) {
    within =
        within && (thrusts[i] >= (p->least[i] - slack)) && (thrusts[i] <= (p->greatest[i] + slack));
  }
  return within;
}

/* The feasible wrench nearest to one that the rotors cannot produce. */
static void nearest_wrench(const qt_motors_t *p, const qt_real asked[4], qt_real made[4]) {
  const qt_real x = qt_is_finite(asked[1]) ? asked[1] : 0.0f;
  const qt_real y = qt_is_finite(asked[2]) ? asked[2] : 0.0f;
  const qt_real z = qt_is_finite(asked[3]) ? asked[3] : 0.0f;
  const qt_real collective = qt_is_finite(asked[0]) ? asked[0] : p->wrench0[0];
  qt_real b[QT_ROTORS];
  qt_real d[QT_ROTORS];
  qt_real share = 1.0f;
  qt_real low = p->floor;
  qt_real high = QT_INFINITY;
  qt_real thrust;
  qt_real yaw = 1.0f;
  /* The thrust of rotor i is b + e T + s d, with T the thrust, s the share of roll/pitch torque. */
  for (int i = 0; i < QT_ROTORS; ++i) {
    b[i] = p->thrust0[i];
    for (int j = 0; j < 4; ++j) {
      b[i] -= p->P[i][j] * p->wrench0[j];
    }
    d[i] = (p->P[i][1] * x) + (p->P[i][2] * y);
  }
  for (int i = 0; i < QT_ROTORS; ++i) {
    for (int j = 0; j < QT_ROTORS; ++j) {
      if ((i != j) && (p->P[i][0] > 0.0f) && (p->P[j][0] > 0.0f)) {
        const qt_real room = collective_at(p, j, p->greatest[j], b[j], d[j], 0.0f) -
                             collective_at(p, i, p->least[i], b[i], d[i], 0.0f);
        const qt_real need = (d[j] / p->P[j][0]) - (d[i] / p->P[i][0]);
        if (need > 0.0f) {
          share = qt_min(share, qt_max(room, 0.0f) / need);
        }
      }
    }
  }
  for (int i = 0; i < QT_ROTORS; ++i) {
    if (p->P[i][0] > 0.0f) {
      low = qt_max(low, collective_at(p, i, p->least[i], b[i], d[i], share));
      high = qt_min(high, collective_at(p, i, p->greatest[i], b[i], d[i], share));
    }
  }
  thrust = qt_min(qt_max(collective, low), high);
  for (int i = 0; i < QT_ROTORS; ++i) {
    const qt_real carried = (b[i] + (p->P[i][0] * thrust)) + (share * d[i]);
    const qt_real more = p->P[i][3] * z;
    if (more > 0.0f) {
      yaw = qt_min(yaw, qt_max(p->greatest[i] - carried, 0.0f) / qt_abs(more));
    } else if (more < 0.0f) {
      yaw = qt_min(yaw, qt_max(carried - p->least[i], 0.0f) / qt_abs(more));
    } else {
      /* This rotor does not contribute to the yaw torque. */
    }
  }
  made[0] = thrust;
  made[1] = share * x;
  made[2] = share * y;
  made[3] = yaw * z;
}

/* The feasible wrench nearest to `asked`; `asked` itself if the rotors can produce it.
 * returns: whether it differs */
bool qt_prioritize(const qt_motors_t *p, const qt_real asked[4], qt_real made[4]) {
  const bool limited = !feasible(p, asked);
  if (limited) {
    nearest_wrench(p, asked, made);
  } else {
    (void)memcpy(made, asked, 4u * sizeof asked[0]);
  }
  return limited;
}

void qt_speeds_of_wrench(const qt_motors_t *p, const qt_real wrench[4], qt_real speeds[QT_ROTORS]) {
  thrusts_of_wrench(p, wrench, speeds);
  for (int i = 0; i < QT_ROTORS; ++i) {
    speeds[i] = speed_for_thrust(speeds[i], p->a2[i], p->a1[i]);
  }
}

/* The speed that corresponds to a command without its sign. */
static qt_real speed_of_command(const qt_motors_t *p, qt_real command) {
#if QT_WITH_SQUARED_COMMANDS
  return qt_sqrt(p->gain * command);
#else
  return p->gain * command;
#endif
}

static qt_real command_of_speed(const qt_motors_t *p, qt_real speed) {
#if QT_WITH_SQUARED_COMMANDS
  return (speed * speed) / p->gain;
#else
  return speed / p->gain;
#endif
}

void qt_speeds_of_commands(const qt_motors_t *p, const qt_real commands[QT_ROTORS],
                           qt_real speeds[QT_ROTORS]) {
  for (int i = 0; i < QT_ROTORS; ++i) {
    speeds[i] = speed_of_command(p, qt_max(p->direction[i] * commands[i], 0.0f));
  }
}

void qt_commands_of_speeds(const qt_motors_t *p, qt_real speeds[QT_ROTORS],
                           qt_real commands[QT_ROTORS]) {
  for (int i = 0; i < QT_ROTORS; ++i) {
    qt_real command = command_of_speed(p, speeds[i]);
#if QT_WITH_QUANTUM
    command = qt_nearest(command / p->quantum) * p->quantum;
#endif
    command = qt_clamp(command, p->least_command, p->greatest_command);
    speeds[i] = speed_of_command(p, command);
    commands[i] = p->direction[i] * command;
  }
}
#if !QT_WITH_CASCADE

static void thrusts_of_speeds(const qt_motors_t *p, const qt_real speeds[QT_ROTORS],
                              qt_real thrusts[QT_ROTORS]) {
  for (int i = 0; i < QT_ROTORS; ++i) {
    thrusts[i] = ((p->a2[i] * speeds[i]) + p->a1[i]) * speeds[i];
  }
}

static void wrench_of_thrusts(const qt_motors_t *p, const qt_real thrusts[QT_ROTORS],
                              qt_real wrench[4]) {
  for (int j = 0; j < 4; ++j) {
    wrench[j] = p->wrench0[j];
    for (int i = 0; i < QT_ROTORS; ++i) {
      wrench[j] += p->M[j][i] * (thrusts[i] - p->thrust0[i]);
    }
  }
}

void qt_inputs_of_speeds(const qt_motors_t *p, const qt_real speeds[QT_ROTORS],
                         qt_real inputs[QT_INPUTS]) {
#if QT_WITH_WRENCH_INPUTS
  qt_real thrusts[QT_ROTORS];
  thrusts_of_speeds(p, speeds, thrusts);
  wrench_of_thrusts(p, thrusts, inputs);
#endif
#if QT_WITH_SPEED_INPUTS
  (void)p;
  for (int i = 0; i < QT_ROTORS; ++i) {
    inputs[i] = speeds[i];
  }
#endif
#if QT_WITH_THRUST_INPUTS
  thrusts_of_speeds(p, speeds, inputs);
#endif
#if QT_WITH_COMMAND_INPUTS
  for (int i = 0; i < QT_ROTORS; ++i) {
    inputs[i] = command_of_speed(p, speeds[i]);
  }
#endif
}
#endif
#if QT_WITH_ROTOR_INPUTS

void qt_speeds_of_inputs(const qt_motors_t *p, const qt_real inputs[QT_INPUTS],
                         qt_real speeds[QT_ROTORS]) {
  for (int i = 0; i < QT_ROTORS; ++i) {
#if QT_WITH_SPEED_INPUTS
    (void)p;
    speeds[i] = qt_max(inputs[i], 0.0f);
#endif
#if QT_WITH_THRUST_INPUTS
    speeds[i] = speed_for_thrust(inputs[i], p->a2[i], p->a1[i]);
#endif
#if QT_WITH_COMMAND_INPUTS
    speeds[i] = speed_of_command(p, qt_max(inputs[i], 0.0f));
#endif
  }
}

bool qt_wrench_of_speeds(const qt_motors_t *p, const qt_real speeds[QT_ROTORS], qt_real wrench[4]) {
  qt_real thrusts[QT_ROTORS];
  bool beyond = false;
  thrusts_of_speeds(p, speeds, thrusts);
  wrench_of_thrusts(p, thrusts, wrench);
  for (int i = 0; i < QT_ROTORS; ++i) {
    beyond = beyond || (thrusts[i] < p->least[i]) || (thrusts[i] > p->greatest[i]);
  }
  return beyond;
}
#endif
