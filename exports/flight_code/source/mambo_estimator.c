/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The estimator of the Parrot Mambo, called once per control period:
 *
 * - Attitude, by a complementary filter: the rates of the gyroscope are integrated; the tilt that
 *   the accelerometer measures corrects roll and pitch.
 * - Height, by a Kalman filter of [z, vz]: driven by the vertical acceleration, corrected by the
 *   sonar.
 * - Velocity, by a Kalman filter of [vx, vy] in the world: driven by the horizontal acceleration,
 *   corrected by the optical flow after subtracting the effect of the body's rotation.
 * - Position, the integral of the velocity, corrected by positions from images, if there are any.
 *
 * The Kalman filters correct, x = x + K (y - C x), P = (I - K C) P (I - K C)' + K R K' with
 * K = P C' (C P C' + R)^-1, give their estimate, and predict the next period.
 */
#include "internal.h"

#define LEAST_TILT_COSINE 0.5f /* sonar and flow are not usable beyond 60 degrees of tilt */

void qt_estimator_initialize(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                             const qt_start_t *start) {
  qt_real R[9];
  qt_real velocity[3];
  (void)memset(s, 0, sizeof *s);
  qt_rotation_of_euler(start->roll, start->pitch, start->yaw, R);
  qt_times3(R, start->velocity, velocity);
  s->angles[0] = start->roll;
  s->angles[1] = start->pitch;
  s->angles[2] = start->yaw;
  for (int i = 0; i < 3; ++i) {
    s->gyro[i] = start->rates[i];
    s->force[i] = R[6 + i] * -p->gravity;
    s->gyro_bias[i] = start->gyro_bias[i];
    s->force_bias[i] = start->force_bias[i];
  }
  for (int i = 0; i < 2; ++i) {
    s->position[i] = start->position[i];
    s->flow_position[i] = start->position[i];
    s->velocity[i] = velocity[i];
  }
  s->height[0] = start->position[2];
  s->height[1] = velocity[2];
  s->echo_height = -start->position[2];
}

/* While the vehicle is stationary, the means of gyroscope and accelerometer are their biases. */
static void calibrate(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                      const qt_real gyro[3], bool gyro_fresh, bool force_fresh) {
  ++s->periods;
  for (int i = 0; i < 3; ++i) {
    s->gyro_sum[i] += gyro_fresh ? gyro[i] : 0.0f;
    s->force_sum[i] += force_fresh ? s->force[i] : 0.0f;
  }
  s->gyro_count += gyro_fresh ? 1.0f : 0.0f;
  s->force_count += force_fresh ? 1.0f : 0.0f;
  if (s->periods >= p->calibration_periods) {
    qt_real R[9];
    qt_rotation_of_euler(s->angles[0], s->angles[1], s->angles[2], R);
    for (int i = 0; i < 3; ++i) {
      s->gyro_bias[i] = s->gyro_sum[i] / qt_max(s->gyro_count, 1.0f);
      s->gyro[i] = gyro[i];
      if (s->force_count > 0.0f) {
        s->force_bias[i] =
            (s->force_sum[i] / qt_max(s->force_count, 1.0f)) - (R[6 + i] * -p->gravity);
      }
    }
  }
}

/* Rates of roll, pitch and yaw from body rates; kept finite near 90 degrees of pitch. */
static void euler_rates(qt_real roll, qt_real pitch, const qt_real rates[3], qt_real of_angles[3]) {
  const qt_real least = 0.05f;
  qt_real sr;
  qt_real cr;
  qt_real sp;
  qt_real cp;
  qt_real held;
  qt_sine_and_cosine(roll, &sr, &cr);
  qt_sine_and_cosine(pitch, &sp, &cp);
  held = (cp < 0.0f) ? qt_min(cp, -least) : qt_max(cp, least);
  of_angles[2] = ((rates[1] * sr) + (rates[2] * cr)) / held;
  of_angles[0] = rates[0] + (sp * of_angles[2]);
  of_angles[1] = (rates[1] * cr) - (rates[2] * sr);
}

/* The complementary filter. */
static void turn(const qt_estimator_parameters_t *p, qt_estimator_state_t *s, const qt_real gyro[3],
                 const qt_real force[3], bool force_fresh) {
  qt_real rates[3];
  qt_real before[3];
  qt_real half_way[3];
  qt_real at_half[3];
  const qt_real norm = qt_sqrt(qt_square3(force));
  const qt_real excess = qt_abs((norm / p->gravity) - 1.0f) / p->force_band;
  /* In free fall the specific force is near zero, and its direction is meaningless. */
  const bool felt = force_fresh && (norm > (0.1f * p->gravity));
  const qt_real weight = felt ? qt_max(1.0f - excess, 0.0f) : 0.0f;
  const qt_real alpha = (QT_DT / (p->attitude_time_constant + QT_DT)) * weight;
  const qt_real beta = alpha / p->bias_time_constant;
  const qt_real tilt_roll = qt_atan2(-force[1], -force[2]);
  const qt_real tilt_pitch =
      qt_atan2(force[0], qt_sqrt((force[1] * force[1]) + (force[2] * force[2])));
  qt_real roll_error;
  qt_real pitch_error;
  qt_real sr;
  qt_real cr;
  for (int i = 0; i < 3; ++i) {
    rates[i] = ((gyro[i] + s->gyro[i]) * 0.5f) - s->gyro_bias[i];
    s->gyro[i] = gyro[i];
  }
  euler_rates(s->angles[0], s->angles[1], rates, before);
  for (int i = 0; i < 3; ++i) {
    half_way[i] = s->angles[i] + (before[i] * (QT_DT * 0.5f));
  }
  euler_rates(half_way[0], half_way[1], rates, at_half);
  for (int i = 0; i < 3; ++i) {
    s->angles[i] += at_half[i] * QT_DT;
  }
  roll_error = qt_wrapped(tilt_roll - s->angles[0]);
  pitch_error = tilt_pitch - s->angles[1];
  s->angles[0] = qt_wrapped(s->angles[0] + (alpha * roll_error));
  s->angles[1] = qt_wrapped(s->angles[1] + (alpha * pitch_error));
  qt_sine_and_cosine(s->angles[0], &sr, &cr);
  s->gyro_bias[0] -= beta * roll_error;
  s->gyro_bias[1] -= (beta * cr) * pitch_error;
  s->gyro_bias[2] += (beta * sr) * pitch_error;
}

/* Replaces the off-diagonal entries by their mean, because rounding makes them differ. */
static void symmetrize(qt_real P[4]) {
  const qt_real mean = 0.5f * (P[1] + P[2]);
  P[1] = mean;
  P[2] = mean;
}

/* Corrects [z, vz] with a height y = z + v. */
static bool use_height(const qt_estimator_parameters_t *p, qt_estimator_state_t *s, qt_real y,
                       qt_estimate_t *estimate) {
  qt_real *P = s->height_P;
  const qt_real S = p->altitude_R + P[0];
  const qt_real e = y - s->height[0];
  const bool used = qt_is_finite(e) && (S > 0.0f);
  if (used) {
    const qt_real K[2] = {P[0] / S, P[2] / S};
    const qt_real a = 1.0f - K[0]; /* I - K C = [a 0; -K1 1] */
    const qt_real AP[4] = {a * P[0], a * P[1], (-K[1] * P[0]) + P[2], (-K[1] * P[1]) + P[3]};
    estimate->innovation_square += (e * e) / S;
    estimate->innovation_freedom += 1.0f;
    P[0] = (AP[0] * a) + ((K[0] * K[0]) * p->altitude_R);
    P[1] = ((AP[0] * -K[1]) + AP[1]) + ((K[0] * K[1]) * p->altitude_R);
    P[2] = (AP[2] * a) + ((K[1] * K[0]) * p->altitude_R);
    P[3] = ((AP[2] * -K[1]) + AP[3]) + ((K[1] * K[1]) * p->altitude_R);
    symmetrize(P);
    s->height[0] += K[0] * e;
    s->height[1] += K[1] * e;
  }
  return used;
}

/* After a time without an echo near the estimate, a steady echo restarts the filter. */
static void correct_height(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                           const qt_scalar_sample_t *sonar, const qt_real R[9], bool upright,
                           qt_estimate_t *estimate) {
  const qt_real echo_height = sonar->value * R[8];
  /* Comparisons with NaN, which means no echo, are false. */
  const bool echo = sonar->fresh && upright && (sonar->value >= p->sonar_least) &&
                    (sonar->value <= p->sonar_greatest);
  const bool steady = echo && (qt_abs(echo_height - s->echo_height) <= p->sonar_jump);
  const bool near = qt_abs(echo_height + s->height[0]) <= p->sonar_deviation;
  if (steady && near) {
    estimate->height_used = use_height(p, s, -echo_height, estimate);
  } else if (steady && (s->unbelieved_time >= p->sonar_recovery_time)) {
    s->height[0] = -echo_height;
    s->height_P[0] = p->altitude_R;
    s->height_P[1] = 0.0f;
    s->height_P[2] = 0.0f;
    s->height_P[3] = 1.0f; /* the speed is known to a metre a second */
    estimate->height_used = true;
  } else {
    /* No sample of this period is used. */
  }
  s->echo_height = echo ? echo_height : s->echo_height;
  s->unbelieved_time = estimate->height_used ? 0.0f : (s->unbelieved_time + QT_DT);
}
#if QT_WITH_ALIGNED_FLOW

/* Stores the flow and the rates of this period, and subtracts the body's rotation at the time of
 * its image from the flow for which this has become possible. Returns whether there is one. */
static bool aligned_flow(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                         const qt_real rates[3], const qt_flow_sample_t *flow, bool fresh,
                         qt_real translation[2]) {
  bool any_due = false;
  for (int k = 1; k < QT_MOMENTS; ++k) {
    s->moments[QT_MOMENTS - k] = s->moments[(QT_MOMENTS - k) - 1];
  }
  for (int i = 0; i < 2; ++i) {
    s->moments[0].rates[i] = rates[i];
    s->moments[0].flow[i] = flow->value[i];
  }
  s->moments[0].age = flow->age;
  s->moments[0].came = fresh;
  for (int k = 1; k <= QT_MOMENTS; ++k) {
    const int j = QT_MOMENTS - k;
    const qt_flow_moment_t *moment = &s->moments[j];
    /* Control periods since the gyroscope's samples covered the time of the image. */
    const qt_real ago = ((moment->age - p->gyro_lag) / QT_DT) + (qt_real)j;
    const bool covered = ago > -1e-6f;
    if (moment->came && covered && ((j == 0) || !(ago > 0.999999f))) {
      const int last = QT_MOMENTS - 1;
      const qt_real back = qt_clamp(ago, 0.0f, (qt_real)last);
      qt_real turning[2] = {0.0f, 0.0f};
      for (int i = 0; i < QT_MOMENTS; ++i) {
        /* Linear interpolation between two samples. */
        const qt_real weight = qt_max(1.0f - qt_abs(back - (qt_real)i), 0.0f);
        turning[0] += s->moments[i].rates[0] * weight;
        turning[1] += s->moments[i].rates[1] * weight;
      }
      translation[0] = moment->flow[0] + (p->flow_compensation[0] * turning[1]);
      translation[1] = moment->flow[1] - (p->flow_compensation[1] * turning[0]);
      any_due = true;
    }
  }
  return any_due;
}
#endif

/* The horizontal velocity in the world from the newest flow: flow = -velocity / depth along body z;
 * the third component follows from vz. */
static void velocity_of_flow(const qt_estimator_parameters_t *p, const qt_estimator_state_t *s,
                             const qt_real R[9], qt_real velocity[2]) {
  const qt_real cosine = qt_max(R[8], LEAST_TILT_COSINE);
  const qt_real depth = -s->height[0] / cosine;
  const qt_real u = -(s->flow[0] * p->flow_scale) * depth;
  const qt_real v = -(s->flow[1] * p->flow_scale) * depth;
  const qt_real w = ((s->height[1] - (R[6] * u)) - (R[7] * v)) / cosine;
  velocity[0] = ((R[0] * u) + (R[1] * v)) + (R[2] * w);
  velocity[1] = ((R[3] * u) + (R[4] * v)) + (R[5] * w);
}

/* Corrects [vx, vy] with a velocity y = [vx, vy] + v. */
static void use_velocity(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                         const qt_real y[2], qt_estimate_t *estimate) {
  qt_real *P = s->velocity_P;
  const qt_real S[4] = {P[0] + p->velocity_R, P[1], P[2], P[3] + p->velocity_R};
  const qt_real e[2] = {y[0] - s->velocity[0], y[1] - s->velocity[1]};
  const qt_real determinant = (S[0] * S[3]) - (S[1] * S[2]);
  estimate->flow_used =
      qt_is_finite(e[0]) && qt_is_finite(e[1]) && (S[0] > 0.0f) && (determinant > 0.0f);
  if (estimate->flow_used) {
    const qt_real S_inv[4] = {S[3] / determinant, -S[1] / determinant, -S[2] / determinant,
                              S[0] / determinant};
    qt_real K[4];
    qt_real A[4];
    qt_real AP[4];
    estimate->innovation_square += (e[0] * ((S_inv[0] * e[0]) + (S_inv[1] * e[1]))) +
                                   (e[1] * ((S_inv[2] * e[0]) + (S_inv[3] * e[1])));
    estimate->innovation_freedom += 2.0f;
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) {
        K[(2 * i) + j] = (P[2 * i] * S_inv[j]) + (P[(2 * i) + 1] * S_inv[2 + j]);
        A[(2 * i) + j] = ((i == j) ? 1.0f : 0.0f) - K[(2 * i) + j];
      }
    }
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) {
        AP[(2 * i) + j] = (A[2 * i] * P[j]) + (A[(2 * i) + 1] * P[2 + j]);
      }
    }
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) {
        P[(2 * i) + j] = ((AP[2 * i] * A[2 * j]) + (AP[(2 * i) + 1] * A[(2 * j) + 1])) +
                         (((K[2 * i] * p->velocity_R) * K[2 * j]) +
                          ((K[(2 * i) + 1] * p->velocity_R) * K[(2 * j) + 1]));
      }
    }
    symmetrize(P);
    for (int i = 0; i < 2; ++i) {
      s->velocity[i] += (K[2 * i] * e[0]) + (K[(2 * i) + 1] * e[1]);
    }
  }
}

/* Returns whether the newest flow is accepted; `measured` receives its velocity. */
static bool correct_velocity(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                             const qt_flow_sample_t *flow, const qt_real rates[3],
                             const qt_real R[9], bool upright, qt_real measured[2],
                             qt_estimate_t *estimate) {
  const bool fresh = flow->fresh && (flow->age >= 0.0f) && qt_is_finite(flow->value[0]) &&
                     qt_is_finite(flow->value[1]);
  qt_real translation[2] = {0.0f, 0.0f};
  bool valid;
#if QT_WITH_ALIGNED_FLOW
  const bool due = aligned_flow(p, s, rates, flow, fresh, translation);
#else
  const bool due = fresh;
  translation[0] = flow->value[0] + (p->flow_compensation[0] * rates[1]);
  translation[1] = flow->value[1] - (p->flow_compensation[1] * rates[0]);
#endif
  if (due) {
    (void)memcpy(s->flow, translation, sizeof s->flow);
  }
  s->flow_age = due ? 0.0f : (s->flow_age + QT_DT);
  s->flow_seen = s->flow_seen || due;
  velocity_of_flow(p, s, R, measured);
  valid = s->flow_seen && (s->flow_age <= p->flow_timeout) && upright &&
          (-s->height[0] >= p->flow_least_height);
  if (valid && (p->hold_flow || due)) {
    use_velocity(p, s, measured, estimate);
  }
  return valid;
}

/* Corrects with positions from images, propagated over the delay of the image. */
static void correct_position(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                             const qt_vector_sample_t *vision) {
  if (vision->fresh && (vision->age >= 0.0f) && qt_all_finite(vision->value)) {
    const qt_real variance = s->position_variance;
    const qt_real gain = variance / (variance + p->vision_R);
    for (int i = 0; i < 2; ++i) {
      const qt_real fix = vision->value[i] + (s->velocity[i] * vision->age);
      s->flow_position[i] += (fix - s->flow_position[i]) * gain;
      s->position[i] += (fix - s->position[i]) * gain;
    }
    s->position_variance -= gain * variance;
  }
}

/* Predicts the start of the next period. */
static void predict(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                    const qt_real acceleration[3], const qt_real flow_velocity[2], bool valid) {
  qt_real *P = s->height_P;
  qt_real FP[2]; /* the first row of F P; the second is that of P */
  for (int i = 0; i < 2; ++i) {
    s->position[i] += s->velocity[i] * QT_DT;
    s->flow_position[i] += valid ? (flow_velocity[i] * QT_DT) : 0.0f;
  }
  s->position_variance += p->position_Q;
  s->height[0] += QT_DT * s->height[1];
  s->height[1] += QT_DT * acceleration[2];
  FP[0] = P[0] + (QT_DT * P[2]);
  FP[1] = P[1] + (QT_DT * P[3]);
  P[0] = FP[0] + (FP[1] * QT_DT);
  P[1] = FP[1];
  P[2] = P[2] + (P[3] * QT_DT);
  P[3] += p->altitude_Q;
  symmetrize(P);
  for (int i = 0; i < 2; ++i) {
    s->velocity[i] += QT_DT * acceleration[i];
  }
  s->velocity_P[0] += p->velocity_Q;
  s->velocity_P[3] += p->velocity_Q;
}

/* One control period of a vehicle that may move. */
static void estimate_motion(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                            const qt_sensors_t *sensors, const qt_real gyro[3], bool force_fresh,
                            qt_estimate_t *estimate) {
  qt_real R[9]; /* from body axes to world axes */
  qt_real force[3];
  qt_real rates[3];
  qt_real acceleration[3]; /* world, gravity added [m/s^2] */
  qt_real flow_velocity[2];
  qt_real velocity[3];
  bool upright;
  bool valid;
  for (int i = 0; i < 3; ++i) {
    force[i] = s->force[i] - s->force_bias[i];
  }
  turn(p, s, gyro, force, force_fresh);
  for (int i = 0; i < 3; ++i) {
    rates[i] = gyro[i] - s->gyro_bias[i];
  }
  qt_rotation_of_euler(s->angles[0], s->angles[1], s->angles[2], R);
  qt_times3(R, force, acceleration);
  acceleration[2] += p->gravity;
  upright = R[8] > LEAST_TILT_COSINE;
  correct_height(p, s, &sensors->range, R, upright, estimate);
  valid = correct_velocity(p, s, &sensors->flow, rates, R, upright, flow_velocity, estimate);
  correct_position(p, s, &sensors->vision);
  velocity[0] = s->velocity[0];
  velocity[1] = s->velocity[1];
  velocity[2] = s->height[1];
  for (int i = 0; i < 2; ++i) {
    estimate->position[i] = p->position_of_flow ? s->flow_position[i] : s->position[i];
  }
  estimate->position[2] = s->height[0];
  qt_transposed_times3(R, velocity, estimate->velocity);
  (void)memcpy(estimate->rates, rates, sizeof estimate->rates);
  predict(p, s, acceleration, flow_velocity, valid);
}

void qt_estimator_step(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                       const qt_sensors_t *sensors, qt_estimate_t *estimate) {
  const bool gyro_fresh = sensors->rates.fresh && qt_all_finite(sensors->rates.value);
  const bool force_fresh =
      sensors->specific_force.fresh && qt_all_finite(sensors->specific_force.value);
  qt_real gyro[3];
  (void)memset(estimate, 0, sizeof *estimate);
  for (int i = 0; i < 3; ++i) {
    gyro[i] = gyro_fresh ? sensors->rates.value[i] : s->gyro[i];
    s->force[i] = force_fresh ? sensors->specific_force.value[i] : s->force[i];
  }
  if (s->periods < p->calibration_periods) {
    calibrate(p, s, gyro, gyro_fresh, force_fresh);
    estimate->position[0] = s->position[0];
    estimate->position[1] = s->position[1];
    estimate->position[2] = s->height[0];
  } else {
    estimate_motion(p, s, sensors, gyro, force_fresh, estimate);
  }
  estimate->roll = s->angles[0];
  estimate->pitch = s->angles[1];
  estimate->yaw = s->angles[2];
}
