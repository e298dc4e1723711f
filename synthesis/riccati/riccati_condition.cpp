// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lyapunov/eigenvalues.hpp"
#include "lyapunov/schur_lyapunov.hpp"
#include "riccati/riccati_parts.hpp"
#include "riccati/riccati_scaling.hpp"

namespace quadtune::internal {

SquaredNorms& SquaredNorms::operator+=(const SquaredNorms& other) {
  residual += other.residual;
  for (std::size_t i = 0; i < terms.size(); ++i) terms[i] += other.terms[i];
  A += other.A;
  G += other.G;
  Q += other.Q;
  X += other.X;
  h0 += other.h0;
  h2 += other.h2;
  return *this;
}

double SquaredNorms::relative_residual() const { return relative_size(residual, terms); }

double SquaredNorms::reciprocal_condition() const {
  if (X == 0) return 1;
  const double condition = std::sqrt(Q) * std::sqrt(h0) +
                           2 * std::sqrt(A) * std::pow(h0, 0.25) * std::pow(h2, 0.25) +
                           std::sqrt(G) * std::sqrt(h2);
  const double rcond = std::min(1.0, std::sqrt(X) / condition);
  return rcond > 0 ? rcond : std::numeric_limits<double>::min();  // also when a sum overflowed
}

Eigen::VectorXcd closed_loop_poles(const RiccatiEquation& p, const Eigen::MatrixXd& K) {
  return eigenvalues(p.A - p.B * K);
}

bool all_stable(Time time, const Eigen::VectorXcd& poles) {
  if (poles.size() == 0) return false;
  return time == Time::continuous ? poles.real().maxCoeff() < 0 : poles.cwiseAbs().maxCoeff() < 1;
}

Eigen::VectorXcd estimate_condition(const RiccatiEquation& p, Candidate& solution) {
  using Eigen::MatrixXd;
  const Eigen::Index n = p.A.rows();
  const MatrixXd Ac = p.A - p.B * solution.K;
  const SchurLyapunov closed_loop(p.time, Ac);
  if (!closed_loop.ok()) return {};
  const MatrixXd XAc = p.time == Time::continuous ? solution.X : MatrixXd(solution.X * Ac);
  const PlainProblem plain = without_cross_term(p);
  SquaredNorms norms;
  norms.A = plain.A.squaredNorm();
  norms.G = (plain.B * plain.B.transpose()).squaredNorm();
  norms.Q = plain.Q.squaredNorm();
  norms.X = solution.X.squaredNorm();
  norms.h0 = closed_loop.solve_transposed(MatrixXd::Identity(n, n)).squaredNorm();
  norms.h2 = closed_loop.solve_transposed(XAc.transpose() * XAc).squaredNorm();
  solution.rcond = norms.reciprocal_condition();
  return closed_loop.eigenvalues();
}

}  // namespace quadtune::internal
