/* SPDX-License-Identifier: Apache-2.0 */
/* The interface between adapter_main.c and your board. Units and axes: @NAME@.h. */
#ifndef ADAPTER_BOARD_H
#define ADAPTER_BOARD_H

#include "program.h"

/* Prepares sensors and motors; `start` is zero when it is called. */
void board_start(qt_start_t *start);

/* Whether the flight continues. The supervisor belongs here: return false if the pilot switches
 * off, the battery is empty, the vehicle tilts too far, or `last->estimate.finite` is false. */
bool board_flies(const qt_output_t *last);

#if QT_WITH_ESTIMATOR
/* The samples that arrived since the last call, with `fresh` false for the others, and the
 * reference of the pilot. */
void board_read(qt_sensors_t *sensors, qt_reference_t *reference);
#else
/* Your estimate, and the reference of the pilot. */
void board_read(qt_estimate_t *estimate, qt_reference_t *reference);
#endif

/* Commands to the motors; all 0 at the end. */
void board_send(const qt_output_t *output);

/* Called if a control period took longer than @DT@ s. */
void board_late(void);

#endif /* ADAPTER_BOARD_H */
