// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/lyapunov.hpp"

#include <fmt/format.h>

#include <cmath>

#include "lyapunov/mode_names.hpp"
#include "lyapunov/schur_lyapunov.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {
namespace {

using internal::SchurLyapunov;
using internal::Time;

/// The pair of eigenvalues that is closest to making the equation singular, and its distance.
struct Pair {
  std::complex<double> first;
  std::complex<double> second;
  double distance = std::numeric_limits<double>::infinity();
};

Pair worst_pair(Time time, const Eigen::VectorXcd& eigenvalues) {
  Pair worst;
  for (Eigen::Index i = 0; i < eigenvalues.size(); ++i)
    for (Eigen::Index j = i; j < eigenvalues.size(); ++j) {
      const std::complex<double> a = eigenvalues[i];
      const std::complex<double> b = eigenvalues[j];
      const double distance = time == Time::continuous ? std::abs(a + b) : std::abs(a * b - 1.0);
      if (distance < worst.distance) worst = {a, b, distance};
    }
  return worst;
}

void check(const internal::ConstRef& A, const internal::ConstRef& Q, const std::string& where) {
  if (A.rows() == 0 || A.rows() != A.cols())
    throw InvalidInput(where,
                       fmt::format("A is {}, expected a square matrix of at least 1x1", shape(A)));
  require_shape(Q, A.rows(), A.rows(), where, "Q", fmt::format("A is {}", shape(A)));
  require_finite(A, where, "A");
  require_finite(Q, where, "Q");
  require_symmetric(Q, where, "Q");
}

LyapunovResult solve(Time time, const internal::ConstRef& A, const internal::ConstRef& Q,
                     const std::string& where) {
  check(A, Q, where);
  const bool continuous = time == Time::continuous;
  LyapunovResult result;
  result.status = LyapunovStatus::singular;
  result.X.setConstant(A.rows(), A.cols(), std::numeric_limits<double>::quiet_NaN());
  const SchurLyapunov schur(time, A);
  if (!schur.ok()) {
    result.culprit = "the eigenvalues of A could not be computed";
    return result;
  }
  const double rounding = std::numeric_limits<double>::epsilon() * static_cast<double>(A.rows());
  const Pair worst = worst_pair(time, schur.eigenvalues());
  Eigen::MatrixXd X = schur.solve(Q);
  X = (0.5 * (X + X.transpose())).eval();
  // In units in which the diagonal of X is 1, so that the units of the states do not matter.
  Eigen::VectorXd units = X.diagonal().cwiseAbs().cwiseSqrt();
  units = (units.array() > 0 && units.array().isFinite()).select(units, 1.0);
  const auto unit = units.asDiagonal();
  const auto per_unit = units.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd A_units = per_unit * A * unit;
  const double size = continuous ? A_units.norm() : 1 + A_units.squaredNorm();
  // A solution this large is dominated by rounding errors, e.g. with Jordan blocks at 0.
  const bool too_large =
      (per_unit * X * per_unit).norm() * rounding * size > (per_unit * Q * per_unit).norm();
  if (!X.allFinite() || too_large || !(worst.distance > rounding * size)) {
    const auto text = [&](std::complex<double> value) {
      const auto snap = [&](double x) { return std::abs(x) <= 10 * rounding * size ? 0.0 : x; };
      return internal::format_number({snap(value.real()), snap(value.imag())});
    };
    result.culprit = fmt::format("eigenvalues {} and {} of A {}", text(worst.first),
                                 text(worst.second), continuous ? "add to 0" : "multiply to 1");
    return result;
  }
  const Eigen::MatrixXd AX = A * X;
  const Eigen::MatrixXd AXA =
      continuous ? Eigen::MatrixXd(AX.transpose()) : Eigen::MatrixXd(AX * A.transpose());
  const double left = continuous ? (AX + AXA + Q).norm() : (AXA - X + Q).norm();
  const double sum = (continuous ? AX.norm() : X.norm()) + AXA.norm() + Q.norm();
  result.residual = left == 0 ? 0 : left / sum;
  result.X = std::move(X);
  result.status = LyapunovStatus::solved;
  return result;
}

}  // namespace

LyapunovResult lyapunov_continuous(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                   const Eigen::Ref<const Eigen::MatrixXd>& Q) {
  return solve(Time::continuous, A, Q, "lyapunov_continuous");
}

LyapunovResult lyapunov_discrete(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                 const Eigen::Ref<const Eigen::MatrixXd>& Q) {
  return solve(Time::discrete, A, Q, "lyapunov_discrete");
}

}  // namespace quadtune
