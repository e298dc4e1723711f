/* SPDX-License-Identifier: Apache-2.0 */
/* Feeds a recorded flight to the module by its topics. fly flight.txt A2 GREATEST_THRUST */
extern "C" {
#include "../recorded.h"
}
#include "adapter_px4.cpp"

/* Rotors of the vehicle: 1 front left, 2 front right, 3 back right, 4 back left. Motors of PX4:
 * 1 front right, 2 back left, 3 front left, 4 back right. */
static const int kRotor[4] = {1, 3, 0, 2};

int main(int argc, char **argv) {
  (void)argc;
  FILE *file = std::fopen(argv[1], "r");
  const double a2 = std::atof(argv[2]), greatest = std::atof(argv[3]);
  static prog_state_t law;
  prog_start_t start{};
  prog_initialize(&law, &start);
  if (prog_main(0, nullptr) != 0) return 2;
  ProgModule *module = ProgModule::instance();
  if (module->interval != static_cast<std::uint32_t>(PROG_DT * 1e6f + 0.5f)) return 5;
  Topic<actuator_armed_s>::newest.armed = true;
  Topic<actuator_armed_s>::has = true;
  recorded_t one;
  double worst = 0, expected[PROG_ROTORS];
  unsigned periods = 0;
  while (next_recorded(file, &one)) {
    if (one.reference.phase == PROG_IDLE) continue;
    one.reference.track_position = true;
    thrusts_of(&law, &one, a2, greatest, expected);
    auto &position = Topic<vehicle_local_position_s>::newest;
    position = {true, true, true, true, 0, 0, 0, 0, 0, 0};
    position.x = static_cast<float>(one.position[0]);
    position.y = static_cast<float>(one.position[1]);
    position.z = static_cast<float>(one.position[2]);
    position.vx = static_cast<float>(one.world[0]);
    position.vy = static_cast<float>(one.world[1]);
    position.vz = static_cast<float>(one.world[2]);
    auto &asked = Topic<trajectory_setpoint_s>::newest;
    for (int i = 0; i < 3; ++i) {
      asked.position[i] = one.reference.position[i];
      asked.velocity[i] = one.reference.velocity[i];
      Topic<vehicle_angular_velocity_s>::newest.xyz[i] = static_cast<float>(one.rates[i]);
    }
    asked.yaw = one.reference.yaw;
    for (int i = 0; i < 4; ++i)
      Topic<vehicle_attitude_s>::newest.q[i] = static_cast<float>(one.quaternion[i]);
    Topic<vehicle_local_position_s>::has = Topic<trajectory_setpoint_s>::has = true;
    Topic<vehicle_angular_velocity_s>::has = Topic<vehicle_attitude_s>::has = true;
    module->now();
    const auto &out = Topic<actuator_motors_s>::newest;
    for (int m = 0; m < 4; ++m)
      worst = std::fmax(worst, std::fabs(out.control[m] - expected[kRotor[m]]));
    if (!std::isnan(out.control[4])) return 6;
    ++periods;
  }
  // Without a place on the map it flies on; disarmed it stops.
  Topic<vehicle_local_position_s>::newest.xy_valid = false;
  module->now();
  if (!(Topic<actuator_motors_s>::newest.control[0] > 0)) return 7;
  Topic<actuator_armed_s>::newest.armed = false;
  module->now();
  if (!std::isnan(Topic<actuator_motors_s>::newest.control[0])) return 8;
  std::printf("%u periods, thrusts apart by %.2e\n", periods, worst);
  return periods > 100 && worst < 1e-3 ? 0 : 1;
}
