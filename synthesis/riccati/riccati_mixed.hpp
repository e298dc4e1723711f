// SPDX-License-Identifier: Apache-2.0
/// The doubling for large problems: steps in single precision, which run at twice the speed,
/// corrected by Newton's method with the residual in double precision.
#pragma once

#include <vector>

#include "riccati/kernel_ops.hpp"
#include "riccati/riccati_doubling.hpp"

namespace quadtune::internal {

/// What is done in single precision: a first approximation, and the sums that solve the closed
/// loop's Lyapunov equation.
class SingleDoubling : private DoublingSteps<KernelOps<0, float>> {
 public:
  using DoubleOps = KernelOps<0, double>;

  SingleDoubling(Eigen::Index nx, Eigen::Index nu);

  /// X of the problem A_tilde, G, Q_tilde in X, with about four digits; continuous from the given
  /// γ, which may move. False when the steps do not converge.
  bool approximate(bool continuous, const DoubleOps& ops, const DoubleOps::Square& A_tilde,
                   const DoubleOps::Square& G, const DoubleOps::Square& Q_tilde, int max_iterations,
                   double& gamma, DoubleOps::Square& X, int& iterations);

  /// Starts a list of powers. F is the (A - B K - γI)⁻¹ of a continuous equation.
  void start_powers(bool continuous, const DoubleOps& ops, double gamma,
                    const DoubleOps::Square& F);
  /// Adds the next power E, E², E⁴, … False when there is no room for it.
  bool keep_power(const DoubleOps& ops, const DoubleOps::Square& power);
  /// M ← the solution of the closed loop's Lyapunov equation for M, with about three digits.
  void solve_lyapunov(const DoubleOps& ops, DoubleOps::Square& M);

 private:
  /// 2¹⁶ samples of the Cayley-transformed loop: slower ones are left to double precision.
  static constexpr std::size_t kRoom = 16;
  /// Change of H at which single precision has nothing more to give.
  static constexpr double kTolerance = 1e-4;

  bool continuous_ = true;
  double sum_gamma_ = 1;
  std::size_t kept_ = 0;
  std::vector<Square> powers_;
  Square F_ = ops_.square();
};

/// As Doubling, by single precision where that reaches the residual of double precision.
class MixedDoubling final : public Doubling<KernelOps<0, double>> {
 public:
  MixedDoubling(Eigen::Index nx, Eigen::Index nu);

  bool solve(const RiccatiEquation& problem, const Eigen::MatrixXd& factor_R,
             const RiccatiOptions& options, Candidate& found, SquaredNorms& norms) override;

 private:
  bool solve_from_single(bool continuous, const RiccatiOptions& options, Candidate& found,
                         SquaredNorms& norms);
  bool keep_powers(bool continuous);
  bool correct(bool continuous, Residual& now);

  SingleDoubling single_;
};

}  // namespace quadtune::internal
