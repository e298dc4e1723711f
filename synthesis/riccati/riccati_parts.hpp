// SPDX-License-Identifier: Apache-2.0
/// Interfaces between the parts of the Riccati solver.
#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/synthesis/riccati.hpp"

namespace quadtune::internal {

using ConstRef = Eigen::Ref<const Eigen::MatrixXd>;

/// Selects one of the two equations.
enum class Time { continuous, discrete };

/// A validated problem. The matrices belong to the caller and must outlive the solve.
struct RiccatiEquation {
  Time time;
  const ConstRef& A;
  const ConstRef& B;
  const ConstRef& Q;
  const ConstRef& R;
  const ConstRef& N;  ///< empty means zero

  [[nodiscard]] bool has_cross_term() const { return N.size() > 0; }
};

/// "care" or "dare", for messages.
[[nodiscard]] const char* equation_name(Time time);

/// The condition of R, as determined by check_problem().
enum class WeightR { well_conditioned, ill_conditioned, singular };

/// Memory of check_problem() that is reused between solves.
struct CheckBuffers {
  Eigen::MatrixXd factor_Q;  ///< (nx × nx)
  Eigen::MatrixXd factor_R;  ///< (nu × nu)
};

/// Rejects wrong shapes, entries that are not finite, asymmetry, and an R with a negative
/// eigenvalue. On return the lower triangle of `buffers.factor_R` contains the Cholesky factor of
/// R, unless R is singular. `indefinite_Q` is empty, or states the negative eigenvalue of Q if it
/// exceeds rounding.
/// @throws InvalidInput  for the reasons above
WeightR check_problem(const RiccatiEquation& problem, CheckBuffers& buffers,
                      std::string& indefinite_Q);

/// "[Q N; N' R] has eigenvalue -0.1, …" if N makes the cost indefinite beyond rounding; otherwise
/// empty.
[[nodiscard]] std::string cost_indefiniteness(const RiccatiEquation& problem);

/// "R + B'SB is singular …" if that is so, up to rounding, for the R, B and S = X of a discrete
/// equation; otherwise empty.
[[nodiscard]] std::string free_inputs(const RiccatiEquation& problem, const Eigen::MatrixXd& X);

/// A candidate solution with its residual and condition.
struct Candidate {
  Eigen::MatrixXd X;  ///< (nx × nx)
  Eigen::MatrixXd K;  ///< (nu × nx)
  double residual = std::numeric_limits<double>::quiet_NaN();
  double rcond = std::numeric_limits<double>::quiet_NaN();
  int iterations = 0;
};

/// Estimates the relative error of K = S⁻¹ F, S = R or R + BᵀXB, due to rounding of X and of the
/// products in double precision: eps ‖|S⁻¹| (|Bᵀ||X||A| + |Nᵀ|)‖ / ‖K‖, without A if continuous.
[[nodiscard]] double gain_rounding(const RiccatiEquation& problem, const Candidate& solution);

/// Squared Frobenius norms from which residual and rcond are computed, in the caller's units. For a
/// problem with decoupled groups they are the sums over the groups.
struct SquaredNorms {
  double residual = 0;
  std::array<double, 4> terms{};  ///< of the equation
  double A = 0, G = 0, Q = 0, X = 0;
  double h0 = 0;  ///< of the solution of the closed loop's Lyapunov equation for I
  double h2 = 0;  ///< the same for X², discrete AcᵀX²Ac

  SquaredNorms& operator+=(const SquaredNorms& other);
  /// ‖residual‖ / sum of the norms of the terms.
  [[nodiscard]] double relative_residual() const;
  /// Reciprocal of the upper bound of the condition by Kenney and Hewer 1990:
  /// (‖Q‖ h₀ + 2 ‖A‖ √(h₀ h₂) + ‖G‖ h₂) / ‖X‖.
  [[nodiscard]] double reciprocal_condition() const;
};

/// Solves by structure-preserving doubling. It owns all its memory; solve() does not allocate.
class DoublingSolver {
 public:
  virtual ~DoublingSolver() = default;

  /// @param factor_R  Cholesky factor of R in its lower triangle
  /// @param norms     out: all norms
  /// @return          true if X is symmetric and proved to be stabilizing; `found` then contains X,
  ///                  K and the number of steps, but neither residual nor rcond.
  virtual bool solve(const RiccatiEquation& problem, const Eigen::MatrixXd& factor_R,
                     const RiccatiOptions& options, Candidate& found, SquaredNorms& norms) = 0;
};

/// Creates a solver with kernels of fixed size if they exist for the size, otherwise of variable
/// size.
[[nodiscard]] std::unique_ptr<DoublingSolver> make_dense_solver(Eigen::Index nx, Eigen::Index nu);

/// The same, but a problem whose states and inputs form decoupled groups (such as that of a
/// hovering vehicle) is solved group by group, each with its own scaling and γ. The first
/// occurrence of a grouping allocates memory.
[[nodiscard]] std::unique_ptr<DoublingSolver> make_doubling_solver(Eigen::Index nx,
                                                                   Eigen::Index nu);

/// Solves by ordered Schur vectors of the Hamiltonian matrix, or of the extended pencil when R is
/// ill conditioned or time is discrete, and refines by Newton–Kleinman steps.
struct SchurOutcome {
  bool found = false;  ///< whether there is a symmetric X; K and residual belong to it
  /// The eigenvalue of the Hamiltonian matrix or pencil nearest to the boundary, and its relative
  /// distance.
  std::complex<double> nearest{};
  double distance = std::numeric_limits<double>::infinity();
};
SchurOutcome solve_by_schur(const RiccatiEquation& problem, WeightR weight_R, Candidate& found);

/// The result of a solve in 50 decimal digits.
struct ExtendedSolution {
  Candidate candidate;  ///< X and K, correctly rounded to double, and their residual
  /// ‖δK‖/‖K‖ when every entry of the problem is changed by one rounding, estimated by random
  /// perturbations. Infinite if that decides whether a solution exists, e.g. if a solution exists
  /// only after Q is increased by its rounding error.
  double gain_error = std::numeric_limits<double>::quiet_NaN();
  Eigen::VectorXcd poles;  ///< (nx) eigenvalues of A - B K
};

/// Whether a solve in 50 digits takes at most seconds: it is a hundred times slower than in double
/// precision. Within this size, solve_extended() limits its steps more strictly for larger
/// problems.
[[nodiscard]] bool fits_extended(Eigen::Index nx, Eigen::Index nu);

/// Solves by doubling and Newton–Kleinman steps in 50 decimal digits, for equations whose matrices
/// differ too much in magnitude for double precision.
/// @return  true if the closed loop of K, rounded to double, is proved to be stable
bool solve_extended(const RiccatiEquation& problem, ExtendedSolution& found);

/// Searches for an imaginary eigenvalue of the Hamiltonian matrix of a continuous equation in 50
/// digits. Returns none for a discrete equation, which is not examined.
[[nodiscard]] std::optional<std::complex<double>> axis_eigenvalue(const RiccatiEquation& problem);

/// Computes K and residual of `candidate` from its X.
/// @return  false if R + BᵀXB is singular, or after an overflow
bool evaluate(const RiccatiEquation& problem, Candidate& candidate);

/// Refines X, which must be stabilizing, by Newton steps with line search while the residual
/// decreases.
void refine_by_newton(const RiccatiEquation& problem, Candidate& candidate);

/// The residual matrix of the equation at X, and the sum of the norms of its terms.
struct ResidualTerms {
  Eigen::MatrixXd residual;
  double scale = 0;
};
[[nodiscard]] ResidualTerms residual_terms(const RiccatiEquation& problem, const Eigen::MatrixXd& X,
                                           const Eigen::MatrixXd& K);

/// The equation without its cross term: A - B R⁻¹ Nᵀ, Q - N R⁻¹ Nᵀ, and B L⁻ᵀ with L Lᵀ = R.
struct PlainProblem {
  Eigen::MatrixXd A;
  Eigen::MatrixXd B;
  Eigen::MatrixXd Q;
};
/// Eliminates the cross term. In divisions a singular R is replaced by a nearby regular matrix.
[[nodiscard]] PlainProblem without_cross_term(const RiccatiEquation& problem);

/// Computes the scale of each state (a power of two) that balances A, B Bᵀ and Q; x = D z.
[[nodiscard]] Eigen::VectorXd balancing(const Eigen::MatrixXd& A, const Eigen::MatrixXd& G,
                                        const Eigen::MatrixXd& Q);

/// Eigenvalues of A - B K, computed with balancing. Empty if LAPACK's QR iteration did not
/// converge.
[[nodiscard]] Eigen::VectorXcd closed_loop_poles(const RiccatiEquation& problem,
                                                 const Eigen::MatrixXd& K);

/// Whether all poles are stable; false if there are none.
[[nodiscard]] bool all_stable(Time time, const Eigen::VectorXcd& poles);

/// Computes the rcond of the candidate from a Schur form of A - B K, and returns its eigenvalues.
Eigen::VectorXcd estimate_condition(const RiccatiEquation& problem, Candidate& solution);

/// The reason why there is no stabilizing solution.
struct Culprit {
  RiccatiStatus status = RiccatiStatus::no_convergence;
  std::string text;
};
/// Searches for the mode that prevents a stabilizing solution. The status is no_convergence if none
/// is found.
/// @param tolerance  relative; weaker couplings are regarded as 0
[[nodiscard]] Culprit find_culprit(const RiccatiEquation& problem, double tolerance,
                                   const RiccatiOptions& options);

}  // namespace quadtune::internal
