// SPDX-License-Identifier: Apache-2.0
/// One Lyapunov function for a whole box of closed loops.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "certify/enclosed_loop.hpp"

namespace quadtune::internal {

/// Coordinates z = Y x; X is Y⁻¹ up to rounding.
struct Coordinates {
  Eigen::MatrixXd Y;
  Eigen::MatrixXd X;
};

/// Whether xᵀ YᵀY x falls with every period of every loop of the box.
struct Contraction {
  bool proved = false;
  /// ‖Y M Y⁻¹‖₂ ≤ 1 - gap for every M of the box; 0 unless proved.
  double gap = 0;
  double condition = 0;  ///< ≥ ‖Y‖ ‖Y⁻¹‖; 0 unless proved
  /// Of the box's middle, computed and not proved; NaN where the given coordinates prove the box.
  double radius = 0;
  /// Along which the loops differ most: a number, or their count for `ahead`; -1: none has a width.
  Eigen::Index widest = -1;
  /// Those in which the box expands least of all that were tried, unless it is proved.
  std::optional<Coordinates> coordinates;
};

/// M(p) is within R of the convex hull of its values in the corners of the box, and x ↦ ‖Y M x‖² is
/// convex in M: what holds at each corner, R added, holds in between.
/// @param start  coordinates to try first: those of a larger box around this one. May be null.
[[nodiscard]] Contraction prove_contraction(const UncertainLoop& loop, const EnclosedBox& box,
                                            const Coordinates* start = nullptr);

}  // namespace quadtune::internal
