// SPDX-License-Identifier: Apache-2.0
/// A vehicle file for a multirotor of one's own, from what a scale and a ruler measure.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/model/vehicle.hpp"
#include "quadtune/model/vehicle_spread.hpp"

namespace quadtune {

/// Where the rotors are, seen from above.
enum class FrameLayout {
  x,     ///< two rotors in front
  plus,  ///< one rotor in front
};

/// Which typical sensors the file lists.
enum class SensorSet {
  gps,   ///< inertial sensors, compass, barometer, satellite receiver
  flow,  ///< inertial sensors, barometer, range finder, optical flow
};

/// What is known of a vehicle. Quantities without a value are estimated.
struct MeasuredVehicle {
  std::string name;                     ///< of the vehicle
  double mass = 0;                      ///< ready to fly [kg], > 0
  double arm = 0;                       ///< from the centre to the axis of each rotor [m], > 0
  double propeller = 0;                 ///< diameter [m], > 0
  int rotors = 4;                       ///< 4, 6 or 8, evenly spaced
  FrameLayout layout = FrameLayout::x;  ///< whether a rotor points forward (plus), or two do (x)
  Spin first_spin = Spin::clockwise;    ///< of the front left rotor (x) or the front one (plus)
  int blades = 2;                       ///< of each propeller, 2 to 8
  bool brushed = false;                 ///< whether the motors are brushed, as in toys of some 50 g
  SensorSet sensors = SensorSet::gps;   ///< sensors whose typical errors are written
  std::optional<double> max_thrust;     ///< of one rotor at full command [N]
  std::optional<double> thrust_to_weight;  ///< of all rotors at full command, > 1
  std::optional<double> max_speed;         ///< of a rotor at full command [rad/s]
  std::optional<double> hover_speed;       ///< of the rotors in hover, their mean [rad/s]
  std::optional<double> motor_lag;         ///< first-order time constant [s]
  std::optional<Eigen::Vector3d> inertia;  ///< about body x, y and z [kg m²]
};

/// A number that was not measured.
struct EstimatedNumber {
  std::string quantity;  ///< e.g. "inertia"
  double value = 0;      ///< [unit]
  std::string unit;      ///< of the value and in the key of the file
  double spread = 0;     ///< relative half width of its 95 % interval; 0: not known
  std::string source;    ///< by which rule it was estimated
  std::string measure;   ///< how to measure it
};

/// A vehicle file and what was estimated for it.
struct NewVehicle {
  std::string text;                        ///< of the vehicle file, with a comment on each estimate
  Vehicle vehicle;                         ///< as parse_vehicle() reads the text
  VehicleSpread spread;                    ///< uncertainty of the estimates
  std::vector<EstimatedNumber> estimates;  ///< numbers that were not measured
};

/// Writes a vehicle file. Inertia: a sphere with 71 % of the mass in the middle and equal point
/// masses at the hubs. Thrust and torque: coefficients of typical propellers, C_T = 0.115 and
/// C_P = 0.05 for two blades. Lag, inertia of the rotor and drag: scaled from the built-in vehicles
/// by the propeller's diameter. Rotors are numbered clockwise from the front left one (x) or the
/// front one (plus), and turn in alternate directions. The ground effect is left out, because the
/// height of the hubs above the ground is not measured.
/// @throws OptionError  naming the member, if one is out of range or members contradict each other
/// Theory: "Estimated vehicles".
[[nodiscard]] NewVehicle new_vehicle(const MeasuredVehicle& measured);

}  // namespace quadtune
