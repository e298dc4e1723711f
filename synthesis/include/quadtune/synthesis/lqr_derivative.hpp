// SPDX-License-Identifier: Apache-2.0
/// How a regulator's cost matrix and gain move with its weights.
/// Derivation: docs/theory.md, "Derivative of the gain by the weights".
#pragma once

#include <Eigen/Core>
#include <memory>

#include "quadtune/lti.hpp"
#include "quadtune/synthesis/lqr.hpp"

namespace quadtune {

/// What a direction of the weights does to the solution.
struct LqrTangent {
  Eigen::MatrixXd dX;  ///< (nx × nx) symmetric
  Eigen::MatrixXd dK;  ///< (nu × nx)
};

/// The derivative of X and K by Q, R and N at a solved problem. The closed loop is reduced to its
/// Schur form once; each direction, or each gradient, is one back-substitution of O(nx³) more.
///
/// Not for X of an equation without digits: the relative error is of the order of 1e-16 over
/// RiccatiResult::rcond, as that of X itself.
class LqrDerivative {
 public:
  /// @param plant     that was solved for
  /// @param weights   that were solved for
  /// @param solution  of lqr(plant, weights); full or essential evidence
  /// @throws InvalidInput  for a solution that is not solved, or of other shapes than the plant's
  ///                       and the weights'.
  LqrDerivative(const ContinuousLti& plant, const LqrWeights& weights,
                const RiccatiResult& solution);
  LqrDerivative(const DiscreteLti& plant, const LqrWeights& weights, const RiccatiResult& solution);
  ~LqrDerivative();
  LqrDerivative(LqrDerivative&&) noexcept;
  LqrDerivative& operator=(LqrDerivative&&) noexcept;

  /// @param direction  dQ (nx × nx) and dR (nu × nu), symmetric, and dN (nx × nu); each may be
  ///                   empty for zero
  /// @return           all NaN where LAPACK found no Schur form of the closed loop
  /// @throws InvalidInput  for shapes, non-finite entries, asymmetry.
  [[nodiscard]] LqrTangent along(const LqrWeights& direction) const;

  /// The gradient of Σ Y_ij K_ij by the weights: Q and R symmetric, so that along any direction
  /// Σ Y∘dK = Σ Q∘dQ + Σ R∘dR + Σ N∘dN.
  ///
  /// @param Y  (nu × nx)
  /// @return   all NaN where LAPACK found no Schur form of the closed loop
  /// @throws InvalidInput  for a shape or non-finite entries.
  [[nodiscard]] LqrWeights gradient(const Eigen::Ref<const Eigen::MatrixXd>& Y) const;

 private:
  struct Parts;
  std::unique_ptr<const Parts> parts_;
};

}  // namespace quadtune
