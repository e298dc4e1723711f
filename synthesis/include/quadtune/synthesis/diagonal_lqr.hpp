// SPDX-License-Identifier: Apache-2.0
/// A design's LQR problem as a function of the diagonals of its weights, with its derivative: what
/// a search over weights evaluates again and again.
#pragma once

#include <Eigen/Core>
#include <string>
#include <variant>
#include <vector>

#include "quadtune/design.hpp"
#include "quadtune/lti.hpp"
#include "quadtune/synthesis/lqr.hpp"
#include "quadtune/synthesis/lqr_derivative.hpp"

namespace quadtune {

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
