/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Replays a recorded flight through the flight program, on a computer with an operating system.
 *
 *   replay flight.txt   compares every command and every estimate with those of the file, bit by
 *                       bit; exit status 0 if all are equal, 1 if not, 2 if the file is no flight
 *   replay -            another program flies this one: it writes to standard input the line
 *                       `start ...`, then two lines a control period, the first group of numbers of
 *                       a recorded flight, answered with the estimate, and the second, answered
 *                       with commands, estimate and flags
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "program.h"

#if QT_WITH_DOUBLE
#define FORMAT "%.17g"
#define TO_REAL strtod
#else
#define FORMAT "%.9g"
#define TO_REAL strtof
#endif
#define LONGEST_LINE 8192

static qt_state_t state;
#if QT_WITH_ESTIMATOR
static qt_sensors_t sensors;
#endif
static qt_reference_t reference;
static qt_output_t output;

static char line[LONGEST_LINE];
static char *place; /* where the next number of the line stands */
static bool broken; /* whether a number was missing */
static long number_of_line;

static qt_real number(void) {
  char *end = place;
  const qt_real x = TO_REAL(place, &end);
  if (end == place) {
    broken = true;
  }
  place = end;
  return x;
}

static void numbers(qt_real *x, int count) {
  for (int i = 0; i < count; ++i) {
    x[i] = number();
  }
}

static bool flag(void) { return number() > 0.5f; }

static void read_start(qt_start_t *start) {
  numbers(start->position, 3);
  numbers(start->velocity, 3);
  numbers(start->rates, 3);
  start->roll = number();
  start->pitch = number();
  start->yaw = number();
  numbers(start->gyro_bias, 3);
  numbers(start->force_bias, 3);
  start->pressure_height = number();
}

#if QT_WITH_ESTIMATOR
/* A sample is `0`, or `1 age value...`. */
static void sample(bool *fresh, qt_real *age, qt_real *values, int count) {
  *fresh = flag();
  if (*fresh) {
    *age = number();
    numbers(values, count);
  }
}

static void vector_sample(qt_vector_sample_t *s) { sample(&s->fresh, &s->age, s->value, 3); }

static void read_sensors(qt_sensors_t *to) {
  to->on_ground = flag();
  vector_sample(&to->specific_force);
  vector_sample(&to->rates);
  vector_sample(&to->magnetic_field);
  sample(&to->pressure.fresh, &to->pressure.age, &to->pressure.value, 1);
  sample(&to->range.fresh, &to->range.age, &to->range.value, 1);
  sample(&to->flow.fresh, &to->flow.age, to->flow.value, 2);
  vector_sample(&to->gps_position);
  vector_sample(&to->gps_velocity);
  vector_sample(&to->vision);
}

#else
static void read_estimate(qt_estimate_t *to) {
  numbers(to->position, 3);
  to->roll = number();
  to->pitch = number();
  to->yaw = number();
  numbers(to->velocity, 3);
  numbers(to->rates, 3);
  to->finite = true;
}

#endif
static void read_reference(qt_reference_t *to) {
  const int phase = (int)number();
  to->phase = (phase == 2) ? QT_FLYING : ((phase == 1) ? QT_TAKE_OFF : QT_IDLE);
  to->track_position = flag();
  numbers(to->position, 3);
  numbers(to->velocity, 3);
  to->roll = number();
  to->pitch = number();
  to->yaw = number();
  numbers(to->idle, QT_ROTORS);
}

#define RESULTS (QT_ROTORS + 14)

/* Commands, the 12 states, whether the wrench was limited, whether the estimate is finite. */
static void results_of(const qt_output_t *from, qt_real results[RESULTS]) {
  const qt_estimate_t *e = &from->estimate;
  qt_real *next = results;
  (void)memcpy(next, from->command, sizeof from->command);
  next += QT_ROTORS;
  (void)memcpy(next, e->position, sizeof e->position);
  next[3] = e->roll;
  next[4] = e->pitch;
  next[5] = e->yaw;
  (void)memcpy(next + 6, e->velocity, sizeof e->velocity);
  (void)memcpy(next + 9, e->rates, sizeof e->rates);
  next[12] = from->limited ? 1.0f : 0.0f;
  next[13] = e->finite ? 1.0f : 0.0f;
}

/* Whether two numbers have the same bits; the sign of zero does not count. */
static bool same(qt_real a, qt_real b) {
  return ((a <= b) && (a >= b)) || (memcmp(&a, &b, sizeof a) == 0);
}

/* The next line that holds numbers; false at the end of the file. */
static bool next_line(FILE *file) {
  do {
    if (fgets(line, LONGEST_LINE, file) == NULL) {
      return false;
    }
    ++number_of_line;
  } while ((line[0] == '#') || (line[0] == '\n'));
  place = line;
  broken = false;
  return true;
}

static void estimate(void) {
#if QT_WITH_ESTIMATOR
  read_sensors(&sensors);
  qt_estimate(&state, &sensors, &output.estimate);
#else
  read_estimate(&output.estimate);
#endif
}

static void control(void) {
  const qt_estimate_t now = output.estimate;
  read_reference(&reference);
  qt_control(&state, &now, &reference, &output);
}

static void print(const qt_real *x, int count) {
  for (int i = 0; i < count; ++i) {
    (void)printf(FORMAT "%c", (double)x[i], (i == (count - 1)) ? '\n' : ' ');
  }
  (void)fflush(stdout);
}

/* Compares the results of one period with those of the line. */
static int compare(const qt_real results[RESULTS]) {
  for (int i = 0; i < RESULTS; ++i) {
    const qt_real expected = number();
    if ((!broken) && (!same(results[i], expected))) {
      (void)printf("replay: line %ld, result %d of %d: " FORMAT ", expected " FORMAT "\n",
                   number_of_line, i + 1, RESULTS, (double)results[i], (double)expected);
      return 1;
    }
  }
  return 0;
}

int main(int argc, char **argv) {
  const bool flown = (argc == 2) && (strcmp(argv[1], "-") == 0);
  FILE *file = flown ? stdin : ((argc == 2) ? fopen(argv[1], "r") : NULL);
  qt_real results[RESULTS];
  qt_start_t start;
  bool started = false;
  long periods = 0;
  int status = 0;
  if (file == NULL) {
    (void)fprintf(stderr, "usage: replay flight.txt, a file that can be read, or replay -\n");
    return 2;
  }
  while ((status == 0) && next_line(file)) {
    if (strncmp(line, "start ", 6) == 0) {
      place = line + 6;
      read_start(&start);
      qt_initialize(&state, &start);
      started = true;
    } else {
      estimate();
      results_of(&output, results);
      if (flown) {
        results[QT_ROTORS + 12] = results[QT_ROTORS + 13]; /* whether it is finite */
        print(&results[QT_ROTORS], 13);
        broken = broken || (!next_line(file));
      }
      control();
      results_of(&output, results);
      if (flown) {
        print(results, RESULTS);
      } else {
        status = compare(results);
      }
      ++periods;
    }
    if (broken || (!started)) {
      (void)fprintf(stderr, "replay: line %ld is no line of a recorded flight\n", number_of_line);
      status = 2;
    }
  }
  if ((!flown) && (status == 0)) {
    if (periods == 0) {
      (void)fprintf(stderr, "replay: the file holds no control period\n");
      status = 2;
    } else {
      (void)printf("%ld control periods, all equal bit by bit\n", periods);
    }
  }
  return status;
}
