/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Replace this file by the drivers of your board. As delivered, it simulates a vehicle at rest on
 * the ground, whose motors idle for one second.
 */
#include <stdio.h>

#include "adapter_board.h"

static long periods;
static long late;

void board_start(qt_start_t *start) { (void)start; }

bool board_flies(const qt_output_t *last) {
  const bool goes_on = (((qt_real)periods * QT_DT) < 1.0f) && last->estimate.finite;
  if (!goes_on) {
    (void)printf("%ld control periods, %ld of them late\n", periods, late);
  }
  return goes_on;
}

#if QT_WITH_ESTIMATOR
void board_read(qt_sensors_t *sensors, qt_reference_t *reference) {
  sensors->on_ground = true;
  sensors->specific_force.value[2] = -9.81f;
  sensors->specific_force.fresh = true;
  sensors->rates.fresh = true;
#else
void board_read(qt_estimate_t *estimate, qt_reference_t *reference) {
  estimate->finite = true;
#endif
  reference->phase = QT_IDLE;
}

void board_send(const qt_output_t *output) {
  (void)output;
  ++periods;
}

void board_late(void) { ++late; }
