/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The general filter: an error-state extended Kalman filter for any combination of sensors. The
 * gyroscope and the accelerometer drive the motion; flow, range, pressure, heading, GPS and vision
 * correct it, each at the time at which it was measured.
 *
 * State: position p, velocity v (world), attitude q = (w, x, y, z) of R, which takes body axes to
 * world axes, biases of gyroscope and accelerometer, offset of the barometer's height.
 * Errors (16): dp, dv, dtheta (a small turn about the world's axes), b_gyro, b_force, h_pressure.
 *
 * The stored motion and its covariance are those of the horizon, which is `horizon` control periods
 * before the newest period; there the delayed inertial samples are complete. From the horizon, the
 * stored samples propagate the motion to the present.
 */
#include "internal.h"

/* Indices of the errors. */
#define AT_POSITION 0
#define AT_DOWN 2 /* of the position */
#define AT_VELOCITY 3
#define AT_TURN 6
#define AT_GYRO 9
#define AT_FORCE 12
#define AT_PRESSURE 15

/* Groups of three errors that a measurement depends on, as bits. */
#define BY_POSITION 1u
#define BY_VELOCITY 2u
#define BY_TURN 4u
#define BY_GYRO 8u
#define BY_FORCE 16u
#define BY_PRESSURE 32u
#define BY_ALL 63u

/* Indices of the rejection counters by a sensor's first scalar. */
#define SCALAR_RANGE 0
#define SCALAR_FLOW 1
#define SCALAR_PRESSURE 3
#define SCALAR_HEADING 4
#define SCALAR_GPS_POSITION 5
#define SCALAR_GPS_VELOCITY 8
#define SCALAR_VISION 11

typedef struct {
  qt_real rates[3]; /* mean over a control period, bias subtracted [rad/s] */
  qt_real force[3]; /* likewise [m/s^2] */
} drive_t;

/* Three rows of the whole covariance. */
typedef struct {
  qt_real row[3][QT_ERRORS];
} rows_t;

/* The index before index i in a ring of `count` entries. */
static int place_before(int i, int count) { return ((i == 0) ? count : i) - 1; }

/* ---- covariance: the lower triangle of a symmetric matrix, row by row ---- */

static int place(int i, int j) {
  return (i >= j) ? (((i * (i + 1)) / 2) + j) : (((j * (j + 1)) / 2) + i);
}

/* Copies the rows `first` to `first + 2` of the full matrix from its lower triangle, or back. */
static void get_rows(const qt_real *P, int first, rows_t *to) {
  for (int r = 0; r < 3; ++r) {
    const int i = first + r;
    const qt_real *row = &P[place(i, 0)];
    int below = place(i, i);
    for (int j = 0; j <= i; ++j) {
      to->row[r][j] = row[j];
    }
    for (int j = i + 1; j < QT_ERRORS; ++j) {
      below += j; /* from place(j - 1, i) to place(j, i) */
      to->row[r][j] = P[below];
    }
  }
}

static void put_rows(qt_real *P, int first, const rows_t *from) {
  for (int r = 0; r < 3; ++r) {
    const int i = first + r;
    qt_real *row = &P[place(i, 0)];
    int below = place(i, i);
    for (int j = 0; j <= i; ++j) {
      row[j] = from->row[r][j];
    }
    for (int j = i + 1; j < QT_ERRORS; ++j) {
      below += j;
      if (j >= (first + 3)) {
        P[below] = from->row[r][j];
      }
    }
  }
}

/* row += b (rows 0 to 2 of y) [+ c (rows 0 to 2 of z)], term by term. */
static void add_products(qt_real row[QT_ERRORS], const qt_real b[3], const rows_t *y) {
  for (int j = 0; j < QT_ERRORS; ++j) {
    row[j] = ((row[j] + (b[0] * y->row[0][j])) + (b[1] * y->row[1][j])) + (b[2] * y->row[2][j]);
  }
}
static void add_both_products(qt_real row[QT_ERRORS], const qt_real b[3], const rows_t *y,
                              const qt_real c[3], const rows_t *z) {
  for (int j = 0; j < QT_ERRORS; ++j) {
    qt_real sum = (row[j] + (b[0] * y->row[0][j])) + (c[0] * z->row[0][j]);
    sum = (sum + (b[1] * y->row[1][j])) + (c[1] * z->row[1][j]);
    row[j] = (sum + (b[2] * y->row[2][j])) + (c[2] * z->row[2][j]);
  }
}

/* x + b' y [+ c' z], term by term. */
static qt_real with_product(qt_real x, const qt_real b[3], const qt_real *y, const qt_real *c,
                            const qt_real *z) {
  qt_real sum = x;
  for (int k = 0; k < 3; ++k) {
    sum += y[k] * b[k];
    if (c != NULL) {
      sum += z[k] * c[k];
    }
  }
  return sum;
}

/* P <- E P E' for E that adds rows: target += block source (+ block2 source2), blocks of 3 x 3. */
static void add_rows(qt_real *P, int target, int source, const qt_real block[9], int source2,
                     const qt_real *block2) {
  rows_t rows;
  rows_t from;
  rows_t from2;
  qt_real own[9];
  get_rows(P, target, &rows);
  get_rows(P, source, &from);
  if (block2 != NULL) {
    get_rows(P, source2, &from2);
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) {
      own[(3 * i) + j] =
          with_product(rows.row[i][target + j], &block[3 * j], &rows.row[i][source],
                       (block2 != NULL) ? &block2[3 * j] : NULL, &rows.row[i][source2]);
    }
  }
  for (int i = 0; i < 3; ++i) { /* the entries of the target itself are replaced below */
    if (block2 != NULL) {
      add_both_products(rows.row[i], &block[3 * i], &from, &block2[3 * i], &from2);
    } else {
      add_products(rows.row[i], &block[3 * i], &from);
    }
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) {
      own[(3 * i) + j] =
          with_product(own[(3 * i) + j], &block[3 * i], &rows.row[j][source],
                       (block2 != NULL) ? &block2[3 * i] : NULL, &rows.row[j][source2]);
    }
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) {
      rows.row[i][target + j] = own[(3 * i) + j];
    }
  }
  put_rows(P, target, &rows);
}

/* P <- E P E': position += h velocity. */
static void add_velocity(qt_real *P, qt_real h) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) {
      P[place(i, j)] += h * (P[place(AT_VELOCITY + i, j)] + P[place(AT_VELOCITY + j, i)] +
                             (h * P[place(AT_VELOCITY + i, AT_VELOCITY + j)]));
    }
  }
  for (int j = 0; j < (QT_ERRORS - 3); ++j) {
    for (int i = 0; i < 3; ++i) {
      P[place(i, AT_VELOCITY + j)] += h * P[place(AT_VELOCITY + i, AT_VELOCITY + j)];
    }
  }
}

/* The covariance over a time h: position gains h velocity, velocity -[gained] x turn - h R b_force,
 * turn -h R b_gyro. R is that half way; gained = R force h [m/s]. */
static void spread(qt_real *P, const qt_real R[9], const qt_real gained[3], qt_real h) {
  qt_real minus_R[9];
  const qt_real minus_cross[9] = {0.0f,      gained[2], -gained[1], -gained[2], 0.0f,
                                  gained[0], gained[1], -gained[0], 0.0f};
  for (int i = 0; i < 9; ++i) {
    minus_R[i] = R[i] * -h;
  }
  add_velocity(P, h);
  add_rows(P, AT_VELOCITY, AT_TURN, minus_cross, AT_FORCE, minus_R);
  add_rows(P, AT_TURN, AT_GYRO, minus_R, 0, NULL);
}

/* P += R diag(variance) R' for three errors. */
static void add_body_noise(qt_real *P, int first, const qt_real R[9], const qt_real variance[3]) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) {
      for (int k = 0; k < 3; ++k) {
        P[place(first + i, first + j)] += R[(3 * i) + k] * R[(3 * j) + k] * variance[k];
      }
    }
  }
}

/* ---- motion ---- */

/* The quaternion of a small rotation vector, to its fourth power. */
static void small_rotation(const qt_real turn[3], qt_real q[4]) {
  const qt_real square = qt_square3(turn);
  const qt_real s = 0.5f - (square * 0.020833333333333332f);
  q[0] = 1.0f - (square * (0.125f - (square * 0.0026041666666666665f)));
  q[1] = s * turn[0];
  q[2] = s * turn[1];
  q[3] = s * turn[2];
}

/* Propagates the motion over a time h with constant inputs. Gravity and force act half way through
 * the rotation. */
static void move(qt_motion_t *motion, const qt_real turn[3], const qt_real force[3],
                 qt_real gravity, qt_real h) {
  qt_real half_turn[3];
  qt_real half[4];
  qt_real middle[4];
  qt_real R[9];
  qt_real gained[3];
  for (int i = 0; i < 3; ++i) {
    half_turn[i] = turn[i] * 0.5f;
  }
  small_rotation(half_turn, half);
  qt_quaternion_product(motion->attitude, half, middle);
  qt_rotation_of_quaternion(middle, R);
  qt_times3(R, force, gained);
  for (int i = 0; i < 3; ++i) {
    gained[i] *= h;
  }
  gained[2] += gravity * h;
  for (int i = 0; i < 3; ++i) {
    motion->position[i] += (motion->velocity[i] + (gained[i] * 0.5f)) * h;
    motion->velocity[i] += gained[i];
  }
  qt_quaternion_product(middle, half, motion->attitude);
}

/* The samples `age` control periods before the newest ones. */
static const qt_reading_t *reading(const qt_estimator_state_t *s, int age) {
  const int i = s->newest_reading + age;
  return &s->readings[(i < QT_READINGS) ? i : (i - QT_READINGS)];
}

/* The inputs over the period that ended `age` periods before the horizon: the trapezoid of linearly
 * interpolated samples, with biases subtracted. */
static void drive_at(const qt_estimator_parameters_t *p, const qt_estimator_state_t *s, int age,
                     drive_t *drive) {
  const qt_reading_t *g0 = reading(s, p->gyro_whole + age);
  const qt_reading_t *g1 = reading(s, p->gyro_whole + age + 1);
  const qt_reading_t *f0 = reading(s, p->force_whole + age);
  const qt_reading_t *f1 = reading(s, p->force_whole + age + 1);
  for (int i = 0; i < 3; ++i) {
    drive->rates[i] = (g0->rates[i] * p->gyro_mean[0]) + (g1->rates[i] * 0.5f);
    drive->force[i] = (f0->force[i] * p->force_mean[0]) + (f1->force[i] * 0.5f);
  }
  if (p->gyro_mean[1] > 0.0f) {
    const qt_reading_t *g2 = reading(s, p->gyro_whole + age + 2);
    for (int i = 0; i < 3; ++i) {
      drive->rates[i] += g2->rates[i] * p->gyro_mean[1];
    }
  }
  if (p->force_mean[1] > 0.0f) {
    const qt_reading_t *f2 = reading(s, p->force_whole + age + 2);
    for (int i = 0; i < 3; ++i) {
      drive->force[i] += f2->force[i] * p->force_mean[1];
    }
  }
  for (int i = 0; i < 3; ++i) {
    drive->rates[i] -= s->gyro_bias[i];
    drive->force[i] -= s->force_bias[i];
  }
}

/* The gyroscope `age` periods before the horizon, interpolated, with its bias subtracted. */
static void rates_at(const qt_estimator_parameters_t *p, const qt_estimator_state_t *s, int age,
                     qt_real rates[3]) {
  const qt_reading_t *g0 = reading(s, p->gyro_whole + age);
  for (int i = 0; i < 3; ++i) {
    rates[i] = (g0->rates[i] * p->gyro_point[0]) - s->gyro_bias[i];
  }
  if (p->gyro_point[1] > 0.0f) {
    const qt_reading_t *g1 = reading(s, p->gyro_whole + age + 1);
    for (int i = 0; i < 3; ++i) {
      rates[i] += g1->rates[i] * p->gyro_point[1];
    }
  }
}

/* The present motion: propagated from the horizon with the samples since then, the last part with
 * the newest samples held. */
static void motion_now(const qt_estimator_parameters_t *p, const qt_estimator_state_t *s,
                       qt_motion_t *now) {
  *now = s->motion;
  if (p->horizon > 0) {
    qt_real turn[3];
    qt_real force[3];
    const qt_reading_t *newest = reading(s, 0);
    for (int i = 0; i < 3; ++i) {
      turn[i] = newest->rates[i] * p->gyro_now.held;
      force[i] = newest->force[i] * p->force_now.held;
    }
    for (int k = 0; (k < QT_HORIZON) && (k < p->gyro_now.count); ++k) {
      const qt_reading_t *a = reading(s, k);
      const qt_reading_t *b = reading(s, k + 1);
      for (int i = 0; i < 3; ++i) {
        turn[i] += (a->rates[i] * p->gyro_now.later[k]) + (b->rates[i] * p->gyro_now.earlier[k]);
      }
    }
    for (int k = 0; (k < QT_HORIZON) && (k < p->force_now.count); ++k) {
      const qt_reading_t *a = reading(s, k);
      const qt_reading_t *b = reading(s, k + 1);
      for (int i = 0; i < 3; ++i) {
        force[i] += (a->force[i] * p->force_now.later[k]) + (b->force[i] * p->force_now.earlier[k]);
      }
    }
    for (int i = 0; i < 3; ++i) {
      turn[i] = (turn[i] - s->gyro_bias[i]) * p->horizon_time;
      force[i] -= s->force_bias[i];
    }
    move(now, turn, force, p->gravity, p->horizon_time);
  }
}

/* ---- measurements of the past ---- */

/* The motion at an earlier time and how its errors follow from those of the horizon:
 * turn_i = turn + G b_gyro, velocity_i = velocity + U x turn + A b_gyro + G b_force,
 * position_i = position - S velocity - W x turn + D b_gyro + E b_force. */
typedef struct {
  qt_motion_t motion;
  qt_real rates[3];
  bool past;
  qt_real S;
  qt_real U[3];
  qt_real W[3];
  qt_real G[9];
  qt_real A[9];
  qt_real D[9];
  qt_real E[9];
} past_t;

/* One step of past_motion(): the period of length h that ended `age` periods before the horizon,
 * backward. */
static void step_back(const qt_estimator_parameters_t *p, const qt_estimator_state_t *s, int age,
                      qt_real h, past_t *past) {
  drive_t drive;
  qt_real turn[3];
  qt_real half[4];
  qt_real middle[4];
  qt_real R[9];
  qt_real felt[3];
  qt_real gained[3];
  qt_real begin[3];
  qt_real end[3];
  const qt_real share = qt_min(h / p->dt, 1.0f);
  drive_at(p, s, age, &drive);
  /* The inverse of move(): half the rotation back, then the velocity, then the other half. */
  for (int i = 0; i < 3; ++i) {
    turn[i] = drive.rates[i] * (-0.5f * h);
  }
  small_rotation(turn, half);
  qt_quaternion_product(past->motion.attitude, half, middle);
  qt_rotation_of_quaternion(middle, R);
  qt_times3(R, drive.force, felt);
  for (int i = 0; i < 3; ++i) {
    felt[i] *= h;
    gained[i] = felt[i];
  }
  gained[2] += p->gravity * h;
  qt_quaternion_product(middle, half, past->motion.attitude);
  for (int i = 0; i < 3; ++i) {
    past->motion.velocity[i] -= gained[i];
    past->motion.position[i] -= (past->motion.velocity[i] + (gained[i] * 0.5f)) * h;
  }
  for (int i = 0; i < 9; ++i) {
    past->G[i] += R[i] * h;
  }
  for (int c = 0; c < 3; ++c) { /* A gains felt x G, column by column */
    past->A[c] += (felt[1] * past->G[6 + c]) - (felt[2] * past->G[3 + c]);
    past->A[3 + c] += (felt[2] * past->G[c]) - (felt[0] * past->G[6 + c]);
    past->A[6 + c] += (felt[0] * past->G[3 + c]) - (felt[1] * past->G[c]);
  }
  past->S += h;
  for (int i = 0; i < 3; ++i) {
    past->U[i] += felt[i];
    past->W[i] += past->U[i] * h;
  }
  for (int i = 0; i < 9; ++i) {
    past->D[i] -= past->A[i] * h;
    past->E[i] -= past->G[i] * h;
  }
  rates_at(p, s, age + 1, begin);
  rates_at(p, s, age, end);
  if (h > 0.0f) {
    for (int i = 0; i < 3; ++i) {
      past->rates[i] = end[i] + ((begin[i] - end[i]) * share);
    }
  }
}

/* The motion `ago` seconds before the horizon, from the stored samples, with the current biases. A
 * measurement older than the stored samples is propagated with the oldest one. */
static void past_motion(const qt_estimator_parameters_t *p, const qt_estimator_state_t *s,
                        qt_real ago, past_t *past) {
  qt_real left = (ago > QT_INSTANT) ? ago : 0.0f; /* rounding of sample times is not the past */
  bool more = left > 0.0f;
  (void)memset(past, 0, sizeof *past);
  past->motion = s->motion;
  past->past = more;
  rates_at(p, s, 0, past->rates);
  for (int j = 0; (j < QT_HISTORY) && more; ++j) {
    const qt_real h = ((j + 1) == QT_HISTORY) ? left : qt_min(left, p->dt);
    left -= h;
    more = left > 0.0f;
    step_back(p, s, j, h, past);
  }
}

/* ---- correction by one scalar ---- */

/* The derivative of a scalar measurement by the errors; entries of unused groups are 0. */
typedef struct {
  qt_real by[QT_ERRORS];
  unsigned groups;
} row_t;

/* The corrections by the scalars of one sensor, accumulated before they are applied. */
typedef struct {
  qt_real errors[QT_ERRORS];
  bool used;
} correction_t;

/* Converts the row of a measurement at an earlier time to the errors of the horizon. */
static void carry(const past_t *past, row_t *row) {
  qt_real p[3];
  qt_real v[3];
  qt_real turn[3];
  qt_real vU[3];
  qt_real pW[3];
  (void)memcpy(p, &row->by[AT_POSITION], sizeof p);
  (void)memcpy(v, &row->by[AT_VELOCITY], sizeof v);
  (void)memcpy(turn, &row->by[AT_TURN], sizeof turn);
  qt_cross(v, past->U, vU);
  qt_cross(p, past->W, pW);
  for (int i = 0; i < 3; ++i) {
    row->by[AT_VELOCITY + i] -= p[i] * past->S;
    row->by[AT_TURN + i] += vU[i] - pW[i];
    row->by[AT_GYRO + i] += qt_column_times3(past->G, i, turn) + qt_column_times3(past->A, i, v) +
                            qt_column_times3(past->D, i, p);
    row->by[AT_FORCE + i] += qt_column_times3(past->G, i, v) + qt_column_times3(past->E, i, p);
  }
  row->groups = BY_ALL;
}

/* w = P c for the row c. */
static void times_row(const qt_real *P, const row_t *row, qt_real w[QT_ERRORS]) {
  for (int i = 0; i < QT_ERRORS; ++i) {
    qt_real sum = 0.0f;
    for (int g = 0; g < 5; ++g) {
      if ((row->groups & (1u << (unsigned)g)) != 0u) {
        const int f = 3 * g;
        sum += (P[place(f, i)] * row->by[f]) + (P[place(f + 1, i)] * row->by[f + 1]) +
               (P[place(f + 2, i)] * row->by[f + 2]);
      }
    }
    if ((row->groups & BY_PRESSURE) != 0u) {
      sum += P[place(AT_PRESSURE, i)] * row->by[AT_PRESSURE];
    }
    w[i] = sum;
  }
}

/* c x */
static qt_real dot_row(const qt_real x[QT_ERRORS], const row_t *row) {
  qt_real sum = 0.0f;
  for (int g = 0; g < 5; ++g) {
    if ((row->groups & (1u << (unsigned)g)) != 0u) {
      const int f = 3 * g;
      sum += (x[f] * row->by[f]) + (x[f + 1] * row->by[f + 1]) + (x[f + 2] * row->by[f + 2]);
    }
  }
  if ((row->groups & BY_PRESSURE) != 0u) {
    sum += x[AT_PRESSURE] * row->by[AT_PRESSURE];
  }
  return sum;
}

/* P <- (I - K c) P (I - K c)' + K R K' with w = P c', S = c w + R, multiplied out:
 * P - K w' - w K' + S K K'. */
static void joseph(qt_real *P, const qt_real K[QT_ERRORS], const qt_real w[QT_ERRORS], qt_real S) {
  int at = 0;
  for (int i = 0; i < QT_ERRORS; ++i) {
    const qt_real rest = w[i] - (S * K[i]);
    for (int j = 0; j <= i; ++j) {
      P[at] -= (K[i] * w[j]) + (rest * K[j]);
      ++at;
    }
  }
}

/* Increases the variances of the three errors from `first` on until the variance of the row has
 * grown by `lacking`. */
static void doubt(qt_estimator_state_t *s, const row_t *row, int first, qt_real lacking) {
  const qt_real size = qt_square3(&row->by[first]);
  qt_real added = 0.0f;
  if (size > 0.0f) {
    added = lacking / size;
  }
  for (int i = 0; i < 3; ++i) {
    s->P[place(first + i, first + i)] += added;
  }
}

/* One scalar measurement. It is rejected if e^2/S exceeds the gate. After recovery_time of
 * rejections, and at least three of them, the variances of the group `doubted` are increased until
 * e^2/S = 1, because the error of the state exceeds its covariance.
 * innovation: measurement minus prediction, both before any of the sensor's corrections
 * returns: whether the measurement was accepted */
static bool correct(const qt_estimator_parameters_t *p, qt_estimator_state_t *s, qt_real gate,
                    const row_t *row, qt_real innovation, qt_real R, qt_rejections_t *rejections,
                    int doubted, correction_t *correction, qt_estimate_t *seen) {
  qt_real w[QT_ERRORS];
  const qt_real e = innovation - dot_row(correction->errors, row);
  const qt_real square = e * e;
  qt_real S;
  bool sound;
  bool near;
  bool again;
  bool believed;
  times_row(s->P, row, w);
  S = dot_row(w, row) + R;
  sound = qt_is_finite(square) && (S > 0.0f);
  near = square <= (gate * S);
  again = sound && (!near) && (rejections->time >= p->recovery_time) && (rejections->count >= 3.0f);
  believed = again || (sound && near);
  if (sound && (!near)) {
    rejections->count += 1.0f;
  }
  if (again) {
    doubt(s, row, doubted, square - S);
    times_row(s->P, row, w);
    S = dot_row(w, row) + R;
  }
  if (believed) {
    const qt_real inverse = 1.0f / S;
    qt_real K[QT_ERRORS];
    rejections->count = 0.0f;
    rejections->time = 0.0f;
    seen->innovation_square += square / S;
    seen->innovation_freedom += 1.0f;
    correction->used = true;
    for (int i = 0; i < QT_ERRORS; ++i) {
      K[i] = w[i] * inverse;
    }
    joseph(s->P, K, w, S);
    for (int i = 0; i < QT_ERRORS; ++i) {
      correction->errors[i] += K[i] * e;
    }
  }
  return believed;
}

/* The same for a scalar at an earlier time or at the horizon. */
static bool correct_at(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                       const past_t *past, row_t *row, qt_real innovation, qt_real R, int scalar,
                       int doubted, correction_t *correction, qt_estimate_t *seen) {
  if (past->past) {
    carry(past, row);
  }
  return correct(p, s, p->gate, row, innovation, R, &s->rejections[scalar], doubted, correction,
                 seen);
}

/* Applies the corrections to the state. A rotation about the vertical also rotates the velocity:
 * the covariance is transformed to the corrected velocity, velocity += turn x change. */
static void apply(const correction_t *correction, qt_estimator_state_t *s) {
  const qt_real *dx = correction->errors;
  const qt_real *moved = &dx[AT_POSITION];
  const qt_real *change = &dx[AT_VELOCITY];
  const qt_real cross[9] = {0.0f,      change[2], -change[1], -change[2], 0.0f,
                            change[0], change[1], -change[0], 0.0f};
  const qt_real turn[4] = {1.0f, 0.5f * dx[AT_TURN], 0.5f * dx[AT_TURN + 1],
                           0.5f * dx[AT_TURN + 2]};
  if (correction->used) {
    qt_real q[4];
    qt_real inverse;
    for (int i = 0; i < 3; ++i) {
      s->motion.position[i] += moved[i];
      s->motion.velocity[i] += change[i];
    }
    add_rows(s->P, AT_VELOCITY, AT_TURN, cross, 0, NULL);
    for (int i = 0; i < 3; ++i) {
      s->gyro_bias[i] += dx[AT_GYRO + i];
      s->force_bias[i] += dx[AT_FORCE + i];
    }
    s->pressure_height += dx[AT_PRESSURE];
    qt_quaternion_product(turn, s->motion.attitude, q);
    inverse = 1.0f / qt_sqrt(qt_square4(q));
    for (int i = 0; i < 4; ++i) {
      s->motion.attitude[i] = q[i] * inverse;
    }
  }
}

/* ---- sensors ---- */

/* Optical flow, the motion field averaged over the image:
 * flow_x = (v_z d_x a - v_x d_z)/h - w_y (1 + a),  flow_y = (v_z d_y b - v_y d_z)/h + w_x (1 + b)
 * with v and the world's down d in body axes and the height h. */
static void use_flow(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                     const qt_real flow[2], qt_real ago, qt_estimate_t *seen) {
  past_t past;
  correction_t correction = {{0}, false};
  qt_real R[9];
  qt_real v[3];
  qt_real height;
  past_motion(p, s, ago, &past);
  qt_rotation_of_quaternion(past.motion.attitude, R);
  qt_transposed_times3(R, past.motion.velocity, v);
  height = -past.motion.position[2];
  if ((height >= p->flow.least_height) && (R[8] > 0.5f)) {
    const qt_real *d = &R[6];
    const qt_real inverse = 1.0f / height;
    for (int axis = 0; axis < 2; ++axis) {
      const qt_real c = p->flow.mean_square[axis];
      const int turning = 1 - axis; /* the axis whose rate moves the image */
      const qt_real sign = (axis == 0) ? -1.0f : 1.0f;
      const qt_real translation = (((v[2] * d[axis]) * c) - (v[axis] * d[2])) * inverse;
      const qt_real expected = translation + ((sign * past.rates[turning]) * (1.0f + c));
      const qt_real variance =
          p->flow.variance + (((1.0f + c) * (1.0f + c)) * p->gyro_variance[turning]);
      qt_real by_velocity[3] = {0.0f, 0.0f, 0.0f};
      qt_real by_down[3] = {0.0f, 0.0f, 0.0f};
      qt_real world[3];
      qt_real turn[3];
      row_t row = {{0}, BY_POSITION | BY_VELOCITY | BY_TURN | BY_GYRO};
      by_velocity[axis] = -d[2] * inverse;
      by_velocity[2] = (d[axis] * c) * inverse;
      by_down[axis] = (v[2] * c) * inverse;
      by_down[2] = -v[axis] * inverse;
      row.by[AT_DOWN] = translation * inverse;
      qt_times3(R, by_velocity, world);
      qt_cross(world, past.motion.velocity, turn);
      for (int i = 0; i < 3; ++i) {
        row.by[AT_VELOCITY + i] = world[i];
        row.by[AT_TURN + i] = turn[i];
      }
      qt_times3(R, by_down, world); /* and its cross product with e_z */
      row.by[AT_TURN] += world[1];
      row.by[AT_TURN + 1] -= world[0];
      row.by[AT_GYRO + turning] = -sign * (1.0f + c);
      if (correct_at(p, s, &past, &row, (flow[axis] * p->flow.inverse_scale[axis]) - expected,
                     variance, SCALAR_FLOW + axis, AT_VELOCITY, &correction, seen)) {
        seen->flow_used = true;
      }
    }
    apply(&correction, s);
  }
}

/* Range along body z to level ground: height/d_z. */
static void use_range(const qt_estimator_parameters_t *p, qt_estimator_state_t *s, qt_real sample,
                      qt_real ago, qt_estimate_t *seen) {
  past_t past;
  correction_t correction = {{0}, false};
  qt_real R[9];
  const qt_real range = sample * p->range.inverse_scale;
  past_motion(p, s, ago, &past);
  qt_rotation_of_quaternion(past.motion.attitude, R);
  if ((R[8] >= p->range.least_cosine) && (range >= p->range.least) &&
      (range <= p->range.greatest)) {
    const qt_real inverse = 1.0f / R[8];
    const qt_real expected = -past.motion.position[2] * inverse;
    const qt_real slope = -expected * inverse; /* by d_z */
    row_t row = {{0}, BY_POSITION | BY_TURN};
    row.by[AT_DOWN] = -inverse;
    row.by[AT_TURN] = R[5] * slope;
    row.by[AT_TURN + 1] = -R[2] * slope;
    if (correct_at(p, s, &past, &row, range - expected, p->range.variance, SCALAR_RANGE,
                   AT_POSITION, &correction, seen)) {
      seen->height_used = true;
    }
    apply(&correction, s);
  }
}

/* Barometer: height plus its offset. */
static void use_pressure(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                         qt_real sample, qt_real ago, qt_estimate_t *seen) {
  past_t past;
  correction_t correction = {{0}, false};
  const qt_real pressure = sample * p->pressure.inverse_scale;
  if (pressure > 0.0f) {
    const qt_real height = p->pressure.linear
                               ? ((pressure - p->pressure.zero) * p->pressure.inverse_fall)
                               : qt_barometric_height(pressure, p->pressure.zero);
    const qt_real expected_offset = s->pressure_height;
    row_t row = {{0}, BY_POSITION | BY_PRESSURE};
    past_motion(p, s, ago, &past);
    row.by[AT_DOWN] = -1.0f;
    row.by[AT_PRESSURE] = 1.0f;
    if (correct_at(p, s, &past, &row, height - (expected_offset - past.motion.position[2]),
                   p->pressure.variance, SCALAR_PRESSURE, AT_POSITION, &correction, seen)) {
      seen->height_used = true;
    }
    apply(&correction, s);
  }
}

/* Magnetometer: the direction of the field's horizontal part is that of magnetic north. */
static void use_heading(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                        const qt_real field[3], qt_real ago, qt_estimate_t *seen) {
  past_t past;
  correction_t correction = {{0}, false};
  qt_real R[9];
  qt_real m[3];
  past_motion(p, s, ago, &past);
  qt_rotation_of_quaternion(past.motion.attitude, R);
  qt_times3(R, field, m);
  if (((m[0] * m[0]) + (m[1] * m[1])) > (1e-6f * qt_square3(m))) {
    const qt_real e = qt_wrapped(p->heading.declination - qt_atan2(m[1], m[0]));
    row_t row = {{0}, BY_TURN};
    for (int i = 0; i < 3; ++i) {
      row.by[AT_TURN + i] = p->heading.row[i];
    }
    (void)correct_at(p, s, &past, &row, e, p->heading.variance, SCALAR_HEADING, AT_TURN,
                     &correction, seen);
    apply(&correction, s);
  }
}

/* A position or a velocity in the world. */
static void use_vector(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                       const qt_aid_t *aid, const qt_real sample[3], qt_real ago, int scalar,
                       int first, qt_estimate_t *seen) {
  past_t past;
  correction_t correction = {{0}, false};
  past_motion(p, s, ago, &past);
  for (int axis = 0; axis < 3; ++axis) {
    const qt_real *from = (first == AT_POSITION) ? past.motion.position : past.motion.velocity;
    row_t row = {{0}, (first == AT_POSITION) ? BY_POSITION : BY_VELOCITY};
    row.by[first + axis] = 1.0f;
    (void)correct_at(p, s, &past, &row, (sample[axis] * aid->inverse_scale) - from[axis],
                     aid->variance, scalar + axis, first, &correction, seen);
  }
  apply(&correction, s);
}

/* A stationary vehicle has neither velocity nor rates, and its accelerometer measures gravity. As
 * this is certain, a large innovation means a large bias: nothing is rejected, and none of it
 * counts among the innovations. */
static void use_standing(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                         bool rates_came, bool force_came) {
  const qt_real no_gate = QT_INFINITY;
  qt_rejections_t none = {0.0f, 0.0f};
  qt_estimate_t unseen;
  correction_t correction = {{0}, false};
  qt_real R[9];
  const qt_reading_t *newest = reading(s, 0);
  (void)memset(&unseen, 0, sizeof unseen);
  qt_rotation_of_quaternion(s->motion.attitude, R);
  for (int i = 0; i < 3; ++i) {
    row_t still = {{0}, BY_VELOCITY};
    row_t turning = {{0}, BY_GYRO};
    row_t felt = {{0}, BY_TURN | BY_FORCE};
    still.by[AT_VELOCITY + i] = 1.0f;
    (void)correct(p, s, no_gate, &still, -s->motion.velocity[i], p->standing_variance, &none,
                  AT_VELOCITY, &correction, &unseen);
    if (rates_came) {
      turning.by[AT_GYRO + i] = 1.0f;
      (void)correct(p, s, no_gate, &turning, newest->rates[i] - s->gyro_bias[i],
                    p->gyro_variance[i], &none, AT_VELOCITY, &correction, &unseen);
    }
    if (force_came) { /* f = -g d + bias, by the turn: d = R' (e_z x turn) */
      felt.by[AT_FORCE + i] = 1.0f;
      felt.by[AT_TURN] = -p->gravity * R[3 + i];
      felt.by[AT_TURN + 1] = p->gravity * R[i];
      (void)correct(p, s, no_gate, &felt,
                    (newest->force[i] - (R[6 + i] * -p->gravity)) - s->force_bias[i],
                    p->force_variance[i], &none, AT_VELOCITY, &correction, &unseen);
    }
  }
  apply(&correction, s);
  if (s->P[place(AT_VELOCITY + 2, AT_VELOCITY + 2)] < p->lift_off_variance) {
    s->P[place(AT_VELOCITY + 2, AT_VELOCITY + 2)] = p->lift_off_variance;
  }
}

/* ---- one control period ---- */

/* Stores a sample and finds the one that the horizon reaches in this period.
 * values: sample of this period; receives the sample that is due
 * returns: whether one is due, and how long before the horizon it was taken */
static bool pass(const qt_estimator_parameters_t *p, qt_queue_t *queue, const qt_real values[3],
                 bool came, qt_real age, qt_real due[3], qt_real *ago) {
  bool found = false;
  queue->newest = place_before(queue->newest, QT_QUEUE);
  (void)memcpy(queue->values[queue->newest], values, sizeof queue->values[0]);
  queue->age[queue->newest] = age;
  queue->came[queue->newest] = came;
  /* If two samples are due at once, the newer one is used. */
  for (int k = 0; (k <= QT_HORIZON) && (k <= p->horizon); ++k) {
    const int behind = p->horizon - k;
    int i = queue->newest + behind;
    if (i >= QT_QUEUE) {
      i -= QT_QUEUE;
    }
    if (queue->came[i] && (queue->age[i] >= p->due[k]) &&
        ((behind == 0) || (queue->age[i] < p->due[k + 1]))) {
      (void)memcpy(due, queue->values[i], sizeof queue->values[0]);
      *ago = qt_max(queue->age[i] - p->behind[k], 0.0f);
      found = true;
    }
  }
  return found;
}

static bool pass_vector(const qt_estimator_parameters_t *p, qt_queue_t *queue,
                        const qt_vector_sample_t *sample, qt_real lag, qt_real due[3],
                        qt_real *ago) {
  return pass(p, queue, sample->value, sample->fresh && qt_all_finite(sample->value),
              sample->age + lag, due, ago);
}

static bool pass_scalar(const qt_estimator_parameters_t *p, qt_queue_t *queue,
                        const qt_scalar_sample_t *sample, qt_real lag, qt_real due[3],
                        qt_real *ago) {
  const qt_real values[3] = {sample->value, 0.0f, 0.0f};
  return pass(p, queue, values, sample->fresh && qt_is_finite(sample->value), sample->age + lag,
              due, ago);
}

/* Corrects with every sample that the horizon has reached. */
static void correct_by_samples(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                               const qt_sensors_t *sensors, qt_estimate_t *seen) {
  qt_real due[3] = {0.0f, 0.0f, 0.0f};
  qt_real ago = 0.0f;
  if (p->gps_position.present &&
      pass_vector(p, &s->gps_position, &sensors->gps_position, p->gps_position.lag, due, &ago)) {
    use_vector(p, s, &p->gps_position, due, ago, SCALAR_GPS_POSITION, AT_POSITION, seen);
  }
  if (p->gps_velocity.present &&
      pass_vector(p, &s->gps_velocity, &sensors->gps_velocity, p->gps_velocity.lag, due, &ago)) {
    use_vector(p, s, &p->gps_velocity, due, ago, SCALAR_GPS_VELOCITY, AT_VELOCITY, seen);
  }
  if (p->vision.present && pass_vector(p, &s->vision, &sensors->vision, p->vision.lag, due, &ago)) {
    use_vector(p, s, &p->vision, due, ago, SCALAR_VISION, AT_POSITION, seen);
  }
  if (p->flow.present) {
    const qt_real flow[3] = {sensors->flow.value[0], sensors->flow.value[1], 0.0f};
    if (pass(p, &s->flow, flow, sensors->flow.fresh && qt_all_finite(flow),
             sensors->flow.age + p->flow.lag, due, &ago)) {
      use_flow(p, s, due, ago, seen);
    }
  }
  if (p->range.present && pass_scalar(p, &s->range, &sensors->range, p->range.lag, due, &ago)) {
    use_range(p, s, due[0], ago, seen);
  }
  if (p->pressure.present &&
      pass_scalar(p, &s->pressure, &sensors->pressure, p->pressure.lag, due, &ago)) {
    use_pressure(p, s, due[0], ago, seen);
  }
  if (p->heading.present &&
      pass_vector(p, &s->field, &sensors->magnetic_field, p->heading.lag, due, &ago)) {
    use_heading(p, s, due, ago, seen);
  }
}

/* Stores the newest samples, with scale factors removed; a missing one is that before. */
static void take_readings(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                          const qt_sensors_t *sensors, bool rates_came, bool force_came) {
  const int place_of_newest = place_before(s->newest_reading, QT_READINGS);
  qt_reading_t *newest = &s->readings[place_of_newest];
  *newest = s->readings[s->newest_reading];
  s->newest_reading = place_of_newest;
  for (int i = 0; i < 3; ++i) {
    if (rates_came) {
      newest->rates[i] = sensors->rates.value[i] * p->gyro_inverse_scale[i];
    }
    if (force_came) {
      newest->force[i] = sensors->specific_force.value[i] * p->force_inverse_scale[i];
    }
  }
}

/* Advances the horizon by one period. */
static void predict(const qt_estimator_parameters_t *p, qt_estimator_state_t *s, bool standing) {
  if (!standing) {
    drive_t drive;
    qt_real turn[3];
    qt_real small[4];
    qt_real middle[4];
    qt_real R[9];
    qt_real gained[3];
    qt_real norm;
    drive_at(p, s, 0, &drive);
    for (int i = 0; i < 3; ++i) {
      turn[i] = drive.rates[i] * (0.5f * p->dt);
    }
    small_rotation(turn, small);
    qt_quaternion_product(s->motion.attitude, small, middle);
    qt_rotation_of_quaternion(middle, R);
    for (int i = 0; i < 3; ++i) {
      turn[i] = drive.rates[i] * p->dt;
    }
    move(&s->motion, turn, drive.force, p->gravity, p->dt);
    norm = 1.5f - (0.5f * qt_square4(s->motion.attitude)); /* one Newton step for 1/|q| */
    for (int i = 0; i < 4; ++i) {
      s->motion.attitude[i] *= norm;
    }
    qt_times3(R, drive.force, gained);
    for (int i = 0; i < 3; ++i) {
      gained[i] *= p->dt;
    }
    spread(s->P, R, gained, p->dt);
    add_body_noise(s->P, AT_VELOCITY, R, p->force_noise);
    add_body_noise(s->P, AT_TURN, R, p->gyro_noise);
  }
  for (int i = 0; i < 3; ++i) {
    s->P[place(AT_GYRO + i, AT_GYRO + i)] += p->gyro_walk;
    s->P[place(AT_FORCE + i, AT_FORCE + i)] += p->force_walk;
  }
  if (p->pressure.present) {
    s->P[place(AT_PRESSURE, AT_PRESSURE)] += p->pressure_walk;
  }
  for (int i = 0; i < QT_SCALARS; ++i) {
    s->rejections[i].time += p->dt;
  }
}

/* The 12 states of a motion. */
static void write_states(qt_estimator_state_t *s, const qt_motion_t *motion, const qt_real rates[3],
                         qt_estimate_t *estimate) {
  qt_real R[9];
  qt_real yaw;
  qt_rotation_of_quaternion(motion->attitude, R);
  estimate->roll = qt_atan2(R[7], R[8]);
  estimate->pitch = qt_atan2(-R[6], qt_sqrt((R[0] * R[0]) + (R[3] * R[3])));
  yaw = qt_atan2(R[3], R[0]);
  /* Unwrapped to the turn nearest to the previous yaw. */
  s->yaw = yaw + (QT_TWO_PI * qt_nearest((s->yaw - yaw) * QT_TURNS_PER_RADIAN));
  estimate->yaw = s->yaw;
  qt_transposed_times3(R, motion->velocity, estimate->velocity);
  for (int i = 0; i < 3; ++i) {
    estimate->position[i] = motion->position[i];
    estimate->rates[i] = rates[i];
  }
}

void qt_estimator_initialize(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                             const qt_start_t *start) {
  qt_real R[9];
  (void)memset(s, 0, sizeof *s);
  qt_rotation_of_euler(start->roll, start->pitch, start->yaw, R);
  qt_quaternion_of_euler(start->roll, start->pitch, start->yaw, s->motion.attitude);
  qt_times3(R, start->velocity, s->motion.velocity);
  s->yaw = start->yaw;
  s->pressure_height = start->pressure_height;
  for (int i = 0; i < 3; ++i) {
    s->motion.position[i] = start->position[i];
    s->gyro_bias[i] = start->gyro_bias[i];
    s->force_bias[i] = start->force_bias[i];
    s->readings[0].rates[i] = start->rates[i] + s->gyro_bias[i];
    s->readings[0].force[i] = (R[6 + i] * -p->gravity) + s->force_bias[i];
  }
  for (int i = 1; i < QT_READINGS; ++i) {
    s->readings[i] = s->readings[0];
  }
  for (int i = 0; i < QT_ERRORS; ++i) {
    s->P[place(i, i)] = p->start_variance[i];
  }
}

void qt_estimator_step(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                       const qt_sensors_t *sensors, qt_estimate_t *estimate) {
  const bool rates_came = sensors->rates.fresh && qt_all_finite(sensors->rates.value);
  const bool force_came =
      sensors->specific_force.fresh && qt_all_finite(sensors->specific_force.value);
  qt_motion_t now;
  qt_real rates[3] = {0.0f, 0.0f, 0.0f};
  (void)memset(estimate, 0, sizeof *estimate);
  take_readings(p, s, sensors, rates_came, force_came);
  predict(p, s, sensors->on_ground);
  if (sensors->on_ground) {
    use_standing(p, s, rates_came, force_came);
  }
  correct_by_samples(p, s, sensors, estimate);
  if (sensors->on_ground) {
    now = s->motion;
  } else {
    motion_now(p, s, &now);
    for (int i = 0; i < 3; ++i) {
      rates[i] = reading(s, 0)->rates[i] - s->gyro_bias[i];
    }
  }
  write_states(s, &now, rates, estimate);
}
