// SPDX-License-Identifier: Apache-2.0
/// Algebraic Riccati equations, continuous and discrete, with the evidence that the solution is the
/// stabilizing one, or the mode that forbids it.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <iosfwd>
#include <limits>
#include <string>
#include <vector>

namespace quadtune {

/// How a Riccati solve ended.
enum class RiccatiStatus {
  not_run,           ///< no problem was given yet
  solved,            ///< X is stabilizing and meets the tolerance
  not_stabilizable,  ///< B cannot steer an unstable or boundary mode of A
  not_detectable,    ///< Q does not see a mode of A on the boundary
  boundary_pair,     ///< closed-loop eigenvalues on the boundary for another reason
  no_convergence,    ///< neither path reached the tolerance
};

/// "solved", "not stabilizable", …
[[nodiscard]] std::string to_string(RiccatiStatus status);

/// How hard the solver tries. The defaults suit 1 ≤ nx ≤ 200.
struct RiccatiOptions {
  double relative_tolerance = 1e-12;  ///< on RiccatiResult::residual of a well-conditioned problem
  int max_iterations = 60;            ///< doubling steps; eight is typical
  std::vector<std::string> state_names;  ///< nx, used by the culprit; empty: "state 1", …
};

/// A stabilizing solution together with the evidence that it is the right one.
struct RiccatiResult {
  RiccatiStatus status = RiccatiStatus::not_run;
  Eigen::MatrixXd X;       ///< (nx × nx) symmetric, ≥ 0; all NaN unless solved
  Eigen::MatrixXd K;       ///< (nu × nx) gain of u = -K x; all NaN unless solved
  Eigen::VectorXcd poles;  ///< (nx) eigenvalues of A - B K; empty unless solved
  /// ‖residual of the equation‖ over the sum of the norms of its terms, Frobenius.
  double residual = std::numeric_limits<double>::quiet_NaN();
  /// Reciprocal condition of the equation at X (Kenney–Hewer, Byers), in (0, 1].
  double rcond = std::numeric_limits<double>::quiet_NaN();
  int iterations = 0;       ///< doubling steps; 0 when the Schur method gave the answer
  bool used_schur = false;  ///< doubling did not reach the tolerance
  std::string culprit;      ///< e.g. "mode at 0: y and vy cannot be steered"; empty when solved

  [[nodiscard]] bool solved() const { return status == RiccatiStatus::solved; }
};

std::ostream& operator<<(std::ostream& out, const RiccatiResult& result);

/// Solves AᵀX + XA - (XB + N) R⁻¹ (BᵀX + Nᵀ) + Q = 0 for the X whose A - B K,
/// K = R⁻¹ (BᵀX + Nᵀ), has all eigenvalues in the open left half-plane.
///
/// @param A  (nx × nx), nx ≥ 1
/// @param B  (nx × nu), nu ≥ 1
/// @param Q  (nx × nx) symmetric, ≥ 0 up to rounding
/// @param R  (nu × nu) symmetric, > 0
/// @param N  (nx × nu), or empty for zero
/// @throws InvalidInput  for shapes, non-finite entries, asymmetry (with its size), an indefinite Q
///                       or R (with the eigenvalue).
/// Source: doubling by Chu, Fan, Lin 2005; ordered Schur by Laub 1979; refinement by Kleinman 1968.
[[nodiscard]] RiccatiResult care(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                 const Eigen::Ref<const Eigen::MatrixXd>& B,
                                 const Eigen::Ref<const Eigen::MatrixXd>& Q,
                                 const Eigen::Ref<const Eigen::MatrixXd>& R,
                                 const Eigen::Ref<const Eigen::MatrixXd>& N = Eigen::MatrixXd(),
                                 const RiccatiOptions& options = {});

/// Solves AᵀXA - X - (AᵀXB + N)(R + BᵀXB)⁻¹(BᵀXA + Nᵀ) + Q = 0 for the X whose A - B K,
/// K = (R + BᵀXB)⁻¹ (BᵀXA + Nᵀ), has all eigenvalues in the open unit disk.
///
/// Shapes and errors as care(); R may be singular as long as R + BᵀXB is not.
/// Source: doubling by Chu, Fan, Lin, Wang 2004; extended pencil by Van Dooren 1981.
[[nodiscard]] RiccatiResult dare(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                 const Eigen::Ref<const Eigen::MatrixXd>& B,
                                 const Eigen::Ref<const Eigen::MatrixXd>& Q,
                                 const Eigen::Ref<const Eigen::MatrixXd>& R,
                                 const Eigen::Ref<const Eigen::MatrixXd>& N = Eigen::MatrixXd(),
                                 const RiccatiOptions& options = {});

}  // namespace quadtune
