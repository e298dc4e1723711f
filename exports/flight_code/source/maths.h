/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Arithmetic of the flight program: small vectors and matrices (row by row), and sine, cosine, arc
 * tangent, logarithm and exponential function that use only sums, products and quotients, so that
 * every processor and every C library gives the same bits. Coefficients: Cephes (S. L. Moshier).
 */
#ifndef QT_MATHS_H
#define QT_MATHS_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "arithmetic.h"

/* (x + QT_ROUNDING) - QT_ROUNDING is an integer. */
#if QT_WITH_DOUBLE
#define QT_ROUNDING 6755399441055744.0 /* 1.5 2^52 */
#else
#define QT_ROUNDING 12582912.0f /* 1.5 2^23 */
#endif
#define QT_INFINITY ((qt_real)INFINITY)
#define QT_PI 3.14159265358979323846f
#define QT_HALF_PI 1.57079632679489661923f
#if QT_WITH_ESTIMATOR
#define QT_TWO_PI 6.28318530717958647693f
#define QT_TURNS_PER_RADIAN 0.159154943091895335769f
#endif

static inline qt_real qt_sqrt(qt_real x) { return sqrtf(x); }
/* The nearest integer, ties to even, for |x| < 2^21. */
static inline qt_real qt_nearest(qt_real x) { return (x + QT_ROUNDING) - QT_ROUNDING; }

/* For |x| <= 8192 rad. */
void qt_sine_and_cosine(qt_real x, qt_real *sine, qt_real *cosine);
/* In [-pi, pi]; 0 for x = y = 0. */
qt_real qt_atan2(qt_real y, qt_real x);
#if QT_WITH_LOGARITHM
/* For normal numbers > 0. */
qt_real qt_natural_logarithm(qt_real x);
/* For |x| <= 80. */
qt_real qt_exponential(qt_real x);

/* The height in the standard atmosphere at which the pressure is `pressure`, above the height at
 * which it is `zero` [m]. */
static inline qt_real qt_barometric_height(qt_real pressure, qt_real zero) {
  return 44330.0f * (1.0f - qt_exponential(0.190295f * qt_natural_logarithm(pressure / zero)));
}
#endif
#if QT_WITH_ESTIMATOR

/* The angle minus whole turns, in [-pi, pi] [rad]. */
static inline qt_real qt_wrapped(qt_real angle) {
  return angle - (QT_TWO_PI * qt_nearest(angle * QT_TURNS_PER_RADIAN));
}
#endif

static inline bool qt_all_finite(const qt_real x[3]) {
  bool finite = true;
  for (int i = 0; i < 3; ++i) {
    finite = finite && qt_is_finite(x[i]);
  }
  return finite;
}

/* y = M x */
static inline void qt_times3(const qt_real M[9], const qt_real x[3], qt_real y[3]) {
  for (int i = 0; i < 3; ++i) {
    y[i] = (M[3 * i] * x[0]) + ((M[(3 * i) + 1] * x[1]) + (M[(3 * i) + 2] * x[2]));
  }
}
/* Entry i of M' x. */
static inline qt_real qt_column_times3(const qt_real M[9], int i, const qt_real x[3]) {
  return (M[i] * x[0]) + ((M[3 + i] * x[1]) + (M[6 + i] * x[2]));
}
/* y = M' x */
static inline void qt_transposed_times3(const qt_real M[9], const qt_real x[3], qt_real y[3]) {
  for (int i = 0; i < 3; ++i) {
    y[i] = qt_column_times3(M, i, x);
  }
}
#if QT_WITH_ESTIMATOR
static inline qt_real qt_square3(const qt_real x[3]) {
  return (x[0] * x[0]) + ((x[1] * x[1]) + (x[2] * x[2]));
}
#endif
#if QT_WITH_GENERAL
static inline qt_real qt_square4(const qt_real x[4]) {
  return ((x[0] * x[0]) + (x[1] * x[1])) + ((x[2] * x[2]) + (x[3] * x[3]));
}
/* c = a x b */
static inline void qt_cross(const qt_real a[3], const qt_real b[3], qt_real c[3]) {
  c[0] = (a[1] * b[2]) - (a[2] * b[1]);
  c[1] = (a[2] * b[0]) - (a[0] * b[2]);
  c[2] = (a[0] * b[1]) - (a[1] * b[0]);
}

/* Quaternions are (w, x, y, z). c = a b; c may not be a or b. */
void qt_quaternion_product(const qt_real a[4], const qt_real b[4], qt_real c[4]);
void qt_quaternion_of_euler(qt_real roll, qt_real pitch, qt_real yaw, qt_real q[4]);
void qt_rotation_of_quaternion(const qt_real q[4], qt_real R[9]);
#endif
/* R = Rz(yaw) Ry(pitch) Rx(roll) takes components in body axes to components in world axes. */
void qt_rotation_of_euler(qt_real roll, qt_real pitch, qt_real yaw, qt_real R[9]);

#endif /* QT_MATHS_H */
