// SPDX-License-Identifier: Apache-2.0
#include "quadtune/model/vehicle.hpp"

#include <fmt/format.h>

#include <cmath>

#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/model/inertia.hpp"

namespace quadtune {
namespace {

// Checks of one vehicle, whose messages have the same place.
class Checker {
 public:
  explicit Checker(std::string where) : where_(std::move(where)) {}

  [[noreturn]] void refuse(const std::string& message) const {
    throw InvalidInput(where_, message);
  }

  void positive(double value, const std::string& what, const std::string& unit) const {
    if (!(value > 0) || !std::isfinite(value))
      refuse(fmt::format("{} is {} {}, expected more than 0", what, value, unit));
  }

  void not_negative(double value, const std::string& what, const std::string& unit) const {
    if (!(value >= 0) || !std::isfinite(value))
      refuse(fmt::format("{} is {} {}, expected 0 or more", what, value, unit));
  }

  void within(double value, double max, const std::string& what, const std::string& unit) const {
    if (!(value >= 0 && value <= max))
      refuse(fmt::format("{} is {} {}, expected 0 to {}", what, value, unit, max));
  }

  void finite(double value, const std::string& what, const std::string& unit) const {
    if (!std::isfinite(value))
      refuse(fmt::format("{} is {} {}, expected a finite number", what, value, unit));
  }

 private:
  std::string where_;
};

void check_motor(const MotorCommand& motor, std::size_t rotors, const Checker& check) {
  check.positive(motor.gain, "motor gain", "rad/s or rad2/s2 per " + motor.unit);
  check.not_negative(motor.min, "minimum motor command", motor.unit);
  check.positive(motor.max, "maximum motor command", motor.unit);
  if (motor.min >= motor.max)
    check.refuse(
        fmt::format("minimum motor command {} is not less than the maximum {} {}, expected "
                    "minimum < maximum",
                    motor.min, motor.max, motor.unit));
  check.within(motor.delay, kMaxCommandDelay, "command delay", "s");
  check.within(motor.delay_jitter, kMaxCommandDelay, "command jitter", "s");
  if (!motor.direction.empty() && motor.direction.size() != rotors)
    check.refuse(fmt::format("motor direction has {}, expected {}, one per rotor",
                             internal::counted(motor.direction.size(), "entry", "entries"),
                             rotors));
  for (const int sign : motor.direction)
    if (sign != 1 && sign != -1)
      check.refuse(fmt::format("motor direction has {}, expected 1 or -1", sign));
}

void check_rotor(const Rotor& rotor, std::size_t number, double max_speed, const Checker& check) {
  const std::string name = fmt::format("rotor {}", number);
  if (!rotor.position.allFinite())
    check.refuse(name + " position is not finite, expected finite numbers");
  check.positive(rotor.thrust_a2, name + " thrust a2", "N s2/rad2");
  check.finite(rotor.thrust_a1, name + " thrust a1", "N s/rad");
  check.not_negative(rotor.torque_d2, name + " torque d2", "N m s2/rad2");
  check.finite(rotor.torque_d1, name + " torque d1", "N m s/rad");
  check.not_negative(rotor.inertia, name + " inertia", "kg m2");
  check.within(rotor.lag, kMaxLag, name + " lag", "s");
  check.within(lag_down(rotor), kMaxLag, name + " lag down", "s");
  check.not_negative(rotor.drag, name + " drag", "N s2/(rad m)");
  check.not_negative(rotor.inflow, name + " inflow", "N s2/(rad m)");
  check.not_negative(rotor.flapping, name + " flapping", "N s2/rad");
  if (rotor.ground_effect && std::isnan(rotor.radius))
    check.refuse(name +
                 " has ground effect but no radius, expected the radius, with which it scales");
  if (!std::isnan(rotor.radius)) check.positive(rotor.radius, name + " radius", "m");
  const double thrust = rotor_thrust(rotor, max_speed);
  if (!(thrust > 0) || !std::isfinite(thrust))
    check.refuse(
        fmt::format("{} gives {:.6g} N at its maximum speed of {:.6g} rad/s, expected "
                    "more than 0 because thrust must lift",
                    name, thrust, max_speed));
  const double torque = rotor_torque(rotor, max_speed);
  if (!(torque >= 0) || !std::isfinite(torque))
    check.refuse(
        fmt::format("{} has a drag torque of {:.6g} N m at its maximum speed of {:.6g} rad/s, "
                    "expected 0 or more because drag opposes the spin",
                    name, torque, max_speed));
}

// The model of the flown plant has one state for the lag of each rotor, or none at all.
void check_lags(const Vehicle& vehicle, const Checker& check) {
  for (std::size_t i = 1; i < vehicle.rotors.size(); ++i) {
    const double first = slower_lag(vehicle.rotors.front()), lag = slower_lag(vehicle.rotors[i]);
    if ((first > 0) == (lag > 0)) continue;
    check.refuse(
        fmt::format("rotor 1 has a lag of {:.6g} s and rotor {} of {:.6g} s, expected a "
                    "lag of all rotors or of none",
                    first, i + 1, lag));
  }
}

// If all rotors turn the same way, their drag torques add up at any speeds that lift the vehicle.
void check_yaw_balance(const Vehicle& vehicle, const Checker& check) {
  double torque = 0;
  for (const Rotor& rotor : vehicle.rotors) {
    if (rotor.spin != vehicle.rotors.front().spin) return;
    const double share =
        vehicle.mass * vehicle.gravity / static_cast<double>(vehicle.rotors.size());
    torque += rotor_torque(rotor, rotor_speed_for_thrust(rotor, share));
  }
  if (torque == 0) return;
  const bool clockwise = vehicle.rotors.front().spin == Spin::clockwise;
  check.refuse(fmt::format(
      "rotors cannot balance yaw: all {} turn {}, which leaves {:.3g} N m of drag torque in hover, "
      "expected both spin directions",
      vehicle.rotors.size(), clockwise ? "clockwise" : "counter-clockwise", torque));
}

}  // namespace

std::string to_string(Spin spin) { return spin == Spin::clockwise ? "cw" : "ccw"; }

std::string to_string(CommandLaw law) {
  return law == CommandLaw::speed ? "speed" : "speed-squared";
}

double rotor_speed_for_thrust(const Rotor& rotor, double thrust) {
  if (!(thrust >= 0) || !std::isfinite(thrust))
    throw InvalidInput("rotor_speed_for_thrust",
                       fmt::format("thrust is {} N, expected 0 or more", thrust));
  const double a2 = rotor.thrust_a2;
  const double a1 = rotor.thrust_a1;
  // a2 w² + a1 w - T = 0, in the form that avoids cancellation.
  const double root = std::sqrt(a1 * a1 + 4 * a2 * thrust);
  if (a1 > 0) return 2 * thrust / (a1 + root);
  return (root - a1) / (2 * a2);
}

double speed_of_command(const MotorCommand& motor, double command) {
  if (!(command >= 0) || !std::isfinite(command))
    throw InvalidInput("speed_of_command",
                       fmt::format("command is {} {}, expected 0 or more", command, motor.unit));
  const double product = motor.gain * command;
  return motor.law == CommandLaw::speed ? product : std::sqrt(product);
}

double command_of_speed(const MotorCommand& motor, double speed) {
  if (!(speed >= 0) || !std::isfinite(speed))
    throw InvalidInput("command_of_speed",
                       fmt::format("speed is {} rad/s, expected 0 or more", speed));
  return (motor.law == CommandLaw::speed ? speed : speed * speed) / motor.gain;
}

void validate(const Vehicle& vehicle, const std::string& where) {
  const Checker check(where);
  check.positive(vehicle.mass, "mass", "kg");
  require_inertia(vehicle.inertia, where, vehicle.inertia_tolerance);
  check.positive(vehicle.gravity, "gravity", "m/s2");
  check.positive(vehicle.air_density, "air density", "kg/m3");
  check.not_negative(vehicle.takeoff_gain, "take-off gain", "");
  if (!(vehicle.altitude_thrust_fraction > 0 && vehicle.altitude_thrust_fraction <= 1))
    check.refuse(fmt::format("altitude thrust fraction is {}, expected more than 0 and 1 or less",
                             vehicle.altitude_thrust_fraction));
  for (int axis = 0; axis < 3; ++axis) {
    check.not_negative(vehicle.drag.cda(axis), "drag area", "m2");
    check.not_negative(vehicle.drag.linear(axis), "linear drag", "N s/m");
  }
  if (vehicle.rotors.empty()) check.refuse("has no rotors, expected at least one");
  check_motor(vehicle.motor, vehicle.rotors.size(), check);
  const double max_speed = speed_of_command(vehicle.motor, vehicle.motor.max);
  for (std::size_t i = 0; i < vehicle.rotors.size(); ++i)
    check_rotor(vehicle.rotors[i], i + 1, max_speed, check);
  check_lags(vehicle, check);
  check_yaw_balance(vehicle, check);
}

std::string place_of(const Vehicle& vehicle) {
  return vehicle.file.empty() ? vehicle.name : vehicle.file.string();
}

}  // namespace quadtune
