/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The state that the flight program keeps between control periods. It is here so that a structure
 * qt_state_t can be declared anywhere; no other program needs its members.
 */
#ifndef QT_STATE_H
#define QT_STATE_H

#if QT_WITH_GENERAL
#define QT_ERRORS 16   /* errors of the filter */
#define QT_PACKED 136  /* entries of its covariance: the lower triangle */
#define QT_HISTORY 40  /* control periods over which a measurement is carried back, at most */
#define QT_HORIZON 16  /* control periods by which the inertial readings may be late, at most */
#define QT_READINGS 60 /* stored inertial readings */
#define QT_QUEUE 18    /* stored samples of a sensor */
#define QT_SCALARS 14  /* scalar measurements of all sensors but the inertial ones */

typedef struct {
  qt_real position[3]; /* world [m] */
  qt_real velocity[3]; /* world [m/s] */
  qt_real attitude[4]; /* quaternion (w, x, y, z), from body axes to world axes */
} qt_motion_t;

typedef struct {
  qt_real rates[3]; /* [rad/s] */
  qt_real force[3]; /* [m/s^2] */
} qt_reading_t;

/* The samples of a sensor in the last control periods, in a ring that starts at `newest`. */
typedef struct {
  qt_real values[QT_QUEUE][3];
  qt_real age[QT_QUEUE]; /* at its arrival [s] */
  bool came[QT_QUEUE];
  int newest;
} qt_queue_t;

typedef struct {
  qt_real time;  /* since the measurement was last accepted [s] */
  qt_real count; /* rejections in a row */
} qt_rejections_t;

typedef struct {
  qt_motion_t motion;      /* at the horizon */
  qt_real gyro_bias[3];    /* [rad/s] */
  qt_real force_bias[3];   /* [m/s^2] */
  qt_real pressure_height; /* offset of the barometer's height [m] */
  qt_real P[QT_PACKED];    /* covariance of the errors */
  qt_real yaw;             /* of the last estimate, unwrapped [rad] */
  qt_reading_t readings[QT_READINGS];
  int newest_reading;
  qt_queue_t flow;
  qt_queue_t range;
  qt_queue_t pressure;
  qt_queue_t field;
  qt_queue_t gps_position;
  qt_queue_t gps_velocity;
  qt_queue_t vision;
  qt_rejections_t rejections[QT_SCALARS];
} qt_estimator_state_t;

#endif
#if QT_WITH_MAMBO
#if QT_WITH_ALIGNED_FLOW
#define QT_MOMENTS 32 /* control periods of flows and rates that are kept */

/* Flow and rates of one control period. */
typedef struct {
  qt_real rates[2]; /* about body x and y [rad/s] */
  qt_real flow[2];  /* [rad/s] */
  qt_real age;      /* of the image when the flow arrived [s] */
  bool came;
} qt_flow_moment_t;

#endif
typedef struct {
  qt_real angles[3];        /* roll, pitch, yaw [rad] */
  qt_real gyro_bias[3];     /* [rad/s] */
  qt_real gyro[3];          /* newest rates, with their bias [rad/s] */
  qt_real force[3];         /* newest specific force [m/s^2] */
  qt_real force_bias[3];    /* [m/s^2] */
  qt_real height[2];        /* z and vz, predicted for the period to come [m, m/s] */
  qt_real height_P[4];      /* covariance of their errors */
  qt_real velocity[2];      /* vx and vy of the world, likewise [m/s] */
  qt_real velocity_P[4];    /* covariance of their errors */
  qt_real position[2];      /* sum of that velocity [m] */
  qt_real flow_position[2]; /* sum of the flow's velocity [m] */
  qt_real position_variance;
  qt_real echo_height;     /* of the last echo in range [m] */
  qt_real unbelieved_time; /* since an echo was accepted [s] */
  qt_real flow[2];         /* newest, the turning taken out [rad/s] */
  qt_real flow_age;        /* [s] */
  bool flow_seen;          /* whether any has arrived */
#if QT_WITH_ALIGNED_FLOW
  qt_flow_moment_t moments[QT_MOMENTS]; /* newest first */
#endif
  int32_t periods; /* of calibration */
  qt_real gyro_sum[3];
  qt_real force_sum[3];
  qt_real gyro_count;
  qt_real force_count;
} qt_estimator_state_t;

#endif
#if QT_WITH_UQUAD
#define QT_STATES 15 /* of the filter */

/* A sum over control periods, and their number. */
typedef struct {
  qt_real sum[3];
  qt_real count;
} qt_mean_t;

typedef struct {
  /* Position [m], roll, pitch, yaw [rad], body velocity [m/s], rates [rad/s], biases of the
   * accelerometer [m/s^2]. */
  qt_real x[QT_STATES];
  qt_real P[QT_STATES * QT_STATES]; /* covariance of their errors, row by row */
  qt_real speeds[QT_ROTORS];        /* of the last commands [rad/s] */
  qt_real gyro_offset[3];           /* [rad/s] */
  qt_real pressure_zero;            /* [Pa] at the height -start_z */
  qt_real start_z;                  /* [m] */
  qt_real field_norm;               /* of the earth's field [uT]; 0: not known */
  qt_real tilt_roll;                /* newest of the accelerometer [rad] */
  qt_real tilt_pitch;
  qt_real force_excess; /* newest ||f|/g - 1| */
  qt_real gps_age;      /* since GPS or an image was accepted [s] */
  int32_t periods;      /* of calibration */
  qt_mean_t gyro;
  qt_mean_t force;
  qt_mean_t field;
  qt_real pressure_sum;
  qt_real pressure_count;
} qt_estimator_state_t;

#endif
#if QT_WITH_CASCADE
typedef struct {
  qt_real integral; /* Ki times the integral of the error [unit of the output] */
  qt_real error;    /* of the last period */
  qt_real output;   /* likewise */
#if QT_WITH_RATE_LEAD
  qt_real rate; /* low pass of the measured rate */
#endif
} qt_loop_state_t;

typedef struct {
  qt_loop_state_t x;
  qt_loop_state_t y;
  qt_loop_state_t roll;
  qt_loop_state_t pitch;
  qt_loop_state_t yaw;
  qt_loop_state_t altitude;
  qt_real wrench_excess[4];   /* requested minus produced in the last period [N, N m] */
  qt_real attitude_excess[2]; /* likewise of pitch and roll references [rad] */
} qt_law_state_t;

#else
#define QT_INPUTS 4 /* the law's inputs: @INPUT@ */
#if QT_WITH_INTEGRALS
#define QT_INTEGRALS 12 /* integrated states */
#endif
#if QT_WITH_PAST
#define QT_PAST 8 /* control periods of past commands that the law feeds back */
#endif

typedef struct {
#if QT_WITH_INTEGRALS
  qt_real integral[QT_INTEGRALS]; /* of the errors, in world axes [unit of the state, times s] */
#endif
  qt_real excess[QT_INPUTS];      /* requested minus produced in the last period */
#if QT_WITH_MEMORY
  qt_real actuators[QT_INPUTS];   /* state of the actuators, less u0 */
#endif
#if QT_WITH_PAST
  qt_real commands[QT_PAST * QT_INPUTS]; /* past inputs less u0, newest first */
#endif
} qt_law_state_t;

#endif
typedef struct {
#if QT_WITH_ESTIMATOR
  qt_estimator_state_t estimator;
#endif
  qt_law_state_t law;
} qt_state_t;

#endif /* QT_STATE_H */
