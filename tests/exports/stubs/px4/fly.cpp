/* SPDX-License-Identifier: Apache-2.0 */
/* Feeds a recorded flight to the module by its topics, then what goes wrong in flight.
 * fly flight.txt A2 GREATEST_THRUST */
extern "C" {
#include "../recorded.h"
}
#include "adapter_px4.cpp"

/* Rotors of the vehicle: 1 front left, 2 front right, 3 back right, 4 back left. Motors of PX4:
 * 1 front right, 2 back left, 3 front left, 4 back right. */
static const int kRotor[4] = {1, 3, 0, 2};

template <class T>
static T &newest() {
  Topic<T>::has = true;
  return Topic<T>::newest;
}

static void tell(const recorded_t &one) {
  stub_now += static_cast<hrt_abstime>(PROG_DT * 1e6f + 0.5f);
  auto &position = newest<vehicle_local_position_s>();
  position.timestamp = stub_now;
  position.x = static_cast<float>(one.position[0]);
  position.y = static_cast<float>(one.position[1]);
  position.z = static_cast<float>(one.position[2]);
  position.vx = static_cast<float>(one.world[0]);
  position.vy = static_cast<float>(one.world[1]);
  position.vz = static_cast<float>(one.world[2]);
  newest<vehicle_angular_velocity_s>().timestamp = stub_now;
  newest<vehicle_attitude_s>().timestamp = stub_now;
  newest<trajectory_setpoint_s>().timestamp = stub_now;
  for (int i = 0; i < 3; ++i)
    newest<vehicle_angular_velocity_s>().xyz[i] = static_cast<float>(one.rates[i]);
  for (int i = 0; i < 4; ++i)
    newest<vehicle_attitude_s>().q[i] = static_cast<float>(one.quaternion[i]);
}

static double thrust() {
  double sum = 0;
  for (int m = 0; m < 4; ++m) sum += newest<actuator_motors_s>().control[m];
  return sum / 4; /* NaN where one is stopped */
}

#define REQUIRE(condition)                                \
  do {                                                    \
    if (!(condition)) {                                   \
      std::printf("line %d: " #condition "\n", __LINE__); \
      return 1;                                           \
    }                                                     \
  } while (false)

int main(int argc, char **argv) {
  (void)argc;
  std::FILE *file = std::fopen(argv[1], "r");
  const double a2 = std::atof(argv[2]), max = std::atof(argv[3]);
  static prog_state_t law;
  prog_start_t start{};
  prog_initialize(&law, &start);
  REQUIRE(prog_main(0, nullptr) == 0);
  ProgModule *module = ProgModule::instance();
  REQUIRE(module->interval == static_cast<std::uint32_t>(PROG_DT * 1e6f + 0.5f));
  module->now();
  REQUIRE(std::isnan(thrust())); /* not armed */
  newest<actuator_armed_s>().armed = true;
  auto &position = newest<vehicle_local_position_s>();
  position.xy_valid = position.z_valid = position.v_xy_valid = position.v_z_valid = true;
  auto &asked = newest<trajectory_setpoint_s>();
  recorded_t one, last;
  double expected[PROG_ROTORS];
  unsigned periods = 0;
  while (next_recorded(file, &one)) {
    if (one.reference.phase == PROG_IDLE) continue;
    last = one;
    one.reference.track_position = true;
    thrusts_of(&law, &one, a2, max, expected);
    tell(one);
    for (int i = 0; i < 3; ++i) {
      asked.position[i] = one.reference.position[i];
      asked.velocity[i] = one.reference.velocity[i];
    }
    asked.yaw = one.reference.yaw;
    module->now();
    const auto &out = newest<actuator_motors_s>();
    for (int m = 0; m < 4; ++m)
      REQUIRE(std::fabs(out.control[m] - std::fmin(expected[kRotor[m]], 1.0)) < 1e-3);
    REQUIRE(std::isnan(out.control[4]));
    REQUIRE(std::fabs(newest<vehicle_thrust_setpoint_s>().xyz[2] + thrust()) < 1e-3);
    ++periods;
  }
  REQUIRE(periods > 100);
  /* At rest in the air, held there: the mean thrust is that of hover. */
  one = last;
  std::memset(one.world, 0, sizeof one.world);
  std::memset(one.rates, 0, sizeof one.rates);
  one.quaternion[0] = 1;
  one.quaternion[1] = one.quaternion[2] = one.quaternion[3] = 0;
  for (int i = 0; i < 3; ++i) asked.position[i] = asked.velocity[i] = NAN;
  asked.yaw = asked.yawspeed = NAN;
  for (int k = 0; k < 50; ++k) tell(one), module->now();
  const double hover = thrust();
  REQUIRE(hover > 0.1 && hover < 0.9);
  /* A goal that was never reached does not count once velocities are asked for. */
  asked.position[2] = static_cast<float>(one.position[2]) - 5;
  tell(one), module->now();
  REQUIRE(thrust() > hover + 0.02);
  asked.position[2] = NAN;
  asked.velocity[2] = 0;
  for (int k = 0; k < 50; ++k) tell(one), module->now();
  REQUIRE(std::fabs(thrust() - hover) < 0.1);
  /* Without a height it does not climb after a goal above; without a place it flies on. */
  asked.velocity[2] = NAN;
  asked.position[2] = static_cast<float>(one.position[2]) - 5;
  position.z_valid = false;
  position.xy_valid = false;
  for (int k = 0; k < 50; ++k) tell(one), module->now();
  REQUIRE(std::fabs(thrust() - hover) < 0.1);
  position.z_valid = position.xy_valid = true;
  asked.position[2] = NAN;
  /* The estimator jumps by 3 m: what is held jumps with it. */
  for (int k = 0; k < 50; ++k) tell(one), module->now();
  const double before = thrust();
  one.position[2] -= 3;
  position.delta_z = -3;
  ++position.z_reset_counter;
  tell(one), module->now();
  REQUIRE(std::fabs(thrust() - before) < 0.02);
  /* One bad attitude is bridged, half a second without rates is not. */
  one.quaternion[1] = NAN;
  tell(one), module->now();
  REQUIRE(std::fabs(thrust() - before) < 0.02);
  one.quaternion[1] = 0;
  tell(one), module->now();
  REQUIRE(std::fabs(thrust() - before) < 0.02);
  for (int k = 0; k < 200; ++k) stub_now += 4000, module->now();
  REQUIRE(std::isnan(thrust()));
  /* On the ground it waits until a climb is asked for. */
  newest<vehicle_land_detected_s>().landed = true;
  for (int k = 0; k < 10; ++k) tell(one), module->now();
  REQUIRE(thrust() == 0);
  asked.position[2] = static_cast<float>(one.position[2]) - 1;
  for (int k = 0; k < 10; ++k) tell(one), module->now();
  REQUIRE(thrust() > 0.1);
  newest<vehicle_land_detected_s>().landed = false;
  newest<actuator_armed_s>().manual_lockdown = true;
  tell(one), module->now();
  REQUIRE(std::isnan(thrust()));
  newest<actuator_armed_s>().manual_lockdown = false;
  tell(one), module->now();
  REQUIRE(thrust() > 0.1);
  ProgModule::asked_to_exit = true;
  module->now();
  REQUIRE(std::isnan(thrust()));
  std::printf("%u periods as the law\n", periods);
  return 0;
}
