// SPDX-License-Identifier: Apache-2.0
/// Stability margins for simultaneous changes of several loops.
#pragma once

#include <Eigen/Core>

#include "quadtune/synthesis/margins.hpp"

namespace quadtune {

/// Bounds of the structured singular value μ of a complex (n × n) matrix for n independent complex
/// scalar uncertainties.
struct StructuredGain {
  double lower = 0;  ///< ρ(U M), maximized over diagonal unitary U
  double upper = 0;  ///< σ_max(D M D⁻¹), minimized over diagonal positive D
};

/// Computes both bounds. They are equal up to rounding for n ≤ 3, and mostly for larger n.
/// @param M  (n × n)
/// Source: Packard and Doyle 1993.
[[nodiscard]] StructuredGain structured_gain(const Eigen::MatrixXcd& M);

/// The largest disk in which the factors of all channels may vary simultaneously and independently.
struct SimultaneousDiskMargin {
  /// The guaranteed disk: alpha = 1/upper bound of max μ(S + (skew - 1)/2).
  DiskMargin guaranteed;
  /// 1/lower bound: a disk of this size contains destabilizing factors. 0 if the loop is unstable.
  double alpha_destabilizing = 0;
};

/// Computes the simultaneous disk margin of a loop.
/// @param loop  any number of channels; for one channel the result is LoopMargins::disk
/// @param skew  as for loop_margins()
[[nodiscard]] SimultaneousDiskMargin simultaneous_disk_margin(const OpenLoop& loop,
                                                              double skew = 0);

}  // namespace quadtune
