// SPDX-License-Identifier: Apache-2.0
/// e^(A dt) and the hold integral in preallocated buffers, the kernel of matrix_exponential() and
/// discretize_zoh().
#pragma once

#include <Eigen/Core>

#include "quadtune/discretize/matrix_exponential.hpp"

namespace quadtune::internal {

/// Shapes are not checked. A matrix A with entries that are not finite gives the status overflow.
class ExponentialKernel {
 public:
  /// Number of doubles of storage for these constructor arguments.
  [[nodiscard]] static Eigen::Index storage_size(Eigen::Index n, Eigen::Index nu);

  /// @param n        rows of A, ≥ 1
  /// @param nu       columns of B, ≥ 0
  /// @param storage  storage_size(n, nu) doubles, aligned to 32 bytes, owned by the caller
  ExponentialKernel(Eigen::Index n, Eigen::Index nu, double* storage);

  [[nodiscard]] Eigen::Index n() const { return n_; }
  [[nodiscard]] Eigen::Index nu() const { return nu_; }

  /// E = e^(A dt), integral = ∫₀^dt e^(Aτ) dτ B. Does not allocate. The results are NaN unless the
  /// status is solved.
  ///
  /// @param A         (n × n)
  /// @param B         (n × nu)
  /// @param dt        > 0
  /// @param E         (n × n), may be A
  /// @param integral  (n × nu), may be B
  ExponentialStatus solve(const Eigen::Ref<const Eigen::MatrixXd>& A,
                          const Eigen::Ref<const Eigen::MatrixXd>& B, double dt,
                          Eigen::Ref<Eigen::MatrixXd> E, Eigen::Ref<Eigen::MatrixXd> integral);

 private:
  void load(const Eigen::Ref<const Eigen::MatrixXd>& A, const Eigen::Ref<const Eigen::MatrixXd>& B,
            double dt);
  int load_scaled(const Eigen::Ref<const Eigen::MatrixXd>& A, double dt);
  bool look_at_powers();
  int halve();
  void series(int degree);
  void double_integral();
  void double_up(int times);
  void store(Eigen::Ref<Eigen::MatrixXd> E, Eigen::Ref<Eigen::MatrixXd> integral) const;
  static ExponentialStatus no_result(Eigen::Ref<Eigen::MatrixXd> E,
                                     Eigen::Ref<Eigen::MatrixXd> integral);

  Eigen::Index n_;
  Eigen::Index nu_;
  Eigen::Index ld_;        // n padded to whole vectors: rows and columns of every buffer
  Eigen::Index cols_;      // nu padded
  Eigen::Index size_;      // doubles of one n × n buffer
  double* I_;              // identity
  double *X_, *X2_, *X3_;  // A dt / 2^s and its powers
  double *P_, *F_;         // Σ Xᵏ/(k+1)! and e^X - I; scratch before and afterwards
  double *G_, *H_;         // the integral and its scratch, B padded
  double X2_norm_ = 0;
  double X3_norm_ = 0;
  double step_ = 0;            // dt / 2^s, the period over which G is the integral
  bool has_identity_ = false;  // F holds e^X, not e^X - I
};

/// A single computation with its own storage.
ExponentialStatus exponential_and_integral(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                           const Eigen::Ref<const Eigen::MatrixXd>& B, double dt,
                                           Eigen::Ref<Eigen::MatrixXd> E,
                                           Eigen::Ref<Eigen::MatrixXd> integral);

}  // namespace quadtune::internal
