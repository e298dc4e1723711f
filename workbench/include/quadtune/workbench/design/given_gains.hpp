// SPDX-License-Identifier: Apache-2.0
/// Reads control laws that the user names: from an export, a gain file, or a design file.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/convention.hpp"
#include "quadtune/design.hpp"
#include "quadtune/exports/read_gains.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/design/design.hpp"

namespace quadtune {

/// Laws, with their design if they are read from a design file.
struct GivenLaws {
  StoredLaws laws;                      ///< from the file
  std::optional<DesignOutcome> design;  ///< solved, if the file is a design
};

/// Reads what read_laws() accepts, or solves the laws of a design file (.toml).
/// @throws InvalidInput  if the file is malformed, has no law, or is a gain schedule
/// @throws NoSolution    if a design has no solution
[[nodiscard]] GivenLaws read_given_laws(const std::string& path);

/// @throws InvalidInput  if the laws belong to another vehicle
void require_vehicle(const StoredLaws& laws, const Vehicle& vehicle, const std::string& path);

/// Gains, with their design if they are read from a design file.
struct GivenGains {
  Gains gains;                   ///< in the convention of the file
  std::optional<Design> design;  ///< if the gains were read from a design file
};

/// Reads what read_gains() accepts; from a design file (.toml) its [published] gains, or else the
/// gains that the design gives.
/// @throws InvalidInput  if a design has no gains or published gains for some inputs only, or the
///                       file is a gain schedule
[[nodiscard]] GivenGains read_given_gains(const std::string& path);

/// @param gains   that were read
/// @param states  of the model
/// @param words   convention of the model
/// @param path    for messages
/// @throws InvalidInput  if the states of the gains are not those of the model
void require_states(const Gains& gains, const std::vector<Signal>& states, const Convention& words,
                    const std::string& path);

/// K and K_int, ordered by the states, integrals and inputs of the problem.
struct OrderedGains {
  Eigen::MatrixXd K;      ///< (nu × nx)
  Eigen::MatrixXd K_int;  ///< (nu × ni)
};

/// Converts the gains to the design's convention and order.
/// @param gains    in any convention
/// @param vehicle  of the problem
/// @param design   states, integrals and inputs of the problem
/// @param path     for messages
/// @throws InvalidInput  if the gains are for another vehicle, or for other inputs, states or
///                       integrals than those of the problem
[[nodiscard]] OrderedGains in_order_of(const Gains& gains, const Vehicle& vehicle,
                                       const LqrDesign& design, const std::string& path);

}  // namespace quadtune
