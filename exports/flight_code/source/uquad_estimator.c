/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The uquad's filter, called once per control period: an extended Kalman filter whose model is the
 * vehicle itself.
 *
 * States x (15): position (world), roll, pitch, yaw, velocity (body), rates (body), and the biases
 * of the accelerometer (body).
 *
 * - Prediction by the equations of motion f at the rotor speeds of the last commands:
 *   x = x + T f(x), P = F P F' + Q, F = I + T df/dx.
 * - Correction by one scalar after the other, y = C x + v with v of variance R: K = P C'/S with
 *   S = C P C' + R, x = x + K (y - C x), P = (I - K C) P (I - K C)' + K R K'.
 *
 * Measurements: roll, pitch and yaw from accelerometer and magnetometer, the specific force, the
 * rates, the height from the barometer, and, if available, GPS and positions from images.
 */
#include "internal.h"

/* First indices of the parts of x; the position is first. */
#define AT_HEIGHT 2 /* of the position */
#define AT_ATTITUDE 3
#define AT_VELOCITY 6
#define AT_RATES 9
#define AT_BIAS 12
#define MAX_VISION_AGE 1.0f /* an older image is not used [s] */
#define MOST_ENTRIES 6      /* of a row C that are not 0 */

/* Force and torque of the rotors on the body, in body axes. */
typedef struct {
  qt_real force[3];         /* [N] */
  qt_real torque[3];        /* about the centre of mass [N m] */
  qt_real angular_momentum; /* of the turning parts, about body z [kg m^2/s] */
} loads_t;

/* The nonzero blocks of df/dx, named by rows and columns. */
typedef struct {
  qt_real position_attitude[9];
  qt_real position_velocity[9]; /* R, from body axes to world axes */
  qt_real attitude_attitude[9];
  qt_real attitude_rates[9];
  qt_real velocity_attitude[9];
  qt_real velocity_velocity[9];
  qt_real velocity_rates[9];
  qt_real rates_rates[9];
} jacobian_t;

/* A row C: its nonzero entries. */
typedef struct {
  int count;
  int column[MOST_ENTRIES];
  qt_real value[MOST_ENTRIES];
} row_t;

/* The sensor samples of a period as used by the filter, and which of them are fresh. */
typedef struct {
  qt_real yaw;        /* in any turn [rad] */
  qt_real rates[3];   /* [rad/s] */
  qt_real height;     /* above z = 0 [m] */
  qt_real vision[3];  /* world, brought to now [m] */
  qt_real tilt_doubt; /* factor of the variance of roll and pitch */
  qt_real yaw_doubt;  /* of the yaw */
  bool force_fresh;
  bool rates_fresh;
  bool tilt_fresh;
  bool yaw_fresh;
  bool height_fresh;
  bool vision_fresh;
} measured_t;

/* ---- model ---- */

/* The sum over the rotors: thrust along body -z at each hub, drag torque against its spin. */
static void rotor_loads(const qt_estimator_parameters_t *p, const qt_real speeds[QT_ROTORS],
                        loads_t *loads) {
  (void)memset(loads, 0, sizeof *loads);
  for (int i = 0; i < QT_ROTORS; ++i) {
    const qt_real w = speeds[i];
    const qt_real thrust = ((p->thrust_a2[i] * w) * w) + (p->thrust_a1[i] * w);
    const qt_real torque = ((p->torque_d2[i] * w) * w) + (p->torque_d1[i] * w);
    loads->force[2] -= thrust;
    loads->torque[0] -= p->rotor_y[i] * thrust;
    loads->torque[1] += p->rotor_x[i] * thrust;
    loads->torque[2] -= p->spin[i] * torque;
    loads->angular_momentum += p->spin_inertia[i] * w;
  }
}

/* Drag of the air along body axis i: F = -(drag/2 |v| + linear) v */
static qt_real drag_force(const qt_estimator_parameters_t *p, int i, qt_real v) {
  return -(((0.5f * p->drag[i]) * qt_abs(v)) + p->linear_drag[i]) * v;
}

/* dF/dv = -(drag |v| + linear) */
static qt_real drag_slope(const qt_estimator_parameters_t *p, int i, qt_real v) {
  return -((p->drag[i] * qt_abs(v)) + p->linear_drag[i]);
}

/* M = [a]x, with M b = a x b. */
static void cross_matrix(const qt_real a[3], qt_real M[9]) {
  M[0] = 0.0f;
  M[1] = -a[2];
  M[2] = a[1];
  M[3] = a[2];
  M[4] = 0.0f;
  M[5] = -a[0];
  M[6] = -a[1];
  M[7] = a[0];
  M[8] = 0.0f;
}

/* C = A B */
static void product3(const qt_real A[9], const qt_real B[9], qt_real C[9]) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      C[(3 * i) + j] =
          (A[3 * i] * B[j]) + ((A[(3 * i) + 1] * B[3 + j]) + (A[(3 * i) + 2] * B[6 + j]));
    }
  }
}

/* f(x), the time derivative of the 12 states. */
static void motion(const qt_estimator_parameters_t *p, const qt_real x[QT_STATES],
                   const loads_t *loads, qt_real f[AT_BIAS]) {
  const qt_real *v = &x[AT_VELOCITY];
  const qt_real *w = &x[AT_RATES];
  qt_real R[9];
  qt_real E[9]; /* from body rates to rates of roll, pitch and yaw */
  qt_real sr;
  qt_real cr;
  qt_real sp;
  qt_real cp;
  qt_real free_fall[3];
  qt_real L[3]; /* angular momentum */
  qt_real torque[3];
  qt_sine_and_cosine(x[AT_ATTITUDE], &sr, &cr);
  qt_sine_and_cosine(x[AT_ATTITUDE + 1], &sp, &cp);
  qt_rotation_of_euler(x[AT_ATTITUDE], x[AT_ATTITUDE + 1], x[AT_ATTITUDE + 2], R);
  E[0] = 1.0f;
  E[1] = sr * (sp / cp);
  E[2] = cr * (sp / cp);
  E[3] = 0.0f;
  E[4] = cr;
  E[5] = -sr;
  E[6] = 0.0f;
  E[7] = sr / cp;
  E[8] = cr / cp;
  /* p' = R v, angles' = E w */
  qt_times3(R, v, f);
  qt_times3(E, w, &f[AT_ATTITUDE]);
  /* v' = F/m + R' g - w x v */
  free_fall[0] = (R[6] * p->gravity) + ((w[2] * v[1]) - (w[1] * v[2]));
  free_fall[1] = (R[7] * p->gravity) + ((w[0] * v[2]) - (w[2] * v[0]));
  free_fall[2] = (R[8] * p->gravity) + ((w[1] * v[0]) - (w[0] * v[1]));
  for (int i = 0; i < 3; ++i) {
    const qt_real force = loads->force[i] + drag_force(p, i, v[i]);
    f[AT_VELOCITY + i] = (force * p->inverse_mass) + free_fall[i];
  }
  /* J w' = torque - w x (J w + h) */
  for (int i = 0; i < 3; ++i) {
    const qt_real *row = &p->J[3 * i];
    L[i] = ((row[0] * w[0]) + (row[1] * w[1])) + (row[2] * w[2]);
  }
  L[2] += loads->angular_momentum;
  torque[0] = loads->torque[0] - ((w[1] * L[2]) - (w[2] * L[1]));
  torque[1] = loads->torque[1] - ((w[2] * L[0]) - (w[0] * L[2]));
  torque[2] = loads->torque[2] - ((w[0] * L[1]) - (w[1] * L[0]));
  for (int i = 0; i < 3; ++i) {
    const qt_real *row = &p->J_inverse[3 * i];
    f[AT_RATES + i] = ((row[0] * torque[0]) + (row[1] * torque[1])) + (row[2] * torque[2]);
  }
}

/* The derivative of R v, the velocity in the world, by the angles. */
static void turned_velocity(const qt_real x[QT_STATES], const qt_real R[9], const qt_real Rv[3],
                            qt_real by_angles[9]) {
  const qt_real *v = &x[AT_VELOCITY];
  qt_real sr;
  qt_real cr;
  qt_real sp;
  qt_real cp;
  qt_real sy;
  qt_real cy;
  qt_sine_and_cosine(x[AT_ATTITUDE], &sr, &cr);
  qt_sine_and_cosine(x[AT_ATTITUDE + 1], &sp, &cp);
  qt_sine_and_cosine(x[AT_ATTITUDE + 2], &sy, &cy);
  for (int i = 0; i < 3; ++i) { /* dR/droll exchanges the second and third column of R */
    by_angles[3 * i] = (R[(3 * i) + 2] * v[1]) - (R[(3 * i) + 1] * v[2]);
  }
  by_angles[1] = cy * Rv[2];
  by_angles[4] = sy * Rv[2];
  by_angles[7] = -((cp * v[0]) + (sp * ((sr * v[1]) + (cr * v[2]))));
  by_angles[2] = -Rv[1]; /* dR/dyaw turns by a quarter about z */
  by_angles[5] = Rv[0];
  by_angles[8] = 0.0f;
}

/* A = df/dx */
static void jacobian(const qt_estimator_parameters_t *p, const qt_real x[QT_STATES],
                     const loads_t *loads, jacobian_t *A) {
  const qt_real *v = &x[AT_VELOCITY];
  const qt_real *w = &x[AT_RATES];
  const qt_real g = p->gravity;
  qt_real sr;
  qt_real cr;
  qt_real sp;
  qt_real cp;
  qt_real Rv[3];
  qt_real across;
  qt_real pitch_rate;
  qt_real secant;
  qt_real tangent;
  qt_real L[3];
  qt_real Lx[9];
  qt_real wx[9];
  qt_real wxJ[9];
  qt_sine_and_cosine(x[AT_ATTITUDE], &sr, &cr);
  qt_sine_and_cosine(x[AT_ATTITUDE + 1], &sp, &cp);
  (void)memset(A, 0, sizeof *A);
  /* p' = R v */
  qt_rotation_of_euler(x[AT_ATTITUDE], x[AT_ATTITUDE + 1], x[AT_ATTITUDE + 2],
                       A->position_velocity);
  qt_times3(A->position_velocity, v, Rv);
  turned_velocity(x, A->position_velocity, Rv, A->position_attitude);
  /* angles' = E w */
  across = (w[1] * sr) + (w[2] * cr);
  pitch_rate = (w[1] * cr) - (w[2] * sr);
  secant = 1.0f / cp;
  tangent = sp * secant;
  A->attitude_attitude[0] = pitch_rate * tangent;
  A->attitude_attitude[1] = (across * secant) * secant;
  A->attitude_attitude[3] = -across;
  A->attitude_attitude[6] = pitch_rate * secant;
  A->attitude_attitude[7] = (across * tangent) * secant;
  A->attitude_rates[0] = 1.0f;
  A->attitude_rates[1] = sr * tangent;
  A->attitude_rates[2] = cr * tangent;
  A->attitude_rates[4] = cr;
  A->attitude_rates[5] = -sr;
  A->attitude_rates[7] = sr * secant;
  A->attitude_rates[8] = cr * secant;
  /* v' = F/m + D(v)/m + R' g - w x v */
  A->velocity_attitude[1] = -g * cp;
  A->velocity_attitude[3] = (g * cp) * cr;
  A->velocity_attitude[4] = (-g * sp) * sr;
  A->velocity_attitude[6] = (-g * cp) * sr;
  A->velocity_attitude[7] = (-g * sp) * cr;
  cross_matrix(w, wx);
  for (int i = 0; i < 9; ++i) {
    A->velocity_velocity[i] = -wx[i];
  }
  for (int i = 0; i < 3; ++i) {
    A->velocity_velocity[4 * i] += drag_slope(p, i, v[i]) * p->inverse_mass;
  }
  cross_matrix(v, A->velocity_rates);
  /* J w' = torque - w x (J w + h): J dw'/dw = [J w + h]x - [w]x J */
  qt_times3(p->J, w, L);
  L[2] += loads->angular_momentum;
  cross_matrix(L, Lx);
  product3(wx, p->J, wxJ);
  for (int i = 0; i < 9; ++i) {
    Lx[i] -= wxJ[i];
  }
  product3(p->J_inverse, Lx, A->rates_rates);
}

/* ---- prediction ---- */

/* Replaces the off-diagonal entries by their mean, because rounding makes them differ. */
static void symmetrize(qt_real P[QT_STATES * QT_STATES]) {
  for (int i = 1; i < QT_STATES; ++i) {
    for (int j = 0; j < i; ++j) {
      const qt_real mean = 0.5f * (P[(QT_STATES * j) + i] + P[(QT_STATES * i) + j]);
      P[(QT_STATES * j) + i] = mean;
      P[(QT_STATES * i) + j] = mean;
    }
  }
}

/* M = (I + h A) M. Entry (i, j) of M is at i * below + j * beside, so that a second call with the
 * two exchanged gives M (I + h A)'. */
static void advance(const jacobian_t *A, qt_real h, qt_real M[QT_STATES * QT_STATES], int below,
                    int beside) {
  for (int j = 0; j < QT_STATES; ++j) {
    qt_real a[3];
    qt_real v[3];
    qt_real w[3];
    qt_real by_a[3];
    qt_real by_v[3];
    qt_real by_w[3];
    for (int i = 0; i < 3; ++i) {
      a[i] = M[((AT_ATTITUDE + i) * below) + (j * beside)];
      v[i] = M[((AT_VELOCITY + i) * below) + (j * beside)];
      w[i] = M[((AT_RATES + i) * below) + (j * beside)];
    }
    qt_times3(A->position_attitude, a, by_a);
    qt_times3(A->position_velocity, v, by_v);
    for (int i = 0; i < 3; ++i) {
      M[(i * below) + (j * beside)] += (by_a[i] + by_v[i]) * h;
    }
    qt_times3(A->attitude_attitude, a, by_a);
    qt_times3(A->attitude_rates, w, by_w);
    for (int i = 0; i < 3; ++i) {
      M[((AT_ATTITUDE + i) * below) + (j * beside)] += (by_a[i] + by_w[i]) * h;
    }
    qt_times3(A->velocity_attitude, a, by_a);
    qt_times3(A->velocity_velocity, v, by_v);
    qt_times3(A->velocity_rates, w, by_w);
    for (int i = 0; i < 3; ++i) {
      M[((AT_VELOCITY + i) * below) + (j * beside)] += ((by_a[i] + by_v[i]) + by_w[i]) * h;
    }
    qt_times3(A->rates_rates, w, by_w);
    for (int i = 0; i < 3; ++i) {
      M[((AT_RATES + i) * below) + (j * beside)] += by_w[i] * h;
    }
  }
}

/* A state without error keeps no error. */
static void clear(qt_estimator_state_t *s, int i) {
  for (int j = 0; j < QT_STATES; ++j) {
    s->P[(QT_STATES * i) + j] = 0.0f;
    s->P[(QT_STATES * j) + i] = 0.0f;
  }
}

/* States that the filter does not estimate have neither error nor motion. */
static void leave_out(const qt_estimator_parameters_t *p, qt_estimator_state_t *s) {
  if (!p->position) {
    for (int i = 0; i < 2; ++i) {
      clear(s, i);
      clear(s, AT_VELOCITY + i);
      s->x[AT_VELOCITY + i] = 0.0f;
    }
  }
  if (!p->biases) {
    for (int i = 0; i < 3; ++i) {
      clear(s, AT_BIAS + i);
    }
  }
}

/* x = x + T f(x), P = F P F' + Q with F = I + T df/dx. A stationary vehicle does not move. */
static void predict(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                    const loads_t *loads, bool standing) {
  const qt_real h = standing ? 0.0f : QT_DT;
  qt_real f[AT_BIAS];
  jacobian_t A;
  motion(p, s->x, loads, f);
  jacobian(p, s->x, loads, &A);
  for (int i = 0; i < AT_BIAS; ++i) {
    if (p->position || (i >= 2)) {
      s->x[i] += f[i] * h;
    }
  }
  advance(&A, h, s->P, QT_STATES, 1);
  advance(&A, h, s->P, 1, QT_STATES);
  for (int i = 0; i < QT_STATES; ++i) {
    s->P[(QT_STATES + 1) * i] += p->Q[i];
  }
  symmetrize(s->P);
  leave_out(p, s);
}

/* ---- correction ---- */

/* One scalar with the innovation e = y - C x; Joseph's form in two steps of rank one (Bierman 1977,
 * section V.5): M = P - K (P C')', P = M + (R K - M C') K'. Returns whether it is accepted, and
 * e^2/S. */
static bool update(qt_estimator_state_t *s, const row_t *C, qt_real e, qt_real R, qt_real gate,
                   qt_real *square) {
  qt_real PC[QT_STATES];
  qt_real K[QT_STATES];
  qt_real S = R;
  bool used;
  for (int i = 0; i < QT_STATES; ++i) {
    PC[i] = s->P[(QT_STATES * i) + C->column[0]] * C->value[0];
    for (int k = 1; (k < MOST_ENTRIES) && (k < C->count); ++k) {
      PC[i] += s->P[(QT_STATES * i) + C->column[k]] * C->value[k];
    }
  }
  for (int k = 0; (k < MOST_ENTRIES) && (k < C->count); ++k) {
    S += C->value[k] * PC[C->column[k]];
  }
  used = qt_is_finite(e) && (S > 0.0f);
  *square = used ? ((e * e) / S) : 0.0f;
  used = used && (*square <= gate);
  if (used) {
    for (int i = 0; i < QT_STATES; ++i) {
      K[i] = PC[i] / S;
    }
    for (int i = 0; i < QT_STATES; ++i) {
      qt_real *P = &s->P[QT_STATES * i];
      qt_real MC;
      qt_real rest;
      for (int j = 0; j < QT_STATES; ++j) {
        P[j] -= K[i] * PC[j];
      }
      MC = P[C->column[0]] * C->value[0];
      for (int k = 1; (k < MOST_ENTRIES) && (k < C->count); ++k) {
        MC += P[C->column[k]] * C->value[k];
      }
      rest = (K[i] * R) - MC;
      for (int j = 0; j < QT_STATES; ++j) {
        P[j] += rest * K[j];
      }
      s->x[i] += K[i] * e;
    }
  }
  return used;
}

/* A fresh measurement with a gate. */
static bool use(const qt_estimator_parameters_t *p, qt_estimator_state_t *s, const row_t *C,
                qt_real e, qt_real R, qt_estimate_t *estimate) {
  qt_real square;
  const bool used = update(s, C, e, R, p->gate, &square);
  if (used) {
    estimate->innovation_square += square;
    estimate->innovation_freedom += 1.0f;
  }
  return used;
}

/* The row of a measured state. */
static row_t of_state(int i) {
  row_t C;
  (void)memset(&C, 0, sizeof C);
  C.count = 1;
  C.column[0] = i;
  C.value[0] = 1.0f;
  return C;
}

/* Measurements of three consecutive states; returns whether one is accepted. */
static bool use_states(const qt_estimator_parameters_t *p, qt_estimator_state_t *s, int first,
                       const qt_real y[3], qt_real R, qt_estimate_t *estimate) {
  bool believed = false;
  for (int i = 0; i < 3; ++i) {
    const row_t C = of_state(first + i);
    const bool used = use(p, s, &C, y[i] - s->x[first + i], R, estimate);
    believed = believed || used;
  }
  return believed;
}

/* Roll, pitch and yaw; the yaw of the state is unwrapped. */
static void use_angles(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                       const measured_t *m, qt_estimate_t *estimate) {
  const row_t roll = of_state(AT_ATTITUDE);
  const row_t pitch = of_state(AT_ATTITUDE + 1);
  const row_t yaw = of_state(AT_ATTITUDE + 2);
  const qt_real tilt_R = p->tilt_R * m->tilt_doubt;
  if (m->tilt_fresh) {
    (void)use(p, s, &roll, qt_wrapped(s->tilt_roll - s->x[AT_ATTITUDE]), tilt_R, estimate);
    (void)use(p, s, &pitch, s->tilt_pitch - s->x[AT_ATTITUDE + 1], tilt_R, estimate);
  }
  if (m->yaw_fresh) {
    (void)use(p, s, &yaw, qt_wrapped(m->yaw - s->x[AT_ATTITUDE + 2]), p->yaw_R * m->yaw_doubt,
              estimate);
  }
}

/* Specific force: (rotors + drag)/m + bias. */
static void use_force(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                      const loads_t *loads, const qt_real force[3], qt_estimate_t *estimate) {
  qt_real v0[3]; /* where the drag is linearized, for all three */
  (void)memcpy(v0, &s->x[AT_VELOCITY], sizeof v0);
  for (int i = 0; i < 3; ++i) {
    const qt_real slope = drag_slope(p, i, v0[i]) * p->inverse_mass;
    const qt_real felt = (loads->force[i] + drag_force(p, i, v0[i])) * p->inverse_mass;
    const qt_real expected = (felt + (slope * (s->x[AT_VELOCITY + i] - v0[i]))) + s->x[AT_BIAS + i];
    row_t C = of_state(AT_VELOCITY + i);
    C.count = 2;
    C.value[0] = slope;
    C.column[1] = AT_BIAS + i;
    C.value[1] = 1.0f;
    (void)use(p, s, &C, force[i] - expected, p->force_R, estimate);
  }
}

/* Velocity in the world, R v, from GPS; returns whether one of the three is accepted. */
static bool use_gps_velocity(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                             const qt_real y[3], qt_estimate_t *estimate) {
  qt_real x0[QT_STATES]; /* where it is linearized, for all three */
  qt_real R[9];
  qt_real Rv[3];
  qt_real by_angles[9];
  bool believed = false;
  (void)memcpy(x0, s->x, sizeof x0);
  qt_rotation_of_euler(x0[AT_ATTITUDE], x0[AT_ATTITUDE + 1], x0[AT_ATTITUDE + 2], R);
  qt_times3(R, &x0[AT_VELOCITY], Rv);
  turned_velocity(x0, R, Rv, by_angles);
  for (int i = 0; i < 3; ++i) {
    qt_real expected = Rv[i];
    bool used;
    row_t C;
    C.count = 6;
    for (int k = 0; k < 3; ++k) {
      C.column[k] = AT_ATTITUDE + k;
      C.value[k] = by_angles[(3 * i) + k];
      C.column[3 + k] = AT_VELOCITY + k;
      C.value[3 + k] = R[(3 * i) + k];
    }
    for (int k = 0; k < MOST_ENTRIES; ++k) {
      expected += C.value[k] * (s->x[C.column[k]] - x0[C.column[k]]);
    }
    used = use(p, s, &C, y[i] - expected, p->gps_velocity_R, estimate);
    believed = believed || used;
  }
  return believed;
}

static bool is_fresh(const qt_vector_sample_t *sample) {
  return sample->fresh && qt_all_finite(sample->value);
}

/* Processes all fresh samples; returns whether GPS or a position from images is accepted. */
static bool correct(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                    const loads_t *loads, const qt_sensors_t *sensors, const measured_t *m,
                    qt_estimate_t *estimate) {
  bool by_gps = false;
  bool by_vision = false;
  bool by_velocity = false;
  use_angles(p, s, m, estimate);
  if (m->force_fresh && (!sensors->on_ground)) {
    use_force(p, s, loads, sensors->specific_force.value, estimate);
  }
  if (m->rates_fresh) {
    (void)use_states(p, s, AT_RATES, m->rates, p->rates_R, estimate);
  }
  if (m->height_fresh) {
    const row_t C = of_state(AT_HEIGHT);
    estimate->height_used = use(p, s, &C, -m->height - s->x[AT_HEIGHT], p->height_R, estimate);
  }
  if (p->position && is_fresh(&sensors->gps_position)) {
    by_gps = use_states(p, s, 0, sensors->gps_position.value, p->gps_position_R, estimate);
  }
  if (p->position && m->vision_fresh) {
    by_vision = use_states(p, s, 0, m->vision, p->vision_R, estimate);
  }
  if (p->position && is_fresh(&sensors->gps_velocity)) {
    by_velocity = use_gps_velocity(p, s, sensors->gps_velocity.value, estimate);
  }
  symmetrize(s->P);
  return by_gps || by_vision || by_velocity;
}

/* Velocity 0 as a measurement: for a stationary vehicle; and weakly for one without GPS and images
 * for so long that its covariance would grow without bound. */
static void use_rest(const qt_estimator_parameters_t *p, qt_estimator_state_t *s, bool standing) {
  const bool lost = p->position && (s->gps_age > p->gps_timeout);
  const qt_real R = standing ? p->standing_variance : p->still_variance;
  for (int i = 0; i < 3; ++i) {
    if (standing || (lost && (i < 2))) {
      const row_t C = of_state(AT_VELOCITY + i);
      qt_real square;
      (void)update(s, &C, -s->x[AT_VELOCITY + i], R, QT_INFINITY, &square);
    }
  }
  symmetrize(s->P);
}

/* ---- sensors ---- */

/* Roll and pitch of a body that does not accelerate, from its specific force. */
static void tilt_of_force(const qt_real force[3], qt_real *roll, qt_real *pitch) {
  *roll = qt_atan2(-force[1], -force[2]);
  *pitch = qt_atan2(force[0], qt_sqrt((force[1] * force[1]) + (force[2] * force[2])));
}

/* Yaw of a body with this roll and pitch, from the magnetic field in body axes. */
static qt_real yaw_of_field(const qt_estimator_parameters_t *p, const qt_real field[3],
                            qt_real roll, qt_real pitch) {
  qt_real sr;
  qt_real cr;
  qt_real sp;
  qt_real cp;
  qt_real aft;
  qt_real ahead;
  qt_real right;
  qt_sine_and_cosine(roll, &sr, &cr);
  qt_sine_and_cosine(pitch, &sp, &cp);
  aft = (sr * field[1]) + (cr * field[2]);
  ahead = (cp * field[0]) + (sp * aft);
  right = (cr * field[1]) - (sr * field[2]);
  return p->declination - qt_atan2(right, ahead);
}

/* Tilt from the accelerometer minus its estimated bias. */
static void measure_tilt(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                         const qt_vector_sample_t *sample, measured_t *m) {
  qt_real force[3];
  qt_real norm;
  for (int i = 0; i < 3; ++i) {
    force[i] = sample->value[i] - s->x[AT_BIAS + i];
  }
  norm = qt_sqrt(qt_square3(force));
  /* In free fall the specific force is near zero, and its direction is meaningless. */
  m->tilt_fresh = m->force_fresh && (norm > (0.1f * p->gravity));
  if (m->tilt_fresh) {
    tilt_of_force(force, &s->tilt_roll, &s->tilt_pitch);
  }
  if (m->force_fresh) {
    s->force_excess = qt_abs((norm / p->gravity) - 1.0f);
  }
}

/* Yaw from the leveled field; and the variances of roll, pitch and yaw. */
static void measure_yaw(const qt_estimator_parameters_t *p, const qt_estimator_state_t *s,
                        const qt_real field[3], measured_t *m) {
  const qt_real roll = p->yaw_by_estimated_tilt ? s->x[AT_ATTITUDE] : s->tilt_roll;
  const qt_real pitch = p->yaw_by_estimated_tilt ? s->x[AT_ATTITUDE + 1] : s->tilt_pitch;
  m->yaw = yaw_of_field(p, field, roll, pitch);
  m->tilt_doubt = 1.0f;
  m->yaw_doubt = 1.0f;
  if (p->dynamic_covariance) {
    const qt_real excess =
        (s->field_norm > 0.0f) ? qt_abs((qt_sqrt(qt_square3(field)) / s->field_norm) - 1.0f) : 0.0f;
    const qt_real by_force = s->force_excess / p->force_band;
    const qt_real by_field = excess / p->field_band;
    m->tilt_doubt = 1.0f + (by_force * by_force);
    m->yaw_doubt = m->tilt_doubt + (by_field * by_field);
  }
}

static void measure(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                    const qt_sensors_t *sensors, measured_t *m) {
  const qt_real pressure = sensors->pressure.value;
  (void)memset(m, 0, sizeof *m);
  m->force_fresh = is_fresh(&sensors->specific_force);
  m->rates_fresh = is_fresh(&sensors->rates);
  m->yaw_fresh = is_fresh(&sensors->magnetic_field);
  m->vision_fresh = is_fresh(&sensors->vision) && (sensors->vision.age >= 0.0f) &&
                    (sensors->vision.age <= MAX_VISION_AGE);
  m->height_fresh = sensors->pressure.fresh && qt_is_finite(pressure) && (pressure > 0.0f);
  for (int i = 0; i < 3; ++i) {
    m->rates[i] = sensors->rates.value[i] - s->gyro_offset[i];
  }
  measure_tilt(p, s, &sensors->specific_force, m);
  measure_yaw(p, s, sensors->magnetic_field.value, m);
  if (m->height_fresh) {
    m->height = qt_barometric_height(pressure, s->pressure_zero) - s->start_z;
  }
  if (m->vision_fresh) { /* Images take long to read: the vehicle has flown on since. */
    qt_real R[9];
    qt_real velocity[3];
    qt_rotation_of_euler(s->x[AT_ATTITUDE], s->x[AT_ATTITUDE + 1], s->x[AT_ATTITUDE + 2], R);
    qt_times3(R, &s->x[AT_VELOCITY], velocity);
    for (int i = 0; i < 3; ++i) {
      m->vision[i] = sensors->vision.value[i] + (velocity[i] * sensors->vision.age);
    }
  }
}

/* ---- calibration ---- */

static void add(qt_mean_t *mean, const qt_real x[3], bool fresh) {
  if (fresh) {
    for (int i = 0; i < 3; ++i) {
      mean->sum[i] += x[i];
    }
    mean->count += 1.0f;
  }
}

static void mean_of(const qt_mean_t *of, qt_real mean[3]) {
  for (int i = 0; i < 3; ++i) {
    mean[i] = of->sum[i] / qt_max(of->count, 1.0f);
  }
}

/* The means over the time in which the vehicle was stationary. */
static void finish_calibration(const qt_estimator_parameters_t *p, qt_estimator_state_t *s) {
  qt_real force[3];
  qt_real field[3];
  if (s->gyro.count > 0.0f) {
    mean_of(&s->gyro, s->gyro_offset);
  }
  mean_of(&s->force, force);
  for (int i = 0; i < 3; ++i) {
    force[i] -= s->x[AT_BIAS + i];
  }
  mean_of(&s->field, field);
  if (s->pressure_count > 0.0f) {
    s->pressure_zero = s->pressure_sum / s->pressure_count;
  } else {
    s->start_z = 0.0f; /* heights are over the place of the reference pressure */
  }
  if (s->force.count > 0.0f) {
    tilt_of_force(force, &s->x[AT_ATTITUDE], &s->x[AT_ATTITUDE + 1]);
  }
  if (s->field.count > 0.0f) {
    const qt_real yaw = yaw_of_field(p, field, s->x[AT_ATTITUDE], s->x[AT_ATTITUDE + 1]);
    s->x[AT_ATTITUDE + 2] += qt_wrapped(yaw - s->x[AT_ATTITUDE + 2]);
    if (!(p->field_norm > 0.0f)) {
      s->field_norm = qt_sqrt(qt_square3(field));
    }
  }
}

static void calibrate(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                      const qt_sensors_t *sensors, const measured_t *m) {
  ++s->periods;
  add(&s->gyro, sensors->rates.value, m->rates_fresh);
  add(&s->force, sensors->specific_force.value, m->force_fresh);
  add(&s->field, sensors->magnetic_field.value, m->yaw_fresh);
  if (m->height_fresh) {
    s->pressure_sum += sensors->pressure.value;
    s->pressure_count += 1.0f;
  }
  if (s->periods >= p->calibration_periods) {
    finish_calibration(p, s);
  }
}

/* ---- entry points ---- */

void qt_estimator_initialize(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                             const qt_start_t *start) {
  (void)memset(s, 0, sizeof *s);
  for (int i = 0; i < 3; ++i) {
    s->x[i] = start->position[i];
    s->x[AT_VELOCITY + i] = start->velocity[i];
    s->x[AT_RATES + i] = start->rates[i];
    s->x[AT_BIAS + i] = start->force_bias[i];
    s->gyro_offset[i] = start->gyro_bias[i];
  }
  s->x[AT_ATTITUDE] = start->roll;
  s->x[AT_ATTITUDE + 1] = start->pitch;
  s->x[AT_ATTITUDE + 2] = start->yaw;
  for (int i = 0; i < QT_STATES; ++i) {
    s->P[(QT_STATES + 1) * i] = p->start_variance[i];
  }
  leave_out(p, s);
  s->tilt_roll = start->roll;
  s->tilt_pitch = start->pitch;
  s->start_z = (p->calibration_periods > 0) ? start->position[2] : 0.0f;
  s->pressure_zero = p->reference_pressure;
  s->field_norm = p->field_norm;
  /* A stationary vehicle is not predicted with them, and one that starts in the air hovers. */
  (void)memcpy(s->speeds, p->hover_speed, sizeof s->speeds);
}

void qt_estimator_step(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                       const qt_sensors_t *sensors, qt_estimate_t *estimate) {
  measured_t m;
  (void)memset(estimate, 0, sizeof *estimate);
  measure(p, s, sensors, &m);
  if (s->periods < p->calibration_periods) {
    calibrate(p, s, sensors, &m);
  } else {
    loads_t loads;
    bool believed;
    rotor_loads(p, s->speeds, &loads);
    predict(p, s, &loads, sensors->on_ground);
    believed = correct(p, s, &loads, sensors, &m, estimate);
    s->gps_age = believed ? 0.0f : (s->gps_age + QT_DT);
    use_rest(p, s, sensors->on_ground);
  }
  (void)memcpy(estimate->position, s->x, sizeof estimate->position);
  estimate->roll = s->x[AT_ATTITUDE];
  estimate->pitch = s->x[AT_ATTITUDE + 1];
  estimate->yaw = s->x[AT_ATTITUDE + 2];
  (void)memcpy(estimate->velocity, &s->x[AT_VELOCITY], sizeof estimate->velocity);
  (void)memcpy(estimate->rates, &s->x[AT_RATES], sizeof estimate->rates);
}
