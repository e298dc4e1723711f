// SPDX-License-Identifier: Apache-2.0
/// How far several loops may move at once.
#pragma once

#include <Eigen/Core>

#include "quadtune/synthesis/margins.hpp"

namespace quadtune {

/// Bounds of the structured singular value of a complex matrix for as many independent complex
/// numbers as it has rows.
struct StructuredGain {
  double lower = 0;  ///< ρ(U M) of a diagonal unitary U
  double upper = 0;  ///< σ_max(D M D⁻¹) of a diagonal positive D, least found
};

/// @param M  (n × n)
/// Equal up to rounding for n ≤ 3, where the bounds meet, and mostly beyond.
/// Source: Packard and Doyle 1993.
[[nodiscard]] StructuredGain structured_gain(const Eigen::MatrixXcd& M);

/// The largest disk that every channel's factor may be anywhere in, all at once and independently.
struct SimultaneousDiskMargin {
  /// Guaranteed: 1/upper bound of max μ(S + (skew - 1)/2). The gains and the phase are this disk's.
  DiskMargin guaranteed;
  /// A disk of this size holds factors that do destabilize: 1/lower bound. 0 of an unstable loop.
  double alpha_destabilizing = 0;
};

/// @param loop  of any number of channels; of one it gives the disk of loop_margins()
/// @param skew  as in loop_margins()
[[nodiscard]] SimultaneousDiskMargin simultaneous_disk_margin(const OpenLoop& loop,
                                                              double skew = 0);

}  // namespace quadtune
