// SPDX-License-Identifier: Apache-2.0
/// Solves many Riccati equations of one size at once, for gain schedules and searches over weights.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "quadtune/synthesis/riccati.hpp"

namespace quadtune {

/// One equation. Shapes and definiteness are those of care() and dare().
struct RiccatiMatrices {
  Eigen::MatrixXd A;  ///< (nx × nx)
  Eigen::MatrixXd B;  ///< (nx × nu)
  Eigen::MatrixXd Q;  ///< (nx × nx)
  Eigen::MatrixXd R;  ///< (nu × nu)
  Eigen::MatrixXd N;  ///< (nx × nu), or empty for zero, then in all equations of a batch
};

/// Solves up to eight equations at a time, one in each lane of a SIMD vector (in two or four groups
/// if the registers are narrower), by structure-preserving doubling without pivoting. All lanes
/// share the scaling and the Cayley shift, so a batch should contain similar equations, such as
/// neighbours in a gain schedule. The residual and the closed-loop stability of each lane are
/// checked. An equation that fails a check is solved by a RiccatiSolver, which pivots, scales each
/// equation separately, and names the culprit.
///
/// Results contain the evidence of RiccatiEvidence::essential, except that rcond is NaN if the
/// batch computed the solution. For nx > 32, the RiccatiSolver solves every equation.
///
/// Not for use by two threads at once. A moved-from batch may only be destroyed or assigned to.
class RiccatiBatch {
 public:
  static constexpr std::size_t kLanes = 8;  ///< number of equations that are solved at a time

  /// @param nx, nu   sizes of all equations, ≥ 1
  /// @param options  `evidence` is ignored; it is always essential
  /// @throws InvalidInput  for the reasons of RiccatiSolver
  RiccatiBatch(Eigen::Index nx, Eigen::Index nu, RiccatiOptions options = {});
  ~RiccatiBatch();
  RiccatiBatch(RiccatiBatch&&) noexcept;
  RiccatiBatch& operator=(RiccatiBatch&&) noexcept;

  /// Solves continuous equations.
  ///
  /// @param problems  1 to kLanes equations
  /// @return          kLanes results, those of `problems` first; valid until the next call
  /// @throws InvalidInput  for the reasons of care(), for the first invalid problem
  std::span<const RiccatiResult> care(std::span<const RiccatiMatrices> problems);

  /// Solves discrete equations in the same way. The RiccatiSolver solves those whose R is not
  /// positive definite.
  std::span<const RiccatiResult> dare(std::span<const RiccatiMatrices> problems);

  /// Number of equations that the RiccatiSolver solved since the construction of this batch.
  [[nodiscard]] std::size_t fallbacks() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace quadtune
