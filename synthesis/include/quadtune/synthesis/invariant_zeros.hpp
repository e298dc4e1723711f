// SPDX-License-Identifier: Apache-2.0
/// Zeros of linear systems with any number of inputs and outputs.
#pragma once

#include <Eigen/Core>

#include "quadtune/lti.hpp"

namespace quadtune {

/// The zeros of a system and its rank.
struct InvariantZeros {
  /// The finite λ at which [A - λI, B; C, D] loses rank. For a controllable and observable system
  /// they are the transmission zeros; otherwise modes that the inputs do not reach or the outputs
  /// do not show can be among them.
  Eigen::VectorXcd zeros;
  Eigen::Index rank = 0;  ///< of the transfer function matrix, for almost every λ
};

/// Removes the parts of the system that have no finite zeros, by orthogonal transformations, until
/// D is regular; the zeros are then the eigenvalues of A - B D⁻¹ C.
/// @param plant      any numbers of inputs and outputs
/// @param tolerance  relative to the norm of the system, below which singular values count as 0
/// @throws InvalidInput  as validate()
/// Source: Emami-Naeini and Van Dooren 1982.
[[nodiscard]] InvariantZeros invariant_zeros(const ContinuousLti& plant, double tolerance = 1e-11);

/// The same for a discrete system.
[[nodiscard]] InvariantZeros invariant_zeros(const DiscreteLti& plant, double tolerance = 1e-11);

}  // namespace quadtune
