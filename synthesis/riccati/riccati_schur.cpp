// SPDX-License-Identifier: Apache-2.0
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "lyapunov/lapack.hpp"
#include "riccati/riccati_parts.hpp"

namespace quadtune::internal {
namespace {

/// Basis of the stable invariant (deflating) subspace, and the eigenvalues.
struct Subspace {
  Eigen::MatrixXd basis;  ///< (2 nx × nx), empty if there is none of this dimension
  Eigen::VectorXcd eigenvalues;
};

lapack_logical in_left_half_plane(const double* real, const double*) { return *real < 0; }
lapack_logical left_of_axis(const double* real, const double*, const double* beta) {
  return *real * *beta < 0;
}
lapack_logical in_unit_disk(const double* real, const double* imaginary, const double* beta) {
  return std::hypot(*real, *imaginary) < std::abs(*beta);
}

/// Computes the subspace of the Hamiltonian matrix [A -G; -Q -Aᵀ].
Subspace of_hamiltonian(const PlainProblem& p) {
  const Eigen::Index n = p.A.rows();
  const auto order = static_cast<lapack_int>(2 * n);
  Eigen::MatrixXd H(2 * n, 2 * n);
  H << p.A, -(p.B * p.B.transpose()), -p.Q, -p.A.transpose();
  Eigen::MatrixXd U(2 * n, 2 * n);
  Eigen::VectorXd real(2 * n);
  Eigen::VectorXd imaginary(2 * n);
  lapack_int stable = 0;
  const lapack_int info =
      LAPACKE_dgees(LAPACK_COL_MAJOR, 'V', 'S', in_left_half_plane, order, H.data(), order, &stable,
                    real.data(), imaginary.data(), U.data(), order);
  Subspace found;
  if (info > 0 && info <= order) return found;
  found.eigenvalues.resize(2 * n);
  found.eigenvalues.real() = real;
  found.eigenvalues.imag() = imaginary;
  if (stable == n) found.basis = U.leftCols(n);
  return found;
}

/// Computes the subspace of the extended pencil after eliminating its last nu columns:
/// [A 0 B; -Q -Aᵀ -N; Nᵀ Bᵀ R] - λ [I 0 0; 0 I 0; 0 0 0], or, discrete,
/// [A 0 B; -Q I -N; Nᵀ 0 R] - λ [I 0 0; 0 Aᵀ 0; 0 -Bᵀ 0].
Subspace of_pencil(const RiccatiEquation& p, const Eigen::VectorXd& d) {
  const Eigen::Index n = p.A.rows();
  const Eigen::Index m = p.B.cols();
  const bool continuous = p.time == Time::continuous;
  const Eigen::VectorXd e = d.cwiseInverse();
  // Scale the inputs by the diagonal of R, and the states to z = D⁻¹ x.
  const Eigen::VectorXd u =
      p.R.diagonal().unaryExpr([](double r) { return r > 0 ? 1 / std::sqrt(r) : 1.0; });
  const Eigen::MatrixXd A = e.asDiagonal() * p.A * d.asDiagonal();
  const Eigen::MatrixXd B = e.asDiagonal() * p.B * u.asDiagonal();
  const Eigen::MatrixXd Q = d.asDiagonal() * p.Q * d.asDiagonal();
  const Eigen::MatrixXd R = u.asDiagonal() * p.R * u.asDiagonal();
  Eigen::MatrixXd N = Eigen::MatrixXd::Zero(n, m);
  if (p.has_cross_term()) N = d.asDiagonal() * p.N * u.asDiagonal();
  Eigen::MatrixXd last(2 * n + m, m);
  last << B, -N, R;
  Eigen::MatrixXd left = Eigen::MatrixXd::Zero(2 * n + m, 2 * n);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(2 * n + m, 2 * n);
  left.topLeftCorner(n, n) = A;
  left.block(n, 0, n, n) = -Q;
  left.bottomLeftCorner(m, n) = N.transpose();
  right.topLeftCorner(n, n).setIdentity();
  if (continuous) {
    left.block(n, n, n, n) = -A.transpose();
    left.bottomRightCorner(m, n) = B.transpose();
    right.block(n, n, n, n).setIdentity();
  } else {
    left.block(n, n, n, n).setIdentity();
    right.block(n, n, n, n) = A.transpose();
    right.bottomRightCorner(m, n) = -B.transpose();
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(last);
  left.applyOnTheLeft(qr.householderQ().adjoint());
  right.applyOnTheLeft(qr.householderQ().adjoint());
  Eigen::MatrixXd S = left.bottomRows(2 * n);
  Eigen::MatrixXd T = right.bottomRows(2 * n);
  const auto order = static_cast<lapack_int>(2 * n);
  Eigen::MatrixXd Z(2 * n, 2 * n);
  Eigen::VectorXd real(2 * n);
  Eigen::VectorXd imaginary(2 * n);
  Eigen::VectorXd beta(2 * n);
  double unused = 0;
  lapack_int stable = 0;
  const lapack_int info =
      LAPACKE_dgges(LAPACK_COL_MAJOR, 'N', 'V', 'S', continuous ? left_of_axis : in_unit_disk,
                    order, S.data(), order, T.data(), order, &stable, real.data(), imaginary.data(),
                    beta.data(), &unused, 1, Z.data(), order);
  Subspace found;
  if (info > 0 && info <= order + 1) return found;
  found.eigenvalues.resize(2 * n);
  for (Eigen::Index i = 0; i < 2 * n; ++i)
    found.eigenvalues[i] = std::complex<double>(real[i], imaginary[i]) / beta[i];
  if (stable == n) found.basis = Z.leftCols(n);
  return found;
}

/// Finds the finite eigenvalue nearest to the boundary. Its distance is relative to the largest
/// pole, or to 1.
void find_nearest(Time time, const Eigen::VectorXcd& eigenvalues, SchurOutcome& outcome) {
  double largest = 1e-300;
  for (const std::complex<double>& value : eigenvalues)
    if (std::isfinite(std::abs(value))) largest = std::max(largest, std::abs(value));
  for (const std::complex<double>& value : eigenvalues) {
    const double distance =
        time == Time::continuous ? std::abs(value.real()) / largest : std::abs(std::abs(value) - 1);
    if (distance < outcome.distance) {
      outcome.distance = distance;
      outcome.nearest = value;
    }
  }
}

}  // namespace

SchurOutcome solve_by_schur(const RiccatiEquation& p, WeightR weight_R, Candidate& found) {
  const Eigen::Index n = p.A.rows();
  PlainProblem plain = without_cross_term(p);
  const Eigen::VectorXd d = balancing(plain.A, plain.B * plain.B.transpose(), plain.Q);
  const Eigen::VectorXd e = d.cwiseInverse();
  plain.A = (e.asDiagonal() * plain.A * d.asDiagonal()).eval();
  plain.B = (e.asDiagonal() * plain.B).eval();
  plain.Q = (d.asDiagonal() * plain.Q * d.asDiagonal()).eval();
  const bool by_matrix = p.time == Time::continuous && weight_R == WeightR::well_conditioned;
  const Subspace stable = by_matrix ? of_hamiltonian(plain) : of_pencil(p, d);
  SchurOutcome outcome;
  find_nearest(p.time, stable.eigenvalues, outcome);
  if (stable.basis.size() == 0) return outcome;
  const Eigen::PartialPivLU<Eigen::MatrixXd> lu(stable.basis.topRows(n).transpose());
  if (!(lu.rcond() > 1e-16)) return outcome;
  Eigen::MatrixXd X = lu.solve(stable.basis.bottomRows(n).transpose());
  X = (0.5 * (X + X.transpose())).eval();
  found.X = e.asDiagonal() * X * e.asDiagonal();
  found.iterations = 0;
  outcome.found = found.X.allFinite() && evaluate(p, found);
  if (outcome.found) refine_by_newton(p, found);
  return outcome;
}

}  // namespace quadtune::internal
