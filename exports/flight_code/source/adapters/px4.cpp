/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The control law as a module of PX4 (written for v1.15). The states are those of PX4's own
 * estimator; the thrusts of the rotors are sent to `actuator_motors`.
 *
 * Before the first flight:
 * - stop mc_rate_control, mc_att_control, mc_pos_control and control_allocator;
 * - compare the order of the motors in rotor_of_motor with the CA_ROTOR parameters of the airframe;
 * - set COM_DISARM_LAND and COM_DISARM_PRFLT to -1 until you have verified that the land detector,
 *   which evaluates vehicle_thrust_setpoint, does not mistake your hover for standing on the
 *   ground.
 *
 * A control of 1 means the thrust of a rotor at its maximum command; THR_MDL_FAC must describe how
 * the thrust of your motors depends on their signal (0 if it is proportional).
 *
 * It follows trajectory_setpoint, in any mode. Without a message in the last half second, or since
 * arming, it holds its position; on the ground it waits with idle motors until a climb is
 * commanded. Sticks have no direct effect.
 */
#include <drivers/drv_hrt.h>
#include <px4_platform_common/module.h>
#include <uORB/topics/actuator_armed.h>
#include <uORB/topics/actuator_motors.h>
#include <uORB/topics/trajectory_setpoint.h>
#include <uORB/topics/vehicle_angular_velocity.h>
#include <uORB/topics/vehicle_attitude.h>
#include <uORB/topics/vehicle_land_detected.h>
#include <uORB/topics/vehicle_local_position.h>
#include <uORB/topics/vehicle_thrust_setpoint.h>
#include <uORB/topics/vehicle_torque_setpoint.h>

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

/* Ages above which a message is ignored [us]. */
static constexpr hrt_abstime kRatesAge = 20000;
static constexpr hrt_abstime kAttitudeAge = 50000;
static constexpr hrt_abstime kPositionAge = 500000;
static constexpr hrt_abstime kSetpointAge = 500000;
/* Duration for which the last commands are kept if messages are missing [us]. */
static constexpr hrt_abstime kBridge = 100000;
/* Maximum distance between a moving reference and the vehicle [m], [rad]. */
static constexpr qt_real kPositionLeash = 1.0f;
static constexpr qt_real kYawLeash = 1.0f;

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
    PRINT_MODULE_DESCRIPTION("Flight program @NAME@ of quadtune.");
    PRINT_MODULE_USAGE_NAME("@NAME@", "controller");
    PRINT_MODULE_USAGE_COMMAND("start");
    PRINT_MODULE_USAGE_DEFAULT_COMMANDS();
    return 0;
  }

 private:
  void Run() override {
    if (should_exit()) {
      stop();
      ScheduleClear();
      exit_and_cleanup();
      return;
    }
    const hrt_abstime now = hrt_absolute_time();
    actuator_armed_s armed{};
    (void)_armed_sub.copy(&armed);
    if (!armed.armed || armed.lockdown || armed.manual_lockdown || armed.force_failsafe) {
      initialize();
      stop();
      _armed_at = now;
      return;
    }
    if (read_estimate(now)) {
      _good_at = now;
      fly(now);
      publish();
    } else if ((now - _good_at) < kBridge) {
      publish(); /* the last commands once more */
    } else {
      initialize();
      stop();
    }
  }

  void fly(hrt_abstime now) {
    trajectory_setpoint_s asked{};
    const bool has = _setpoint_sub.copy(&asked) && (asked.timestamp >= _armed_at) &&
                     ((now - asked.timestamp) < kSetpointAge);
    if (!_flying) {
      hold_here();
    }
    if (on_ground() && !(has && asks_to_climb(asked))) {
      const qt_estimate_t here = _estimate;
      initialize();
      _estimate = here;
      _reference.phase = QT_IDLE; /* with commands of 0 */
    } else {
      _flying = true;
      _reference.phase = QT_FLYING;
      read_reference(has ? &asked : nullptr);
    }
    qt_control(&_law, &_estimate, &_reference, &_output);
  }

  bool on_ground() {
    vehicle_land_detected_s land{};
    return _land_sub.copy(&land) && land.landed;
  }

  bool asks_to_climb(const trajectory_setpoint_s &asked) const {
    return (PX4_ISFINITE(asked.position[2]) &&
            (asked.position[2] < (_estimate.position[2] - 0.2f))) ||
           (!PX4_ISFINITE(asked.position[2]) && PX4_ISFINITE(asked.velocity[2]) &&
            (asked.velocity[2] < -0.1f));
  }

  void initialize() {
    const qt_start_t start = {};
    qt_initialize(&_law, &start);
    _estimate = {};
    _reference = {};
    _flying = false;
    _placed = false;
    _high = false;
  }

  void hold_here() {
    memcpy(_reference.position, _estimate.position, sizeof _reference.position);
    _reference.yaw = _estimate.yaw;
    for (Asked &asked : _asked) {
      asked = Asked::nothing;
    }
  }

  /*
   * World north-east-down and body forward-right-down, as in the law. Without a position on the map
   * the law flies level; without a height it holds the last one, with a climb rate of 0.
   * returns: false without a current attitude or current rates
   */
  bool read_estimate(hrt_abstime now) {
    vehicle_attitude_s attitude{};
    vehicle_angular_velocity_s rates{};
    vehicle_local_position_s position{};
    if (!_attitude_sub.copy(&attitude) || ((now - attitude.timestamp) > kAttitudeAge) ||
        !_rates_sub.copy(&rates) || ((now - rates.timestamp) > kRatesAge)) {
      return false;
    }
    const bool fresh = _position_sub.copy(&position) && ((now - position.timestamp) < kPositionAge);
    const bool placed = fresh && position.xy_valid && position.v_xy_valid;
    const bool high = fresh && position.z_valid && position.v_z_valid;
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
    qt_estimate_t next = _estimate;
    if (placed) {
      next.position[0] = position.x;
      next.position[1] = position.y;
      velocity[0] = position.vx;
      velocity[1] = position.vy;
    }
    if (high) {
      next.position[2] = position.z;
      velocity[2] = position.vz;
    }
    next.roll = atan2f(R[7], R[8]);
    next.pitch = -asinf(qt_clamp(R[6], -1.0f, 1.0f));
    next.yaw = near_to(atan2f(R[3], R[0]), _estimate.yaw);
    for (int i = 0; i < 3; ++i) { /* the transpose takes world axes to body axes */
      next.velocity[i] = (R[i] * velocity[0]) + (R[3 + i] * velocity[1]) + (R[6 + i] * velocity[2]);
      next.rates[i] = rates.xyz[i];
    }
    next.finite = true;
    if (!qt_is_finite(w + x + y + z) || !qt_is_finite(next.yaw) || !qt_all_finite(next.position) ||
        !qt_all_finite(next.velocity) || !qt_all_finite(next.rates)) {
      return false;
    }
    _estimate = next;
    follow_resets(position, placed, high);
    return true;
  }

  /* If the estimate jumps, the held reference jumps with it. When the estimator starts to know a
   * position or a height, the reference starts there. */
  void follow_resets(const vehicle_local_position_s &position, bool placed, bool high) {
    for (int i = 0; i < 2; ++i) {
      if (placed && !_placed) {
        _reference.position[i] = _estimate.position[i];
      } else if (placed && (position.xy_reset_counter != _xy_resets)) {
        _reference.position[i] += position.delta_xy[i];
      }
    }
    if (high && !_high) {
      _reference.position[2] = _estimate.position[2];
    } else if (high && (position.z_reset_counter != _z_resets)) {
      _reference.position[2] += position.delta_z;
    }
    if (_placed && (position.heading_reset_counter != _heading_resets)) {
      _reference.yaw += position.delta_heading;
    }
    _placed = placed;
    _high = high;
    _xy_resets = position.xy_reset_counter;
    _z_resets = position.z_reset_counter;
    _heading_resets = position.heading_reset_counter;
  }

  enum class Asked { nothing, value, rate };

  static Asked kind_of(bool has, float value, float rate) {
    return (has && PX4_ISFINITE(value))  ? Asked::value
           : (has && PX4_ISFINITE(rate)) ? Asked::rate
                                         : Asked::nothing;
  }

  /* One axis of the position: as commanded, or advanced by the commanded velocity. */
  void follow(Asked asked, float value, float rate, bool known, int axis) {
    qt_real &to = _reference.position[axis];
    const qt_real here = _estimate.position[axis];
    if ((asked != _asked[axis]) || !known) {
      to = here; /* an older goal does not count any more */
    }
    _asked[axis] = asked;
    _reference.velocity[axis] = 0.0f;
    if (!known || (asked == Asked::nothing)) {
      return;
    }
    if (PX4_ISFINITE(rate)) {
      _reference.velocity[axis] = rate;
    }
    to = (asked == Asked::value)
             ? value
             : qt_clamp(to + (rate * QT_DT), here - kPositionLeash, here + kPositionLeash);
  }

  void read_reference(const trajectory_setpoint_s *from) {
    const trajectory_setpoint_s none{};
    const trajectory_setpoint_s &asked = (from != nullptr) ? *from : none;
    const bool has = from != nullptr;
    _reference.track_position = _placed;
    for (int i = 0; i < 3; ++i) {
      follow(kind_of(has, asked.position[i], asked.velocity[i]), asked.position[i],
             asked.velocity[i], (i < 2) ? _placed : _high, i);
    }
    const Asked turn = kind_of(has, asked.yaw, asked.yawspeed);
    if (turn != _asked[3]) {
      _reference.yaw = _estimate.yaw;
    }
    _asked[3] = turn;
    if (turn == Asked::value) {
      _reference.yaw = near_to(asked.yaw, _estimate.yaw);
    } else if (turn == Asked::rate) {
      _reference.yaw = qt_clamp(_reference.yaw + (asked.yawspeed * QT_DT),
                                _estimate.yaw - kYawLeash, _estimate.yaw + kYawLeash);
    }
  }

  void publish() {
    const qt_motors_t &motors = qt_parameters.motors;
    actuator_motors_s out{};
    qt_real all = 0.0f;
    qt_real max = 0.0f;
    for (int m = 0; m < actuator_motors_s::NUM_CONTROLS; ++m) {
      out.control[m] = NAN; /* no such motor */
    }
    for (int m = 0; m < QT_ROTORS; ++m) {
      const int i = rotor_of_motor[m];
      const qt_real w = _output.speed[i];
      const qt_real thrust = ((motors.a2[i] * w) + motors.a1[i]) * w;
      all += thrust;
      max += motors.greatest[i];
      out.control[m] =
          _output.estimate.finite ? qt_clamp(thrust / motors.greatest[i], 0.0f, 1.0f) : NAN;
    }
    out.timestamp = hrt_absolute_time();
    out.timestamp_sample = out.timestamp;
    _motors_pub.publish(out);
    /* Used by the land detector and the logs. */
    vehicle_thrust_setpoint_s thrust{};
    vehicle_torque_setpoint_s torque{};
    thrust.timestamp = torque.timestamp = out.timestamp;
    thrust.timestamp_sample = torque.timestamp_sample = out.timestamp;
    thrust.xyz[2] = -all / max;
    for (int i = 0; i < 3; ++i) {
      torque.xyz[i] = _output.wrench[1 + i];
    }
    _thrust_pub.publish(thrust);
    _torque_pub.publish(torque);
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
  Asked _asked[4]{}; /* of the axes x, y, z and of the heading */
  bool _flying{false};
  bool _placed{false}; /* whether the place on the map is known */
  bool _high{false};   /* whether the height is */
  uint8_t _xy_resets{0};
  uint8_t _z_resets{0};
  uint8_t _heading_resets{0};
  hrt_abstime _armed_at{0};
  hrt_abstime _good_at{0};

  uORB::Subscription _armed_sub{ORB_ID(actuator_armed)};
  uORB::Subscription _attitude_sub{ORB_ID(vehicle_attitude)};
  uORB::Subscription _land_sub{ORB_ID(vehicle_land_detected)};
  uORB::Subscription _position_sub{ORB_ID(vehicle_local_position)};
  uORB::Subscription _rates_sub{ORB_ID(vehicle_angular_velocity)};
  uORB::Subscription _setpoint_sub{ORB_ID(trajectory_setpoint)};
  uORB::Publication<actuator_motors_s> _motors_pub{ORB_ID(actuator_motors)};
  uORB::Publication<vehicle_thrust_setpoint_s> _thrust_pub{ORB_ID(vehicle_thrust_setpoint)};
  uORB::Publication<vehicle_torque_setpoint_s> _torque_pub{ORB_ID(vehicle_torque_setpoint)};
};

extern "C" __EXPORT int qt_main(int argc, char *argv[]) { return QtModule::main(argc, argv); }
