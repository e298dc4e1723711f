// SPDX-License-Identifier: Apache-2.0
/// Many Riccati equations of one size at once, as a gain schedule or a search over weights has
/// them.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "quadtune/synthesis/riccati.hpp"

namespace quadtune {

/// One equation: shapes, signs and the meaning of an empty N as for care() and dare().
struct RiccatiMatrices {
  Eigen::MatrixXd A;  ///< (nx × nx)
  Eigen::MatrixXd B;  ///< (nx × nu)
  Eigen::MatrixXd Q;  ///< (nx × nx)
  Eigen::MatrixXd R;  ///< (nu × nu)
  Eigen::MatrixXd N;  ///< (nx × nu), or empty for zero; of all equations of a batch or of none
};

/// Solves up to eight equations at a time, one in each lane of a vector (in two or four groups
/// where the registers are narrower): structure-preserving doubling without pivoting, in scales and
/// with a Cayley shift that the lanes share, so that neighbours, whose scales are alike, belong
/// together. Each lane's residual and the stability of its closed loop are checked; what does not
/// pass goes to a RiccatiSolver, which pivots, scales by itself, and names the culprit.
///
/// A result holds what RiccatiEvidence::essential tells, but for rcond: that is NaN where the batch
/// gave the answer. Beyond nx = 32 every equation goes to the RiccatiSolver.
///
/// Not for use by two threads at once. A moved-from batch may only be destroyed or assigned to.
class RiccatiBatch {
 public:
  static constexpr std::size_t kLanes = 8;

  /// @param nx, nu   sizes that every equation will have, ≥ 1
  /// @param options  evidence is taken for essential
  /// @throws InvalidInput  as RiccatiSolver
  RiccatiBatch(Eigen::Index nx, Eigen::Index nu, RiccatiOptions options = {});
  ~RiccatiBatch();
  RiccatiBatch(RiccatiBatch&&) noexcept;
  RiccatiBatch& operator=(RiccatiBatch&&) noexcept;

  /// Solves continuous equations.
  ///
  /// @param problems  1 to kLanes of them
  /// @return          kLanes results, those of `problems` first; valid until the next call
  /// @throws InvalidInput  as care(), for the first problem that is refused
  std::span<const RiccatiResult> care(std::span<const RiccatiMatrices> problems);

  /// Solves discrete equations, likewise. R must be > 0, or the RiccatiSolver answers.
  std::span<const RiccatiResult> dare(std::span<const RiccatiMatrices> problems);

  /// Equations that the RiccatiSolver had to answer, since this batch was made.
  [[nodiscard]] std::size_t fallbacks() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace quadtune
