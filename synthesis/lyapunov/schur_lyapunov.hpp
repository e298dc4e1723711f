// SPDX-License-Identifier: Apache-2.0
/// Solves several Lyapunov equations with the same A by one Schur form.
#pragma once

#include <Eigen/Core>
#include <complex>

#include "riccati/riccati_parts.hpp"

namespace quadtune::internal {

/// Bartels–Stewart method: A is balanced by powers of two and reduced to its Schur form once, in
/// O(n³). Every solve is a triangular recursion that costs another O(n³).
class SchurLyapunov {
 public:
  SchurLyapunov(Time time, const ConstRef& A);

  /// False if LAPACK's QR iteration did not converge.
  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] const Eigen::VectorXcd& eigenvalues() const { return eigenvalues_; }

  /// Solves A X + X Aᵀ + Q = 0, or A X Aᵀ - X + Q = 0. Q need not be symmetric.
  [[nodiscard]] Eigen::MatrixXd solve(const ConstRef& Q) const { return solve(Q, false); }
  /// Solves Aᵀ X + X A + Q = 0, or Aᵀ X A - X + Q = 0.
  [[nodiscard]] Eigen::MatrixXd solve_transposed(const ConstRef& Q) const { return solve(Q, true); }

 private:
  [[nodiscard]] Eigen::MatrixXd solve(const ConstRef& Q, bool transposed) const;
  [[nodiscard]] Eigen::MatrixXd solve_continuous(const Eigen::MatrixXd& Q, bool transposed) const;
  [[nodiscard]] Eigen::MatrixXd solve_discrete(const Eigen::MatrixXd& Q, bool transposed) const;

  Time time_;
  bool ok_ = false;
  Eigen::VectorXd scale_;  ///< A = D U T Uᴴ D⁻¹
  Eigen::MatrixXd T_;      ///< quasi-triangular, continuous
  Eigen::MatrixXd U_;
  Eigen::MatrixXcd Tc_;  ///< triangular, discrete
  Eigen::MatrixXcd Uc_;
  Eigen::VectorXcd eigenvalues_;
};

}  // namespace quadtune::internal
