// SPDX-License-Identifier: Apache-2.0
/// What the parts of the Riccati solver hand to one another.
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

/// Which of the two equations.
enum class Time { continuous, discrete };

/// A checked problem. The matrices are the caller's and outlive the solve.
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

/// What check_problem() learnt about R on the way.
enum class WeightR { well_conditioned, ill_conditioned, singular };

/// Memory of check_problem(), kept between solves.
struct CheckBuffers {
  Eigen::MatrixXd factor_Q;  ///< (nx × nx)
  Eigen::MatrixXd factor_R;  ///< (nu × nu)
};

/// Refuses wrong shapes, non-finite entries, asymmetry, and an R with a negative eigenvalue.
/// On return the lower triangle of `buffers.factor_R` holds the Cholesky factor of R, unless R is
/// singular. `indefinite_Q` is emptied, or says which eigenvalue of Q is negative beyond rounding.
/// @throws InvalidInput
WeightR check_problem(const RiccatiEquation& problem, CheckBuffers& buffers,
                      std::string& indefinite_Q);

/// "[Q N; N' R] has eigenvalue -0.1, …" when that is so beyond rounding because of N; else empty.
[[nodiscard]] std::string cost_indefiniteness(const RiccatiEquation& problem);

/// "R + B'SB is singular …" when that is so beyond rounding of a discrete equation's R, B and S =
/// X; else empty.
[[nodiscard]] std::string free_inputs(const RiccatiEquation& problem, const Eigen::MatrixXd& X);

/// A candidate solution with the measures by which it is judged.
struct Candidate {
  Eigen::MatrixXd X;  ///< (nx × nx)
  Eigen::MatrixXd K;  ///< (nu × nx)
  double residual = std::numeric_limits<double>::quiet_NaN();
  double rcond = std::numeric_limits<double>::quiet_NaN();
  int iterations = 0;
};

/// What rounding X and the products of K = S⁻¹ F, S = R or R + BᵀXB, may make of K in double
/// precision, relative to its norm: eps ‖|S⁻¹| (|Bᵀ||X||A| + |Nᵀ|)‖ / ‖K‖, without A if continuous.
[[nodiscard]] double gain_rounding(const RiccatiEquation& problem, const Candidate& solution);

/// Squared Frobenius norms from which residual and rcond follow, in the caller's units. Those of a
/// problem that falls into parts are the sums over its parts.
struct SquaredNorms {
  double residual = 0;
  std::array<double, 4> terms{};  ///< of the equation
  double A = 0, G = 0, Q = 0, X = 0;
  double h0 = 0;  ///< solution of the closed loop's Lyapunov equation for I
  double h2 = 0;  ///< the same for X², discrete AcᵀX²Ac

  SquaredNorms& operator+=(const SquaredNorms& other);
  /// ‖residual‖ over the sum of the norms of the terms.
  [[nodiscard]] double relative_residual() const;
  /// By Kenney and Hewer 1990, upper bound of the condition:
  /// (‖Q‖ h₀ + 2 ‖A‖ √(h₀ h₂) + ‖G‖ h₂) / ‖X‖.
  [[nodiscard]] double reciprocal_condition() const;
};

/// Solves by structure-preserving doubling. Owns all its memory: solve() does not allocate.
class DoublingSolver {
 public:
  virtual ~DoublingSolver() = default;

  /// @param factor_R  Cholesky factor of R in its lower triangle.
  /// @param norms     out, complete
  /// @return          true when X is symmetric and proved stabilizing; `found` then holds X, K and
  ///                  the number of steps, but neither residual nor rcond.
  virtual bool solve(const RiccatiEquation& problem, const Eigen::MatrixXd& factor_R,
                     const RiccatiOptions& options, Candidate& found, SquaredNorms& norms) = 0;
};

/// The kernels of fixed size where there are some, Eigen's above.
[[nodiscard]] std::unique_ptr<DoublingSolver> make_dense_solver(Eigen::Index nx, Eigen::Index nu);

/// The same, but a problem whose states and inputs fall into groups that do not know of one another
/// (as a hovering vehicle's do) is solved group by group, each with its own scaling and γ. A
/// grouping that was not met before allocates.
[[nodiscard]] std::unique_ptr<DoublingSolver> make_doubling_solver(Eigen::Index nx,
                                                                   Eigen::Index nu);

/// Solves by ordered Schur vectors of the Hamiltonian matrix, or of the extended pencil when R is
/// ill conditioned or time is discrete, and refines by Newton–Kleinman steps.
struct SchurOutcome {
  bool found = false;  ///< the candidate's X is symmetric, K and residual belong to it
  /// Eigenvalue of the Hamiltonian matrix or pencil nearest to the boundary, and how near,
  /// relative.
  std::complex<double> nearest{};
  double distance = std::numeric_limits<double>::infinity();
};
SchurOutcome solve_by_schur(const RiccatiEquation& problem, WeightR weight_R, Candidate& found);

/// What 50 decimal digits tell.
struct ExtendedSolution {
  Candidate candidate;  ///< X and K exact up to their rounding to double, residual that of both
  /// ‖δK‖/‖K‖ when every entry of the problem is rounded once more, found by trial; infinite where
  /// that decides whether there is a solution, as where only a Q raised by its rounding has one.
  double gain_error = std::numeric_limits<double>::quiet_NaN();
  Eigen::VectorXcd poles;  ///< (nx) of A - B K
};

/// Whether 50 digits take seconds at most: they cost a hundred times the time of a double. Within
/// that size, the larger the problem, the fewer steps solve_extended() takes before it gives up.
[[nodiscard]] bool fits_extended(Eigen::Index nx, Eigen::Index nu);

/// Solves by doubling and Newton–Kleinman steps in 50 decimal digits, for equations whose matrices
/// are too far apart for a double. True when the loop of K, as rounded to double, is proved stable.
bool solve_extended(const RiccatiEquation& problem, ExtendedSolution& found);

/// An eigenvalue of the Hamiltonian matrix of a continuous equation on the imaginary axis, by 50
/// digits; none of a discrete equation, where this is not looked for.
[[nodiscard]] std::optional<std::complex<double>> axis_eigenvalue(const RiccatiEquation& problem);

/// Fills K and residual of `candidate` from its X.
/// @return  false when R + BᵀXB is singular, or something overflowed.
bool evaluate(const RiccatiEquation& problem, Candidate& candidate);

/// Newton steps with line search while they lower the residual; X must be stabilizing.
void refine_by_newton(const RiccatiEquation& problem, Candidate& candidate);

/// Residual matrix of the equation at X, and the sum of the norms of its terms.
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
/// A singular R is replaced by its non-singular part where it divides.
[[nodiscard]] PlainProblem without_cross_term(const RiccatiEquation& problem);

/// Scale of each state (powers of two) that levels A, B Bᵀ and Q against one another; x = D z.
[[nodiscard]] Eigen::VectorXd balancing(const Eigen::MatrixXd& A, const Eigen::MatrixXd& G,
                                        const Eigen::MatrixXd& Q);

/// Eigenvalues of A - B K, balanced first. Empty when LAPACK's QR iteration did not end.
[[nodiscard]] Eigen::VectorXcd closed_loop_poles(const RiccatiEquation& problem,
                                                 const Eigen::MatrixXd& K);

/// Whether all poles are stable; there must be some.
[[nodiscard]] bool all_stable(Time time, const Eigen::VectorXcd& poles);

/// Fills the candidate's rcond by a Schur form of A - B K, whose eigenvalues it returns.
Eigen::VectorXcd estimate_condition(const RiccatiEquation& problem, Candidate& solution);

/// Why there is no stabilizing solution.
struct Culprit {
  RiccatiStatus status = RiccatiStatus::no_convergence;
  std::string text;
};
/// Looks for the mode that forbids a stabilizing solution; status no_convergence when none is
/// found.
/// @param tolerance  relative; how weak a coupling counts as none
[[nodiscard]] Culprit find_culprit(const RiccatiEquation& problem, double tolerance,
                                   const RiccatiOptions& options);

}  // namespace quadtune::internal
