// SPDX-License-Identifier: Apache-2.0
/// Algebraic Riccati equations, continuous and discrete. A result contains the evidence that the
/// solution is the stabilizing one, or names the mode that prevents it.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <iosfwd>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace quadtune {

/// How a Riccati solve ended.
enum class RiccatiStatus {
  not_run,           ///< no problem has been solved yet
  solved,            ///< X is stabilizing and meets the tolerance
  not_stabilizable,  ///< an unstable or boundary mode of A is uncontrollable through B
  not_detectable,    ///< a boundary mode of A is unobservable through Q
  boundary_pair,     ///< closed-loop eigenvalues on the stability boundary for another reason
  no_convergence,    ///< no method reached the tolerance
};

/// "solved", "not stabilizable", …
[[nodiscard]] std::string to_string(RiccatiStatus status);

/// How much evidence a solve computes. Both levels include X, K, residual, rcond and the proof that
/// X is stabilizing (the powers of the closed loop converge to 0).
enum class RiccatiEvidence {
  full,       ///< also closed-loop poles, which cost more than the solution if nx is small
  essential,  ///< no poles
};

/// The purpose of the equation. It affects only the wording of the culprit.
enum class RiccatiProblem {
  regulator,  ///< "cannot be controlled", "is not observable through Q"
  filter,  ///< (Aᵀ, Cᵀ): "cannot be observed by the measurements", "is not driven by the noise"
};

/// Options of the solvers, and of lqr(), kalman() and what is built on them. The defaults suit
/// 1 ≤ nx ≤ 200.
struct RiccatiOptions {
  /// Maximum of RiccatiResult::residual, in (0, 1). A residual that the condition of the equation
  /// explains, at most min(2e-14 / rcond, 1e-6), is accepted as well. A result in 50 digits is
  /// exact whatever the tolerance.
  double relative_tolerance = 1e-12;
  /// Doubling steps, ≥ 1; eight is typical. If they do not suffice, the Schur method solves the
  /// equation (RiccatiResult::used_schur); the status is no_convergence only if every method fails.
  int max_iterations = 60;
  RiccatiEvidence evidence = RiccatiEvidence::full;  ///< how much evidence is computed
  /// Whether a Q with a negative eigenvalue that exceeds rounding is rejected with InvalidInput. If
  /// not, the equation is solved nevertheless (published test problems have such a Q), and
  /// RiccatiResult::warning states the eigenvalue.
  bool reject_indefinite_Q = false;
  /// Names the culprit as for a regulator or for a filter.
  RiccatiProblem problem = RiccatiProblem::regulator;
  /// nx names for the culprit; empty: "state 1", …
  std::vector<std::string> state_names = {};
};

/// A stabilizing solution with its evidence.
struct RiccatiResult {
  RiccatiStatus status = RiccatiStatus::not_run;  ///< solved, or why there is no solution
  Eigen::MatrixXd X;       ///< (nx × nx) symmetric, ≥ 0 if Q is; all NaN unless solved
  Eigen::MatrixXd K;       ///< (nu × nx) gain of u = -K x; all NaN unless solved
  Eigen::VectorXcd poles;  ///< (nx) eigenvalues of A - B K; empty unless solved with full evidence
  /// Relative residual: ‖residual of the equation‖ / sum of the norms of its terms, Frobenius.
  double residual = std::numeric_limits<double>::quiet_NaN();
  /// Reciprocal condition of the equation at X (Kenney–Hewer, Byers), in (0, 1]. The solution's
  /// relative error is of the order of 1e-16 / rcond.
  double rcond = std::numeric_limits<double>::quiet_NaN();
  int iterations = 0;       ///< doubling steps; 0 if the Schur method computed the solution
  bool used_schur = false;  ///< whether doubling missed the tolerance
  /// Whether the equation was solved in 50 decimal digits, because neither method reached the
  /// tolerance in double precision or, with full evidence, because the accuracy of the result was
  /// doubtful. Only for up to 40 states and inputs.
  bool used_extended = false;
  /// Sensitivity of K to rounding of the matrices: ‖δK‖/‖K‖ when every entry is changed by one
  /// rounding (a relative 1.1e-16). If used_extended, it is estimated by random perturbations;
  /// otherwise it is an upper bound, computed only if rcond < 1e-12, and NaN if not computed.
  /// Infinite if the rounding decides whether a solution exists.
  double gain_error = std::numeric_limits<double>::quiet_NaN();
  std::string culprit;  ///< e.g. "mode at 0: y cannot be controlled"; empty when solved
  /// e.g. "Q has eigenvalue -0.1, …", or that the equation is ill-conditioned (rcond < 1e-12, or
  /// gain_error > 1e-6) with the possible relative error of K; empty if there is no warning.
  std::string warning;

  /// Whether there is a stabilizing solution.
  [[nodiscard]] bool solved() const { return status == RiccatiStatus::solved; }
};

/// Prints the status, the culprit, and residual, rcond and method in one line.
std::ostream& operator<<(std::ostream& out, const RiccatiResult& result);

/// Solves AᵀX + XA - (XB + N) R⁻¹ (BᵀX + Nᵀ) + Q = 0 for the X whose A - B K,
/// K = R⁻¹ (BᵀX + Nᵀ), has all eigenvalues in the open left half-plane.
///
/// @param A        (nx × nx), nx ≥ 1
/// @param B        (nx × nu), nu ≥ 1
/// @param Q        (nx × nx) symmetric, ≥ 0 up to rounding (1e-12 of its norm); see
///                 RiccatiOptions::reject_indefinite_Q
/// @param R        (nu × nu) symmetric, > 0
/// @param N        (nx × nu), or empty for zero
/// @param options  tolerances, evidence and names; accepted ranges at the type
/// @throws InvalidInput  for wrong shapes, entries that are not finite, asymmetry (with its size),
///                       an R that is not positive definite (with the eigenvalue), and options out
///                       of range.
/// Source: doubling by Chu, Fan, Lin 2005; ordered Schur by Laub 1979; refinement by Kleinman 1968.
/// If double precision is insufficient, the equation is solved in 50 digits: see
/// RiccatiResult::used_extended.
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

/// Solves Riccati equations of one size repeatedly and reuses its memory. A solve does not allocate
/// if doubling reaches the tolerance, the evidence is essential, and nx ≤ 100.
///
/// Not for use by two threads at once. A moved-from solver may only be destroyed or assigned to.
class RiccatiSolver {
 public:
  /// @param nx, nu   sizes of all equations to solve, ≥ 1
  /// @param options  for all equations
  /// @throws InvalidInput  if a size is < 1, or an option is out of range
  RiccatiSolver(Eigen::Index nx, Eigen::Index nu, RiccatiOptions options = {});
  ~RiccatiSolver();
  RiccatiSolver(RiccatiSolver&&) noexcept;
  RiccatiSolver& operator=(RiccatiSolver&&) noexcept;

  /// Same as the function care(), for the sizes of this solver. The result is valid until the next
  /// call.
  const RiccatiResult& care(const Eigen::Ref<const Eigen::MatrixXd>& A,
                            const Eigen::Ref<const Eigen::MatrixXd>& B,
                            const Eigen::Ref<const Eigen::MatrixXd>& Q,
                            const Eigen::Ref<const Eigen::MatrixXd>& R,
                            const Eigen::Ref<const Eigen::MatrixXd>& N = Eigen::MatrixXd());

  /// Same as the function dare(), for the sizes of this solver. The result is valid until the next
  /// call.
  const RiccatiResult& dare(const Eigen::Ref<const Eigen::MatrixXd>& A,
                            const Eigen::Ref<const Eigen::MatrixXd>& B,
                            const Eigen::Ref<const Eigen::MatrixXd>& Q,
                            const Eigen::Ref<const Eigen::MatrixXd>& R,
                            const Eigen::Ref<const Eigen::MatrixXd>& N = Eigen::MatrixXd());

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace quadtune
