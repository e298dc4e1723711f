/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The steady Kalman filters of the design of `qt`:
 *
 * @FILTERS@
 *
 * One step of a filter in each of its periods, u the inputs and y the measurements of the period:
 *
 *   e = y - C x, estimate = x + M e      qt_kalman_correct()
 *   x = A x + B u + L e                  qt_kalman_predict()
 *
 * The two are separate so that u may depend on the estimate. A design without covariance between
 * the noises of process and measurement has L = A M: the prediction then starts from the estimate.
 * For the control law of the program, write the estimate into a structure qt_estimate_t.
 */
#ifndef QT_KALMAN_H
#define QT_KALMAN_H

#include "program.h"

#define QT_KALMAN_FILTERS 1
#define QT_KALMAN_STATES 12      /* of the largest filter */
#define QT_KALMAN_INPUTS 4       /* likewise */
#define QT_KALMAN_MEASUREMENTS 6 /* likewise */

/* Unused entries are 0. */
typedef struct {
  int states;
  int inputs;
  int measurements;
  qt_real A[QT_KALMAN_STATES][QT_KALMAN_STATES];
  qt_real B[QT_KALMAN_STATES][QT_KALMAN_INPUTS];
  qt_real C[QT_KALMAN_MEASUREMENTS][QT_KALMAN_STATES];
  qt_real M[QT_KALMAN_STATES][QT_KALMAN_MEASUREMENTS];
  qt_real L[QT_KALMAN_STATES][QT_KALMAN_MEASUREMENTS];
} qt_kalman_t;

typedef struct {
  qt_real x[QT_KALMAN_STATES];       /* predicted for the measurement to come */
  qt_real e[QT_KALMAN_MEASUREMENTS]; /* of the measurement since then; 0: none */
} qt_kalman_state_t;

extern const qt_kalman_t qt_kalman[QT_KALMAN_FILTERS]; /* in the order above */

/* Must be called first. The known states; 0 if none are known. */
void qt_kalman_initialize(const qt_kalman_t *filter, qt_kalman_state_t *state,
                          const qt_real x[QT_KALMAN_STATES]);

/* Corrects with the current measurement; not called in a period without one. Entries of y that are
 * not finite are ignored. Returns whether the estimate is finite; otherwise it does not recover. */
bool qt_kalman_correct(const qt_kalman_t *filter, qt_kalman_state_t *state,
                       const qt_real y[QT_KALMAN_MEASUREMENTS], qt_real estimate[QT_KALMAN_STATES]);

/* Predicts the next period. Entries of u that are not finite count as 0. */
void qt_kalman_predict(const qt_kalman_t *filter, qt_kalman_state_t *state,
                       const qt_real u[QT_KALMAN_INPUTS]);

#endif /* QT_KALMAN_H */
