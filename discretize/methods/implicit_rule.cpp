// SPDX-License-Identifier: Apache-2.0
#include "methods/implicit_rule.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <complex>
#include <limits>

#include "methods/written_out.hpp"
#include "quadtune/errors.hpp"

namespace quadtune::internal {
namespace {

using Eigen::MatrixXd;

// Rejects a pole of A so close to 1/(α h) that I - α A h is singular up to rounding.
void refuse_pole(const MatrixXd& A, double dt, const ImplicitRule& rule, const std::string& where) {
  const double forbidden = 1 / (rule.alpha * rule.step);
  const Eigen::VectorXcd poles = A.eigenvalues();
  Eigen::Index nearest = 0;
  const double distance =
      (poles.array() - std::complex<double>(forbidden)).abs().minCoeff(&nearest);
  const double rounding =
      16 * static_cast<double>(A.rows()) * std::numeric_limits<double>::epsilon();
  if (distance > rounding * forbidden) return;
  throw InvalidInput(
      where, fmt::format("A has a pole at {:.6g} 1/s, expected none at {} because the "
                         "transformation sends it to infinity (dt is {} s); choose another dt",
                         poles[nearest].real(), rule.forbidden, dt));
}

}  // namespace

DiscreteLti discretize_by_rule(const ContinuousLti& plant, double dt, const ImplicitRule& rule,
                               const std::string& where) {
  refuse_pole(plant.A, dt, rule, where);
  DiscreteLti result = with_explicit_outputs(plant, dt);
  const MatrixXd I = MatrixXd::Identity(plant.A.rows(), plant.A.rows());
  const MatrixXd Ah = plant.A * rule.step;
  const Eigen::PartialPivLU<MatrixXd> lu(I - rule.alpha * Ah);
  const MatrixXd C = result.C;
  result.A = lu.solve(I + (1 - rule.alpha) * Ah);
  result.B = lu.solve(plant.B * rule.step);
  const MatrixXd Ct = lu.transpose().solve(C.transpose());
  result.C = Ct.transpose();
  result.D += rule.alpha * C * result.B;  // α C T B h
  refuse_overflow(result, where);
  return result;
}

}  // namespace quadtune::internal
