/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Flight program `qt`: @DESCRIPTION@
 *
 * One call of qt_step() in each control period of @DT@ s:
 * sensors -> estimate -> control law -> allocation -> motor commands.
 *
 * Axes: body forward-right-down, world north-east-down (a height is a negative position).
 * Units: m, s, rad, N, Pa, microtesla. R = Rz(yaw) Ry(pitch) Rx(roll) takes body axes to world
 * axes; yaw is unwrapped.
 * No heap, no input or output, no recursion; the complete state is in the structure qt_state_t.
 */
#ifndef QT_H
#define QT_H

#include <stdbool.h>
#include <stdint.h>

typedef float qt_real;

#define QT_ROTORS 4
#define QT_DT 0.005f /* control period [s] */

#include "state.h"

/* ---- inputs ---- */

#if QT_WITH_ESTIMATOR
#if QT_WITH_UQUAD
/* The newest sample of a sensor. `fresh` is true only in the control period in which it arrived;
 * `age` is the time since it was measured [s], which this program reads for the vision only. A
 * sample with a number that is not finite is ignored. */
#else
/* The newest sample of a sensor. `fresh` is true only in the control period in which it arrived;
 * `age` is the time since it was measured [s]. A sample with a number that is not finite or with a
 * negative age is ignored. */
#endif
typedef struct {
  qt_real value[3];
  qt_real age;
  bool fresh;
} qt_vector_sample_t;

typedef struct {
  qt_real value[2];
  qt_real age;
  bool fresh;
} qt_flow_sample_t;

typedef struct {
  qt_real value;
  qt_real age;
  bool fresh;
} qt_scalar_sample_t;

/* This program uses: @SENSORS@. */
typedef struct {
  qt_vector_sample_t specific_force; /* accelerometer: (0, 0, -g) at rest, level [m/s^2] */
  qt_vector_sample_t rates;          /* gyroscope [rad/s] */
  qt_vector_sample_t magnetic_field; /* body axes [uT] */
  qt_scalar_sample_t pressure;       /* of the air [Pa] */
  qt_scalar_sample_t range;          /* along body z down to the ground [m] */
  /* Mean image velocity divided by the focal length [rad/s]: for a level body at the height h,
   * (-v_x / h - w_y, -v_y / h + w_x) with the body's velocity v and rates w. */
  qt_flow_sample_t flow;
  qt_vector_sample_t gps_position; /* world [m] */
  qt_vector_sample_t gps_velocity; /* world [m/s] */
  qt_vector_sample_t vision;       /* position from images, world [m] */
  bool on_ground;                  /* the vehicle is known to stand still on the ground */
} qt_sensors_t;

#endif
typedef enum {
  QT_IDLE = 0,     /* the motors get reference.idle; 0: they stand */
  QT_TAKE_OFF = 1, /* @TAKE_OFF@ */
  QT_FLYING = 2    /* the law has the motors */
} qt_phase_t;

/* Every number must be finite. */
typedef struct {
  qt_phase_t phase;
  bool track_position; /* true: position and heading; false: roll, pitch, heading and height */
  qt_real position[3]; /* world [m] */
  qt_real velocity[3]; /* of the moving reference, world [m/s] */
  qt_real roll;        /* [rad], where track_position is false */
  qt_real pitch;       /* [rad], likewise */
  qt_real yaw;         /* [rad], unwrapped */
  /* Motor commands in phase QT_IDLE, with their signs. They are sent unchecked. */
  qt_real idle[QT_ROTORS];
} qt_reference_t;

/* ---- outputs ---- */

typedef struct {
  qt_real position[3];        /* world [m] */
  qt_real roll;               /* [rad] */
  qt_real pitch;              /* [rad] */
  qt_real yaw;                /* [rad], unwrapped */
  qt_real velocity[3];        /* body [m/s] */
  qt_real rates[3];           /* body [rad/s] */
  bool finite;                /* false, or a number above that is not finite: all commands are 0 */
  bool height_used;           /* whether range or pressure was accepted in this period */
  bool flow_used;             /* whether the flow was */
  qt_real innovation_square;  /* sum of e^2/S over the measurements used in this period */
  qt_real innovation_freedom; /* how many those are */
} qt_estimate_t;

typedef struct {
  /* Motor commands: @COMMAND@. */
  qt_real command[QT_ROTORS];
  qt_real speed[QT_ROTORS]; /* that these commands stand for [rad/s] */
  qt_real wrench[4];        /* request of the law: thrust along body -z [N], torques [N m] */
  bool limited;             /* the motors cannot produce that wrench; they produce the nearest */
  qt_estimate_t estimate;
} qt_output_t;

/* ---- entry points ---- */

/* Known values when the program starts. */
typedef struct {
  qt_real position[3];     /* world [m] */
  qt_real velocity[3];     /* body [m/s] */
  qt_real rates[3];        /* body [rad/s] */
  qt_real roll;            /* [rad] */
  qt_real pitch;           /* [rad] */
  qt_real yaw;             /* [rad] */
  qt_real gyro_bias[3];    /* offsets that are known already, otherwise 0 [rad/s] */
  qt_real force_bias[3];   /* of the accelerometer [m/s^2] */
  qt_real pressure_height; /* of the barometer's height [m] */
} qt_start_t;

/* Must be called first, and again after a flight. */
void qt_initialize(qt_state_t *state, const qt_start_t *start);

#if QT_WITH_ESTIMATOR
/* One control period: qt_estimate() followed by qt_control(). */
void qt_step(qt_state_t *state, const qt_sensors_t *sensors, const qt_reference_t *reference,
             qt_output_t *output);

#if QT_WITH_UQUAD
/* The estimator only. It predicts with the speeds of the last qt_control(). */
#else
/* The estimator only. */
#endif
void qt_estimate(qt_state_t *state, const qt_sensors_t *sensors, qt_estimate_t *estimate);

/* Control law, allocation and motor commands from an estimate of your own. */
#else
/* One control period: control law, allocation and motor commands from your estimate, of which the
 * position, angles, velocity, rates and `finite` are used. */
#endif
void qt_control(qt_state_t *state, const qt_estimate_t *estimate, const qt_reference_t *reference,
                qt_output_t *output);

/* Ends a flight: all commands are 0. */
void qt_terminate(qt_state_t *state, qt_output_t *output);

#endif /* QT_H */
