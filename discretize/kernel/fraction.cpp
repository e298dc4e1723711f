// SPDX-License-Identifier: Apache-2.0
#include "kernel/fraction.hpp"

#include <algorithm>
#include <cmath>

namespace quadtune::internal {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

ContinuousLti realize_for_sampling(const ContinuousTransferFunction& plant, double dt) {
  ContinuousLti result = realize(plant);
  const Index n = result.A.rows();
  if (n < 2) return result;
  // A power of two, limited so that its n-th power does not overflow.
  const double ratio = std::min(std::scalbn(1.0, -std::ilogb(dt)) / result.A(1, 0),
                                std::scalbn(1.0, 900 / static_cast<int>(n)));
  if (!(ratio > 1)) return result;
  double scale = 1;  // x_i ← ratio^i x_i
  for (Index i = 0; i < n; ++i, scale *= ratio) {
    result.A.row(i) *= scale;
    result.A.col(i) /= scale;
    result.C.col(i) /= scale;
  }
  return result;
}

VectorXd numerator(const MatrixXd& A, const MatrixXd& B, const MatrixXd& C, const MatrixXd& D,
                   const VectorXd& den) {
  const Index n = den.size() - 1;
  VectorXd h(n + 1);
  h[0] = D.size() ? D(0, 0) : 0;
  VectorXd state = B.col(0);
  for (Index k = 1; k <= n; ++k) {
    h[k] = C.size() ? C.row(0).dot(state) : state[0];
    state = (A * state).eval();
  }
  VectorXd num(n + 1);
  for (Index i = 0; i <= n; ++i) num[i] = den.head(i + 1).dot(h.head(i + 1).reverse());
  return num;
}

}  // namespace quadtune::internal
