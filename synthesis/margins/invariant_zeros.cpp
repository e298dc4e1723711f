// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/invariant_zeros.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>

#include "lyapunov/eigenvalues.hpp"

namespace quadtune {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

struct System {
  MatrixXd A, B, C, D;

  [[nodiscard]] System transposed() const {
    return {A.transpose(), C.transpose(), B.transpose(), D.transpose()};
  }
};

/// An orthogonal matrix [range, rest] whose first `rank` columns span the columns of M.
struct Range {
  MatrixXd basis;
  Index rank = 0;
};

Range range_of(const MatrixXd& M, double level) {
  if (M.rows() == 0 || M.cols() == 0) return {MatrixXd::Identity(M.rows(), M.rows()), 0};
  const Eigen::JacobiSVD<MatrixXd> svd(M, Eigen::ComputeFullU);
  return {svd.matrixU(), (svd.singularValues().array() > level).count()};
}

/// Removes outputs and states until the rows of D are independent. The zeros stay.
System with_full_rows(System s, double level) {
  for (;;) {
    // Rows of D that are 0: outputs y2 = C2 x, in which 0 = C2 x must hold.
    const Range rows = range_of(s.D, level);
    const Index m = rows.rank;
    if (m == s.D.rows()) return s;
    const MatrixXd C = rows.basis.transpose() * s.C;
    const MatrixXd D1 = rows.basis.leftCols(m).transpose() * s.D;
    const MatrixXd C2 = C.bottomRows(C.rows() - m);
    const Range states = range_of(C2.transpose(), level);
    const Index r = states.rank;
    const Index n = s.A.rows() - r;
    // x = V z with z = [z2, z1]: C2 x = 0 requires z2 = 0, and then 0 = A21 z1 + B2 u.
    MatrixXd V(s.A.rows(), s.A.rows());
    V << states.basis.rightCols(n), states.basis.leftCols(r);
    const MatrixXd A = V.transpose() * s.A * V;
    const MatrixXd B = V.transpose() * s.B;
    System next;
    next.A = A.topLeftCorner(n, n);
    next.B = B.topRows(n);
    next.C.resize(m + r, n);
    next.C << (C.topRows(m) * V).leftCols(n), A.bottomLeftCorner(r, n);
    next.D.resize(m + r, s.B.cols());
    next.D << D1, B.bottomRows(r);
    s = std::move(next);
    if (r == 0) return s;  // the outputs y2 were 0 for every x
  }
}

InvariantZeros zeros_of(System s, double tolerance) {
  const double level = tolerance * std::max({s.A.norm(), s.B.norm(), s.C.norm(), s.D.norm()});
  s = with_full_rows(std::move(s), level);
  s = with_full_rows(s.transposed(), level);  // now D is square and regular
  InvariantZeros result;
  result.rank = s.D.rows();
  if (s.A.rows() == 0) return result;
  const MatrixXd zeros_at =
      s.D.size() > 0 ? MatrixXd(s.A - s.B * s.D.partialPivLu().solve(s.C)) : s.A;
  result.zeros = internal::eigenvalues(zeros_at);
  return result;
}

template <class Lti>
System system_of(const Lti& plant) {
  validate(plant, "invariant_zeros");
  const Index nx = plant.A.rows();
  System s{plant.A, plant.B, plant.C, plant.D};
  if (s.C.size() == 0) s.C = MatrixXd::Identity(nx, nx);
  if (s.D.size() == 0) s.D = MatrixXd::Zero(s.C.rows(), s.B.cols());
  return s;
}

}  // namespace

InvariantZeros invariant_zeros(const ContinuousLti& plant, double tolerance) {
  return zeros_of(system_of(plant), tolerance);
}
InvariantZeros invariant_zeros(const DiscreteLti& plant, double tolerance) {
  return zeros_of(system_of(plant), tolerance);
}

}  // namespace quadtune
