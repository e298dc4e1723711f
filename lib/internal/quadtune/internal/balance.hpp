// SPDX-License-Identifier: Apache-2.0
/// Levelling the rows and columns of a square matrix.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>

namespace quadtune::internal {

/// Powers of two d such that rows and columns of diag(d)⁻¹ A diag(d) have about the same 1-norms
/// without the diagonal (Osborne 1960; Parlett, Reinsch 1969). A row or column of zeros is left.
/// Entries that are rounding beside the largest have no say: where they alone couple two parts of a
/// plant they would pull the parts' scales apart until rounding is all that is seen.
inline Eigen::VectorXd balance(const Eigen::MatrixXd& A) {
  const Eigen::Index n = A.rows();
  Eigen::VectorXd d = Eigen::VectorXd::Ones(n);
  Eigen::MatrixXd size = A.cwiseAbs();
  size.diagonal().setZero();
  const double rounding = std::numeric_limits<double>::epsilon() * size.maxCoeff();
  size = (size.array() > rounding).select(size, 0.0);
  constexpr int kSweeps = 20;
  bool changed = true;
  for (int sweep = 0; changed && sweep < kSweeps; ++sweep) {
    changed = false;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double quotient = size.row(i).sum() / size.col(i).sum();
      if (!(quotient > 0) || !std::isfinite(quotient)) continue;
      const int half = std::ilogb(quotient) / 2;
      if (half == 0) continue;
      d[i] *= std::ldexp(1.0, half);
      size.row(i) *= std::ldexp(1.0, -half);
      size.col(i) *= std::ldexp(1.0, half);
      changed = true;
    }
  }
  return d;
}

}  // namespace quadtune::internal
