// SPDX-License-Identifier: Apache-2.0
/// The flown loop of a law for several vehicles of a box: a search, not a proof.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "quadtune/synthesis/robustness.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"

namespace quadtune {

/// The least stable of the vehicles that were analysed.
struct FlownBox {
  int vehicles = 0;                ///< number of vehicles analysed
  std::optional<FlownLoop> worst;  ///< of the largest |z|; none if there is no flown plant
  Eigen::VectorXd parameters;      ///< of that vehicle, as the family's
  std::string why;                 ///< why there is no flown plant; otherwise empty
};

struct FlownBoxOptions {
  Eigen::VectorXd also;     ///< parameters of one more vehicle to look at; empty: none
  std::size_t threads = 0;  ///< at most so many at once; 0: one for each processor
  std::function<bool()> interrupted = {};
};

/// Computes the poles of the flown loop at the nominal vehicle and at corners of the box, where all
/// moments of inertia are at the same end. The law and the estimator are those of the plan and know
/// nothing of the difference.
/// @param family  of uncertain_hover(): its parameters are mass, inertia x, y, z, thrust, lag,
/// delay
/// @throws InvalidInput  for a family of other parameters
/// @throws Interrupted
[[nodiscard]] FlownBox flown_box(const PlannedFlight& plan, const LoopFamily& family,
                                 const FlownBoxOptions& options = {});

}  // namespace quadtune
