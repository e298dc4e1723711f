// SPDX-License-Identifier: Apache-2.0
/// Matrices of numbers with 50 decimal digits, for Riccati equations that need more than double
/// precision. Each operation is a function, which is compiled once. As expressions of Eigen, the
/// formulas of riccati_extended.cpp take a compiler several times as long.
#pragma once

#include <Eigen/Core>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cstddef>
#include <vector>

namespace quadtune::internal {

using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>,
                                           boost::multiprecision::et_off>;

/// A matrix of 50-digit numbers. The sizes of operands must match, which only debug builds check.
class ExtendedMatrix {
 public:
  using Index = Eigen::Index;

  ExtendedMatrix() = default;
  /// All entries are 0.
  ExtendedMatrix(Index rows, Index cols);
  explicit ExtendedMatrix(const Eigen::Ref<const Eigen::MatrixXd>& M);
  static ExtendedMatrix identity(Index n);
  static ExtendedMatrix diagonal(const Eigen::VectorXd& entries);

  [[nodiscard]] Index rows() const { return rows_; }
  [[nodiscard]] Index cols() const { return cols_; }
  [[nodiscard]] bool empty() const { return entries_.empty(); }
  [[nodiscard]] Real& operator()(Index i, Index j) { return entries_[at(i, j)]; }
  [[nodiscard]] const Real& operator()(Index i, Index j) const { return entries_[at(i, j)]; }

  [[nodiscard]] bool is_finite() const;
  /// Frobenius norm, and its square.
  [[nodiscard]] Real norm() const;
  [[nodiscard]] Real squared_norm() const;
  /// The nearest matrix of doubles.
  [[nodiscard]] Eigen::MatrixXd rounded() const;
  [[nodiscard]] ExtendedMatrix transpose() const;

  ExtendedMatrix& operator+=(const ExtendedMatrix& B);
  ExtendedMatrix& operator-=(const ExtendedMatrix& B);
  ExtendedMatrix& operator*=(const Real& factor);
  void add_to_diagonal(const Real& term);
  /// Copies B to the block that begins at row i and column j.
  void set_block(Index i, Index j, const ExtendedMatrix& B);

 private:
  [[nodiscard]] std::size_t at(Index i, Index j) const {
    return static_cast<std::size_t>(i + j * rows_);
  }

  Index rows_ = 0, cols_ = 0;
  std::vector<Real> entries_;  // column by column
};

ExtendedMatrix operator+(ExtendedMatrix A, const ExtendedMatrix& B);
ExtendedMatrix operator-(ExtendedMatrix A, const ExtendedMatrix& B);
ExtendedMatrix operator-(ExtendedMatrix A);
ExtendedMatrix operator*(const ExtendedMatrix& A, const ExtendedMatrix& B);
ExtendedMatrix operator*(const Real& factor, ExtendedMatrix A);

/// (M + Mᵀ)/2
[[nodiscard]] ExtendedMatrix symmetric(const ExtendedMatrix& M);

/// P A = L U of a square A, with partial pivoting. If A is singular, solutions are not finite.
class ExtendedLu {
 public:
  explicit ExtendedLu(ExtendedMatrix A);
  /// A⁻¹ B
  [[nodiscard]] ExtendedMatrix solve(ExtendedMatrix B) const;
  [[nodiscard]] ExtendedMatrix inverse() const;

 private:
  ExtendedMatrix lu_;  // L below the diagonal, U on and above it
  std::vector<Eigen::Index> swapped_with_;
};

/// A = L Lᵀ of a symmetric A, of which the lower triangle is read.
class ExtendedCholesky {
 public:
  explicit ExtendedCholesky(ExtendedMatrix A);
  [[nodiscard]] bool positive_definite() const { return positive_definite_; }
  /// A⁻¹ B, if A is positive definite.
  [[nodiscard]] ExtendedMatrix solve(ExtendedMatrix B) const;

 private:
  ExtendedMatrix L_;
  bool positive_definite_ = true;
};

/// Eigenvalues of a square M from a real Schur form; empty if its iteration did not converge.
[[nodiscard]] Eigen::VectorXcd eigenvalues(const ExtendedMatrix& M);

}  // namespace quadtune::internal
