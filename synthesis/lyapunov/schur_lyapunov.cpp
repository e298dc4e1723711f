// SPDX-License-Identifier: Apache-2.0
#include "lyapunov/schur_lyapunov.hpp"

#include "lyapunov/lapack.hpp"

namespace quadtune::internal {

SchurLyapunov::SchurLyapunov(Time time, const ConstRef& A) : time_(time) {
  const auto n = static_cast<lapack_int>(A.rows());
  Eigen::MatrixXd balanced = A;
  scale_.resize(n);
  lapack_int low = 0;
  lapack_int high = 0;
  if (LAPACKE_dgebal(LAPACK_COL_MAJOR, 'S', n, balanced.data(), n, &low, &high, scale_.data()) != 0)
    return;
  eigenvalues_.resize(n);
  lapack_int selected = 0;
  if (time == Time::continuous) {
    T_ = balanced;
    U_.resize(n, n);
    Eigen::VectorXd real(n);
    Eigen::VectorXd imaginary(n);
    ok_ = LAPACKE_dgees(LAPACK_COL_MAJOR, 'V', 'N', nullptr, n, T_.data(), n, &selected,
                        real.data(), imaginary.data(), U_.data(), n) == 0;
    eigenvalues_.real() = real;
    eigenvalues_.imag() = imaginary;
  } else {
    Tc_ = balanced.cast<std::complex<double>>();
    Uc_.resize(n, n);
    ok_ = LAPACKE_zgees(LAPACK_COL_MAJOR, 'V', 'N', nullptr, n, Tc_.data(), n, &selected,
                        eigenvalues_.data(), Uc_.data(), n) == 0;
  }
}

Eigen::MatrixXd SchurLyapunov::solve(const ConstRef& Q, bool transposed) const {
  const Eigen::VectorXd scale = transposed ? Eigen::VectorXd(scale_.cwiseInverse()) : scale_;
  const auto D = scale.asDiagonal();
  const auto D_inverse = scale.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd scaled = D_inverse * Q * D_inverse;
  const Eigen::MatrixXd X = time_ == Time::continuous ? solve_continuous(scaled, transposed)
                                                      : solve_discrete(scaled, transposed);
  return D * X * D;
}

// T Y + Y Tᵀ = -Uᵀ Q U, X = U Y Uᵀ.
Eigen::MatrixXd SchurLyapunov::solve_continuous(const Eigen::MatrixXd& Q, bool transposed) const {
  const auto n = static_cast<lapack_int>(Q.rows());
  Eigen::MatrixXd Y = -(U_.transpose() * Q * U_);
  double scale = 1;
  LAPACKE_dtrsyl(LAPACK_COL_MAJOR, transposed ? 'T' : 'N', transposed ? 'N' : 'T', 1, n, n,
                 T_.data(), n, T_.data(), n, Y.data(), n, &scale);
  return U_ * (Y / scale) * U_.transpose();
}

// T Y Tᴴ - Y = -C, column by column from the last: with w = Σ_{k>j} y_k conj(t_jk),
// (conj(t_jj) T - I) y_j = -c_j - T w. Transposed: Tᴴ Y T - Y = -C from the first.
Eigen::MatrixXd SchurLyapunov::solve_discrete(const Eigen::MatrixXd& Q, bool transposed) const {
  const Eigen::Index n = Q.rows();
  Eigen::MatrixXcd Y = -(Uc_.adjoint() * Q.cast<std::complex<double>>() * Uc_);
  Eigen::MatrixXcd shifted(n, n);
  for (Eigen::Index step = 0; step < n; ++step) {
    const Eigen::Index j = transposed ? step : n - 1 - step;
    Eigen::VectorXcd w;
    if (transposed) {
      w = Y.leftCols(j) * Tc_.col(j).head(j);
      shifted = Tc_(j, j) * Tc_.adjoint();
      Y.col(j) -= Tc_.adjoint().triangularView<Eigen::Lower>() * w;
    } else {
      w = Y.rightCols(n - 1 - j) * Tc_.row(j).tail(n - 1 - j).adjoint();
      shifted = std::conj(Tc_(j, j)) * Tc_;
      Y.col(j) -= Tc_.triangularView<Eigen::Upper>() * w;
    }
    shifted.diagonal().array() -= 1.0;
    if (transposed)
      shifted.triangularView<Eigen::Lower>().solveInPlace(Y.col(j));
    else
      shifted.triangularView<Eigen::Upper>().solveInPlace(Y.col(j));
  }
  return (Uc_ * Y * Uc_.adjoint()).real();
}

}  // namespace quadtune::internal
