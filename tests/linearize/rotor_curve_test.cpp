// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "quadtune/model/vehicle.hpp"
#include "trim_problem.hpp"

namespace quadtune::internal {
namespace {

RotorCurve curve_of(const Vehicle& vehicle) {
  return RotorCurve(vehicle.rotors.front(), vehicle.motor, 1, 1);
}

// The uquad's rotors have thrust and torque with linear terms.
TEST(RotorCurve, InvertsThrustAndTorqueOfARotor) {
  for (const char* name : {"uquad", "mambo"}) {
    const Vehicle vehicle = load_vehicle(name);
    const Rotor& rotor = vehicle.rotors.front();
    const RotorCurve curve = curve_of(vehicle);
    for (int tenth = 1; tenth <= 10; ++tenth) {
      const double speed =
          curve.min_speed() + 0.1 * tenth * (curve.max_speed() - curve.min_speed());
      const double thrust = rotor_thrust(rotor, speed, 1);
      EXPECT_NEAR(curve.speed(thrust), speed, 1e-9 * speed) << name;
      EXPECT_NEAR(curve.torque(thrust), rotor_torque(rotor, speed, 1),
                  1e-9 * rotor_torque(rotor, speed, 1))
          << name;
    }
  }
}

// Newton's method passes through thrusts that no rotor has. There the torque is continued by the
// tangent: value and slope are continuous, and the continuation is a straight line.
TEST(RotorCurve, ContinuesTheTorqueByItsTangent) {
  for (const char* name : {"uquad", "mambo"}) {
    const Vehicle vehicle = load_vehicle(name);
    const RotorCurve curve = curve_of(vehicle);
    // The speed is constant where the continuation is used.
    double low = -1, high = curve.max_thrust();
    while (high - low > 1e-12 * curve.max_thrust()) {
      const double middle = (low + high) / 2;
      (curve.speed(middle) > curve.speed(-1.0) ? high : low) = middle;
    }
    const double join = low, step = 1e-4 * curve.max_thrust();
    const double at = curve.torque(join);
    const double below = at - curve.torque(join - step);
    const double above = curve.torque(join + step) - at;
    EXPECT_GT(below, 0) << name;
    EXPECT_NEAR(below, above, 0.1 * below) << name;
    EXPECT_NEAR(at - curve.torque(join - 1000 * step), 1000 * below, 1e-6 * below) << name;
    EXPECT_NEAR(curve.torque(join * (1 + 1e-9)), at, 1e-6 * std::abs(at)) << name;
  }
}

}  // namespace
}  // namespace quadtune::internal
