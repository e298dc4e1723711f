/* SPDX-License-Identifier: Apache-2.0 */
/* The messages, as far as they are used, and one place for the newest of each. */
#pragma once
#include <cstdint>

struct actuator_armed_s {
  bool armed, lockdown, manual_lockdown, force_failsafe;
};
struct actuator_motors_s {
  static constexpr int NUM_CONTROLS = 12;
  uint64_t timestamp, timestamp_sample;
  float control[NUM_CONTROLS];
  uint16_t reversible_flags;
};
struct trajectory_setpoint_s {
  uint64_t timestamp;
  float position[3], velocity[3], yaw, yawspeed;
};
struct vehicle_angular_velocity_s {
  uint64_t timestamp;
  float xyz[3];
};
struct vehicle_attitude_s {
  uint64_t timestamp;
  float q[4];
};
struct vehicle_land_detected_s {
  bool landed;
};
struct vehicle_local_position_s {
  uint64_t timestamp;
  bool xy_valid, z_valid, v_xy_valid, v_z_valid;
  float x, y, z, vx, vy, vz;
  float delta_xy[2], delta_z, delta_heading;
  uint8_t xy_reset_counter, z_reset_counter, heading_reset_counter;
};
struct vehicle_thrust_setpoint_s {
  uint64_t timestamp, timestamp_sample;
  float xyz[3];
};
struct vehicle_torque_setpoint_s {
  uint64_t timestamp, timestamp_sample;
  float xyz[3];
};

template <class T>
struct Topic {
  static inline T newest{};
  static inline bool has = false;
};
template <class T>
struct orb_metadata {
  using Message = T;
};
#define ORB_ID(name) orb_metadata<name##_s>()
