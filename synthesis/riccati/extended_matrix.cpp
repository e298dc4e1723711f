// SPDX-License-Identifier: Apache-2.0
#include "riccati/extended_matrix.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <boost/multiprecision/eigen.hpp>
#include <cassert>
#include <complex>
#include <utility>

namespace quadtune::internal {

namespace mp = boost::multiprecision;
using Index = Eigen::Index;

ExtendedMatrix::ExtendedMatrix(Index rows, Index cols)
    : rows_(rows), cols_(cols), entries_(static_cast<std::size_t>(rows * cols), Real(0)) {}

ExtendedMatrix::ExtendedMatrix(const Eigen::Ref<const Eigen::MatrixXd>& M)
    : ExtendedMatrix(M.rows(), M.cols()) {
  for (Index j = 0; j < M.cols(); ++j)
    for (Index i = 0; i < M.rows(); ++i) (*this)(i, j) = M(i, j);
}

ExtendedMatrix ExtendedMatrix::identity(Index n) {
  ExtendedMatrix result(n, n);
  result.add_to_diagonal(1);
  return result;
}

ExtendedMatrix ExtendedMatrix::diagonal(const Eigen::VectorXd& entries) {
  ExtendedMatrix result(entries.size(), entries.size());
  for (Index i = 0; i < entries.size(); ++i) result(i, i) = entries(i);
  return result;
}

bool ExtendedMatrix::is_finite() const {
  return std::all_of(entries_.begin(), entries_.end(),
                     [](const Real& x) { return mp::isfinite(x); });
}

Real ExtendedMatrix::squared_norm() const {
  Real sum = 0;
  for (const Real& x : entries_) sum += x * x;
  return sum;
}

Real ExtendedMatrix::norm() const { return mp::sqrt(squared_norm()); }

Eigen::MatrixXd ExtendedMatrix::rounded() const {
  Eigen::MatrixXd result(rows(), cols());
  for (Index j = 0; j < cols_; ++j)
    for (Index i = 0; i < rows_; ++i) result(i, j) = (*this)(i, j).convert_to<double>();
  return result;
}

ExtendedMatrix ExtendedMatrix::transpose() const {
  ExtendedMatrix result(cols(), rows());
  for (Index j = 0; j < cols(); ++j)
    for (Index i = 0; i < rows(); ++i) result(j, i) = (*this)(i, j);
  return result;
}

ExtendedMatrix& ExtendedMatrix::operator+=(const ExtendedMatrix& B) {
  assert(rows_ == B.rows_ && cols_ == B.cols_);
  for (std::size_t k = 0; k < entries_.size(); ++k) entries_[k] += B.entries_[k];
  return *this;
}

ExtendedMatrix& ExtendedMatrix::operator-=(const ExtendedMatrix& B) {
  assert(rows_ == B.rows_ && cols_ == B.cols_);
  for (std::size_t k = 0; k < entries_.size(); ++k) entries_[k] -= B.entries_[k];
  return *this;
}

ExtendedMatrix& ExtendedMatrix::operator*=(const Real& factor) {
  for (Real& x : entries_) x *= factor;
  return *this;
}

void ExtendedMatrix::add_to_diagonal(const Real& term) {
  for (Index i = 0; i < std::min(rows(), cols()); ++i) (*this)(i, i) += term;
}

void ExtendedMatrix::set_block(Index i, Index j, const ExtendedMatrix& B) {
  for (Index c = 0; c < B.cols(); ++c)
    for (Index r = 0; r < B.rows(); ++r) (*this)(i + r, j + c) = B(r, c);
}

ExtendedMatrix operator+(ExtendedMatrix A, const ExtendedMatrix& B) { return A += B; }
ExtendedMatrix operator-(ExtendedMatrix A, const ExtendedMatrix& B) { return A -= B; }
ExtendedMatrix operator-(ExtendedMatrix A) { return A *= Real(-1); }
ExtendedMatrix operator*(const Real& factor, ExtendedMatrix A) { return A *= factor; }

ExtendedMatrix operator*(const ExtendedMatrix& A, const ExtendedMatrix& B) {
  assert(A.cols() == B.rows());
  ExtendedMatrix C(A.rows(), B.cols());
  for (Index j = 0; j < B.cols(); ++j)
    for (Index k = 0; k < A.cols(); ++k) {
      const Real& b = B(k, j);
      for (Index i = 0; i < A.rows(); ++i) C(i, j) += A(i, k) * b;
    }
  return C;
}

ExtendedMatrix symmetric(const ExtendedMatrix& M) { return Real(0.5) * (M + M.transpose()); }

ExtendedLu::ExtendedLu(ExtendedMatrix A) : lu_(std::move(A)) {
  assert(lu_.rows() == lu_.cols());
  const Index n = lu_.rows();
  for (Index k = 0; k < n; ++k) {
    Index pivot = k;
    for (Index i = k + 1; i < n; ++i)
      if (mp::abs(lu_(i, k)) > mp::abs(lu_(pivot, k))) pivot = i;
    swapped_with_.push_back(pivot);
    for (Index j = 0; j < n && pivot != k; ++j) std::swap(lu_(k, j), lu_(pivot, j));
    for (Index i = k + 1; i < n; ++i) lu_(i, k) /= lu_(k, k);
    for (Index j = k + 1; j < n; ++j)
      for (Index i = k + 1; i < n; ++i) lu_(i, j) -= lu_(i, k) * lu_(k, j);
  }
}

ExtendedMatrix ExtendedLu::solve(ExtendedMatrix B) const {
  assert(B.rows() == lu_.rows());
  const Index n = lu_.rows();
  for (Index j = 0; j < B.cols(); ++j) {
    for (Index k = 0; k < n; ++k)
      std::swap(B(k, j), B(swapped_with_[static_cast<std::size_t>(k)], j));
    for (Index k = 0; k < n; ++k)
      for (Index i = k + 1; i < n; ++i) B(i, j) -= lu_(i, k) * B(k, j);
    for (Index k = n - 1; k >= 0; --k) {
      B(k, j) /= lu_(k, k);
      for (Index i = 0; i < k; ++i) B(i, j) -= lu_(i, k) * B(k, j);
    }
  }
  return B;
}

ExtendedMatrix ExtendedLu::inverse() const { return solve(ExtendedMatrix::identity(lu_.rows())); }

ExtendedCholesky::ExtendedCholesky(ExtendedMatrix A) : L_(std::move(A)) {
  const Index n = L_.rows();
  for (Index k = 0; k < n; ++k) {
    if (!(L_(k, k) > 0)) {
      positive_definite_ = false;
      return;
    }
    L_(k, k) = mp::sqrt(L_(k, k));
    for (Index i = k + 1; i < n; ++i) L_(i, k) /= L_(k, k);
    for (Index j = k + 1; j < n; ++j)
      for (Index i = j; i < n; ++i) L_(i, j) -= L_(i, k) * L_(j, k);
  }
}

ExtendedMatrix ExtendedCholesky::solve(ExtendedMatrix B) const {
  assert(positive_definite_ && B.rows() == L_.rows());
  const Index n = L_.rows();
  for (Index j = 0; j < B.cols(); ++j) {
    for (Index k = 0; k < n; ++k) {
      B(k, j) /= L_(k, k);
      for (Index i = k + 1; i < n; ++i) B(i, j) -= L_(i, k) * B(k, j);
    }
    for (Index k = n - 1; k >= 0; --k) {
      for (Index i = k + 1; i < n; ++i) B(k, j) -= L_(i, k) * B(i, j);
      B(k, j) /= L_(k, k);
    }
  }
  return B;
}

Eigen::VectorXcd eigenvalues(const ExtendedMatrix& M) {
  const Index n = M.rows();
  Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic> entries(n, n);
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) entries(i, j) = M(i, j);
  const Eigen::RealSchur<decltype(entries)> schur(entries, false);
  if (schur.info() != Eigen::Success) return {};
  const auto& T = schur.matrixT();
  Eigen::VectorXcd values(n);
  for (Index i = 0; i < n; ++i) {
    if (i + 1 == n || T(i + 1, i) == 0) {
      values[i] = T(i, i).convert_to<double>();
      continue;
    }
    const Real mean = (T(i, i) + T(i + 1, i + 1)) / 2;
    const Real half = (T(i, i) - T(i + 1, i + 1)) / 2;
    const Real square = half * half + T(i, i + 1) * T(i + 1, i);
    const double root = mp::sqrt(mp::abs(square)).convert_to<double>();
    const double real = mean.convert_to<double>();
    values[i] = square < 0 ? std::complex<double>(real, root) : real + root;
    values[i + 1] = square < 0 ? std::complex<double>(real, -root) : real - root;
    ++i;
  }
  return values;
}

}  // namespace quadtune::internal
