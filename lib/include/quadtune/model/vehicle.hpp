// SPDX-License-Identifier: Apache-2.0
/// The parameters of a multirotor, the input of all other stages.
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

/// Direction of rotation of a rotor seen from above.
enum class Spin { clockwise, counter_clockwise };

/// +1 if the rotor turns about body +z (down), that is clockwise seen from above; else -1.
[[nodiscard]] constexpr double spin_sign(Spin spin) { return spin == Spin::clockwise ? 1.0 : -1.0; }

/// One rotor with its motor. Thrust acts along body -z at `position`; drag torque opposes the spin.
struct Rotor {
  Eigen::Vector3d position =
      Eigen::Vector3d::Zero();  ///< hub from the centre of mass, body axes [m]
  Spin spin = Spin::clockwise;  ///< direction of rotation
  double thrust_a2 = 0;  ///< T = a2 w² + a1 w [N], at the vehicle's air density [N s²/rad²]
  double thrust_a1 = 0;  ///< [N s/rad]
  double torque_d2 = 0;  ///< Q = d2 w² + d1 w [N m], at the same density [N m s²/rad²]
  double torque_d1 = 0;  ///< [N m s/rad]
  double inertia = 0;    ///< of the rotating parts about the axis [kg m²]
  /// First-order time constant while the speed rises [s], ≤ 1; 0: none.
  double lag = 0;
  /// First-order time constant while the speed falls [s]; NaN: equal to `lag`.
  double lag_down = std::numeric_limits<double>::quiet_NaN();
  // The hub moves through the air with velocity v, body axes: theory.md, "Rigid body". All are ≥ 0.
  double drag = 0;  ///< F = -drag w (v_x, v_y, 0) [N s²/(rad m)]
  /// T grows by inflow w v_z, so a climb loses thrust [N s²/(rad m)].
  double inflow = 0;
  double flapping = 0;         ///< M = flapping w (-v_y, v_x, 0) [N s²/rad]
  bool ground_effect = false;  ///< T increases near the ground; requires the radius
  double radius = std::numeric_limits<double>::quiet_NaN();  ///< [m]; NaN if unknown
  double chord = std::numeric_limits<double>::quiet_NaN();   ///< [m]; NaN if unknown
  /// T = Ct rho pi r⁴ w²; NaN if the curve was given.
  double Ct = std::numeric_limits<double>::quiet_NaN();
  /// Q = Cq rho pi r⁵ w²; NaN if the curve was given.
  double Cq = std::numeric_limits<double>::quiet_NaN();
  int blades = 0;  ///< 0 if unknown
};

/// The relation between a motor command and the rotor speed.
enum class CommandLaw {
  speed,          ///< w = gain · command
  speed_squared,  ///< w² = gain · command
};

/// Commands that the motors accept. The limits bound the rotor speed in every trim and simulation.
struct MotorCommand {
  CommandLaw law = CommandLaw::speed;  ///< relation between the command and the rotor speed
  double gain = 1;                     ///< [rad/s per unit] or [rad²/s² per unit]
  std::string unit = "rad/s";          ///< of the command: "rad/s" or "count"
  double min = 0;      ///< minimum command at which the rotor turns steadily [unit], ≥ 0
  double max = 0;      ///< maximum command [unit], > min
  double quantum = 0;  ///< resolution of the command [unit], ≥ 0; 0: continuous
  double delay = 0;    ///< from the law's output to the motors' command [s], ≥ 0
  /// Maximum additional delay, drawn uniformly in each period [s], ≥ 0.
  double delay_jitter = 0;
  /// Sign that the flight code gives to each motor's command, ±1; empty: all +1.
  std::vector<int> direction;
};

/// Body drag, per body axis i: F_i = -(rho/2) cda_i |v_i| v_i - linear_i v_i.
struct Drag {
  Eigen::Vector3d cda = Eigen::Vector3d::Zero();     ///< drag coefficient times area [m²]
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();  ///< [N s/m]
};

/// All parameters of a vehicle. World axes north-east-down, body axes forward-right-down, SI units.
struct Vehicle {
  std::string name;         ///< e.g. "crazyflie"
  std::string description;  ///< one line; may be empty
  std::string source;       ///< reference for the numbers
  double mass = 0;          ///< [kg]
  Eigen::Matrix3d inertia =
      Eigen::Matrix3d::Zero();  ///< about the centre of mass, body axes [kg m²]
  /// Relative amount by which measured moments may violate the triangle inequality.
  double inertia_tolerance = 0;
  std::vector<Rotor> rotors;   ///< 1 to kMaxRotors
  MotorCommand motor;          ///< command range and law of the motors
  Drag drag;                   ///< of the body
  double gravity = 9.81;       ///< [m/s²]
  double air_density = 1.225;  ///< for which the rotor curves hold [kg/m³]
  double takeoff_gain = 0;     ///< thrust at take-off is (1 + gain) m g, ≥ 0
  /// Fraction of the maximum thrust that the altitude loop may use, > 0, ≤ 1.
  double altitude_thrust_fraction = 1;
  std::optional<Battery> battery;       ///< empty: an ideal supply of constant voltage
  Sensors sensors = typical_sensors();  ///< noise, rates and delays
  bool sensors_known = false;           ///< whether the sensors were given for this vehicle
  double airframe_height = std::numeric_limits<double>::quiet_NaN();    ///< [m]
  double airframe_diameter = std::numeric_limits<double>::quiet_NaN();  ///< [m]
  /// Published gains that the vehicle flies with, as a baseline for new designs.
  std::optional<PublishedCascade> published_cascade;
  std::filesystem::path file;  ///< the file that was read; empty if made in memory
  std::string text;            ///< the bytes of that file, for the manifest's hash
};

/// Thrust of one rotor, a Rotor or a BasicRotor, at speed w [rad/s] [N].
/// `density_ratio` is the air density relative to that of the rotor curves.
template <class AnyRotor, class T, class P = double>
[[nodiscard]] T rotor_thrust(const AnyRotor& rotor, const T& w, P density_ratio = P(1)) {
  return (rotor.thrust_a2 * w * w + rotor.thrust_a1 * w) * density_ratio;  // T = a2 w² + a1 w [N]
}

/// Drag torque of one rotor at speed w [rad/s] [N m]; the arguments are those of rotor_thrust().
template <class AnyRotor, class T, class P = double>
[[nodiscard]] T rotor_torque(const AnyRotor& rotor, const T& w, P density_ratio = P(1)) {
  return (rotor.torque_d2 * w * w + rotor.torque_d1 * w) * density_ratio;  // Q = d2 w² + d1 w [N m]
}

/// Maximum lag of a rotor [s].
inline constexpr double kMaxLag = 1;
inline constexpr double kMaxCommandDelay = 10;  ///< maximum delay of a command [s]

/// Time constant while the speed falls [s].
[[nodiscard]] inline double lag_down(const Rotor& rotor) {
  return std::isnan(rotor.lag_down) ? rotor.lag : rotor.lag_down;
}

/// The larger time constant of both directions [s], which linear models use.
[[nodiscard]] inline double slower_lag(const Rotor& rotor) {
  return std::max(rotor.lag, lag_down(rotor));
}

/// Whether the motion of the air affects the vehicle: it has body drag, or a rotor has drag, inflow
/// or flapping.
[[nodiscard]] inline bool has_aerodynamics(const Vehicle& vehicle) {
  if (!vehicle.drag.cda.isZero(0) || !vehicle.drag.linear.isZero(0)) return true;
  return std::any_of(vehicle.rotors.begin(), vehicle.rotors.end(), [](const Rotor& rotor) {
    return rotor.drag > 0 || rotor.inflow > 0 || rotor.flapping > 0;
  });
}

/// "cw" or "ccw", as vehicle files write it.
[[nodiscard]] std::string to_string(Spin spin);

/// "speed" or "speed-squared", as vehicle files write it.
[[nodiscard]] std::string to_string(CommandLaw law);

/// Speed [rad/s] at which the rotor produces `thrust` ≥ 0 [N]: the larger root of the thrust curve.
/// @throws InvalidInput  if thrust is negative or not finite.
[[nodiscard]] double rotor_speed_for_thrust(const Rotor& rotor, double thrust);

/// The rotor speed [rad/s] of a command [MotorCommand::unit]; the limits are not applied.
/// @throws InvalidInput  if the command is negative or not finite
[[nodiscard]] double speed_of_command(const MotorCommand& motor, double command);

/// The command of a rotor speed [rad/s], the inverse of speed_of_command().
/// @throws InvalidInput  if the speed is negative or not finite
[[nodiscard]] double command_of_speed(const MotorCommand& motor, double speed);

/// Validates a vehicle: positive mass, a physically possible inertia, at least one rotor, curves
/// that produce thrust, ordered limits, and rotors whose drag torques do not all have the same
/// sign. Whether the thrust is sufficient is checked by trim().
/// @throws InvalidInput  with the field, its value, the expected range and the reason.
void validate(const Vehicle& vehicle, const std::string& where);

/// The place of a vehicle in messages: its file, or the name of a built-in vehicle.
[[nodiscard]] std::string place_of(const Vehicle& vehicle);

/// Maximum size of a vehicle file [bytes].
inline constexpr std::size_t kVehicleFileLimit = std::size_t{1} << 20;

/// Reads a built-in vehicle by name or a vehicle file by path (docs/formats.md). A word is a path
/// if it contains a slash, ends in ".toml", or names an existing file but no built-in vehicle.
/// @throws InvalidInput  "file:line: key …" for an invalid file; for an unknown name, with the
///                       nearest built-in one.
/// @throws FileError     if the file cannot be read.
[[nodiscard]] Vehicle load_vehicle(const std::string& name_or_path);

/// Parses a vehicle from the text of a file.
/// @param text    content of the file
/// @param origin  the file's name in messages
/// @throws InvalidInput  "origin:line: key …"
[[nodiscard]] Vehicle parse_vehicle(const std::string& text, const std::string& origin);

/// Names of the built-in vehicles, in the order of the documentation.
[[nodiscard]] std::vector<std::string> built_in_vehicles();

}  // namespace quadtune
