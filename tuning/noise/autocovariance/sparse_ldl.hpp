// SPDX-License-Identifier: Apache-2.0
/// Factorization L D Lᵀ of a symmetric sparse matrix in the given order, by CHOLMOD, with the
/// entries of the inverse on the pattern of L.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>

namespace quadtune::internal {

class SparseLdl {
 public:
  /// @param lower  lower triangle of a symmetric matrix that has this factorization: quasi-definite
  ///               in its order
  explicit SparseLdl(const Eigen::SparseMatrix<double>& lower);
  ~SparseLdl();
  SparseLdl(const SparseLdl&) = delete;
  SparseLdl& operator=(const SparseLdl&) = delete;

  /// False if a pivot was zero or not finite; then no other function may be called except
  /// bad_row().
  [[nodiscard]] bool factored() const;
  /// Row of the first such pivot.
  [[nodiscard]] Eigen::Index bad_row() const;

  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  /// Σ log |d|.
  [[nodiscard]] double log_determinant() const;
  /// Lower triangle of the inverse on the pattern of L (Takahashi, Fagan and Chen 1973).
  [[nodiscard]] Eigen::SparseMatrix<double> inverse_on_pattern() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace quadtune::internal
