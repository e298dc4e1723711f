// SPDX-License-Identifier: Apache-2.0
#include "residuals.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>

namespace quadtune::bench {
namespace {

using Extended = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

Extended extended(const Eigen::MatrixXd& M) { return M.cast<long double>(); }

double relative(const Extended& residual, long double terms) {
  return static_cast<double>(residual.norm() / terms);
}

}  // namespace

double care_residual(const Problem& problem, const Eigen::MatrixXd& solution) {
  const Extended A = extended(problem.A);
  const Extended B = extended(problem.B);
  const Extended Q = extended(problem.Q);
  const Extended X = extended(solution);
  const Extended XA = X * A;
  const Extended AtX = A.transpose() * X;
  const Extended BtX = B.transpose() * X;
  const Extended XB = X * B;
  const Extended XGX = XB * extended(problem.R).llt().solve(BtX);
  return relative(AtX + XA - XGX + Q, AtX.norm() + XA.norm() + XGX.norm() + Q.norm());
}

double dare_residual(const Problem& problem, const Eigen::MatrixXd& solution) {
  const Extended A = extended(problem.A);
  const Extended B = extended(problem.B);
  const Extended Q = extended(problem.Q);
  const Extended X = extended(solution);
  const Extended AtXA = A.transpose() * X * A;
  const Extended BtXA = B.transpose() * X * A;
  const Extended AtXB = A.transpose() * X * B;
  const Extended S = extended(problem.R) + B.transpose() * X * B;
  const Extended last = AtXB * S.partialPivLu().solve(BtXA);
  return relative(AtXA - X - last + Q, AtXA.norm() + X.norm() + last.norm() + Q.norm());
}

double hold_error(const Problem& problem, double dt, const Eigen::MatrixXd& Ad,
                  const Eigen::MatrixXd& Bd) {
  const Extended Z = extended(problem.A) * static_cast<long double>(dt);
  // P = Σ Zᵏ/(k+1)!, accurate for the small ‖A dt‖ of sampling
  Extended term = Extended::Identity(Z.rows(), Z.cols());
  Extended P = term;
  for (int k = 1; k < 60; ++k) {
    term = (term * Z / (k + 1)).eval();
    P += term;
  }
  Extended E = Z * P;
  E.diagonal().array() += 1;
  const Extended integral = P * extended(problem.B) * static_cast<long double>(dt);
  return std::max(relative(extended(Ad) - E, E.norm()),
                  relative(extended(Bd) - integral, integral.norm()));
}

}  // namespace quadtune::bench
