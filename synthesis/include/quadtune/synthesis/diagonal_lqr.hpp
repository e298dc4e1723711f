// SPDX-License-Identifier: Apache-2.0
/// An LQR as a function of its weights: how its cost matrix and gain move with them.
/// Derivation: docs/theory.md, "Derivative of the gain by the weights".
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "quadtune/design.hpp"
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

/// The plant is augmented by its integrals and sampled once. The cost that is solved is linear in
/// the weights with every method, so it is a sum of costs of one weight each, worked out once too.
///
/// The weights w are p = nx + ni + nu numbers: of the states, of the integrals, of the inputs.
class DiagonalLqr {
 public:
  /// @param plant   nx states, nu inputs
  /// @param design  integrals, method and dt; its Q, R and Q_integral are not looked at
  /// @throws InvalidInput  as with_integrals(); a dt ≤ 0 for a sampled method.
  DiagonalLqr(const ContinuousLti& plant, const LqrDesign& design);

  /// nx + ni states, then nu inputs: "x", …, "int_x", …, "w1", …
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] Eigen::Index size() const { return std::ssize(names_); }   ///< p
  [[nodiscard]] Eigen::Index states() const { return size() - inputs(); }  ///< nx + ni
  [[nodiscard]] Eigen::Index inputs() const { return inputs_; }            ///< nu

  /// The plant of the equation: with its integrals, and sampled unless the method is continuous.
  [[nodiscard]] const std::variant<ContinuousLti, DiscreteLti>& plant() const { return plant_; }

  /// The weights of the equation.
  /// @param w  (p) ≥ 0
  /// @throws InvalidInput  for another size, or an entry that is negative or not finite.
  [[nodiscard]] LqrWeights weights(const Eigen::Ref<const Eigen::VectorXd>& w) const;

  /// The gain [K K_int] (nu × (nx + ni)) with its evidence, equal to state_feedback()'s up to
  /// rounding.
  /// @throws InvalidInput  as weights(); for an input's weight of 0 where the method needs R > 0.
  [[nodiscard]] RiccatiResult solve(const Eigen::Ref<const Eigen::VectorXd>& w) const;

  /// Derivative of [K K_int], stacked column by column, by each weight. Times the weight it is the
  /// derivative by its logarithm.
  ///
  /// @param solution  solve(w), solved
  /// @return          (nu (nx + ni) × p)
  /// @throws InvalidInput  as weights() and LqrDerivative.
  [[nodiscard]] Eigen::MatrixXd jacobian(const Eigen::Ref<const Eigen::VectorXd>& w,
                                         const RiccatiResult& solution) const;

  /// Derivative of Σ Y_ij K_ij by each weight, by one back-substitution for all of them.
  /// @param Y  (nu × (nx + ni))
  [[nodiscard]] Eigen::VectorXd gradient(const Eigen::Ref<const Eigen::VectorXd>& w,
                                         const RiccatiResult& solution,
                                         const Eigen::Ref<const Eigen::MatrixXd>& Y) const;

 private:
  [[nodiscard]] LqrDerivative derivative(const Eigen::Ref<const Eigen::VectorXd>& w,
                                         const RiccatiResult& solution) const;

  std::variant<ContinuousLti, DiscreteLti> plant_;
  std::vector<LqrWeights> unit_costs_;  ///< p: of the equation, for a weight of 1 and others of 0
  std::vector<std::string> names_;
  Eigen::Index inputs_;
};

/// The diagonals of a design's weights in DiagonalLqr's order, and back: `design` with the weights
/// w on its diagonals and 0 beside them.
/// @throws InvalidInput  for weights that are not diagonal, or another number of them.
[[nodiscard]] Eigen::VectorXd diagonals_of(const LqrDesign& design);
[[nodiscard]] LqrDesign with_diagonals(LqrDesign design,
                                       const Eigen::Ref<const Eigen::VectorXd>& w);

}  // namespace quadtune
