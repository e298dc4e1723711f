// SPDX-License-Identifier: Apache-2.0
/// Solvers of SLICOT with workspaces that are allocated once, so that only the routine is timed,
/// and the copies of those inputs that it overwrites.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace quadtune::bench {

/// SB02MD: Laub's Schur vector method on the Hamiltonian or symplectic matrix.
class Sb02md {
 public:
  /// @param discrete  the discrete equation (HINV = 'D')
  /// @param scaled    SCAL = 'G', the scaling of SLICOT; otherwise 'N'
  Sb02md(Eigen::Index nx, bool discrete, bool scaled);

  /// @param G  B R⁻¹ Bᵀ, computed beforehand; SLICOT requires SB02MT for it
  bool solve(const Eigen::MatrixXd& A, const Eigen::MatrixXd& G, const Eigen::MatrixXd& Q);

  [[nodiscard]] const Eigen::MatrixXd& X() const { return Q_; }

 private:
  bool discrete_;
  bool scaled_;
  Eigen::MatrixXd A_, G_, Q_, S_, U_;
  Eigen::VectorXd real_, imaginary_, work_;
  std::vector<int> integers_, flags_;
};

/// SB02OD: generalized Schur vectors of the extended pencil, R not inverted (JOBB = 'B').
class Sb02od {
 public:
  Sb02od(Eigen::Index nx, Eigen::Index nu, bool discrete);

  bool solve(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, const Eigen::MatrixXd& Q,
             const Eigen::MatrixXd& R);

  [[nodiscard]] const Eigen::MatrixXd& X() const { return X_; }

 private:
  bool discrete_;
  Eigen::MatrixXd X_, S_, T_, U_;
  Eigen::VectorXd alpha_real_, alpha_imaginary_, beta_, work_;
  std::vector<int> integers_, flags_;
};

/// MB05ND: e^(A dt) and its integral by Padé approximants, TOL = unit roundoff.
class Mb05nd {
 public:
  explicit Mb05nd(Eigen::Index nx);

  bool solve(const Eigen::MatrixXd& A, double dt);

  [[nodiscard]] const Eigen::MatrixXd& exponential() const { return E_; }
  [[nodiscard]] const Eigen::MatrixXd& integral() const { return integral_; }

 private:
  Eigen::MatrixXd E_, integral_;
  Eigen::VectorXd work_;
  std::vector<int> integers_;
};

}  // namespace quadtune::bench
