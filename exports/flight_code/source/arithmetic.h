/* SPDX-License-Identifier: Apache-2.0 */
/* Clamping, and requirements on how the compiler evaluates sums and products. */
#ifndef QT_ARITHMETIC_H
#define QT_ARITHMETIC_H

#include <float.h>

#include "program.h"

/* Expressions must be evaluated as written, and in no wider type. */
#if defined(__FAST_MATH__)
#error "expected a compiler without -ffast-math"
#endif
#if QT_WITH_DOUBLE
#if (FLT_EVAL_METHOD != 0) && (FLT_EVAL_METHOD != 1)
#error "expected double arithmetic in double precision, e.g. by -mfpmath=sse"
#endif
#define QT_REAL_MAX 1.7976931348623157e+308
#else
#if FLT_EVAL_METHOD != 0
#error "expected float arithmetic in single precision, e.g. by -mfpmath=sse"
#endif
#define QT_REAL_MAX 3.402823466e+38f
#endif

static inline qt_real qt_min(qt_real a, qt_real b) { return (a < b) ? a : b; }
static inline qt_real qt_max(qt_real a, qt_real b) { return (a > b) ? a : b; }
/* x within low <= high; low if x is NaN. */
static inline qt_real qt_clamp(qt_real x, qt_real low, qt_real high) {
  return qt_min(qt_max(x, low), high);
}
static inline qt_real qt_abs(qt_real x) { return (x < 0.0f) ? -x : x; }
static inline bool qt_is_finite(qt_real x) { return qt_abs(x) <= QT_REAL_MAX; }

#endif /* QT_ARITHMETIC_H */
