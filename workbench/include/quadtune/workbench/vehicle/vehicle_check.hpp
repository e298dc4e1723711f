// SPDX-License-Identifier: Apache-2.0
/// Whether a vehicle can fly: it hovers, and its rotors can command thrust and all torques.
#pragma once

#include <string>
#include <vector>

#include "quadtune/linearize/trim.hpp"
#include "quadtune/model/plausibility.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// A vehicle that passed.
struct VehicleCheck {
  Vehicle vehicle;                       ///< that can fly
  TrimResult hover;                      ///< solved
  std::vector<Implausibility> warnings;  ///< values outside their plausible ranges
  std::vector<std::string> obstacles;    ///< why `design`, `pid` or `fly` reject the vehicle
};

/// A vehicle cannot hold a hover unless its rotors change thrust and all three torques
/// independently: the four rows of wrench_jacobian(), normalized, must be linearly independent.
/// @param vehicle  valid
/// @param hover    a solved trim of the vehicle
/// @param name     the vehicle's name or file, for messages
/// @throws NoSolution  naming the axis that no rotor changes, if there is one
void require_authority(const Vehicle& vehicle, const TrimResult& hover, const std::string& name);

/// Reads a vehicle and checks that it can hover.
/// @param name  of a built-in vehicle, or a vehicle file
/// @throws InvalidInput, FileError  as load_vehicle()
/// @throws NoSolution               "NAME: cannot hover: …", or as require_authority()
[[nodiscard]] VehicleCheck check_vehicle(const std::string& name);

/// Warnings about the vehicle of a command, because gains for implausible values are useless.
/// @param word  a word of the command line
/// @return  "FILE: …" for each value outside its plausible range, if the word is the path of a
///          valid vehicle file (.toml), or of a valid design file for a vehicle file
[[nodiscard]] std::vector<std::string> vehicle_warnings(const std::string& word);

}  // namespace quadtune
