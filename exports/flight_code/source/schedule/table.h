/* SPDX-License-Identifier: Apache-2.0 */
/* The numbers of the schedule. */
#ifndef QT_TABLE_H
#define QT_TABLE_H

#include "program.h"

#define QT_AXES 2
#define QT_VALUES 12
#define QT_POINTS 27

extern const qt_real qt_axis_values[QT_VALUES]; /* one axis after the other */
extern const int qt_axis_start[QT_AXES];        /* where each axis begins there */
extern const int qt_axis_length[QT_AXES];       /* how many values it has */

/* The points of the grid; the last axis varies fastest. */
#if QT_WITH_HOLES
extern const bool qt_has_gain[QT_POINTS]; /* where there is none, all numbers are 0 */
#endif
extern const qt_gains_t qt_gains_table[QT_POINTS];
extern const qt_trim_t qt_trim_table[QT_POINTS];

#endif /* QT_TABLE_H */
