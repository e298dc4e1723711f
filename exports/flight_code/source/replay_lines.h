/* SPDX-License-Identifier: Apache-2.0 */
/* Reads a recording line by line and number by number, and compares. Only for replay.c. */
#ifndef QT_REPLAY_LINES_H
#define QT_REPLAY_LINES_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "program.h"

#if QT_WITH_DOUBLE
#define FORMAT "%.17g"
#define TO_REAL strtod
#else
#define FORMAT "%.9g"
#define TO_REAL strtof
#endif
#define QT_LONGEST_LINE 8192

static char *rest;  /* the next number of the line */
static bool broken; /* whether a number was missing */
static long number_of_line;

static qt_real number(void) {
  char *end = rest;
  const qt_real x = TO_REAL(rest, &end);
  if (end == rest) {
    broken = true;
  }
  rest = end;
  return x;
}

static void numbers(qt_real *x, int count) {
  for (int i = 0; i < count; ++i) {
    x[i] = number();
  }
}

/* Whether two numbers have the same bits, up to the sign of zero and the payload of NaN. */
static bool same(qt_real a, qt_real b) { return ((a <= b) && (a >= b)) || (isnan(a) && isnan(b)); }

/* Reads the next line with numbers; false at the end of the file. */
static bool next_line(FILE *file) {
  static char line[QT_LONGEST_LINE];
  bool came;
  do {
    came = fgets(line, QT_LONGEST_LINE, file) != NULL;
    number_of_line += came ? 1 : 0;
  } while (came && ((line[0] == '#') || (line[0] == '\n')));
  rest = line;
  broken = false;
  return came;
}

/* Compares results with the next numbers of the line. */
static bool repeats(const qt_real *results, int count) {
  bool equal = true;
  for (int i = 0; (i < count) && equal; ++i) {
    const qt_real expected = number();
    equal = broken || same(results[i], expected);
    if (!equal) {
      (void)printf("replay: line %ld, result %d of %d: " FORMAT ", expected " FORMAT "\n",
                   number_of_line, i + 1, count, (double)results[i], (double)expected);
    }
  }
  return equal;
}

#endif /* QT_REPLAY_LINES_H */
