// SPDX-License-Identifier: Apache-2.0
// Conversion from a firmware's outputs to torques and thrust, linearized at hover. docs/theory.md,
// "Cascades of autopilots".
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "firmware/firmware_parts.hpp"
#include "firmware/px4_mixer.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/firmware.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// One rotor at hover.
struct RotorAtHover {
  double signal = 0;  ///< of the motor's range, 0 … 1
  double thrust = 0;  ///< dT/dsignal [N]
  double torque = 0;  ///< dQ/dthrust [m]
};

/// Thrusts that balance the weight without torque, with the minimum sum of squares.
VectorXd hover_thrusts(const Vehicle& vehicle) {
  const Index n = std::ssize(vehicle.rotors);
  MatrixXd to_wrench(3, n);
  for (Index i = 0; i < n; ++i) {
    const Rotor& rotor = vehicle.rotors[static_cast<std::size_t>(i)];
    to_wrench.col(i) << 1, -rotor.position.y(), rotor.position.x();
  }
  const Eigen::Vector3d wrench(vehicle.mass * vehicle.gravity, 0, 0);
  return to_wrench.completeOrthogonalDecomposition().solve(wrench);
}

RotorAtHover at_hover(const Vehicle& vehicle, const Rotor& rotor, double thrust) {
  const MotorCommand& motor = vehicle.motor;
  if (!(thrust > 0))
    throw NoSolution(vehicle.name + ": hover would require a negative thrust of a rotor",
                     vehicle.name);
  const double w = rotor_speed_for_thrust(rotor, thrust);
  const double command = command_of_speed(motor, w), range = motor.max - motor.min;
  RotorAtHover result;
  result.signal = (command - motor.min) / range;
  if (!(result.signal > 0 && result.signal < 1))
    throw NoSolution(fmt::format("{}: hover needs a motor command of {:.6g} {}, expected a value "
                                 "between {:.6g} and {:.6g}",
                                 vehicle.name, command, motor.unit, motor.min, motor.max),
                     vehicle.name);
  // w = gain c, or w² = gain c, of which dw/dc = gain/(2 w).
  const double speed_per_command =
      motor.law == CommandLaw::speed ? motor.gain : motor.gain / (2 * w);
  const double thrust_per_speed = 2 * rotor.thrust_a2 * w + rotor.thrust_a1;
  const double torque_per_speed = 2 * rotor.torque_d2 * w + rotor.torque_d1;
  result.thrust = thrust_per_speed * speed_per_command * range;
  result.torque = torque_per_speed / thrust_per_speed;
  return result;
}

/// Rejects a rotor that does not match the frame of the firmware.
[[noreturn]] void refuse_frame(const Firmware& firmware, const std::string& came,
                               const char* expected) {
  throw InvalidInput(
      to_string(firmware.kind),
      fmt::format("{}, expected {}, because the firmware's mixer is made for it", came, expected));
}

bool is_x(const Vehicle& vehicle) {
  std::array<int, 4> seen{};  // front left, front right, back right, back left
  for (const Rotor& rotor : vehicle.rotors) {
    const double x = rotor.position.x(), y = rotor.position.y();
    if (!(std::abs(x) > 0.1 * std::abs(y) && std::abs(y) > 0.1 * std::abs(x))) return false;
    ++seen[static_cast<std::size_t>(x > 0 ? (y > 0 ? 1 : 0) : (y > 0 ? 2 : 3))];
  }
  return seen == std::array{1, 1, 1, 1};
}

bool is_plus(const Vehicle& vehicle) {
  std::array<int, 4> seen{};  // front, right, back, left
  for (const Rotor& rotor : vehicle.rotors) {
    const double x = rotor.position.x(), y = rotor.position.y();
    const bool lengthwise = std::abs(x) > std::abs(y);
    if (std::min(std::abs(x), std::abs(y)) > 0.1 * std::max(std::abs(x), std::abs(y))) return false;
    ++seen[static_cast<std::size_t>(lengthwise ? (x > 0 ? 0 : 2) : (y > 0 ? 1 : 3))];
  }
  return seen == std::array{1, 1, 1, 1};
}

/// The firmware's yaw output speeds up the rotors that it assumes to turn counter-clockwise.
void require_spins(const Firmware& firmware, const Vehicle& vehicle) {
  for (const Rotor& rotor : vehicle.rotors) {
    const double x = rotor.position.x(), y = rotor.position.y();
    // X: front left and back right clockwise. Plus: front and back clockwise.
    const bool clockwise = is_x(vehicle) ? (x > 0) == (y < 0) : std::abs(x) > std::abs(y);
    if (rotor.spin != (clockwise ? Spin::clockwise : Spin::counter_clockwise))
      refuse_frame(
          firmware,
          fmt::format("the rotor at ({:.3g}, {:.3g}) m turns {}", x, y, to_string(rotor.spin)),
          "front left and back right clockwise (X), or front and back "
          "clockwise (plus)");
  }
}

void require_frame(const Firmware& firmware, const Vehicle& vehicle) {
  const bool plus = firmware.kind == FirmwareKind::ardupilot && is_plus(vehicle);
  if (vehicle.rotors.size() != 4 || (!plus && !is_x(vehicle)))
    refuse_frame(firmware,
                 fmt::format("the vehicle has {} rotors {}", vehicle.rotors.size(),
                             is_plus(vehicle) ? "in plus" : "not in X"),
                 firmware.kind == FirmwareKind::ardupilot ? "four in X or in plus" : "four in X");
  require_spins(firmware, vehicle);
}

/// Rejects a file of a board whose frame is not that of the vehicle. Types other than plus and X are
/// accepted, because they are variants of X.
void require_same_frame(const Firmware& firmware, const Vehicle& vehicle,
                        const ParameterValues& value) {
  constexpr double kQuad = 1, kPlus = 0, kX = 1;
  const double frame = value("FRAME_CLASS"), type = value("FRAME_TYPE");
  const auto refuse = [&](const char* name, double came, double expected, const char* frames) {
    throw InvalidInput(to_string(firmware.kind),
                       fmt::format("{} is {:g}, expected {:g}, because {} has {}", name, came,
                                   expected, vehicle.name, frames));
  };
  if (!std::isnan(frame) && frame != 0 && frame != kQuad)
    refuse("FRAME_CLASS", frame, kQuad, "four rotors");
  if (type == kPlus && !is_plus(vehicle)) refuse("FRAME_TYPE", type, kX, "four rotors in X");
  if (type == kX && is_plus(vehicle)) refuse("FRAME_TYPE", type, kPlus, "four rotors in plus");
}

/// Thrust per motor at full output, 65535, in N.
double crazyflie_full_thrust(const Firmware& firmware) {
  const bool kit = firmware.setup == "thrust-kit", brushless = firmware.setup == "brushless";
  if (brushless && exports::is_from(firmware, "2025.12")) return 0.20;
  if (exports::is_from(firmware, "2025.12.1")) return kit ? 0.18 : 0.12;
  if (brushless)
    throw InvalidInput(
        "crazyflie",
        fmt::format("set-up 'brushless' does not exist for version {}, expected 2025.12 or "
                    "newer, because the thrust of earlier ones is not calibrated",
                    firmware.version));
  if (exports::is_from(firmware, "2025.09")) return kit ? 0.1625 : 0.1125;
  return 0.147150 * 65535 / 65536;
}

/// A firmware's curve from its command to the motor signal.
struct Curve {
  double expo = 0;           ///< command = (1 - expo) x + expo x²
  double low = 0, high = 1;  ///< signal = low + (high - low) x

  [[nodiscard]] double at(double signal) const {
    const double x = (signal - low) / (high - low);
    return (1 - expo) * x + expo * x * x;
  }
  [[nodiscard]] double slope(double signal) const {
    const double x = (signal - low) / (high - low);
    return (1 - expo + 2 * expo * x) / (high - low);
  }
};

Curve curve_of(const Firmware& firmware, const ParameterValues& value) {
  if (firmware.kind == FirmwareKind::px4) return {value("THR_MDL_FAC"), 0, 1};
  if (firmware.kind == FirmwareKind::ardupilot)
    return {value("MOT_THST_EXPO"), value("MOT_SPIN_MIN"), value("MOT_SPIN_MAX")};
  return {};
}

}  // namespace

FirmwareScale firmware_scale(const Firmware& firmware, const Vehicle& vehicle,
                             const std::vector<Parameter>& values) {
  const ParameterValues value(firmware, values);
  if (firmware.kind != FirmwareKind::px4) require_frame(firmware, vehicle);
  if (firmware.kind == FirmwareKind::ardupilot) require_same_frame(firmware, vehicle, value);
  FirmwareScale scale;
  scale.mass = vehicle.mass;
  const VectorXd thrusts = hover_thrusts(vehicle);
  const Curve curve = curve_of(firmware, value);
  if (!(curve.low < curve.high))
    throw InvalidInput(to_string(firmware.kind),
                       fmt::format("MOT_SPIN_MIN is {:g} and MOT_SPIN_MAX {:g}, expected the first "
                                   "to be smaller",
                                   curve.low, curve.high));
  const Index n = thrusts.size();
  MatrixXd mix;  // of roll, pitch, yaw: commands per unit of the firmware's output
  if (firmware.kind == FirmwareKind::px4) mix = exports::px4_mix(vehicle, value);
  for (Index i = 0; i < n; ++i) {
    const Rotor& rotor = vehicle.rotors[static_cast<std::size_t>(i)];
    const RotorAtHover at = at_hover(vehicle, rotor, thrusts(i));
    // A Crazyflie command is a thrust, independent of the battery.
    double slope = at.thrust / curve.slope(at.signal), command = curve.at(at.signal);
    if (firmware.kind == FirmwareKind::crazyflie) {
      slope = crazyflie_full_thrust(firmware) / 65535;
      command = thrusts(i) / slope;
    }
    if (!(slope > 0 && command > 0))
      throw InvalidInput(to_string(firmware.kind),
                         fmt::format("{} at hover gives {:.3g} N of thrust per unit of the "
                                     "command, expected a positive value",
                                     vehicle.name, slope));
    const double x = rotor.position.x(), y = rotor.position.y();
    const double right = -y, front = x, yaw = -spin_sign(rotor.spin) * at.torque;
    Eigen::Vector3d share;  // of the commands, with their signs
    switch (firmware.kind) {
      case FirmwareKind::px4:
        share = mix.row(i);
        break;
      case FirmwareKind::ardupilot: {
        const double min = 0.1 * std::hypot(x, y);
        share = {std::abs(y) > min ? std::copysign(0.5, right) : 0,
                 std::abs(x) > min ? std::copysign(0.5, front) : 0, std::copysign(0.5, yaw)};
        break;
      }
      case FirmwareKind::betaflight:
        share = {std::copysign(1e-3, right), std::copysign(1e-3, front), std::copysign(1e-3, yaw)};
        break;
      case FirmwareKind::crazyflie:
        share = {std::copysign(0.5, right), std::copysign(0.5, front), std::copysign(1.0, yaw)};
        break;
    }
    scale.torque[0] += right * share(0) * slope;
    scale.torque[1] += front * share(1) * slope;
    scale.torque[2] += yaw * share(2) * slope;
    scale.thrust += slope;
    scale.hover += command / static_cast<double>(n);
  }
  return scale;
}

}  // namespace quadtune
