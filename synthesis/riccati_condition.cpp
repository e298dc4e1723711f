// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lapack.hpp"
#include "riccati_parts.hpp"
#include "schur_lyapunov.hpp"

namespace quadtune::internal {

double reciprocal_condition(double norm_A, double norm_G, double norm_Q, double norm_X, double h0,
                            double h2) {
  if (norm_X == 0) return 1;
  const double sum = norm_Q * h0 + 2 * norm_A * std::sqrt(h0) * std::sqrt(h2) + norm_G * h2;
  const double rcond = std::min(1.0, norm_X / sum);
  return rcond > 0 ? rcond : std::numeric_limits<double>::min();  // also when the sum overflowed
}

Eigen::VectorXcd closed_loop_poles(const RiccatiEquation& p, const Eigen::MatrixXd& K) {
  Eigen::MatrixXd Ac = p.A - p.B * K;
  const auto n = static_cast<lapack_int>(Ac.rows());
  Eigen::VectorXd real(n);
  Eigen::VectorXd imaginary(n);
  double unused = 0;
  if (LAPACKE_dgeev(LAPACK_COL_MAJOR, 'N', 'N', n, Ac.data(), n, real.data(), imaginary.data(),
                    &unused, 1, &unused, 1) != 0)
    return {};
  Eigen::VectorXcd poles(n);
  poles.real() = real;
  poles.imag() = imaginary;
  return poles;
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
  const double h0 = closed_loop.solve_transposed(MatrixXd::Identity(n, n)).norm();
  const double h2 = closed_loop.solve_transposed(XAc.transpose() * XAc).norm();
  const PlainProblem plain = without_cross_term(p);
  solution.rcond = reciprocal_condition(plain.A.norm(), (plain.B * plain.B.transpose()).norm(),
                                        plain.Q.norm(), solution.X.norm(), h0, h2);
  return closed_loop.eigenvalues();
}

}  // namespace quadtune::internal
