// SPDX-License-Identifier: Apache-2.0
/// Control laws that the user names: of an export, of a file of gains, or of a design file.
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

/// Laws with what is known of them where they are a design's.
struct GivenLaws {
  StoredLaws laws;
  std::optional<DesignOutcome> design;  ///< solved, where the file is a design
};

/// Reads what read_laws() reads, or solves the laws of a design file (.toml).
/// @throws InvalidInput  for another file, one without a law, or a gain schedule
/// @throws NoSolution    for a design that has no solution
[[nodiscard]] GivenLaws read_given_laws(const std::string& path);

/// @throws InvalidInput  for laws of another vehicle
void require_vehicle(const StoredLaws& laws, const Vehicle& vehicle, const std::string& path);

struct GivenGains {
  Gains gains;
  std::optional<Design> design;  ///< where they stood in a design file
};

/// Reads what read_gains() reads; of a design file (.toml) [published], or where it has none the
/// gains that it gives.
/// @throws InvalidInput  for a design without gains, or with published ones of some inputs only,
///                       and for a gain schedule.
[[nodiscard]] GivenGains read_given_gains(const std::string& path);

/// @param words  the model's convention
/// @param path   for messages
/// @throws InvalidInput  for gains of other states than the model's.
void require_states(const Gains& gains, const std::vector<Signal>& states, const Convention& words,
                    const std::string& path);

/// K and K_int as the problem has its states, integrals and inputs.
struct OrderedGains {
  Eigen::MatrixXd K;      ///< (nu × nx)
  Eigen::MatrixXd K_int;  ///< (nu × ni)
};

/// Turns the gains into the design's convention and order.
/// @param path  for messages
/// @throws InvalidInput  for the gains of another vehicle, of other inputs, states or integrals
/// than
///                       the problem's.
[[nodiscard]] OrderedGains in_order_of(const Gains& gains, const Vehicle& vehicle,
                                       const LqrDesign& design, const std::string& path);

}  // namespace quadtune
