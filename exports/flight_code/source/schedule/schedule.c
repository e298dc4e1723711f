/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Multilinear interpolation. On each axis, a value is between a lower and an upper value of the
 * grid, at a share s of the way. The result is the sum over the corners c of this cell,
 *
 *
 *   K = sum w_c K_c,   w_c = product over the axes of s at the upper value, 1 - s at the lower.
 */
#include <string.h>

#include "arithmetic.h"
#include "table.h"

#define QT_CORNERS 4 /* 2 to the power of QT_AXES */
#if QT_WITH_INTERVALS
#define QT_LONGEST_AXIS 9 /* most values of one axis */
#endif

/* Indices of the axes. */
#if QT_WITH_SPEED
#define QT_SPEED_AXIS 0
#endif
#if QT_WITH_CLIMB
#define QT_CLIMB_AXIS 0
#endif
#if QT_WITH_YAW_RATE
#define QT_YAW_RATE_AXIS 0
#endif
#if QT_WITH_MASS
#define QT_MASS_AXIS 0
#endif
#if QT_WITH_DENSITY
#define QT_DENSITY_AXIS 0
#endif

/* The corners of a cell with their weights. */
typedef struct {
  int point[QT_CORNERS];
  qt_real weight[QT_CORNERS];
} qt_cell_t;

static void values_of(const qt_point_t *point, qt_real values[QT_AXES]) {
#if QT_WITH_SPEED
  values[QT_SPEED_AXIS] = point->speed;
#endif
#if QT_WITH_CLIMB
  values[QT_CLIMB_AXIS] = point->climb;
#endif
#if QT_WITH_YAW_RATE
  values[QT_YAW_RATE_AXIS] = point->yaw_rate;
#endif
#if QT_WITH_MASS
  values[QT_MASS_AXIS] = point->mass;
#endif
#if QT_WITH_DENSITY
  values[QT_DENSITY_AXIS] = point->density;
#endif
}

#if QT_WITH_INTERVALS
/* The index of the lower value: the largest that does not exceed x, but not the last one. */
static int lower_of(const qt_real *axis, int last, qt_real x) {
  int lower = 0;
  for (int i = 1; (i < QT_LONGEST_AXIS) && (i < last); ++i) {
    if (x >= axis[i]) {
      lower = i;
    }
  }
  return lower;
}
#endif

/* The cell of a point. Its indices are within the table for any point, including NaN. */
static qt_status_t find_cell(const qt_point_t *point, qt_cell_t *cell) {
  qt_real values[QT_AXES];
  int lower[QT_AXES];
  int upper[QT_AXES];
  qt_real share[QT_AXES];
  bool finite = true;
  bool within = true;
#if QT_WITH_HOLES
  bool complete = true;
#endif
  qt_status_t status = QT_FOUND;
  values_of(point, values);
  for (int a = 0; a < QT_AXES; ++a) {
    const qt_real *axis = &qt_axis_values[qt_axis_start[a]];
    const int last = qt_axis_length[a] - 1;
    finite = finite && qt_is_finite(values[a]);
    within = within && (values[a] >= axis[0]) && (values[a] <= axis[last]);
    lower[a] = 0;
    upper[a] = 0;
    share[a] = 0.0f;
#if QT_WITH_INTERVALS
    if (last > 0) { /* s = (x - lower) / (upper - lower) */
      const qt_real x = qt_clamp(values[a], axis[0], axis[last]);
      lower[a] = lower_of(axis, last, x);
      upper[a] = lower[a] + 1;
      share[a] = (x - axis[lower[a]]) / (axis[upper[a]] - axis[lower[a]]);
    }
#endif
  }
  for (int c = 0; c < QT_CORNERS; ++c) {
    cell->point[c] = 0;
    cell->weight[c] = 1.0f;
    for (int a = 0; a < QT_AXES; ++a) { /* bit a of c says which end of axis a */
      const bool at_upper = (((unsigned int)c) >> ((unsigned int)a) & 1u) != 0u;
      cell->point[c] = (cell->point[c] * qt_axis_length[a]) + (at_upper ? upper[a] : lower[a]);
      cell->weight[c] = cell->weight[c] * (at_upper ? share[a] : (1.0f - share[a]));
    }
#if QT_WITH_HOLES
    complete = complete && (qt_has_gain[cell->point[c]] || (cell->weight[c] <= 0.0f));
#endif
  }
  if (!finite) {
    status = QT_NOT_FINITE;
#if QT_WITH_HOLES
  } else if (!complete) {
    status = QT_NO_GAIN;
#endif
  } else if (!within) {
    status = QT_NEAREST;
  } else {
    /* The point is within the grid. */
  }
  return status;
}

qt_status_t qt_gains(const qt_point_t *point, qt_gains_t *gains) {
  qt_cell_t cell;
  const qt_status_t status = find_cell(point, &cell);
  if ((status == QT_FOUND) || (status == QT_NEAREST)) {
    (void)memset(gains, 0, sizeof *gains);
    for (int c = 0; c < QT_CORNERS; ++c) {
      const qt_gains_t *corner = &qt_gains_table[cell.point[c]];
      const qt_real w = cell.weight[c];
      for (int i = 0; i < QT_INPUTS; ++i) {
        for (int j = 0; j < QT_STATES; ++j) { /* K = sum w_c K_c */
          gains->K[i][j] += w * corner->K[i][j];
        }
#if QT_WITH_INTEGRALS
        for (int j = 0; j < QT_INTEGRALS; ++j) { /* K_int = sum w_c K_int_c */
          gains->K_int[i][j] += w * corner->K_int[i][j];
        }
#endif
      }
    }
  }
  return status;
}

qt_status_t qt_trim(const qt_point_t *point, qt_trim_t *trim) {
  qt_cell_t cell;
  const qt_status_t status = find_cell(point, &cell);
  if ((status == QT_FOUND) || (status == QT_NEAREST)) {
    (void)memset(trim, 0, sizeof *trim);
    for (int c = 0; c < QT_CORNERS; ++c) {
      const qt_trim_t *corner = &qt_trim_table[cell.point[c]];
      const qt_real w = cell.weight[c];
      for (int j = 0; j < QT_STATES; ++j) { /* x0 = sum w_c x0_c */
        trim->x0[j] += w * corner->x0[j];
      }
      for (int i = 0; i < QT_INPUTS; ++i) { /* u0 = sum w_c u0_c */
        trim->u0[i] += w * corner->u0[i];
      }
    }
  }
  return status;
}

#if QT_WITH_INTEGRALS
void qt_law(const qt_gains_t *gains, const qt_real u0[QT_INPUTS], const qt_real sp[QT_STATES],
            const qt_real x[QT_STATES], const qt_real x_int[QT_INTEGRALS], qt_real u[QT_INPUTS]) {
#else
void qt_law(const qt_gains_t *gains, const qt_real u0[QT_INPUTS], const qt_real sp[QT_STATES],
            const qt_real x[QT_STATES], qt_real u[QT_INPUTS]) {
#endif
  for (int i = 0; i < QT_INPUTS; ++i) { /* @LAW@ */
    qt_real sum = u0[i];
    for (int j = 0; j < QT_STATES; ++j) {
#if QT_WITH_STATE_MINUS_SET_POINT
      sum += gains->K[i][j] * (x[j] - sp[j]);
#else
      sum += gains->K[i][j] * (sp[j] - x[j]);
#endif
    }
#if QT_WITH_INTEGRALS
    for (int j = 0; j < QT_INTEGRALS; ++j) {
      sum += gains->K_int[i][j] * x_int[j];
    }
#endif
    u[i] = sum;
  }
}
