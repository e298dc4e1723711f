/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The flight program on a computer with POSIX clocks: one control period every @DT@ s, at instants
 * that do not drift. adapter_board.c is the interface to sensors, pilot and motors.
 */
#define _POSIX_C_SOURCE 200809L

#include <errno.h>
#include <signal.h>
#include <string.h>
#include <time.h>

#include "adapter_board.h"

#define NANOSECONDS 1000000000L

static qt_state_t state;
static qt_output_t output;

/* Ctrl-C and a termination request stop the motors, as does the end of a flight. */
static volatile sig_atomic_t asked_to_end;

static void end(int signal_number) {
  (void)signal_number;
  asked_to_end = 1;
}

static struct timespec later(struct timespec t) {
  t.tv_nsec += (long)((QT_DT * 1e9f) + 0.5f);
  if (t.tv_nsec >= NANOSECONDS) {
    t.tv_nsec -= NANOSECONDS;
    t.tv_sec += 1;
  }
  return t;
}

static bool before(const struct timespec *a, const struct timespec *b) {
  return (a->tv_sec < b->tv_sec) || ((a->tv_sec == b->tv_sec) && (a->tv_nsec < b->tv_nsec));
}

int main(void) {
  static qt_start_t start;
  static qt_reference_t reference;
#if QT_WITH_ESTIMATOR
  static qt_sensors_t sensors;
#else
  static qt_estimate_t estimate;
#endif
  struct timespec next;
  struct timespec now;
  struct sigaction action;
  (void)memset(&action, 0, sizeof action);
  action.sa_handler = end;
  (void)sigaction(SIGINT, &action, NULL);
  (void)sigaction(SIGTERM, &action, NULL);
  board_start(&start);
  qt_initialize(&state, &start);
  output.estimate.finite = true; /* nothing speaks against the first period */
  (void)clock_gettime(CLOCK_MONOTONIC, &next);
  while ((asked_to_end == 0) && board_flies(&output)) {
#if QT_WITH_ESTIMATOR
    board_read(&sensors, &reference);
    qt_step(&state, &sensors, &reference, &output);
#else
    board_read(&estimate, &reference);
    qt_control(&state, &estimate, &reference, &output);
#endif
    board_send(&output);
    next = later(next);
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    if (before(&next, &now)) {
      next = now; /* the period was exceeded: the next one begins at once */
      board_late();
    } else {
      while ((clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &next, NULL) == EINTR) &&
             (asked_to_end == 0)) {
        /* A signal that does not end the flight. */
      }
    }
  }
  qt_terminate(&state, &output);
  board_send(&output);
  return 0;
}
