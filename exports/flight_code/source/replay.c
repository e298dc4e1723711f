/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Replays a recorded flight through the flight program, on a computer with an operating system.
 * A recorded run of the Kalman filters is replayed likewise.
 *
 *   replay flight.txt   compares every command and every estimate with those of the file, bit by
 *                       bit; exit status 0 if all are equal, 1 if not, 2 if the file is malformed
 *   replay -            another program flies this one: it writes to standard input the line
 *                       `start ...`, then two lines per control period: the first group of numbers
 *                       of a recorded flight, answered with the estimate, and the second, answered
 *                       with commands, estimate and flags
 */
#include <string.h>

#include "replay_lines.h"
#if QT_WITH_KALMAN
#include "kalman.h"
#endif

static qt_state_t state;
static qt_output_t output;

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
  const qt_real phase = number();
  if (phase > 1.5f) {
    to->phase = QT_FLYING;
  } else if (phase > 0.5f) {
    to->phase = QT_TAKE_OFF;
  } else {
    to->phase = QT_IDLE;
  }
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
  qt_real *states = &results[QT_ROTORS];
  (void)memcpy(results, from->command, sizeof from->command);
  (void)memcpy(states, e->position, sizeof e->position);
  states[3] = e->roll;
  states[4] = e->pitch;
  states[5] = e->yaw;
  (void)memcpy(&states[6], e->velocity, sizeof e->velocity);
  (void)memcpy(&states[9], e->rates, sizeof e->rates);
  states[12] = from->limited ? 1.0f : 0.0f;
  states[13] = e->finite ? 1.0f : 0.0f;
}

static void estimate(void) {
#if QT_WITH_ESTIMATOR
  static qt_sensors_t sensors;
  read_sensors(&sensors);
  qt_estimate(&state, &sensors, &output.estimate);
#else
  read_estimate(&output.estimate);
#endif
}

static void control(void) {
  static qt_reference_t reference;
  read_reference(&reference);
  qt_control(&state, &output.estimate, &reference, &output);
}

static void print(const qt_real *x, int count) {
  for (int i = 0; i < count; ++i) {
    (void)printf(FORMAT "%c", (double)x[i], (i == (count - 1)) ? '\n' : ' ');
  }
  (void)fflush(stdout);
}

#if QT_WITH_KALMAN

static const qt_kalman_t *filter = NULL; /* that the lines are of; NULL: they are of a flight */
static qt_kalman_state_t filter_state;

/* The line `filter`, its number, and the states it starts with. */
static bool start_filter(void) {
  qt_real x[QT_KALMAN_STATES];
  const qt_real index = number();
  const bool is_there = (index >= 0.0f) && (index < (qt_real)QT_KALMAN_FILTERS);
  if (is_there) {
    filter = &qt_kalman[(int)index];
    numbers(x, filter->states);
    qt_kalman_initialize(filter, &filter_state, x);
  }
  return is_there;
}

/* Measurements, inputs, and the estimate to compare. */
static bool filter_repeats(void) {
  qt_real y[QT_KALMAN_MEASUREMENTS];
  qt_real u[QT_KALMAN_INPUTS];
  qt_real estimate[QT_KALMAN_STATES];
  numbers(y, filter->measurements);
  numbers(u, filter->inputs);
  (void)qt_kalman_correct(filter, &filter_state, y, estimate);
  qt_kalman_predict(filter, &filter_state, u);
  return repeats(estimate, filter->states);
}
#endif

/* Replays a flight, or answers another program; returns the exit status. */
static int replay(FILE *file, bool flown) {
  qt_real results[RESULTS];
  qt_start_t start;
  bool started = false;
  long periods = 0;
  int status = 0;
  while ((status == 0) && next_line(file)) {
    if (strncmp(rest, "start ", 6) == 0) {
      rest = &rest[6];
      read_start(&start);
      qt_initialize(&state, &start);
      started = true;
#if QT_WITH_KALMAN
      filter = NULL;
    } else if (strncmp(rest, "filter ", 7) == 0) {
      rest = &rest[7];
      started = start_filter();
    } else if (filter != NULL) {
      status = filter_repeats() ? 0 : 1;
      ++periods;
#endif
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
      } else if (!repeats(results, RESULTS)) {
        status = 1;
      } else {
        /* The period matches the recording. */
      }
      ++periods;
    }
    if (broken || (!started)) {
      (void)fprintf(stderr, "replay: line %ld is malformed\n", number_of_line);
      status = 2;
    }
  }
  if ((!flown) && (status == 0)) {
    if (periods == 0) {
      (void)fprintf(stderr, "replay: the file has no control period\n");
      status = 2;
    } else {
      (void)printf("%ld control periods, all equal bit by bit\n", periods);
    }
  }
  return status;
}

int main(int argc, char **argv) {
  const bool flown = (argc == 2) && (strcmp(argv[1], "-") == 0);
  FILE *file = NULL;
  int status = 2;
  if (flown) {
    file = stdin;
  } else if (argc == 2) {
    file = fopen(argv[1], "r");
  } else {
    /* No file to close. */
  }
  if (file == NULL) {
    (void)fprintf(stderr, "usage: replay flight.txt, or replay -\n");
  } else {
    status = replay(file, flown);
    (void)fclose(file);
  }
  return status;
}
