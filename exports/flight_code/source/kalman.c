/* SPDX-License-Identifier: Apache-2.0 */
/* Steady Kalman filters: the gains are those of the steady-state covariances. */
#include "kalman.h"

#include "maths.h"

void qt_kalman_initialize(const qt_kalman_t *filter, qt_kalman_state_t *state,
                          const qt_real x[QT_KALMAN_STATES]) {
  (void)memset(state, 0, sizeof *state);
  for (int i = 0; (i < QT_KALMAN_STATES) && (i < filter->states); ++i) {
    state->x[i] = x[i];
  }
}

/* e = y - C x, estimate = x + M e */
bool qt_kalman_correct(const qt_kalman_t *filter, qt_kalman_state_t *state,
                       const qt_real y[QT_KALMAN_MEASUREMENTS],
                       qt_real estimate[QT_KALMAN_STATES]) {
  bool finite = true;
  for (int i = 0; (i < QT_KALMAN_MEASUREMENTS) && (i < filter->measurements); ++i) {
    qt_real e = y[i];
    for (int j = 0; (j < QT_KALMAN_STATES) && (j < filter->states); ++j) {
      e -= filter->C[i][j] * state->x[j];
    }
    state->e[i] = qt_is_finite(e) ? e : 0.0f;
  }
  for (int i = 0; (i < QT_KALMAN_STATES) && (i < filter->states); ++i) {
    estimate[i] = state->x[i];
    for (int j = 0; (j < QT_KALMAN_MEASUREMENTS) && (j < filter->measurements); ++j) {
      estimate[i] += filter->M[i][j] * state->e[j];
    }
    finite = finite && qt_is_finite(estimate[i]);
  }
  return finite;
}

/* x = A x + B u + L e */
void qt_kalman_predict(const qt_kalman_t *filter, qt_kalman_state_t *state,
                       const qt_real u[QT_KALMAN_INPUTS]) {
  qt_real x[QT_KALMAN_STATES];
  (void)memcpy(x, state->x, sizeof x);
  for (int i = 0; (i < QT_KALMAN_STATES) && (i < filter->states); ++i) {
    qt_real next = 0.0f;
    for (int j = 0; (j < QT_KALMAN_STATES) && (j < filter->states); ++j) {
      next += filter->A[i][j] * x[j];
    }
    for (int j = 0; (j < QT_KALMAN_INPUTS) && (j < filter->inputs); ++j) {
      next += filter->B[i][j] * (qt_is_finite(u[j]) ? u[j] : 0.0f);
    }
    for (int j = 0; (j < QT_KALMAN_MEASUREMENTS) && (j < filter->measurements); ++j) {
      next += filter->L[i][j] * state->e[j];
    }
    state->x[i] = next;
  }
  (void)memset(state->e, 0, sizeof state->e);
}
