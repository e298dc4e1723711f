// SPDX-License-Identifier: Apache-2.0
/// The LQR solution as a function of its weights, and the derivatives of cost matrix and gain.
/// Derivation: docs/theory.md, "Derivative of the gain with respect to the weights".
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

/// Directional derivative of the solution.
struct LqrTangent {
  Eigen::MatrixXd dX;  ///< (nx × nx) symmetric
  Eigen::MatrixXd dK;  ///< (nu × nx)
};

/// The derivative of X and K with respect to Q, R and N at a solved problem. The closed loop is
/// reduced to its Schur form once; each direction or gradient then costs one back-substitution of
/// O(nx³).
///
/// The relative error is of the order of 1e-16 / RiccatiResult::rcond, like that of X itself, so
/// that the derivative of an ill-conditioned equation is not meaningful.
class LqrDerivative {
 public:
  /// @param plant     the plant of the solved problem
  /// @param weights   the weights of the solved problem
  /// @param solution  result of lqr(plant, weights), with full or essential evidence
  /// @throws InvalidInput  if the solution is not solved, or if its shapes disagree with the plant
  ///                       or the weights.
  LqrDerivative(const ContinuousLti& plant, const LqrWeights& weights,
                const RiccatiResult& solution);
  /// The same for a discrete problem.
  LqrDerivative(const DiscreteLti& plant, const LqrWeights& weights, const RiccatiResult& solution);
  ~LqrDerivative();
  LqrDerivative(LqrDerivative&&) noexcept;
  LqrDerivative& operator=(LqrDerivative&&) noexcept;

  /// Computes the derivative of X and K along a direction of the weights.
  /// @param direction  dQ (nx × nx) and dR (nu × nu), symmetric, and dN (nx × nu); each may be
  ///                   empty for zero
  /// @return           all NaN if LAPACK did not converge to a Schur form of the closed loop
  /// @throws InvalidInput  for wrong shapes, entries that are not finite, or asymmetry.
  [[nodiscard]] LqrTangent along(const LqrWeights& direction) const;

  /// Computes the gradient Q, R, N of Σ Y_ij K_ij with respect to the weights. Q and R are
  /// symmetric, and along any direction Σ Y∘dK = Σ Q∘dQ + Σ R∘dR + Σ N∘dN.
  ///
  /// @param Y  (nu × nx)
  /// @return   all NaN if LAPACK did not converge to a Schur form of the closed loop
  /// @throws InvalidInput  for a wrong shape or entries that are not finite.
  [[nodiscard]] LqrWeights gradient(const Eigen::Ref<const Eigen::MatrixXd>& Y) const;

 private:
  struct Parts;
  std::unique_ptr<const Parts> parts_;
};

/// The LQR problem of a design whose weights are diagonal, for repeated solution with different
/// weights. The constructor augments the plant by its integrals and samples it once. The cost of
/// the equation is linear in the weights with every method; the constructor therefore also computes
/// the contribution of each weight once.
///
/// The vector w has p = nx + ni + nu weights: those of the states, the integrals and the inputs.
class DiagonalLqr {
 public:
  /// @param plant   nx states, nu inputs
  /// @param design  integrals, method and dt; its Q, R and Q_integral are ignored
  /// @throws InvalidInput  for the reasons of with_integrals(), and if dt ≤ 0 for a sampled method.
  DiagonalLqr(const ContinuousLti& plant, const LqrDesign& design);

  /// Names of the weights, nx + ni states and then nu inputs: "x", …, "int_x", …, "w1", …
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] Eigen::Index size() const { return std::ssize(names_); }   ///< p
  [[nodiscard]] Eigen::Index states() const { return size() - inputs(); }  ///< nx + ni
  [[nodiscard]] Eigen::Index inputs() const { return inputs_; }            ///< nu

  /// The plant of the equation, with its integrals; sampled unless the method is continuous.
  [[nodiscard]] const std::variant<ContinuousLti, DiscreteLti>& plant() const { return plant_; }

  /// Computes the weights of the equation.
  /// @param w  (p) ≥ 0
  /// @throws InvalidInput  if the size is wrong, or an entry is negative or not finite.
  [[nodiscard]] LqrWeights weights(const Eigen::Ref<const Eigen::VectorXd>& w) const;

  /// Computes the gain [K K_int] (nu × (nx + ni)) with its evidence. It equals that of
  /// state_feedback() up to rounding.
  /// @throws InvalidInput  for the reasons of weights(), and if the weight of an input is 0
  ///                       although the method requires R > 0.
  [[nodiscard]] RiccatiResult solve(const Eigen::Ref<const Eigen::VectorXd>& w) const;

  /// Computes the derivative of [K K_int], stacked column by column, with respect to each weight.
  /// Multiplied by the weight, it is the derivative with respect to the logarithm of the weight.
  ///
  /// @param w         (p) weights, > 0
  /// @param solution  solve(w), solved
  /// @return          (nu (nx + ni) × p)
  /// @throws InvalidInput  for the reasons of weights() and LqrDerivative.
  [[nodiscard]] Eigen::MatrixXd jacobian(const Eigen::Ref<const Eigen::VectorXd>& w,
                                         const RiccatiResult& solution) const;

  /// Computes the gradient of Σ Y_ij K_ij with respect to all weights by one back-substitution.
  /// @param w         (p) weights, > 0
  /// @param solution  solve(w), solved
  /// @param Y         (nu × (nx + ni))
  [[nodiscard]] Eigen::VectorXd gradient(const Eigen::Ref<const Eigen::VectorXd>& w,
                                         const RiccatiResult& solution,
                                         const Eigen::Ref<const Eigen::MatrixXd>& Y) const;

 private:
  [[nodiscard]] LqrDerivative derivative(const Eigen::Ref<const Eigen::VectorXd>& w,
                                         const RiccatiResult& solution) const;

  std::variant<ContinuousLti, DiscreteLti> plant_;
  std::vector<LqrWeights> unit_costs_;  ///< p costs of the equation: one weight is 1, the others 0
  std::vector<std::string> names_;
  Eigen::Index inputs_;
};

/// Returns the diagonals (p) of a design's weights, in the order of DiagonalLqr.
/// @throws InvalidInput  if a weight matrix is not square or not diagonal
[[nodiscard]] Eigen::VectorXd diagonals_of(const LqrDesign& design);

/// The inverse of diagonals_of(): the design with diagonal weight matrices that hold w (p).
/// @throws InvalidInput  if the size of w is not the number of weights of the design
[[nodiscard]] LqrDesign with_diagonals(LqrDesign design,
                                       const Eigen::Ref<const Eigen::VectorXd>& w);

}  // namespace quadtune
