// SPDX-License-Identifier: Apache-2.0
/// Algebraic Riccati equations, continuous and discrete, with the evidence that the solution is the
/// stabilizing one, or the mode that forbids it.
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
  not_run,           ///< no problem was given yet
  solved,            ///< X is stabilizing and meets the tolerance
  not_stabilizable,  ///< B cannot steer an unstable or boundary mode of A
  not_detectable,    ///< Q does not see a mode of A on the boundary
  boundary_pair,     ///< closed-loop eigenvalues on the boundary for another reason
  no_convergence,    ///< neither path reached the tolerance
};

/// "solved", "not stabilizable", …
[[nodiscard]] std::string to_string(RiccatiStatus status);

/// How much a solve tells about its solution. X, K, residual, rcond and the proof that X is
/// stabilizing (the powers of the closed loop vanish) belong to both.
enum class RiccatiEvidence {
  full,       ///< closed-loop poles as well, which cost more than the solution when nx is small
  essential,  ///< no poles
};

/// What the equation is solved for: only the words of the culprit depend on it.
enum class RiccatiProblem {
  regulator,  ///< "cannot be steered", "is not seen by Q"
  filter,  ///< on (Aᵀ, Cᵀ): "cannot be seen by the measurements", "is not driven by the noise"
};

/// How hard the solver tries. The defaults suit 1 ≤ nx ≤ 200.
struct RiccatiOptions {
  double relative_tolerance = 1e-12;  ///< on RiccatiResult::residual of a well-conditioned problem
  int max_iterations = 60;            ///< doubling steps; eight is typical
  RiccatiEvidence evidence = RiccatiEvidence::full;
  /// Whether a Q with a negative eigenvalue beyond rounding throws InvalidInput. If not, the
  /// stabilizing solution is looked for all the same (published test problems have such a Q), and
  /// RiccatiResult::warning tells the eigenvalue.
  bool refuse_indefinite_Q = false;
  RiccatiProblem problem = RiccatiProblem::regulator;
  std::vector<std::string> state_names;  ///< nx, used by the culprit; empty: "state 1", …
};

/// A stabilizing solution together with the evidence that it is the right one.
struct RiccatiResult {
  RiccatiStatus status = RiccatiStatus::not_run;
  Eigen::MatrixXd X;       ///< (nx × nx) symmetric, ≥ 0 if Q is; all NaN unless solved
  Eigen::MatrixXd K;       ///< (nu × nx) gain of u = -K x; all NaN unless solved
  Eigen::VectorXcd poles;  ///< (nx) eigenvalues of A - B K; empty unless solved with full evidence
  /// ‖residual of the equation‖ over the sum of the norms of its terms, Frobenius.
  double residual = std::numeric_limits<double>::quiet_NaN();
  /// Reciprocal condition of the equation at X (Kenney–Hewer, Byers), in (0, 1]. The solution's
  /// relative error is of the order of 1e-16 / rcond.
  double rcond = std::numeric_limits<double>::quiet_NaN();
  int iterations = 0;       ///< doubling steps; 0 when the Schur method gave the answer
  bool used_schur = false;  ///< doubling did not reach the tolerance
  /// Solved in 50 decimal digits, because neither method reached the tolerance in double precision
  /// or, with full evidence, because its answer was doubtful. Only up to 40 states and inputs.
  bool used_extended = false;
  /// How far K depends on the last digit of the matrices: ‖δK‖/‖K‖ when every entry is rounded once
  /// more (by 1.1e-16 of it). Found by trial where used_extended; otherwise a bound, and that only
  /// where rcond < 1e-12. NaN where it was not asked. Infinite: the rounding decides whether there
  /// is a solution.
  double gain_error = std::numeric_limits<double>::quiet_NaN();
  std::string culprit;  ///< e.g. "mode at 0: y and vy cannot be steered"; empty when solved
  /// e.g. "Q has eigenvalue -0.1, …", or that the equation is ill-conditioned (rcond < 1e-12, or
  /// gain_error > 1e-6) and how far K may be off; empty when there is nothing to say.
  std::string warning;

  [[nodiscard]] bool solved() const { return status == RiccatiStatus::solved; }
};

std::ostream& operator<<(std::ostream& out, const RiccatiResult& result);

/// Solves AᵀX + XA - (XB + N) R⁻¹ (BᵀX + Nᵀ) + Q = 0 for the X whose A - B K,
/// K = R⁻¹ (BᵀX + Nᵀ), has all eigenvalues in the open left half-plane.
///
/// @param A  (nx × nx), nx ≥ 1
/// @param B  (nx × nu), nu ≥ 1
/// @param Q  (nx × nx) symmetric, ≥ 0 up to rounding (1e-12 of its norm); see
///           RiccatiOptions::refuse_indefinite_Q
/// @param R  (nu × nu) symmetric, > 0
/// @param N  (nx × nu), or empty for zero
/// @throws InvalidInput  for shapes, non-finite entries, asymmetry (with its size), an R that is
/// not
///                       > 0 (with the eigenvalue), options out of range.
/// Source: doubling by Chu, Fan, Lin 2005; ordered Schur by Laub 1979; refinement by Kleinman 1968.
/// Where double precision does not do, the same in 50 digits: see RiccatiResult::used_extended.
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

/// Solves Riccati equations of one size again and again in memory that it owns. As long as doubling
/// reaches the tolerance, evidence is essential and nx ≤ 100, a solve allocates nothing.
///
/// Not for use by two threads at once. A moved-from solver may only be destroyed or assigned to.
class RiccatiSolver {
 public:
  /// @param nx, nu   sizes that every solve will have, ≥ 1
  /// @throws InvalidInput  for sizes < 1, or options out of range
  RiccatiSolver(Eigen::Index nx, Eigen::Index nu, RiccatiOptions options = {});
  ~RiccatiSolver();
  RiccatiSolver(RiccatiSolver&&) noexcept;
  RiccatiSolver& operator=(RiccatiSolver&&) noexcept;

  /// As the function care(), for the sizes of this solver. The result is valid until the next call.
  const RiccatiResult& care(const Eigen::Ref<const Eigen::MatrixXd>& A,
                            const Eigen::Ref<const Eigen::MatrixXd>& B,
                            const Eigen::Ref<const Eigen::MatrixXd>& Q,
                            const Eigen::Ref<const Eigen::MatrixXd>& R,
                            const Eigen::Ref<const Eigen::MatrixXd>& N = Eigen::MatrixXd());

  /// As the function dare(), for the sizes of this solver. The result is valid until the next call.
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
