/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Gain schedule `qt` for the vehicle '@VEHICLE@': state feedback
 *
 *   @LAW@
 *
 * with @NUMBERS@ interpolated multilinearly between the points of a grid.
 *
 * The grid has @POINTS@ points, of which @SOLVED@ have gains. Its axes, the last of which runs
 * fastest:
 * @AXES@
 *
 * Convention @CONVENTION@
 * In the order of the vectors, and of the rows and columns of K:
 * @SIGNALS@
 *
 * Each point was linearized at the heading @YAW@ rad. At another heading, rotate horizontal
 * positions, their set points and their integrals with the vehicle.
 * Angles are not wrapped: give x and sp of a heading without jumps.
 * Sample time: @SAMPLE_TIME@.
 *
 * No heap, no input or output, no recursion, no state: every call depends only on its arguments.
 */
#ifndef QT_H
#define QT_H

#include <stdbool.h>

typedef float qt_real;

#define QT_STATES 12
#define QT_INPUTS 4
#if QT_WITH_INTEGRALS
#define QT_INTEGRALS 1
#endif

/* A point of the schedule. */
typedef struct {
#if QT_WITH_SPEED
  qt_real speed; /* over the ground along the heading [m/s] */
#endif
#if QT_WITH_CLIMB
  qt_real climb; /* upward [m/s] */
#endif
#if QT_WITH_YAW_RATE
  qt_real yaw_rate; /* of the heading, > 0 clockwise seen from above [rad/s] */
#endif
#if QT_WITH_MASS
  qt_real mass; /* over the vehicle's */
#endif
#if QT_WITH_DENSITY
  qt_real density; /* of the air, over the vehicle's */
#endif
} qt_point_t;

typedef struct {
  qt_real K[QT_INPUTS][QT_STATES]; /* [unit of the input / unit of the state] */
#if QT_WITH_INTEGRALS
  qt_real K_int[QT_INPUTS][QT_INTEGRALS]; /* [unit of the input / unit of the integral] */
#endif
} qt_gains_t;

/* The trim of the vehicle. */
typedef struct {
  qt_real x0[QT_STATES]; /* states */
  qt_real u0[QT_INPUTS]; /* inputs */
} qt_trim_t;

/* The result of a lookup in the schedule. */
typedef enum {
  QT_FOUND = 0,     /* the point lies within the grid */
  QT_NEAREST = 1,   /* beyond it: each value counts as the nearest that its axis has */
  QT_NO_GAIN = 2,   /* a point of the grid that counts has no gain: nothing was written */
  QT_NOT_FINITE = 3 /* a value is infinite or NaN: nothing was written */
} qt_status_t;

/* K@AND_K_INT@ at a point. If there is no result, the previous gains are kept: initialize them at a
 * point that has gains before the first flight, and check the status. */
qt_status_t qt_gains(const qt_point_t *point, qt_gains_t *gains);

/* x0 and u0 at a point, likewise. */
qt_status_t qt_trim(const qt_point_t *point, qt_trim_t *trim);

/* u of the law above, without the limits of the motors. In flight, use the gains at the estimated
 * flight, but u0 and sp at the commanded flight. sp is x0, except that positions and heading are
 * those of the moving reference, or x's own if they are not controlled: x0 has 0 there. A trim at
 * the estimated flight would feed it back to the inputs, for which the gains do not account. */
#if QT_WITH_INTEGRALS
void qt_law(const qt_gains_t *gains, const qt_real u0[QT_INPUTS], const qt_real sp[QT_STATES],
            const qt_real x[QT_STATES], const qt_real x_int[QT_INTEGRALS], qt_real u[QT_INPUTS]);
#else
void qt_law(const qt_gains_t *gains, const qt_real u0[QT_INPUTS], const qt_real sp[QT_STATES],
            const qt_real x[QT_STATES], qt_real u[QT_INPUTS]);
#endif

#endif /* QT_H */
