// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "quadtune/errors.hpp"
#include "quadtune/exports/uquad.hpp"
#include "quadtune/version.hpp"

namespace quadtune {
namespace {

bool same_curves(const Rotor& a, const Rotor& b) {
  return a.thrust_a2 == b.thrust_a2 && a.thrust_a1 == b.thrust_a1 && a.torque_d2 == b.torque_d2 &&
         a.torque_d1 == b.torque_d1 && a.inertia == b.inertia &&
         std::abs(std::hypot(a.position.x(), a.position.y()) -
                  std::hypot(b.position.x(), b.position.y())) < 1e-12;
}

}  // namespace

std::string uquad_constants_text(const Vehicle& vehicle, double dt) {
  const std::vector<Rotor>& rotors = vehicle.rotors;
  if (rotors.size() != 4 || !std::all_of(rotors.begin(), rotors.end(), [&](const Rotor& rotor) {
        return same_curves(rotor, rotors.front());
      }))
    throw InvalidInput("uquad", fmt::format("'{}' does not have four equal rotors; "
                                            "they are required because the header has one arm "
                                            "and one curve",
                                            vehicle.name));
  const Rotor& rotor = rotors.front();
  const Eigen::Matrix3d& J = vehicle.inertia;
  std::string text = fmt::format(
      "/* Constants of the vehicle '{}', written by quadtune {}. SI units.\n"
      " * The names are quadtune's: compare them with those of your program. */\n"
      "#ifndef UQUAD_CONSTANTS_H\n#define UQUAD_CONSTANTS_H\n\n",
      vehicle.name, kVersion);
  const auto define = [&](const char* name, double value, const char* meaning) {
    if (!std::isfinite(value))
      throw InvalidInput("uquad", fmt::format("{} is {}, expected a finite number", name, value));
    text += fmt::format("#define UQUAD_{} {} /* {} */\n", name, value, meaning);
  };
  define("SAMPLE_PERIOD", dt, "s");
  define("GRAVITY", vehicle.gravity, "m/s^2");
  define("MASS", vehicle.mass, "kg");
  define("ARM", std::hypot(rotor.position.x(), rotor.position.y()), "m, from centre to rotor");
  // About the same point in axes x forward, y left, z up: products with exactly one of y and z
  // change sign.
  define("IXX", J(0, 0), "kg m^2, x forward, y left, z up");
  define("IYY", J(1, 1), "kg m^2");
  define("IZZ", J(2, 2), "kg m^2");
  if (!J.isDiagonal(0)) {
    define("IXY", -J(0, 1), "kg m^2, entry of the matrix of inertia");
    define("IXZ", -J(0, 2), "kg m^2");
    define("IYZ", J(1, 2), "kg m^2");
  }
  for (std::size_t i = 0; i < rotors.size(); ++i) {
    const auto of_rotor = [&](const char* what, double value, const char* meaning) {
      define(fmt::format("ROTOR{}_{}", i + 1, what).c_str(), value, meaning);
    };
    of_rotor("X", rotors[i].position.x(), "m, forward");
    of_rotor("Y", -rotors[i].position.y(), "m, to the left");
    of_rotor("SPIN", rotors[i].spin == Spin::counter_clockwise ? 1 : -1,
             "1: counter-clockwise seen from above");
  }
  define("ROTOR_INERTIA", rotor.inertia, "kg m^2, of each rotor about its axis");
  define("THRUST_W2", rotor.thrust_a2, "N s^2/rad^2: T = THRUST_W2 w^2 + THRUST_W1 w");
  define("THRUST_W1", rotor.thrust_a1, "N s/rad");
  define("TORQUE_W2", rotor.torque_d2, "N m s^2/rad^2: Q = TORQUE_W2 w^2 + TORQUE_W1 w");
  define("TORQUE_W1", rotor.torque_d1, "N m s/rad");
  define("HOVER_SPEED", rotor_speed_for_thrust(rotor, vehicle.mass * vehicle.gravity / 4), "rad/s");
  define("LEAST_SPEED", speed_of_command(vehicle.motor, vehicle.motor.min), "rad/s");
  define("GREATEST_SPEED", speed_of_command(vehicle.motor, vehicle.motor.max), "rad/s");
  return text + "\n#endif\n";
}

}  // namespace quadtune
