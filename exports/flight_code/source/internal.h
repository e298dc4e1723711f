/* SPDX-License-Identifier: Apache-2.0 */
/* Parameters and internal functions of the flight program. */
#ifndef QT_INTERNAL_H
#define QT_INTERNAL_H

#include "maths.h"

#if QT_WITH_GENERAL
#define QT_INSTANT 1e-9f /* instants nearer than this are the same [s] */

/* A sensor of position or velocity. */
typedef struct {
  bool present;
  qt_real lag;           /* of its response, beyond the age of a sample [s] */
  qt_real variance;      /* of the noise of one sample, per axis */
  qt_real inverse_scale; /* truth over reading */
} qt_aid_t;

/* Weights of the samples that propagate the motion from the horizon to the present. */
typedef struct {
  qt_real held; /* of the newest sample, held */
  int count;    /* earlier periods with interpolated samples */
  qt_real later[QT_HORIZON];
  qt_real earlier[QT_HORIZON];
} qt_now_weights_t;

typedef struct {
  qt_real dt;           /* control period [s] */
  qt_real gravity;      /* [m/s^2] */
  int horizon;          /* delay of the inertial samples in control periods */
  qt_real horizon_time; /* [s] */
  /* A delayed sample of a period is interpolated between the stored ones from this index on: as
   * the mean over the period, and at its end. */
  int gyro_whole;
  int force_whole;
  qt_real gyro_mean[2];
  qt_real force_mean[2];
  qt_real gyro_point[2];
  qt_now_weights_t gyro_now;
  qt_now_weights_t force_now;
  qt_real gyro_inverse_scale[3];
  qt_real force_inverse_scale[3];
  qt_real gyro_variance[3];  /* of the noise of one reading [rad^2/s^2] */
  qt_real force_variance[3]; /* [m^2/s^4] */
  qt_real gyro_noise[3];     /* variance that the attitude gains in a period [rad^2] */
  qt_real force_noise[3];    /* that the velocity gains [m^2/s^2] */
  qt_real gyro_walk;         /* that the biases gain [rad^2/s^2] */
  qt_real force_walk;        /* [m^2/s^4] */
  qt_real pressure_walk;     /* that the barometer's offset gains [m^2] */
  qt_real gate;              /* e^2/S above which a measurement is rejected */
  qt_real recovery_time;     /* after rejections for so long, a sensor is accepted again [s] */
  qt_real standing_variance; /* of velocity and rates while stationary */
  qt_real lift_off_variance; /* least of the vertical velocity when it stops standing [m^2/s^2] */
  qt_real start_variance[QT_ERRORS];
  qt_real due[QT_HORIZON + 2];    /* k dt - QT_INSTANT [s] */
  qt_real behind[QT_HORIZON + 1]; /* k dt [s] */
  qt_aid_t gps_position;
  qt_aid_t gps_velocity;
  qt_aid_t vision;
  struct {
    bool present;
    qt_real lag;      /* [s] */
    qt_real variance; /* per axis [rad^2/s^2] */
    qt_real inverse_scale[2];
    qt_real mean_square[2]; /* a third of tan^2 of half the field of view, along x and y */
    qt_real least_height;   /* below which the flow is not used [m] */
  } flow;
  struct {
    bool present;
    qt_real lag;      /* [s] */
    qt_real variance; /* [m^2] */
    qt_real inverse_scale;
    qt_real least;        /* shortest range used [m] */
    qt_real greatest;     /* longest [m] */
    qt_real least_cosine; /* of the tilt up to which it is used */
  } range;
  struct {
    bool present;
    bool linear;      /* height = (pressure - zero)/fall; otherwise the standard atmosphere */
    qt_real lag;      /* [s] */
    qt_real variance; /* of the height [m^2] */
    qt_real inverse_scale;
    qt_real zero;         /* pressure at the world's origin [Pa] */
    qt_real inverse_fall; /* [m/Pa] */
  } pressure;
  struct {
    bool present;
    qt_real lag;         /* [s] */
    qt_real variance;    /* of the heading [rad^2] */
    qt_real declination; /* of magnetic north, east positive [rad] */
    qt_real row[3];      /* d(heading)/d(turn) of the expected field */
  } heading;
} qt_estimator_parameters_t;

#endif
#if QT_WITH_MAMBO
typedef struct {
  qt_real gravity;                /* [m/s^2] */
  int32_t calibration_periods;    /* in which the vehicle is stationary after the start */
  qt_real attitude_time_constant; /* of the correction by the accelerometer [s] */
  qt_real force_band;             /* share of g by which |f| may differ until it counts nothing */
  qt_real bias_time_constant;     /* in which a bias of the gyroscope is found [s] */
  qt_real altitude_Q;             /* variance that vz gains in a period [m^2/s^2] */
  qt_real altitude_R;             /* of the sonar [m^2] */
  qt_real sonar_least;            /* shortest valid echo [m] */
  qt_real sonar_greatest;         /* longest [m] */
  qt_real sonar_jump;             /* greatest step from one echo to the next [m] */
  qt_real sonar_deviation;        /* greatest distance from the estimated height [m] */
  qt_real sonar_recovery_time;    /* after it a steady echo is the height [s] */
  qt_real velocity_Q;             /* that vx and vy gain in a period [m^2/s^2] */
  qt_real velocity_R;             /* of the flow's velocity, per axis [m^2/s^2] */
  qt_real flow_scale;             /* correction factor of the flow */
  qt_real flow_compensation[2];   /* how much of it the body's turning makes, for x and y */
  qt_real gyro_lag;               /* of a reading of the gyroscope [s] */
  qt_real flow_least_height;      /* below which the flow is ignored [m] */
  qt_real flow_timeout;           /* after which the newest flow is not used [s] */
  bool hold_flow;                 /* the newest flow corrects in every period until the next */
  bool position_of_flow;          /* position is the sum of the flow's velocity */
  qt_real position_Q;             /* that px and py gain in a period [m^2] */
  qt_real vision_R;               /* of a position from images, per axis [m^2] */
} qt_estimator_parameters_t;

#endif
#if QT_WITH_UQUAD
typedef struct {
  int32_t calibration_periods; /* in which the vehicle is stationary after the start */
  qt_real Q[QT_STATES];        /* variances that the states gain in a period */
  qt_real start_variance[QT_STATES];
  qt_real tilt_R;             /* of roll and pitch by the accelerometer [rad^2] */
  qt_real yaw_R;              /* by the magnetometer [rad^2] */
  qt_real force_R;            /* of the specific force, per axis [m^2/s^4] */
  qt_real rates_R;            /* of the gyroscope, per axis [rad^2/s^2] */
  qt_real height_R;           /* by the barometer [m^2] */
  qt_real gps_position_R;     /* per axis [m^2] */
  qt_real gps_velocity_R;     /* per axis [m^2/s^2] */
  qt_real vision_R;           /* of positions from images, per axis [m^2] */
  qt_real gate;               /* e^2/S above which a measurement is rejected */
  bool position;              /* false: px, py, u and v are constant, without error */
  bool biases;                /* whether those of the accelerometer are estimated */
  bool yaw_by_estimated_tilt; /* the field is leveled by the estimated tilt, not by the force */
  /* Variances of tilt and yaw are multiplied by 1 + (d/band)^2, with d the relative difference of
   * |f| from g, for the yaw also that of the field from its norm. */
  bool dynamic_covariance;
  qt_real force_band;
  qt_real field_band;
  qt_real field_norm;         /* [uT]; 0: the mean while stationary */
  qt_real declination;        /* of magnetic north, east positive [rad] */
  qt_real reference_pressure; /* at z = 0, unless there is a mean while stationary [Pa] */
  qt_real gps_timeout;        /* without GPS and images, after which u and v are held at 0 [s] */
  qt_real still_variance;     /* of that [m^2/s^2] */
  qt_real standing_variance;  /* of the velocity 0 while stationary [m^2/s^2] */
  /* The vehicle. */
  qt_real gravity;              /* [m/s^2] */
  qt_real inverse_mass;         /* [1/kg] */
  qt_real J[9];                 /* inertia, row by row [kg m^2] */
  qt_real J_inverse[9];         /* [1/(kg m^2)] */
  qt_real drag[3];              /* density of the air times area and coefficient, per axis [kg/m] */
  qt_real linear_drag[3];       /* per axis [N s/m] */
  qt_real rotor_x[QT_ROTORS];   /* of the hub, forward of the centre of mass [m] */
  qt_real rotor_y[QT_ROTORS];   /* to the right of it [m] */
  qt_real spin[QT_ROTORS];      /* 1 or -1: which way it turns about body z */
  qt_real thrust_a2[QT_ROTORS]; /* thrust = a2 w^2 + a1 w [N s^2/rad^2] */
  qt_real thrust_a1[QT_ROTORS]; /* [N s/rad] */
  qt_real torque_d2[QT_ROTORS]; /* drag torque = d2 w^2 + d1 w [N m s^2/rad^2] */
  qt_real torque_d1[QT_ROTORS]; /* [N m s/rad] */
  qt_real spin_inertia[QT_ROTORS]; /* of the turning parts, times the spin [kg m^2] */
  qt_real hover_speed[QT_ROTORS];  /* [rad/s] */
} qt_estimator_parameters_t;

#endif
#if QT_WITH_CASCADE
typedef struct {
  qt_real dt;               /* control period [s] */
  qt_real Kp;               /* output per error */
  qt_real Ki;               /* output per error and second */
  qt_real Kd;               /* output per measured rate; the opposite sign of Kp damps */
  qt_real set_point_weight; /* share of the set point in the proportional part */
  qt_real error_now;        /* weight of the present error in the integral's increment */
  qt_real error_before;     /* weight of the error before */
  qt_real output_min;
  qt_real output_max;
  qt_real integral_min;
  qt_real integral_max;
  qt_real back_calculation; /* [1/s] */
#if QT_WITH_RATE_LEAD
  /* Kd also acts on rate_lead times the rate minus its low pass, which changes by rate_share of this
   * difference in each period. */
  qt_real rate_lead;
  qt_real rate_share;
#endif
} qt_loop_t;

typedef struct {
  qt_loop_t x;             /* pitch reference [rad] from the error along the heading [m] */
  qt_loop_t y;             /* roll reference [rad] from the error across the heading [m] */
  qt_loop_t roll;          /* tau_x [N m] from [rad] */
  qt_loop_t pitch;         /* tau_y */
  qt_loop_t yaw;           /* tau_z */
  qt_loop_t altitude;      /* force down beside the weight [N] from the error in height, down [m] */
  qt_real attitude_limit;  /* of roll and pitch reference [rad] */
  qt_real weight;          /* m g [N] */
  qt_real take_off_thrust; /* [N] */
  qt_real greatest_thrust; /* [N] */
  bool velocity_feed_forward; /* the reference's velocity is subtracted from that which is damped */
  bool conditional_integration; /* integrals do not grow where the motors produce no more */
} qt_law_parameters_t;

#else
#if QT_WITH_INTEGRALS
typedef struct {
  qt_real error_limit;     /* an error beyond it is not integrated */
  qt_real increment_limit; /* of the integral in one period */
  qt_real integral_limit;
} qt_guard_t;

#endif
typedef struct {
  qt_real dt;               /* control period [s] */
  qt_real x0[12];           /* set point at which u0 holds */
  qt_real u0[QT_INPUTS];    /* @INPUT_UNIT@ */
  qt_real K[QT_INPUTS][12]; /* [unit of the input per unit of the state] */
#if QT_WITH_INTEGRALS
  qt_real K_int[QT_INPUTS][QT_INTEGRALS];
  int integrated[QT_INTEGRALS]; /* which of the 12 states */
  qt_guard_t guard[QT_INTEGRALS];
  int of_position[2];           /* which integral is that of north and of east; -1: none */
#endif
  bool heading_axes;            /* errors of position are turned from the trim's heading */
  qt_real position_error_limit; /* of the error that the law sees [m] */
  bool conditional_integration; /* integrals do not grow where the motors produce no more */
#if QT_WITH_MEMORY
  qt_real lag_share[QT_INPUTS]; /* 1 - exp(-dt/lag) */
  qt_real K_lag[QT_INPUTS][QT_INPUTS];
#endif
#if QT_WITH_PAST
  qt_real K_past[QT_INPUTS][QT_PAST * QT_INPUTS];
#endif
} qt_law_parameters_t;

#endif
/* Conversion from a wrench (thrust along body -z, torques about body x, y, z) to commands. */
typedef struct {
  qt_real P[QT_ROTORS][4]; /* thrusts from wrench */
#if !QT_WITH_CASCADE
  qt_real M[4][QT_ROTORS]; /* wrench from thrusts */
#endif
  qt_real wrench0[4];          /* at hover [N, N m] */
  qt_real thrust0[QT_ROTORS];  /* [N] */
  qt_real a2[QT_ROTORS];       /* thrust = a2 w^2 + a1 w [N s^2/rad^2] */
  qt_real a1[QT_ROTORS];       /* [N s/rad] */
  qt_real least[QT_ROTORS];    /* thrust [N] */
  qt_real greatest[QT_ROTORS]; /* [N] */
  qt_real floor;               /* least collective thrust [N] */
  qt_real gain;                /* @GAIN@ */
  qt_real least_command;
  qt_real greatest_command;
#if QT_WITH_QUANTUM
  qt_real quantum; /* the command's smallest step */
#endif
  qt_real direction[QT_ROTORS]; /* sign of each motor's command */
} qt_motors_t;

typedef struct {
#if QT_WITH_ESTIMATOR
  qt_estimator_parameters_t estimator;
#endif
  qt_law_parameters_t law;
  qt_motors_t motors;
} qt_parameters_t;

extern const qt_parameters_t qt_parameters;

#if QT_WITH_ESTIMATOR
void qt_estimator_initialize(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                             const qt_start_t *start);
/* The caller checks whether the estimate is finite. */
void qt_estimator_step(const qt_estimator_parameters_t *p, qt_estimator_state_t *s,
                       const qt_sensors_t *sensors, qt_estimate_t *estimate);
#endif
#if QT_WITH_CASCADE
void qt_law_step(const qt_law_parameters_t *p, qt_law_state_t *s, const qt_estimate_t *x,
                 const qt_reference_t *reference, qt_real wrench[4]);
/* Informs the law what the motors produce of its request. */
void qt_law_carried_out(const qt_law_parameters_t *p, qt_law_state_t *s, const qt_real asked[4],
                        const qt_real made[4]);
#else
void qt_law_step(const qt_law_parameters_t *p, qt_law_state_t *s, const qt_estimate_t *estimate,
                 const qt_reference_t *reference, qt_real u[QT_INPUTS]);
/* Informs the law what the motors produce of its request. */
void qt_law_carried_out(const qt_law_parameters_t *p, qt_law_state_t *s,
                        const qt_real asked[QT_INPUTS], const qt_real made[QT_INPUTS]);
#endif

/* The feasible wrench nearest to `asked`; `asked` itself if the rotors can produce it.
 * Returns whether it differs. */
bool qt_prioritize(const qt_motors_t *p, const qt_real asked[4], qt_real made[4]);
void qt_speeds_of_wrench(const qt_motors_t *p, const qt_real wrench[4], qt_real speeds[QT_ROTORS]);
/* Commands for these speeds, within the motors' limits, and the resulting speeds. */
void qt_commands_of_speeds(const qt_motors_t *p, qt_real speeds[QT_ROTORS],
                           qt_real commands[QT_ROTORS]);
void qt_speeds_of_commands(const qt_motors_t *p, const qt_real commands[QT_ROTORS],
                           qt_real speeds[QT_ROTORS]);
#if !QT_WITH_CASCADE
/* The inputs of the law that correspond to these speeds. */
void qt_inputs_of_speeds(const qt_motors_t *p, const qt_real speeds[QT_ROTORS],
                         qt_real inputs[QT_INPUTS]);
#endif
#if QT_WITH_ROTOR_INPUTS
/* The speeds that correspond to the inputs of the law. */
void qt_speeds_of_inputs(const qt_motors_t *p, const qt_real inputs[QT_INPUTS],
                         qt_real speeds[QT_ROTORS]);
/* The wrench of these speeds; returns whether a rotor cannot produce its thrust. */
bool qt_wrench_of_speeds(const qt_motors_t *p, const qt_real speeds[QT_ROTORS], qt_real wrench[4]);
#endif

#endif /* QT_INTERNAL_H */
