// SPDX-License-Identifier: Apache-2.0
/// The flown loop of a law for several vehicles of an uncertainty box: a search, not a proof.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "quadtune/synthesis/robustness.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"

namespace quadtune {

/// The least stable vehicle of those analysed.
struct FlownBox {
  int vehicles = 0;                ///< number of vehicles analysed
  std::optional<FlownLoop> worst;  ///< loop with the largest |z|; none if there is no flown plant
  Eigen::VectorXd parameters;      ///< of that vehicle, in the order of the family's
  std::string why;                 ///< why there is no flown plant; otherwise empty
};

/// Options of flown_box().
struct FlownBoxOptions {
  Eigen::VectorXd also;     ///< parameters of one more vehicle to analyse; empty: none
  std::size_t threads = 0;  ///< maximum number of threads; 0: one per processor
  /// Called regularly; true throws Interrupted; may be empty.
  std::function<bool()> interrupted = {};
};

/// Computes the poles of the flown loop at the nominal vehicle and at corners of the box where all
/// moments of inertia are at the same end. Law and estimator are those of the plan and do not
/// depend on the vehicle.
/// @param plan     of a hover
/// @param family   from uncertain_hover(): its parameters are mass, inertia x, y, z, thrust, lag,
///                 delay
/// @param options  further vehicle, threads, and interruption
/// @throws InvalidInput  if the family has other parameters
/// @throws Interrupted
[[nodiscard]] FlownBox flown_box(const PlannedFlight& plan, const LoopFamily& family,
                                 const FlownBoxOptions& options = {});

}  // namespace quadtune
