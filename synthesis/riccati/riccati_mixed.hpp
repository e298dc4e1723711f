// SPDX-License-Identifier: Apache-2.0
/// Doubling for large problems: the steps use single precision, which is twice as fast, and
/// Newton's method corrects the result with residuals in double precision.
#pragma once

#include <vector>

#include "riccati/kernel_ops.hpp"
#include "riccati/riccati_doubling.hpp"

namespace quadtune::internal {

/// The computations in single precision: a first approximation, and the sums that solve the
/// Lyapunov equation of the closed loop.
class SingleDoubling : private DoublingSteps<KernelOps<0, float>> {
 public:
  using DoubleOps = KernelOps<0, double>;

  SingleDoubling(Eigen::Index nx, Eigen::Index nu);

  /// Solves the problem A_tilde, G, Q_tilde for X, to about four digits. The continuous problem
  /// starts with the given γ, which may be changed. False if the steps do not converge.
  bool approximate(bool continuous, const DoubleOps& ops, const DoubleOps::Square& A_tilde,
                   const DoubleOps::Square& G, const DoubleOps::Square& Q_tilde, int max_iterations,
                   double& gamma, DoubleOps::Square& X, int& iterations);

  /// Starts a list of powers. F is (A - B K - γI)⁻¹ if continuous.
  void start_powers(bool continuous, const DoubleOps& ops, double gamma,
                    const DoubleOps::Square& F);
  /// Adds the next power E, E², E⁴, … False if the list is full.
  bool keep_power(const DoubleOps& ops, const DoubleOps::Square& power);
  /// M ← the solution of the closed loop's Lyapunov equation for M, with about three digits.
  void solve_lyapunov(const DoubleOps& ops, DoubleOps::Square& M);

 private:
  /// Maximum number of powers, 2¹⁶ samples of the Cayley-transformed loop. Slower loops are solved
  /// in double precision.
  static constexpr std::size_t kRoom = 16;
  /// Relative change of H at which single precision has converged.
  static constexpr double kTolerance = 1e-4;

  bool continuous_ = true;
  double sum_gamma_ = 1;
  std::size_t kept_ = 0;
  std::vector<Square> powers_;
  Square F_ = ops_.square();
};

/// Same as Doubling, but uses single precision if that attains the residual of double precision.
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
