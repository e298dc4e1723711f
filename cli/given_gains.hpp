// SPDX-License-Identifier: Apache-2.0
/// Gains that weights are looked for: of an export, or those that a design file has as published.
#pragma once

#include <optional>
#include <string>

#include "quadtune/design.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/linearize/linearize.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune::cli {

struct GivenGains {
  Gains gains;
  std::optional<Design> design;  ///< where they stood in a design file
};

/// Reads what read_gains() reads, or [published] of a design file (.toml).
/// @throws InvalidInput  for a design without published gains, or with those of some inputs only.
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

}  // namespace quadtune::cli
