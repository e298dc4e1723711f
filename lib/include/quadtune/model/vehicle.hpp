// SPDX-License-Identifier: Apache-2.0
/// A multirotor in numbers: what every other stage starts from.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/cascade.hpp"
#include "quadtune/model/battery.hpp"
#include "quadtune/model/sensors.hpp"

namespace quadtune {

/// Sense of a rotor seen from above.
enum class Spin { clockwise, counter_clockwise };

/// +1 when the rotor turns about body +z (down), that is clockwise seen from above; else -1.
[[nodiscard]] constexpr double spin_sign(Spin spin) { return spin == Spin::clockwise ? 1.0 : -1.0; }

/// One rotor with its motor. Thrust acts along body -z at `position`; drag torque opposes the spin.
struct Rotor {
  Eigen::Vector3d position =
      Eigen::Vector3d::Zero();  ///< hub from the centre of mass, body axes [m]
  Spin spin = Spin::clockwise;
  double thrust_a2 = 0;  ///< T = a2 w² + a1 w [N], at the vehicle's air density [N s²/rad²]
  double thrust_a1 = 0;  ///< [N s/rad]
  double torque_d2 = 0;  ///< Q = d2 w² + d1 w [N m], likewise [N m s²/rad²]
  double torque_d1 = 0;  ///< [N m s/rad]
  double inertia = 0;    ///< of the turning parts about the axis [kg m²]
  double lag = 0;  ///< first-order time constant of the speed while it rises [s], ≤ 1; 0: none
  double lag_down = std::numeric_limits<double>::quiet_NaN();  ///< while it falls; NaN: as `lag`
  // The hub moves through the air with v, body axes: theory.md, "Rigid body". All are ≥ 0.
  double drag = 0;             ///< F = -drag w (v_x, v_y, 0) [N s²/(rad m)]
  double inflow = 0;           ///< T grows by inflow w v_z, so climbing costs [N s²/(rad m)]
  double flapping = 0;         ///< M = flapping w (-v_y, v_x, 0) [N s²/rad]
  bool ground_effect = false;  ///< T grows near the ground; needs the radius
  double radius = std::numeric_limits<double>::quiet_NaN();  ///< [m]; NaN when not known
  double chord = std::numeric_limits<double>::quiet_NaN();   ///< [m]; NaN when not known
  double Ct = std::numeric_limits<double>::quiet_NaN();  ///< T = Ct rho pi r⁴ w²; NaN: curve given
  double Cq = std::numeric_limits<double>::quiet_NaN();  ///< Q = Cq rho pi r⁵ w²; NaN: curve given
  int blades = 0;                                        ///< 0 when not known
};

/// How a motor command becomes a rotor speed.
enum class CommandLaw {
  speed,          ///< w = gain · command
  speed_squared,  ///< w² = gain · command
};

/// What the motors accept. Limits bound the rotor speed in every trim and every simulation.
struct MotorCommand {
  CommandLaw law = CommandLaw::speed;
  double gain = 1;             ///< [rad/s per unit] or [rad²/s² per unit]
  std::string unit = "rad/s";  ///< of the command: "rad/s" or "count"
  double min = 0;              ///< lowest command at which the rotor turns steadily
  double max = 0;              ///< highest command
  double quantum = 0;          ///< the command's smallest step; 0: none
  double delay = 0;            ///< from the law's output to the motors' command [s], ≥ 0
  double delay_jitter = 0;     ///< greatest further delay, uniform, drawn each period [s], ≥ 0
  std::vector<int>
      direction;  ///< sign that the flight code gives to each motor's command, ±1; empty: all +1
};

/// Body drag, per body axis i: F_i = -(rho/2) cda_i |v_i| v_i - linear_i v_i.
struct Drag {
  Eigen::Vector3d cda = Eigen::Vector3d::Zero();     ///< drag coefficient times area [m²]
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();  ///< [N s/m]
};

/// Everything that is known of a vehicle. World north-east-down, body forward-right-down, SI.
struct Vehicle {
  std::string name;
  std::string description;
  std::string source;  ///< where the numbers come from
  double mass = 0;     ///< [kg]
  Eigen::Matrix3d inertia =
      Eigen::Matrix3d::Zero();  ///< about the centre of mass, body axes [kg m²]
  double inertia_tolerance =
      0;                      ///< share by which measured moments may break the triangle inequality
  std::vector<Rotor> rotors;  ///< at least one
  MotorCommand motor;
  Drag drag;
  double gravity = 9.81;                ///< [m/s²]
  double air_density = 1.225;           ///< at which the rotor curves hold [kg/m³]
  double takeoff_gain = 0;              ///< thrust at take-off is (1 + gain) m g
  double altitude_thrust_fraction = 1;  ///< share of the greatest thrust left to the altitude loop
  std::optional<Battery> battery;       ///< none: a supply that never falls
  Sensors sensors = typical_sensors();
  bool sensors_known = false;  ///< whether the sensors are the vehicle's own
  double airframe_height = std::numeric_limits<double>::quiet_NaN();    ///< [m]
  double airframe_diameter = std::numeric_limits<double>::quiet_NaN();  ///< [m]
  /// Gains that fly on it today, to measure new ones by.
  std::optional<PublishedCascade> published_cascade;
  std::filesystem::path file;  ///< it was read from; empty when made in memory
  std::string text;            ///< the file's bytes, for the manifest's hash
};

/// Thrust and drag torque of one rotor, a Rotor or a BasicRotor, at speed w [rad/s] in air of
/// density `density_ratio` times the vehicle's.
template <class AnyRotor, class T, class P = double>
[[nodiscard]] T rotor_thrust(const AnyRotor& rotor, const T& w, P density_ratio = P(1)) {
  return (rotor.thrust_a2 * w * w + rotor.thrust_a1 * w) * density_ratio;  // T = a2 w² + a1 w [N]
}
template <class AnyRotor, class T, class P = double>
[[nodiscard]] T rotor_torque(const AnyRotor& rotor, const T& w, P density_ratio = P(1)) {
  return (rotor.torque_d2 * w * w + rotor.torque_d1 * w) * density_ratio;  // Q = d2 w² + d1 w [N m]
}

/// The longest lag of a rotor and the longest delay of a command that a vehicle may have [s].
inline constexpr double kLongestLag = 1;
inline constexpr double kLongestCommandDelay = 10;

/// Time constants of the speed while it falls, and the slower of both directions [s]. Linear models
/// take the slower one.
[[nodiscard]] inline double lag_down(const Rotor& rotor) {
  return std::isnan(rotor.lag_down) ? rotor.lag : rotor.lag_down;
}
[[nodiscard]] inline double slower_lag(const Rotor& rotor) {
  return std::max(rotor.lag, lag_down(rotor));
}

/// Whether moving air changes the forces on a vehicle: body drag, or a rotor's drag, inflow or
/// flapping.
[[nodiscard]] inline bool feels_wind(const Vehicle& vehicle) {
  if (!vehicle.drag.cda.isZero(0) || !vehicle.drag.linear.isZero(0)) return true;
  return std::any_of(vehicle.rotors.begin(), vehicle.rotors.end(), [](const Rotor& rotor) {
    return rotor.drag > 0 || rotor.inflow > 0 || rotor.flapping > 0;
  });
}

/// "cw" or "ccw"; "speed" or "speed-squared": as vehicle files write them.
[[nodiscard]] std::string to_string(Spin spin);
[[nodiscard]] std::string to_string(CommandLaw law);

/// Speed [rad/s] at which the rotor gives `thrust` ≥ 0 [N]: the larger root of the thrust curve.
/// @throws InvalidInput  if thrust is negative or not finite.
[[nodiscard]] double rotor_speed_for_thrust(const Rotor& rotor, double thrust);

/// Speed [rad/s] of a command, and back; limits are not applied.
/// @throws InvalidInput  if the argument is negative or not finite.
[[nodiscard]] double speed_of_command(const MotorCommand& motor, double command);
[[nodiscard]] double command_of_speed(const MotorCommand& motor, double speed);

/// Checks everything that a vehicle must satisfy: positive mass, an inertia that a body can have,
/// at least one rotor, curves that give thrust, limits in order, and rotors that do not all drag
/// the body round the same way. Whether the thrust suffices is the trim's question, not asked here.
/// @throws InvalidInput  naming the field, what came, what was expected and why.
void validate(const Vehicle& vehicle, const std::string& where);

/// Largest vehicle file that is read [bytes].
inline constexpr std::size_t kVehicleFileLimit = std::size_t{1} << 20;

/// Reads a built-in vehicle by name or a vehicle file by path (docs/formats.md). A word with a
/// slash or that ends in ".toml" is a path, and so is any other that names no built-in vehicle but
/// a file.
/// @throws InvalidInput  "file:line: key …" for a bad file, or the nearest built-in name.
/// @throws FileError     if the file cannot be read.
[[nodiscard]] Vehicle load_vehicle(const std::string& name_or_path);

/// Parses a vehicle from the text of a file.
/// @param origin  what messages call the file.
[[nodiscard]] Vehicle parse_vehicle(const std::string& text, const std::string& origin);

/// Names of the built-in vehicles, in the order of the documentation.
[[nodiscard]] std::vector<std::string> built_in_vehicles();

}  // namespace quadtune
