// SPDX-License-Identifier: Apache-2.0
/// Balancing of square matrices.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>

namespace quadtune::internal {

/// Powers of two d such that each row of diag(d)⁻¹ A diag(d) has about the same 1-norm as the
/// column of the same index, without the diagonal (Osborne 1960; Parlett, Reinsch 1969). Zero rows
/// and columns are left unchanged. Entries below rounding relative to the largest entry are
/// ignored: if only such entries coupled two parts of a plant, they would drive the scales of the
/// parts apart until rounding errors dominate.
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
