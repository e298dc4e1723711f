/* SPDX-License-Identifier: Apache-2.0 */
/* Sine, cosine, arc tangent, logarithm and exponential function in double precision: errors of at
 * most 2 units in the last place, for the arc tangent 4. */
#include "maths.h"

#define MOST_COEFFICIENTS 6 /* of a polynomial below */

/* The bits of a number, and back. */
static uint64_t bits_of(qt_real x) {
  uint64_t bits;
  (void)memcpy(&bits, &x, sizeof bits);
  return bits;
}
#if QT_WITH_LOGARITHM
static qt_real real_of(uint64_t bits) {
  qt_real x;
  (void)memcpy(&x, &bits, sizeof x);
  return x;
}
#endif

/* c[0] x^(count - 1) + ... + c[count - 1]. */
static qt_real polynomial(qt_real x, const qt_real *c, int count) {
  qt_real sum = c[0];
  for (int i = 1; (i < MOST_COEFFICIENTS) && (i < count); ++i) {
    sum = (sum * x) + c[i];
  }
  return sum;
}
/* x^count + c[0] x^(count - 1) + ... + c[count - 1]. */
static qt_real monic_polynomial(qt_real x, const qt_real *c, int count) {
  qt_real sum = x + c[0];
  for (int i = 1; (i < MOST_COEFFICIENTS) && (i < count); ++i) {
    sum = (sum * x) + c[i];
  }
  return sum;
}

/* Sine and cosine: x = k pi/2 + r, then polynomials in r. For |x| <= 1e5. */
void qt_sine_and_cosine(qt_real x, qt_real *sine, qt_real *cosine) {
  static const qt_real of_sine[6] = {1.58969099521155010221e-10, -2.50507602534068634195e-08,
                                     2.75573137070700676789e-06, -1.98412698298579493134e-04,
                                     8.33333333332248946124e-03, -1.66666666666666324348e-01};
  static const qt_real of_cosine[6] = {-1.13596475577881948265e-11, 2.08757232129817482790e-09,
                                       -2.75573143513906633035e-07, 2.48015872894767294178e-05,
                                       -1.38888888888741095749e-03, 4.16666666666666019037e-02};
  const qt_real k = qt_nearest(x * 0.63661977236758134308);
  /* pi/2 in three parts of 33, 33 and 53 bits: k times the first two is exact. */
  const qt_real r = ((x - (k * 1.57079632673412561417)) - (k * 6.07710050630396597660e-11)) -
                    (k * 2.02226624879595063154e-21);
  const qt_real z = r * r;
  const qt_real s = r + ((r * z) * polynomial(z, of_sine, 6));
  const qt_real c = (1.0 - (0.5 * z)) + ((z * z) * polynomial(z, of_cosine, 6));
  /* k modulo 4: the last bits of k + 1.5 2^52 are those of the integer k. */
  const uint64_t quarter = bits_of(k + QT_ROUNDING) & 3u;
  const bool odd = (quarter & 1u) != 0u;
  const qt_real a = odd ? c : s;
  const qt_real b = odd ? s : c;
  *sine = (quarter >= 2u) ? -a : a;
  *cosine = ((quarter == 1u) || (quarter == 2u)) ? -b : b;
}

/* The arc tangent of 0 <= x <= 1. */
static qt_real arc_tangent(qt_real x) {
  static const qt_real above[5] = {-8.750608600031904122785e-1, -1.615753718733365076637e1,
                                   -7.500855792314704667340e1, -1.228866684490136173410e2,
                                   -6.485021904942025371773e1};
  static const qt_real below[5] = {2.485846490142306297962e1, 1.650270098316988542046e2,
                                   4.328810604912902668951e2, 4.853903996359136964868e2,
                                   1.945506571482613964425e2};
  const bool large = x > 0.66;
  const qt_real y = large ? ((x - 1.0) / (x + 1.0)) : x;
  const qt_real z = y * y;
  const qt_real ratio = (z * polynomial(z, above, 5)) / monic_polynomial(z, below, 5);
  qt_real angle = (y * ratio) + y;
  if (large) { /* pi/4 has a part beyond a double */
    angle = 0.78539816339744830962 + (angle + 3.061616997868382943065e-17);
  }
  return angle;
}

qt_real qt_atan2(qt_real y, qt_real x) {
  const qt_real ay = qt_abs(y);
  const qt_real ax = qt_abs(x);
  const qt_real most = qt_max(ay, ax);
  qt_real angle = arc_tangent((most > 0.0) ? (qt_min(ay, ax) / most) : 0.0);
  if (ay > ax) {
    angle = QT_HALF_PI - angle;
  }
  if (x < 0.0) {
    angle = QT_PI - angle;
  }
  return (ay <= QT_INFINITY) && (ax <= QT_INFINITY) ? ((y < 0.0) ? -angle : angle)
                                                    : (y + x); /* NaN stays NaN */
}
#if QT_WITH_LOGARITHM

/* Natural logarithm of normal numbers > 0. */
qt_real qt_natural_logarithm(qt_real x) {
  static const qt_real above[6] = {1.01875663804580931796e-4, 4.97494994976747001425e-1,
                                   4.70579119878881725854e0,  1.44989225341610930846e1,
                                   1.79368678507819816313e1,  7.70838733755885391666e0};
  static const qt_real below[5] = {1.12873587189167450590e1, 4.52279145837532221105e1,
                                   8.29875266912776603211e1, 7.11544750618563894466e1,
                                   2.31251620126765340583e1};
  const uint64_t bits = bits_of(x);
  const uint32_t exponent = (uint32_t)((bits >> 52) & 0x7ffu);
  qt_real e = (qt_real)exponent - 1022.0;
  qt_real m = real_of((bits & 0x000fffffffffffffu) | 0x3fe0000000000000u); /* 1/2 <= m < 1 */
  qt_real z;
  qt_real y;
  if (m < 0.70710678118654752440) {
    e -= 1.0;
    m += m;
  }
  m -= 1.0;
  z = m * m;
  y = m * ((z * polynomial(m, above, 6)) / monic_polynomial(m, below, 5));
  y = (y - (e * 2.121944400546905827679e-4)) - (0.5 * z);
  return (m + y) + (e * 0.693359375);
}

/* For |x| <= 700. */
qt_real qt_exponential(qt_real x) {
  static const qt_real above[3] = {1.26177193074810590878e-4, 3.02994407707441961300e-2,
                                   9.99999999999999999910e-1};
  static const qt_real below[4] = {3.00198505138664455042e-6, 2.52448340349684104192e-3,
                                   2.27265548208155028766e-1, 2.00000000000000000009e0};
  const qt_real bounded = qt_clamp(x, -700.0, 700.0);
  const qt_real n = qt_nearest(bounded * 1.44269504088896340736);
  const qt_real r = (bounded - (n * 6.93145751953125e-1)) - (n * 1.42860682030941723212e-6);
  const qt_real z = r * r;
  const qt_real p = r * polynomial(z, above, 3);
  const qt_real ratio = p / (polynomial(z, below, 4) - p);
  const qt_real y = 1.0 + (ratio + ratio);
  const uint64_t power = ((bits_of(n + QT_ROUNDING) - bits_of(QT_ROUNDING)) + 1023u) << 52;
  return (x <= QT_INFINITY) ? (y * real_of(power)) : x; /* NaN stays NaN */
}
#endif
