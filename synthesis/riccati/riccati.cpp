// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/riccati.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <Eigen/SVD>
#include <ostream>

#include "lyapunov/mode_names.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/enum_names.hpp"
#include "riccati/riccati_parts.hpp"

namespace quadtune {

using internal::Candidate;
using internal::ConstRef;
using internal::Culprit;
using internal::RiccatiEquation;
using internal::Time;
using internal::WeightR;

namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
/// Relative size below which couplings are regarded as rounding errors.
constexpr double kNoCoupling = 1e-14;
/// Relative size of couplings that are regarded as 0 after all methods have failed.
constexpr double kWeakCoupling = 1e-9;
/// A solution with a smaller rcond has a warning.
constexpr double kLowRcond = 1e-12;
/// With a smaller rcond, the equation is solved in 50 digits if full evidence is requested: with a
/// tiny R, an equation whose Q is indefinite by rounding may have no solution although the residual
/// is small.
constexpr double kDoubtfulRcond = 1e-8;
/// A larger gain_error causes a warning and, if estimated in double precision, a solve in 50
/// digits.
constexpr double kLargeGainError = 1e-6;
/// With a larger internal::gain_rounding(), the equation is solved in 50 digits, too.
constexpr double kDoubtfulGain = 1e-9;
/// A smaller gain_error is regarded as negligible.
constexpr double kNoLoss = 1e-12;

void check_options(const RiccatiOptions& options, Eigen::Index nx, const std::string& where) {
  if (!(options.relative_tolerance > 0 && options.relative_tolerance < 1))
    throw InvalidInput(where, fmt::format("relative_tolerance is {}, expected a number in (0, 1)",
                                          options.relative_tolerance));
  if (options.max_iterations < 1)
    throw InvalidInput(where,
                       fmt::format("max_iterations is {}, expected >= 1", options.max_iterations));
  const auto count = static_cast<Eigen::Index>(options.state_names.size());
  if (count != 0 && count != nx)
    throw InvalidInput(where, fmt::format("state_names has {} names, expected {} (A is {}x{})",
                                          count, nx, nx, nx));
}

void fill_with_nan(RiccatiResult& result, Eigen::Index nx, Eigen::Index nu) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  result.X.setConstant(nx, nx, nan);
  result.K.setConstant(nu, nx, nan);
  result.residual = nan;
  result.rcond = nan;
  result.gain_error = nan;
  result.iterations = 0;
}

/// Empty, or a warning that the magnitudes of the matrices make the culprit uncertain.
std::string note_on_sizes(const RiccatiEquation& p) {
  constexpr double kTooFarApart = 1e14;
  double largest = 1;
  double smallest = 1;
  for (const ConstRef* M : {&p.A, &p.B, &p.Q, &p.R}) {
    const double size = M->cwiseAbs().maxCoeff();
    largest = std::max(largest, size);
    if (size > 0) smallest = std::min(smallest, size);
  }
  if (largest / smallest < kTooFarApart) return "";
  return fmt::format(
      "; this may be due to rounding: entries reach {:.1g} in A, {:.1g} in B, {:.1g} in Q, {:.1g} "
      "in "
      "R; choose units, weights or a period that bring them closer to 1",
      p.A.cwiseAbs().maxCoeff(), p.B.cwiseAbs().maxCoeff(), p.Q.cwiseAbs().maxCoeff(),
      p.R.cwiseAbs().maxCoeff());
}

void fail(const RiccatiEquation& problem, const Culprit& culprit, RiccatiResult& result) {
  result.status = culprit.status;
  result.culprit = culprit.text + note_on_sizes(problem);
  fill_with_nan(result, problem.A.rows(), problem.B.cols());
}

/// Whether the residual is within the tolerance, or within what the condition of the equation
/// explains.
bool residual_is_small(const Candidate& found, const RiccatiOptions& options) {
  const double unavoidable = std::min(1e-6, 100 * kEps / found.rcond);
  return found.residual <= std::max(options.relative_tolerance, unavoidable);
}

/// Whether a combination of the inputs has neither a weight nor an effect, so that R + B'XB is
/// singular for every X.
bool has_idle_input(const RiccatiEquation& p) {
  const double B = p.B.norm(), R = p.R.norm();
  Eigen::MatrixXd both(p.B.rows() + p.R.rows(), p.B.cols());
  both << p.B / (B > 0 ? B : 1), p.R / (R > 0 ? R : 1);
  const Eigen::VectorXd singular = Eigen::JacobiSVD<Eigen::MatrixXd>(both).singularValues();
  return singular(singular.size() - 1) < 1e-12 * singular(0);
}

Culprit culprit_after_all(const RiccatiEquation& problem, const internal::SchurOutcome& schur,
                          RiccatiProblem kind) {
  const bool continuous = problem.time == Time::continuous;
  if (!continuous && has_idle_input(problem))
    return {
        RiccatiStatus::no_convergence,
        kind == RiccatiProblem::filter
            ? "R + C P C' is singular: a combination of the measurements has no noise and does not "
              "depend on the states"
            : "R + B' S B is singular: a combination of the inputs has no weight and no effect on "
              "the states"};
  const auto on_boundary = [&](std::complex<double> value) {
    return Culprit{
        RiccatiStatus::boundary_pair,
        fmt::format("closed-loop eigenvalue at {} is on the {}", internal::format_mode(value),
                    continuous ? "imaginary axis" : "unit circle")};
  };
  if (continuous && internal::fits_extended(problem.A.rows(), problem.B.cols())) {
    // Other eigenvalues may be 1e7 times as large, so that double precision is insufficient.
    if (const auto value = internal::axis_eigenvalue(problem)) return on_boundary(*value);
  } else {
    constexpr double kOnBoundary = 1e-6;
    if (schur.distance < kOnBoundary) return on_boundary(schur.nearest);
  }
  return {RiccatiStatus::no_convergence,
          "neither doubling nor the Schur method reached the tolerance"};
}

/// "0.7 %", or "6e-05" if that is shorter.
std::string share(double part) {
  if (part >= 1) return "100 % or more";
  return part >= 1e-3 ? fmt::format("{:.2g} %", 100 * part) : fmt::format("{:.1g}", part);
}

/// Empty, or a warning about the sensitivity of the gain to rounding of the matrices.
std::string condition_warning(const RiccatiResult& result, RiccatiProblem problem) {
  if (!(result.rcond < kLowRcond) && !(result.gain_error > kLargeGainError)) return {};
  const std::string what =
      fmt::format("the equation is ill-conditioned (rcond {:.1g}): ", result.rcond);
  if (!std::isfinite(result.gain_error))
    return what + "the rounding of the matrices decides whether a solution exists";
  const char* gain = problem == RiccatiProblem::filter ? "L" : "K";
  if (result.used_extended && result.gain_error < kNoLoss)
    return what + fmt::format(
                      "{} is exact for the matrices as given, and rounding their entries by 1e-16 "
                      "changes it by less than {:.0g} of its norm",
                      gain, kNoLoss);
  if (result.used_extended)
    return what + fmt::format(
                      "{} is exact for the matrices as given, but rounding their entries by 1e-16 "
                      "changes it by about {} of its norm",
                      gain, share(result.gain_error));
  return what + fmt::format("the error of {} may be up to about {} of its norm", gain,
                            share(result.gain_error));
}

}  // namespace

struct RiccatiSolver::State {
  Eigen::Index nx;
  Eigen::Index nu;
  RiccatiOptions options;
  std::unique_ptr<internal::DoublingSolver> doubling;
  internal::CheckBuffers buffers;
  Candidate found;
  RiccatiResult result;

  State(Eigen::Index nx_, Eigen::Index nu_, RiccatiOptions options_)
      : nx(nx_),
        nu(nu_),
        options(std::move(options_)),
        doubling(internal::make_doubling_solver(nx, nu)) {
    buffers.factor_Q.resize(nx, nx);
    buffers.factor_R.resize(nu, nu);
    found.X.resize(nx, nx);
    found.K.resize(nu, nx);
    fill_with_nan(result, nx, nu);
  }

  const RiccatiResult& solve(const RiccatiEquation& problem) {
    result.status = RiccatiStatus::not_run;
    result.used_schur = false;
    result.culprit.clear();
    result.warning.clear();
    result.used_extended = false;
    result.gain_error = std::numeric_limits<double>::quiet_NaN();
    if (result.poles.size() > 0) result.poles.resize(0);
    if (problem.A.rows() != nx || problem.B.cols() != nu) refuse_sizes(problem);
    const WeightR weight_R = internal::check_problem(problem, buffers, result.warning);
    if (options.reject_indefinite_Q && !result.warning.empty())
      throw InvalidInput(internal::equation_name(problem.time), result.warning);
    const bool want_poles = options.evidence == RiccatiEvidence::full;
    if (weight_R == WeightR::well_conditioned && solve_by_doubling(problem)) {
      if (want_poles) result.poles = internal::closed_loop_poles(problem, found.K);
      if (!want_poles || internal::all_stable(problem.time, result.poles)) {
        if (!want_poles || !is_doubtful(problem, weight_R) || !solve_exactly(problem))
          succeed(problem);
        return result;
      }
    }
    solve_slowly(problem, weight_R, want_poles);
    return result;
  }

 private:
  void refuse_sizes(const RiccatiEquation& problem) {
    fill_with_nan(result, nx, nu);
    throw InvalidInput(
        internal::equation_name(problem.time),
        fmt::format("A is {}x{} and B is {}x{}, expected the sizes of this solver, A {}x{} and B "
                    "{}x{}",
                    problem.A.rows(), problem.A.cols(), problem.B.rows(), problem.B.cols(), nx, nx,
                    nx, nu));
  }

  bool solve_by_doubling(const RiccatiEquation& problem) {
    internal::SquaredNorms norms;
    if (!doubling->solve(problem, buffers.factor_R, options, found, norms)) return false;
    found.residual = norms.relative_residual();
    found.rcond = norms.reciprocal_condition();
    return residual_is_small(found, options);
  }

  void succeed(const RiccatiEquation& problem) {
    result.status = RiccatiStatus::solved;
    result.X = found.X;
    result.K = found.K;
    result.residual = found.residual;
    result.rcond = found.rcond;
    result.iterations = found.iterations;
    if (std::isnan(result.gain_error) && result.rcond < kLowRcond)
      result.gain_error = 0.5 * kEps / result.rcond;
    if (options.evidence == RiccatiEvidence::full && options.problem == RiccatiProblem::regulator) {
      if (result.warning.empty()) {
        const std::string cost = internal::cost_indefiniteness(problem);
        if (!cost.empty()) warn(cost + ": the cost of K is stationary, but may not be the minimum");
      }
      if (problem.time == Time::discrete) warn(internal::free_inputs(problem, result.X));
    }
    warn(condition_warning(result, options.problem));
  }

  void warn(const std::string& warning) {
    if (!result.warning.empty() && !warning.empty()) result.warning += "; ";
    result.warning += warning;
  }

  /// Whether the accuracy of `found` is doubtful. The error of X may be residual/rcond; a nearly
  /// singular R amplifies it in K.
  [[nodiscard]] bool is_doubtful(const RiccatiEquation& problem, WeightR weight_R) const {
    if (found.rcond < kDoubtfulRcond || weight_R != WeightR::well_conditioned) return true;
    const double rounding = internal::gain_rounding(problem, found);
    const double error = rounding * std::max(1.0, found.residual / kEps) / found.rcond;
    return !(rounding < kDoubtfulGain && error < kLargeGainError);
  }

  /// Solves in 50 digits if the size permits it.
  bool solve_exactly(const RiccatiEquation& problem) {
    internal::ExtendedSolution exact;
    if (!internal::fits_extended(nx, nu)) return false;
    if (!internal::solve_extended(problem, exact)) {
      result.gain_error = std::numeric_limits<double>::infinity();
      return false;
    }
    found = std::move(exact.candidate);
    result.used_extended = true;
    result.gain_error = exact.gain_error;
    if (options.evidence == RiccatiEvidence::full) result.poles = std::move(exact.poles);
    succeed(problem);
    return true;
  }

  /// A cost that is not positive semidefinite is then the likely cause.
  void give_up(const RiccatiEquation& problem, const Culprit& culprit) {
    fail(problem, culprit, result);
    if (options.problem == RiccatiProblem::regulator && result.warning.empty())
      warn(internal::cost_indefiniteness(problem));
    if (!result.warning.empty()) result.culprit += "; " + result.warning;
  }

  /// First checks whether a solution exists, which the Schur method does not detect.
  void solve_slowly(const RiccatiEquation& problem, WeightR weight_R, bool want_poles) {
    const double rounding = kNoCoupling * static_cast<double>(nx);
    Culprit culprit = internal::find_culprit(problem, rounding, options);
    if (culprit.status != RiccatiStatus::no_convergence) {
      give_up(problem, culprit);
      return;
    }
    const internal::SchurOutcome schur = internal::solve_by_schur(problem, weight_R, found);
    if (schur.found) {
      result.poles = internal::estimate_condition(problem, found);
      if (internal::all_stable(problem.time, result.poles) && residual_is_small(found, options)) {
        if (want_poles && is_doubtful(problem, weight_R) && solve_exactly(problem)) return;
        succeed(problem);
        result.used_schur = true;
        if (!want_poles) result.poles.resize(0);
        return;
      }
    }
    result.poles.resize(0);
    culprit = internal::find_culprit(problem, kWeakCoupling, options);
    if (culprit.status != RiccatiStatus::no_convergence) {
      give_up(problem, culprit);
      return;
    }
    if (solve_exactly(problem)) return;
    give_up(problem, culprit_after_all(problem, schur, options.problem));
  }
};

RiccatiSolver::RiccatiSolver(Eigen::Index nx, Eigen::Index nu, RiccatiOptions options) {
  if (nx < 1 || nu < 1)
    throw InvalidInput("RiccatiSolver",
                       fmt::format("sizes are nx = {}, nu = {}, expected both >= 1", nx, nu));
  check_options(options, nx, "RiccatiSolver");
  state_ = std::make_unique<State>(nx, nu, std::move(options));
}

RiccatiSolver::~RiccatiSolver() = default;
RiccatiSolver::RiccatiSolver(RiccatiSolver&&) noexcept = default;
RiccatiSolver& RiccatiSolver::operator=(RiccatiSolver&&) noexcept = default;

const RiccatiResult& RiccatiSolver::care(const ConstRef& A, const ConstRef& B, const ConstRef& Q,
                                         const ConstRef& R, const ConstRef& N) {
  return state_->solve({Time::continuous, A, B, Q, R, N});
}

const RiccatiResult& RiccatiSolver::dare(const ConstRef& A, const ConstRef& B, const ConstRef& Q,
                                         const ConstRef& R, const ConstRef& N) {
  return state_->solve({Time::discrete, A, B, Q, R, N});
}

namespace {

RiccatiResult solve_once(const RiccatiEquation& problem, const RiccatiOptions& options) {
  const Eigen::Index nx = problem.A.rows();
  const Eigen::Index nu = problem.B.cols();
  if (nx == 0 || nu == 0 || problem.A.cols() != nx) {
    internal::CheckBuffers unused;
    std::string unused_warning;
    internal::check_problem(problem, unused, unused_warning);
  }
  check_options(options, nx, internal::equation_name(problem.time));
  RiccatiSolver solver(nx, nu, options);
  return problem.time == Time::continuous
             ? solver.care(problem.A, problem.B, problem.Q, problem.R, problem.N)
             : solver.dare(problem.A, problem.B, problem.Q, problem.R, problem.N);
}

}  // namespace

RiccatiResult care(const ConstRef& A, const ConstRef& B, const ConstRef& Q, const ConstRef& R,
                   const ConstRef& N, const RiccatiOptions& options) {
  return solve_once({Time::continuous, A, B, Q, R, N}, options);
}

RiccatiResult dare(const ConstRef& A, const ConstRef& B, const ConstRef& Q, const ConstRef& R,
                   const ConstRef& N, const RiccatiOptions& options) {
  return solve_once({Time::discrete, A, B, Q, R, N}, options);
}

constexpr internal::EnumName<RiccatiStatus> kRiccatiStatuses[] = {
    {RiccatiStatus::not_run, "not run"},
    {RiccatiStatus::solved, "solved"},
    {RiccatiStatus::not_stabilizable, "not stabilizable"},
    {RiccatiStatus::not_detectable, "not detectable"},
    {RiccatiStatus::boundary_pair, "eigenvalues on the boundary"},
    {RiccatiStatus::no_convergence, "no convergence"}};

std::string to_string(RiccatiStatus status) { return internal::name_in(kRiccatiStatuses, status); }

std::ostream& operator<<(std::ostream& out, const RiccatiResult& result) {
  out << to_string(result.status);
  if (!result.culprit.empty()) out << " (" << result.culprit << ")";
  if (result.solved())
    out << fmt::format(", residual {:.2g}, rcond {:.2g}, {}", result.residual, result.rcond,
                       result.used_extended ? "50 digits"
                       : result.used_schur  ? "Schur method"
                                            : fmt::format("{} doublings", result.iterations));
  return out;
}

}  // namespace quadtune
