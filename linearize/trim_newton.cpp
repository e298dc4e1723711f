// SPDX-License-Identifier: Apache-2.0
#include "trim_newton.hpp"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "least_norm.hpp"

namespace quadtune::internal {
namespace {

struct Step {
  Eigen::VectorXd dz;
  Eigen::Index freedom;
};

// With four rotors J dz = -r is a single square system. Returns false if it is singular.
bool square_step(const ValueAndJacobian& at, Step& step) {
  const Eigen::PartialPivLU<Eigen::Matrix<double, 6, 6>> lu(at.jacobian);
  if (!(lu.rcond() > kRankTolerance)) return false;
  step.dz = lu.solve(-Eigen::Matrix<double, 6, 1>(at.value));
  step.freedom = 0;
  return true;
}

// Solves J_a da + J_f (f - f0) = -r: the part outside the range of J_a determines the thrusts f, of
// least norm; roll and pitch then solve for the rest.
Step newton_step(const TrimProblem& problem, const Eigen::VectorXd& z, const ValueAndJacobian& at,
                 bool within_limits) {
  Step step;
  if (problem.rotors() == 4 && !within_limits && square_step(at, step)) return step;
  const Eigen::MatrixXd J_a = at.jacobian.leftCols(2);
  const Eigen::MatrixXd J_f = at.jacobian.rightCols(problem.rotors());
  const Eigen::VectorXd f0 = z.tail(problem.rotors());
  const Eigen::MatrixXd Q = Eigen::HouseholderQR<Eigen::MatrixXd>(J_a).householderQ();
  const Eigen::MatrixXd C = Q.rightCols(4).transpose() * J_f;
  const Eigen::VectorXd d = Q.rightCols(4).transpose() * (J_f * f0 - at.value);
  const Eigen::VectorXd f =
      within_limits ? bounded_least_norm(C, d, problem.low(), problem.high()) : least_norm(C, d);
  step.dz.resize(z.size());
  step.dz << least_norm(J_a, -at.value - J_f * (f - f0)), f - f0;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> rank(C);
  rank.setThreshold(kRankTolerance);
  step.freedom = problem.rotors() - rank.rank();
  return step;
}

}  // namespace

NewtonResult newton(const TrimProblem& problem, Eigen::VectorXd z, const TrimOptions& options,
                    bool within_limits) {
  constexpr double kRounding = 1e-13;  // smaller residuals cannot be improved
  constexpr double kStepDone = 1e-10;  // the distribution of thrust has converged
  constexpr double kMinStep = 1e-6;    // minimum fraction of a Newton step
  constexpr double kDecrease = 1e-4;   // sufficient decrease (Armijo)
  NewtonResult result;
  double merit = problem.residual(z).norm();
  while (result.iterations < options.max_iterations && std::isfinite(merit)) {
    const Step step = newton_step(problem, z, problem.balance(z), within_limits);
    result.freedom = step.freedom;
    if (!step.dz.allFinite()) break;
    ++result.iterations;
    double share = 1;
    double next = problem.residual(z + step.dz).norm();
    while (!(next <= std::max((1 - kDecrease * share) * merit, kRounding)) && share > kMinStep) {
      share /= 2;
      next = problem.residual(z + share * step.dz).norm();
    }
    if (share <= kMinStep) break;
    z += share * step.dz;
    merit = next;
    if (merit <= kRounding && step.dz.norm() <= kStepDone) break;
  }
  result.z = z;
  result.residual = problem.residual(z).cwiseAbs().maxCoeff();
  return result;
}

}  // namespace quadtune::internal
