// SPDX-License-Identifier: Apache-2.0
/// Gains that the user names beside a problem: in its order; and laws as JSON that is read again.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "quadtune/convention.hpp"
#include "quadtune/design.hpp"
#include "quadtune/exports/content.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/design/given_gains.hpp"

namespace quadtune::cli {

/// The keys by which read_laws() knows the laws again, for what a verb prints as JSON:
/// "format", "format_version", and "gains", "cascade" and "estimator" of what `content` has.
void add_laws(internal::Json& json, const ExportContent& content);

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
