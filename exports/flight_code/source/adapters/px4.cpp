/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The control law as a module of PX4 (written for v1.15). PX4's own estimator gives the states; the
 * thrusts of the rotors go to `actuator_motors`.
 *
 * Before it flies: stop mc_rate_control, mc_att_control, mc_pos_control and control_allocator,
 * which publish the same topics; and compare the order of the motors in rotor_of_motor with the
 * CA_ROTOR parameters of your airframe. A control of 1 means the thrust of a rotor at its greatest
 * command; THR_MDL_FAC must describe how your motors' thrust depends on their signal (0 where it is
 * proportional to it).
 */
#include <lib/mathlib/mathlib.h>
#include <px4_platform_common/module.h>
#include <uORB/topics/actuator_armed.h>
#include <uORB/topics/actuator_motors.h>
#include <uORB/topics/trajectory_setpoint.h>
#include <uORB/topics/vehicle_angular_velocity.h>
#include <uORB/topics/vehicle_attitude.h>
#include <uORB/topics/vehicle_local_position.h>

#include <cmath>
#include <cstring>
#include <px4_platform_common/px4_work_queue/ScheduledWorkItem.hpp>
#include <uORB/Publication.hpp>
#include <uORB/Subscription.hpp>

extern "C" {
#include "internal.h"
}

/* Rotor of the law for each motor of the airframe. */
static constexpr int rotor_of_motor[QT_ROTORS] = {QT_ROTORS_OF_MOTORS};

class QtModule : public ModuleBase<QtModule>, public px4::ScheduledWorkItem {
 public:
  QtModule() : ScheduledWorkItem(MODULE_NAME, px4::wq_configurations::rate_ctrl) { initialize(); }

  bool init() {
    ScheduleOnInterval(static_cast<uint32_t>((QT_DT * 1e6f) + 0.5f));
    return true;
  }

  static int task_spawn(int argc, char *argv[]) {
    (void)argc;
    (void)argv;
    QtModule *instance = new QtModule();

    if (instance == nullptr) {
      return PX4_ERROR;
    }

    _object.store(instance);
    _task_id = task_id_is_work_queue;
    return instance->init() ? PX4_OK : PX4_ERROR;
  }

  static int custom_command(int argc, char *argv[]) {
    (void)argc;
    (void)argv;
    return print_usage("unknown command");
  }

  static int print_usage(const char *reason = nullptr) {
    if (reason != nullptr) {
      PX4_WARN("%s", reason);
    }

    PRINT_MODULE_DESCRIPTION("Flight program @NAME@: @DESCRIPTION@.");
    PRINT_MODULE_USAGE_NAME("@NAME@", "controller");
    PRINT_MODULE_USAGE_COMMAND("start");
    PRINT_MODULE_USAGE_DEFAULT_COMMANDS();
    return 0;
  }

 private:
  void Run() override {
    if (should_exit()) {
      ScheduleClear();
      exit_and_cleanup();
      return;
    }

    actuator_armed_s armed{};
    _armed_sub.copy(&armed);

    if (!armed.armed || armed.lockdown) {
      initialize();
      stop();
      return;
    }

    if (!read_estimate()) {
      stop();
      return;
    }

    read_reference();
    qt_control(&_law, &_estimate, &_reference, &_output);
    publish();
  }

  void initialize() {
    const qt_start_t start = {};
    qt_initialize(&_law, &start);
    _estimate = {};
    _reference = {};
    _flying = false;
    _placed = false;
  }

  /*
   * World north-east-down and body forward-right-down, as the law has them. Without a position on
   * the map the law flies level; without a height it keeps its thrust near that of hover. returns:
   * false without an attitude or rates
   */
  bool read_estimate() {
    vehicle_attitude_s attitude;
    vehicle_angular_velocity_s rates;
    vehicle_local_position_s position{};

    if (!_attitude_sub.copy(&attitude) || !_rates_sub.copy(&rates)) {
      return false;
    }

    (void)_position_sub.copy(&position);
    const qt_real w = attitude.q[0];
    const qt_real x = attitude.q[1];
    const qt_real y = attitude.q[2];
    const qt_real z = attitude.q[3];
    const qt_real R[9] = {1.0f - (2.0f * ((y * y) + (z * z))), 2.0f * ((x * y) - (w * z)),
                          2.0f * ((x * z) + (w * y)),          2.0f * ((x * y) + (w * z)),
                          1.0f - (2.0f * ((x * x) + (z * z))), 2.0f * ((y * z) - (w * x)),
                          2.0f * ((x * z) - (w * y)),          2.0f * ((y * z) + (w * x)),
                          1.0f - (2.0f * ((x * x) + (y * y)))};
    qt_real velocity[3] = {0.0f, 0.0f, 0.0f};
    const bool placed = position.xy_valid && position.v_xy_valid;

    if (placed) {
      _estimate.position[0] = position.x;
      _estimate.position[1] = position.y;
      velocity[0] = position.vx;
      velocity[1] = position.vy;
    }

    if (position.z_valid && position.v_z_valid) {
      _estimate.position[2] = position.z;
      velocity[2] = position.vz;
    }

    if (placed && !_placed) { /* the reference begins where the vehicle is */
      _reference.position[0] = _estimate.position[0];
      _reference.position[1] = _estimate.position[1];
    }

    _placed = placed;
    _estimate.roll = atan2f(R[7], R[8]);
    _estimate.pitch = -asinf(qt_clamp(R[6], -1.0f, 1.0f));
    _estimate.yaw = near_to(atan2f(R[3], R[0]), _estimate.yaw);

    for (int i = 0; i < 3; ++i) { /* the transpose takes world axes to body axes */
      _estimate.velocity[i] =
          (R[i] * velocity[0]) + (R[3 + i] * velocity[1]) + (R[6 + i] * velocity[2]);
      _estimate.rates[i] = rates.xyz[i];
    }

    _estimate.finite = true;
    return true;
  }

  /* Position, velocity and heading that are not finite are not asked for: the vehicle keeps its
   * own. */
  void read_reference() {
    trajectory_setpoint_s asked;

    if (!_flying) {
      memcpy(_reference.position, _estimate.position, sizeof _reference.position);
      _reference.yaw = _estimate.yaw;
      _flying = true;
    }

    _reference.phase = QT_FLYING;
    _reference.track_position = _placed;

    if (!_setpoint_sub.copy(&asked)) {
      return;
    }

    for (int i = 0; i < 3; ++i) {
      const bool moves = PX4_ISFINITE(asked.velocity[i]);
      _reference.velocity[i] = moves ? asked.velocity[i] : 0.0f;

      if (PX4_ISFINITE(asked.position[i])) {
        _reference.position[i] = asked.position[i];

      } else if (moves) {
        _reference.position[i] += asked.velocity[i] * QT_DT;
      }
    }

    if (PX4_ISFINITE(asked.yaw)) {
      _reference.yaw = near_to(asked.yaw, _estimate.yaw);

    } else if (PX4_ISFINITE(asked.yawspeed)) {
      _reference.yaw += asked.yawspeed * QT_DT;
    }
  }

  void publish() {
    const qt_motors_t &motors = qt_parameters.motors;
    actuator_motors_s out{};

    for (int m = 0; m < actuator_motors_s::NUM_CONTROLS; ++m) {
      out.control[m] = NAN; /* no such motor */
    }

    for (int m = 0; m < QT_ROTORS; ++m) {
      const int i = rotor_of_motor[m];
      const qt_real w = _output.speed[i];
      const qt_real thrust = ((motors.a2[i] * w) + motors.a1[i]) * w;
      out.control[m] =
          _output.estimate.finite ? qt_clamp(thrust / motors.greatest[i], 0.0f, 1.0f) : NAN;
    }

    out.timestamp = out.timestamp_sample = hrt_absolute_time();
    _motors_pub.publish(out);
  }

  void stop() {
    qt_terminate(&_law, &_output);
    publish();
  }

  /* `angle` plus the whole turns that bring it nearest to `to`. */
  static qt_real near_to(qt_real angle, qt_real to) {
    return angle + ((2.0f * QT_PI) * qt_nearest((to - angle) / (2.0f * QT_PI)));
  }

  qt_state_t _law;
  qt_estimate_t _estimate;
  qt_reference_t _reference;
  qt_output_t _output;
  bool _flying{false};
  bool _placed{false}; /* whether the place on the map is known */

  uORB::Subscription _armed_sub{ORB_ID(actuator_armed)};
  uORB::Subscription _attitude_sub{ORB_ID(vehicle_attitude)};
  uORB::Subscription _position_sub{ORB_ID(vehicle_local_position)};
  uORB::Subscription _rates_sub{ORB_ID(vehicle_angular_velocity)};
  uORB::Subscription _setpoint_sub{ORB_ID(trajectory_setpoint)};
  uORB::Publication<actuator_motors_s> _motors_pub{ORB_ID(actuator_motors)};
};

extern "C" __EXPORT int qt_main(int argc, char *argv[]) { return QtModule::main(argc, argv); }
