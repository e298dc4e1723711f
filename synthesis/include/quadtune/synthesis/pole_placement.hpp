// SPDX-License-Identifier: Apache-2.0
/// State feedback with given closed-loop poles.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>

namespace quadtune {

/// How a pole placement ended.
enum class PolePlacementStatus {
  not_run,
  solved,            ///< the poles of A - B K are the requested ones
  not_controllable,  ///< a mode cannot be moved, and it is not among the requested poles
  inaccurate,  ///< the computed poles differ from the requested ones by more than the tolerance
};

/// "not run", "solved", "not controllable", "inaccurate".
[[nodiscard]] std::string to_string(PolePlacementStatus status);

/// A gain with its evidence.
struct PolePlacement {
  PolePlacementStatus status = PolePlacementStatus::not_run;  ///< solved, or why there is no gain
  Eigen::MatrixXd K;       ///< (nu × nx) gain of u = -K x; all NaN unless solved
  Eigen::VectorXcd poles;  ///< (nx) computed eigenvalues of A - B K; empty unless solved
  /// The largest distance between a requested pole and the computed one that is paired with it.
  double error = std::numeric_limits<double>::quiet_NaN();
  std::string culprit;  ///< e.g. "mode at 2 cannot be controlled"; empty when solved

  /// Whether there is a gain.
  [[nodiscard]] bool solved() const { return status == PolePlacementStatus::solved; }
};

/// Computes a gain K for which A - B K has the given eigenvalues. For one input, it is unique. For
/// several inputs, each pole is moved with the smallest gain that moves it, and poles are paired
/// with the eigenvalues of A that are near them; poles may repeat.
///
/// @param A          (nx × nx), nx ≥ 1; continuous or discrete
/// @param B          (nx × nu), nu ≥ 1
/// @param poles      (nx) complex ones in conjugate pairs
/// @param tolerance  on PolePlacement::error, relative to the largest modulus of the poles and of
///                   the eigenvalues of A. It is raised to 100 ε^(1/m) for a pole of multiplicity
///                   m, which rounding determines only that well.
/// @throws InvalidInput  if shapes disagree, an entry is not finite, or a complex pole has no
///                       conjugate
/// Source: Varga 1981, by the real Schur form (LAPACK).
[[nodiscard]] PolePlacement place_poles(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                        const Eigen::Ref<const Eigen::MatrixXd>& B,
                                        const Eigen::Ref<const Eigen::VectorXcd>& poles,
                                        double tolerance = 1e-6);

}  // namespace quadtune
