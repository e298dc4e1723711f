// SPDX-License-Identifier: Apache-2.0
/// The textbook solver of Riccati equations: ordered real Schur form by LAPACK [Laub 1979].
#pragma once

#include <Eigen/Core>
#include <vector>

namespace quadtune::bench {

/// Buffers are allocated once; solving allocates only what a caller of LAPACK requires.
class OrderedSchur {
 public:
  explicit OrderedSchur(Eigen::Index nx);

  /// @return  false if LAPACK fails or the dimension of the subspace is not nx
  bool care(const Eigen::MatrixXd& A, const Eigen::MatrixXd& G, const Eigen::MatrixXd& Q);

  /// X = AᵀX(I + GX)⁻¹A + Q by the subspace inside the unit circle of
  /// [A + GA⁻ᵀQ  -GA⁻ᵀ; -A⁻ᵀQ  A⁻ᵀ].
  bool dare(const Eigen::MatrixXd& A, const Eigen::MatrixXd& G, const Eigen::MatrixXd& Q);

  [[nodiscard]] const Eigen::MatrixXd& X() const { return X_; }

 private:
  using Select = int (*)(const double*, const double*);
  bool invariant_subspace(Select select);

  Eigen::Index nx_;
  Eigen::MatrixXd H_;    // (2nx × 2nx), its Schur form afterwards
  Eigen::MatrixXd U_;    // Schur vectors
  Eigen::MatrixXd U11_;  // transposed, for X = U21 U11⁻¹
  Eigen::MatrixXd X_;
  Eigen::MatrixXd Ait_;  // A⁻ᵀ
  Eigen::VectorXd real_, imaginary_, work_;
  std::vector<int> flags_, pivots_;
};

}  // namespace quadtune::bench
