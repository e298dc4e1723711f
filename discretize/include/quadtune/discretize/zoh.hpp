// SPDX-License-Identifier: Apache-2.0
/// Zero-order hold: the exact discrete model of a plant whose inputs are held between samples.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "quadtune/lti.hpp"

namespace quadtune {

/// Samples ẋ = Ax + Bu exactly for inputs held between samples. A may be singular.
///
/// @param plant  A (nx × nx), B (nx × nu); time in seconds.
/// @param dt     Sample period [s], 0 < dt < ∞.
/// @return       A_d = e^(A dt), B_d = ∫₀^dt e^(Aτ) dτ B; C, D, names and units unchanged.
/// @throws InvalidInput  if dt is out of range, shapes disagree, an entry is not finite, or dt is
///                       so long that an entry of the result exceeds the range of a double.
/// Source: Van Loan 1978 (definition); docs/theory.md, "Discretization" (algorithm).
[[nodiscard]] DiscreteLti discretize_zoh(const ContinuousLti& plant, double dt);

/// The same for many plants of one size: solve() does not allocate.
class ZohWorkspace {
 public:
  /// @param nx  states, ≥ 1
  /// @param nu  inputs, ≥ 1
  ZohWorkspace(Eigen::Index nx, Eigen::Index nu);
  ~ZohWorkspace();
  ZohWorkspace(ZohWorkspace&&) noexcept;
  ZohWorkspace& operator=(ZohWorkspace&&) noexcept;

  /// @param A   (nx × nx) [1/s times units], finite
  /// @param B   (nx × nu), finite
  /// @param dt  Sample period [s], 0 < dt < ∞.
  /// @param Ad  (nx × nx) receives e^(A dt); must not share memory with A
  /// @param Bd  (nx × nu) receives ∫₀^dt e^(Aτ) dτ B; must not share memory with B
  /// @throws InvalidInput  as discretize_zoh(); Ad and Bd are then all NaN.
  void solve(const Eigen::Ref<const Eigen::MatrixXd>& A, const Eigen::Ref<const Eigen::MatrixXd>& B,
             double dt, Eigen::Ref<Eigen::MatrixXd> Ad, Eigen::Ref<Eigen::MatrixXd> Bd);

 private:
  struct Workspace;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace quadtune
