/* SPDX-License-Identifier: Apache-2.0 */
/* The messages, as far as they are used, and one place for the newest of each. */
#pragma once
#include <cstdint>

struct actuator_armed_s {
  bool armed, lockdown;
};
struct actuator_motors_s {
  static constexpr int NUM_CONTROLS = 12;
  uint64_t timestamp, timestamp_sample;
  float control[NUM_CONTROLS];
  uint16_t reversible_flags;
};
struct trajectory_setpoint_s {
  float position[3], velocity[3], yaw, yawspeed;
};
struct vehicle_angular_velocity_s {
  float xyz[3];
};
struct vehicle_attitude_s {
  float q[4];
};
struct vehicle_local_position_s {
  bool xy_valid, z_valid, v_xy_valid, v_z_valid;
  float x, y, z, vx, vy, vz;
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
