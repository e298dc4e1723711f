/* SPDX-License-Identifier: Apache-2.0 */
/* Sine, cosine, arc tangent, logarithm and exponential function in single precision: errors of at
 * most 1.5 2^-24 (sine and cosine), 3 units in the last place (arc tangent), 1 (the others). */
#include "maths.h"

/* The bits of a number, and back. */
static uint32_t bits_of(qt_real x) {
  uint32_t bits;
  (void)memcpy(&bits, &x, sizeof bits);
  return bits;
}
#if QT_WITH_LOGARITHM
static qt_real real_of(uint32_t bits) {
  qt_real x;
  (void)memcpy(&x, &bits, sizeof x);
  return x;
}
#endif

/* Sine and cosine: x = k pi/2 + r, then polynomials in r. For |x| <= 8192. */
void qt_sine_and_cosine(qt_real x, qt_real *sine, qt_real *cosine) {
  const qt_real k = qt_nearest(x * 0.6366197723675814f);
  /* pi/2 in three parts: k times the first two is exact. */
  const qt_real r =
      ((x - (k * 1.5703125f)) - (k * 4.837512969970703125e-4f)) - (k * 7.549789948768648e-8f);
  const qt_real z = r * r;
  const qt_real s =
      r + ((r * z) * ((((-1.9515295891e-4f * z) + 8.3321608736e-3f) * z) - 1.6666654611e-1f));
  const qt_real c = (1.0f - (0.5f * z)) +
                    ((z * z) * ((((2.443315711809948e-5f * z) - 1.388731625493765e-3f) * z) +
                                4.166664568298827e-2f));
  /* k modulo 4: the last bits of k + 1.5 2^23 are those of the integer k. */
  const uint32_t quarter = bits_of(k + QT_ROUNDING) & 3u;
  const bool odd = (quarter & 1u) != 0u;
  const qt_real a = odd ? c : s;
  const qt_real b = odd ? s : c;
  *sine = (quarter >= 2u) ? -a : a;
  *cosine = ((quarter == 1u) || (quarter == 2u)) ? -b : b;
}

/* The arc tangent of 0 <= x <= 1. */
static qt_real arc_tangent(qt_real x) {
  const bool large = x > 0.4142135623730950f; /* tan pi/8 */
  const qt_real y = large ? ((x - 1.0f) / (x + 1.0f)) : x;
  const qt_real z = y * y;
  qt_real angle =
      ((((((((8.05374449538e-2f * z) - 1.38776856032e-1f) * z) + 1.99777106478e-1f) * z) -
         3.33329491539e-1f) *
        z) *
       y) +
      y;
  if (large) {
    angle += 0.7853981633974483f;
  }
  return angle;
}

/* In [-pi, pi]; 0 for x = y = 0. */
qt_real qt_atan2(qt_real y, qt_real x) {
  const qt_real ay = qt_abs(y);
  const qt_real ax = qt_abs(x);
  const qt_real most = qt_max(ay, ax);
  qt_real angle = arc_tangent((most > 0.0f) ? (qt_min(ay, ax) / most) : 0.0f);
  if (ay > ax) {
    angle = QT_HALF_PI - angle;
  }
  if (x < 0.0f) {
    angle = QT_PI - angle;
  }
  return (ay <= QT_INFINITY) && (ax <= QT_INFINITY) ? ((y < 0.0f) ? -angle : angle)
                                                    : (y + x); /* NaN stays NaN */
}

#if QT_WITH_LOGARITHM
/* Natural logarithm of normal numbers > 0. */
qt_real qt_natural_logarithm(qt_real x) {
  const uint32_t bits = bits_of(x);
  const uint32_t exponent = (bits >> 23) & 0xffu;
  qt_real e = (qt_real)exponent - 126.0f;
  qt_real m = real_of((bits & 0x007fffffu) | 0x3f000000u); /* 1/2 <= m < 1 */
  qt_real z;
  qt_real y;
  if (m < 0.707106781186547524f) {
    e -= 1.0f;
    m += m;
  }
  m -= 1.0f;
  z = m * m;
  y = 7.0376836292e-2f;
  y = (y * m) - 1.1514610310e-1f;
  y = (y * m) + 1.1676998740e-1f;
  y = (y * m) - 1.2420140846e-1f;
  y = (y * m) + 1.4249322787e-1f;
  y = (y * m) - 1.6668057665e-1f;
  y = (y * m) + 2.0000714765e-1f;
  y = (y * m) - 2.4999993993e-1f;
  y = (y * m) + 3.3333331174e-1f;
  y = (y * m) * z;
  y = (y - (e * 2.12194440e-4f)) - (0.5f * z);
  return (m + y) + (e * 0.693359375f);
}

/* For |x| <= 80. */
qt_real qt_exponential(qt_real x) {
  const qt_real bounded = qt_clamp(x, -80.0f, 80.0f);
  const qt_real n = qt_nearest(bounded * 1.44269504088896341f);
  const qt_real r = (bounded - (n * 0.693359375f)) + (n * 2.12194440e-4f);
  const uint32_t power = (bits_of(n + QT_ROUNDING) - bits_of(QT_ROUNDING) + 127u) << 23;
  qt_real y = 1.9875691500e-4f;
  y = (y * r) + 1.3981999507e-3f;
  y = (y * r) + 8.3334519073e-3f;
  y = (y * r) + 4.1665795894e-2f;
  y = (y * r) + 1.6666665459e-1f;
  y = (y * r) + 5.0000001201e-1f;
  y = ((y * (r * r)) + r) + 1.0f;
  return (x <= QT_INFINITY) ? (y * real_of(power)) : x; /* NaN stays NaN */
}
#endif
