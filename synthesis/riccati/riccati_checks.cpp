// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "quadtune/errors.hpp"
#include "quadtune/matrix_checks.hpp"
#include "riccati/riccati_parts.hpp"

namespace quadtune::internal {
namespace {

constexpr double kMachineEpsilon = std::numeric_limits<double>::epsilon();
/// Negative eigenvalues of Q or R up to this fraction of its norm are regarded as rounding errors.
constexpr double kIndefiniteByRounding = 1e-12;

/// Whether M is exactly symmetric, finite, and diagonal: a fast path that avoids the full checks.
struct Look {
  bool finite;
  bool symmetric;
  bool diagonal;
};
Look look_at(const ConstRef& M) {
  double differences = 0;
  double off_diagonal = 0;
  double diagonal = 0;
  for (Eigen::Index j = 0; j < M.cols(); ++j) {
    for (Eigen::Index i = 0; i < j; ++i) {
      differences += std::abs(M(i, j) - M(j, i));
      off_diagonal += std::abs(M(i, j)) + std::abs(M(j, i));
    }
    diagonal += std::abs(M(j, j));
  }
  const bool finite = std::isfinite(diagonal + off_diagonal);
  return {finite, finite && differences == 0, finite && off_diagonal == 0};
}

double smallest_eigenvalue(const ConstRef& M) {
  const Eigen::MatrixXd symmetric = 0.5 * (M + M.transpose());
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric, Eigen::EigenvaluesOnly)
      .eigenvalues()[0];
}

/// Computes the Cholesky factor of M + shift·I in the lower triangle of L. Returns the smallest
/// pivot relative to its diagonal entry, or a number ≤ 0 if the factorization failed.
double cholesky(const ConstRef& M, double shift, Eigen::MatrixXd& L) {
  const Eigen::Index n = M.rows();
  double smallest = std::numeric_limits<double>::infinity();
  for (Eigen::Index j = 0; j < n; ++j) {
    L.col(j).tail(n - j) = M.col(j).tail(n - j);
    L(j, j) += shift;
    const double entry = L(j, j);
    for (Eigen::Index k = 0; k < j; ++k) L.col(j).tail(n - j) -= L(j, k) * L.col(k).tail(n - j);
    const double pivot = L(j, j);
    if (!(pivot > 0) || !(entry > 0)) return entry == 0 && pivot == 0 ? 0.0 : -1.0;
    smallest = std::min(smallest, pivot / entry);
    L.col(j).tail(n - j) /= std::sqrt(pivot);
  }
  return smallest;
}

/// "Q has eigenvalue -0.1, expected Q >= 0 …" if M is indefinite beyond rounding; otherwise empty.
std::string indefiniteness(const ConstRef& M, const Look& look, const char* name,
                           Eigen::MatrixXd& buffer, const char* remedy = "check the signs") {
  if (look.diagonal && M.diagonal().minCoeff() >= 0) return {};
  const double norm = M.norm();
  if (cholesky(M, 0.5 * kIndefiniteByRounding * norm, buffer) > 0) return {};
  const double min = smallest_eigenvalue(M);
  if (min >= -kIndefiniteByRounding * norm) return {};
  return fmt::format(
      "{} has eigenvalue {:.6g}, expected {} >= 0, because a negative weight rewards a deviation; "
      "{}",
      name, min, name, remedy);
}

WeightR check_R(const RiccatiEquation& problem, const Look& look, const std::string& where,
                CheckBuffers& buffers) {
  // A smaller pivot may be due to the rounding of the entries of R.
  const double singular_pivot = kMachineEpsilon * static_cast<double>(problem.R.rows());
  const double pivot = cholesky(problem.R, 0, buffers.factor_R);
  if (pivot > 1e-10) return WeightR::well_conditioned;
  if (pivot > singular_pivot) return WeightR::ill_conditioned;
  if (problem.time == Time::continuous) {
    const double min = smallest_eigenvalue(problem.R);
    throw InvalidInput(where, fmt::format("R has eigenvalue {:.6g}, expected R > 0{}", min,
                                          min > 0 ? " beyond rounding" : ""));
  }
  const std::string indefinite = indefiniteness(problem.R, look, "R", buffers.factor_R);
  if (!indefinite.empty()) throw InvalidInput(where, indefinite);
  return WeightR::singular;
}

void check_shapes(const RiccatiEquation& p, const std::string& where) {
  const Eigen::Index nx = p.A.rows();
  const Eigen::Index nu = p.B.cols();
  if (nx == 0 || p.A.cols() != nx)
    throw InvalidInput(
        where, fmt::format("A is {}, expected a square matrix of at least 1x1", shape(p.A)));
  if (p.B.rows() != nx)
    throw InvalidInput(
        where, fmt::format("B is {}, expected {} rows (A is {})", shape(p.B), nx, shape(p.A)));
  if (nu == 0)
    throw InvalidInput(where, fmt::format("B is {}, expected at least 1 column", shape(p.B)));
  if (p.Q.rows() != nx || p.Q.cols() != nx)
    require_shape(p.Q, nx, nx, where, "Q", fmt::format("A is {}", shape(p.A)));
  if (p.R.rows() != nu || p.R.cols() != nu)
    require_shape(p.R, nu, nu, where, "R",
                  fmt::format("B has {} column{}", nu, nu == 1 ? "" : "s"));
  if (p.has_cross_term() && (p.N.rows() != nx || p.N.cols() != nu))
    require_shape(p.N, nx, nu, where, "N", fmt::format("A is {}, B is {}", shape(p.A), shape(p.B)));
}

}  // namespace

const char* equation_name(Time time) { return time == Time::continuous ? "care" : "dare"; }

WeightR check_problem(const RiccatiEquation& p, CheckBuffers& buffers, std::string& indefinite_Q) {
  const std::string where = equation_name(p.time);
  check_shapes(p, where);
  if (!p.A.allFinite()) require_finite(p.A, where, "A");
  if (!p.B.allFinite()) require_finite(p.B, where, "B");
  if (p.has_cross_term()) require_finite(p.N, where, "N");
  const Look Q = look_at(p.Q);
  const Look R = look_at(p.R);
  if (!Q.finite) require_finite(p.Q, where, "Q");
  if (!R.finite) require_finite(p.R, where, "R");
  if (!Q.symmetric) require_symmetric(p.Q, where, "Q");
  if (!R.symmetric) require_symmetric(p.R, where, "R");
  buffers.factor_Q.resize(p.Q.rows(), p.Q.cols());
  buffers.factor_R.resize(p.R.rows(), p.R.cols());
  indefinite_Q = indefiniteness(p.Q, Q, "Q", buffers.factor_Q);
  return check_R(p, R, where, buffers);
}

std::string cost_indefiniteness(const RiccatiEquation& p) {
  if (!p.has_cross_term()) return {};
  const Eigen::Index nx = p.A.rows();
  const Eigen::Index size = nx + p.B.cols();
  Eigen::MatrixXd cost(size, size);
  cost << p.Q, p.N, p.N.transpose(), p.R;
  Eigen::MatrixXd buffer(size, size);
  return indefiniteness(cost, look_at(cost), "[Q N; N' R]", buffer,
                        "check the signs and the size of N");
}

std::string free_inputs(const RiccatiEquation& p, const Eigen::MatrixXd& X) {
  if (p.R.isDiagonal(0) && p.R.diagonal().minCoeff() > 0) return {};
  // In units in which the weight of every input is 1.
  constexpr double kRounding = 1e-13;
  const Eigen::MatrixXd cost = p.R + p.B.transpose() * X * p.B;
  if (cost.diagonal().minCoeff() > 0) {
    const Eigen::VectorXd units = cost.diagonal().cwiseSqrt().cwiseInverse();
    if (smallest_eigenvalue(units.asDiagonal() * cost * units.asDiagonal()) > kRounding) return {};
  }
  return "R + B'SB is singular up to rounding, so that other gains have the same cost as K";
}

}  // namespace quadtune::internal
