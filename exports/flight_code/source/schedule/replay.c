/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Evaluates recorded points of the schedule, on a computer with an operating system.
 *
 *   replay points.txt   compares status, gains, trim and inputs with those of the file, bit by bit;
 *                       exit status 0 if all are equal, 1 if not, 2 if the file is malformed
 */
#include "replay_lines.h"

static void read_point(qt_point_t *point) {
#if QT_WITH_SPEED
  point->speed = number();
#endif
#if QT_WITH_CLIMB
  point->climb = number();
#endif
#if QT_WITH_YAW_RATE
  point->yaw_rate = number();
#endif
#if QT_WITH_MASS
  point->mass = number();
#endif
#if QT_WITH_DENSITY
  point->density = number();
#endif
}

/* Whether the status of both lookups, the gains, the trim and the inputs match the line. */
static bool line_repeats(void) {
  static qt_gains_t gains; /* those of the line before hold where there are none */
  static qt_trim_t trim;
  qt_point_t point;
  qt_real sp[QT_STATES];
  qt_real x[QT_STATES];
#if QT_WITH_INTEGRALS
  qt_real x_int[QT_INTEGRALS];
#endif
  qt_real u[QT_INPUTS];
  qt_real status[2];
  bool equal;
  read_point(&point);
  numbers(sp, QT_STATES);
  numbers(x, QT_STATES);
#if QT_WITH_INTEGRALS
  numbers(x_int, QT_INTEGRALS);
#endif
  status[0] = (qt_real)(int)qt_gains(&point, &gains);
  status[1] = (qt_real)(int)qt_trim(&point, &trim);
#if QT_WITH_INTEGRALS
  qt_law(&gains, trim.u0, sp, x, x_int, u);
#else
  qt_law(&gains, trim.u0, sp, x, u);
#endif
  equal = repeats(status, 2);
  for (int i = 0; i < QT_INPUTS; ++i) {
    equal = equal && repeats(gains.K[i], QT_STATES);
  }
#if QT_WITH_INTEGRALS
  for (int i = 0; i < QT_INPUTS; ++i) {
    equal = equal && repeats(gains.K_int[i], QT_INTEGRALS);
  }
#endif
  equal = equal && repeats(trim.x0, QT_STATES);
  equal = equal && repeats(trim.u0, QT_INPUTS);
  return equal && repeats(u, QT_INPUTS);
}

/* Returns the exit status. */
static int replay(FILE *file) {
  long points = 0;
  int status = 0;
  while ((status == 0) && next_line(file)) {
    if (!line_repeats()) {
      status = 1;
    }
    if (broken) {
      (void)fprintf(stderr, "replay: line %ld is not a recorded point\n", number_of_line);
      status = 2;
    }
    ++points;
  }
  if (status == 0) {
    if (points == 0) {
      (void)fprintf(stderr, "replay: the file has no point\n");
      status = 2;
    } else {
      (void)printf("%ld points, all equal bit by bit\n", points);
    }
  }
  return status;
}

int main(int argc, char **argv) {
  FILE *file = NULL;
  int status = 2;
  if (argc == 2) {
    file = fopen(argv[1], "r");
  }
  if (file == NULL) {
    (void)fprintf(stderr, "usage: replay points.txt\n");
  } else {
    status = replay(file);
    (void)fclose(file);
  }
  return status;
}
