// SPDX-License-Identifier: Apache-2.0
/// Proves one quadratic Lyapunov function for a whole box of closed loops.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "certify/enclosed_loop.hpp"

namespace quadtune::internal {

/// Coordinates z = Y x, where X is Y⁻¹ up to rounding.
struct Coordinates {
  Eigen::MatrixXd Y;
  Eigen::MatrixXd X;
};

/// Whether xᵀ YᵀY x decreases in every period for every loop of the box.
struct Contraction {
  bool proved = false;
  /// ‖Y M Y⁻¹‖₂ ≤ 1 - gap for every M of the box; 0 unless proved.
  double gap = 0;
  double condition = 0;  ///< ≥ ‖Y‖ ‖Y⁻¹‖; 0 unless proved
  /// Spectral radius at the midpoint of the box, computed but not proved; NaN if the given
  /// coordinates prove the box.
  double radius = 0;
  /// The coordinate along which the loops differ most: the index of a parameter, or the number of
  /// parameters for `ahead`; -1 if no interval has positive width.
  Eigen::Index widest = -1;
  /// Unless proved: the coordinates with the minimum expansion of the box among those tried.
  std::optional<Coordinates> coordinates;
};

/// Tries to prove a box. M(p) is within R of the convex hull of its values at the corners of the
/// box, and x ↦ ‖Y M x‖² is convex in M: a bound that holds at each corner, with R added, also
/// holds in between.
/// @param start  coordinates to try first: those of a larger box around this one. May be null.
[[nodiscard]] Contraction prove_contraction(const UncertainLoop& loop, const EnclosedBox& box,
                                            const Coordinates* start = nullptr);

}  // namespace quadtune::internal
