// SPDX-License-Identifier: Apache-2.0
/// The matrix exponential by a Taylor series of adaptive degree with scaling and doubling.
#pragma once

#include <Eigen/Core>
#include <memory>

namespace quadtune {

/// The outcome of the computation of an exponential.
enum class ExponentialStatus {
  not_run,
  solved,
  overflow,  ///< an entry of the result exceeds the range of a double
};

/// The exponential, or the reason why there is none.
struct ExponentialResult {
  /// Solved, or the reason why there is no E.
  ExponentialStatus status = ExponentialStatus::not_run;
  Eigen::MatrixXd E;  ///< (n × n) e^A; all NaN unless solved

  /// Whether E is the exponential.
  [[nodiscard]] bool solved() const { return status == ExponentialStatus::solved; }
};

/// e^A to a few rounding units times the condition number of the problem, for any norm of A.
///
/// @param A  (n × n), n ≥ 1
/// @throws InvalidInput  if A is not square or has an entry that is not finite.
/// Source: truncation by Al-Mohy and Higham 2009 (norms of powers), evaluation by Paterson and
///         Stockmeyer 1973; docs/theory.md, "Discretization".
[[nodiscard]] ExponentialResult matrix_exponential(const Eigen::Ref<const Eigen::MatrixXd>& A);

/// The same for many matrices of one size: solve() does not allocate.
class MatrixExponential {
 public:
  /// @param n  rows of the matrices, ≥ 1
  explicit MatrixExponential(Eigen::Index n);
  ~MatrixExponential();
  MatrixExponential(MatrixExponential&&) noexcept;
  MatrixExponential& operator=(MatrixExponential&&) noexcept;

  /// E = e^A.
  ///
  /// @param A  (n × n), finite
  /// @param E  (n × n) the result, all NaN unless solved; may be A itself
  /// @throws InvalidInput  if a shape differs or an entry is not finite.
  [[nodiscard]] ExponentialStatus solve(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                        Eigen::Ref<Eigen::MatrixXd> E);

 private:
  struct Workspace;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace quadtune
