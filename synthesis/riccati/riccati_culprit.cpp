// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "lyapunov/eigenvalues.hpp"
#include "lyapunov/lapack.hpp"
#include "lyapunov/mode_names.hpp"
#include "riccati/riccati_parts.hpp"

namespace quadtune::internal {
namespace {

/// The uncontrollable part of (A, B): rows of P are orthonormal, P A = F P and P B = 0.
struct Unreachable {
  Eigen::MatrixXd P;
  Eigen::MatrixXd F;
  double size;  ///< ‖A‖, relative to which eigenvalues of F are regarded as 0
};

/// Computes the staircase form by singular values (Paige 1981; Van Dooren 1981). Unlike a rank test
/// at computed eigenvalues, it is reliable for repeated ones, which rounding scatters.
Unreachable unreachable_part(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, double tolerance) {
  const Eigen::Index n = A.rows();
  Eigen::MatrixXd P = Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd F = A;
  Eigen::MatrixXd entry = B;
  double threshold = tolerance * B.norm();
  while (F.rows() > 0) {
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(entry, Eigen::ComputeFullU);
    const Eigen::Index rank = (svd.singularValues().array() > threshold).count();
    if (rank == 0) break;
    const Eigen::MatrixXd& U = svd.matrixU();
    const Eigen::Index rest = F.rows() - rank;
    const Eigen::MatrixXd turned = U.transpose() * F * U;
    P = (U.transpose() * P).bottomRows(rest).eval();
    entry = turned.bottomLeftCorner(rest, rank);
    F = turned.bottomRightCorner(rest, rest).eval();
    threshold = tolerance * A.norm();
  }
  return {P, F, A.norm()};
}

thread_local std::complex<double> wanted;
thread_local double within;
lapack_logical in_cluster(const double* real, const double* imaginary) {
  return std::abs(std::complex<double>(*real, std::abs(*imaginary)) - wanted) <= within ||
         std::abs(std::complex<double>(*real, -std::abs(*imaginary)) - wanted) <= within;
}

/// A mode that prevents a solution, and its dominant states.
struct Mode {
  bool found = false;
  std::complex<double> value;
  std::vector<std::string> states;
};

double excess(Time time, std::complex<double> value) {
  return time == Time::continuous ? value.real() : std::abs(value) - 1;
}

/// Lists the states with the largest entries in the invariant subspace of the cluster around
/// `member`.
void name_states(const Unreachable& part, std::complex<double> member, double width,
                 const std::vector<std::string>& names, Mode& mode) {
  const auto k = static_cast<lapack_int>(part.F.rows());
  Eigen::MatrixXd T = part.F.transpose();
  Eigen::MatrixXd U(k, k);
  Eigen::VectorXd real(k);
  Eigen::VectorXd imaginary(k);
  lapack_int chosen = 0;
  wanted = {member.real(), std::abs(member.imag())};
  within = width;
  LAPACKE_dgees(LAPACK_COL_MAJOR, 'V', 'S', in_cluster, k, T.data(), k, &chosen, real.data(),
                imaginary.data(), U.data(), k);
  const Eigen::MatrixXd carriers = part.P.transpose() * U.leftCols(std::max<lapack_int>(chosen, 1));
  const Eigen::VectorXd weight = carriers.rowwise().norm();
  constexpr double kCarries = 0.3;
  for (Eigen::Index i = 0; i < weight.size(); ++i)
    if (weight[i] >= kCarries * weight.maxCoeff())
      mode.states.push_back(names.empty() ? fmt::format("state {}", i + 1)
                                          : names[static_cast<std::size_t>(i)]);
}

/// Mean of the eigenvalues within `width` of value or, if that is near the real axis, of its
/// conjugate: the mean of a multiple eigenvalue that rounding has scattered is much more accurate
/// than its members.
std::complex<double> cluster_mean(const Eigen::VectorXcd& values, std::complex<double> value,
                                  double width) {
  std::complex<double> sum = 0;
  double count = 0;
  for (const std::complex<double>& other : values) {
    if (std::abs(other - value) > width && std::abs(std::conj(other) - value) > width) continue;
    sum += value.imag() < 0 ? std::complex<double>(other.real(), -std::abs(other.imag()))
                            : std::complex<double>(other.real(), std::abs(other.imag()));
    ++count;
  }
  const std::complex<double> mean = sum / count;
  return std::abs(value.imag()) <= width ? std::complex<double>(mean.real(), 0) : mean;
}

/// Searches for an eigenvalue of `part` on the boundary or, with `beyond`, also outside.
Mode find_mode(Time time, const Unreachable& part, bool beyond, double boundary,
               const std::vector<std::string>& names) {
  const double size = time == Time::continuous ? part.size : 1.0;
  const double near = boundary * size;
  const double tight = std::max(100 * near, 1e-300);
  const double wide = std::max(1e-3 * size, tight);
  const Eigen::VectorXcd values = eigenvalues(part.F);
  Mode mode;
  std::complex<double> member;
  double width = tight;
  double worst = -std::numeric_limits<double>::infinity();
  for (const std::complex<double>& value : values) {
    const std::complex<double> mean = cluster_mean(values, value, wide);
    const bool scattered = std::abs(excess(time, mean)) <= near;
    const std::complex<double> judged = scattered ? mean : value;
    const double out = excess(time, judged);
    if (out < -near || (!beyond && out > near) || out <= worst) continue;
    worst = out;
    member = value;
    width = scattered ? wide : tight;
    mode.value = judged;
    mode.found = true;
  }
  if (!mode.found) return mode;
  const auto snapped = [&](double x) { return std::abs(x) <= 10 * near ? 0 : x; };
  const double real = mode.value.real();
  mode.value = {time == Time::continuous ? snapped(real) : real, snapped(mode.value.imag())};
  name_states(part, member, width, names, mode);
  return mode;
}

/// The problem in scaled states.
PlainProblem scaled(const PlainProblem& p, const Eigen::VectorXd& d) {
  const Eigen::VectorXd e = d.cwiseInverse();
  return {e.asDiagonal() * p.A * d.asDiagonal(), e.asDiagonal() * p.B,
          d.asDiagonal() * p.Q * d.asDiagonal()};
}

/// Scales M to the norm of A. A common factor does not affect controllability or observability.
Eigen::MatrixXd as_large_as(const Eigen::MatrixXd& A, const Eigen::MatrixXd& M) {
  const double largest = M.cwiseAbs().maxCoeff();
  if (largest == 0) return M;
  const Eigen::MatrixXd unit = M / largest;
  return unit * (std::max(A.norm(), std::numeric_limits<double>::min()) / unit.norm());
}

/// Repeats the test of controllability in the caller's units and without the magnitudes of the
/// weights, because extreme weights make couplings look like rounding errors. is_unseen() does the
/// same for observability through Q.
bool is_unsteered(const RiccatiEquation& p, const Eigen::MatrixXd& A, double tolerance,
                  double boundary) {
  const Unreachable part = unreachable_part(A, as_large_as(A, p.B), tolerance);
  return find_mode(p.time, part, true, boundary, {}).found;
}
bool is_unseen(const RiccatiEquation& p, const PlainProblem& plain, double tolerance,
               double boundary) {
  const Unreachable part =
      unreachable_part(plain.A.transpose(), as_large_as(plain.A, plain.Q), tolerance);
  return find_mode(p.time, part, false, boundary, {}).found;
}

}  // namespace

Culprit find_culprit(const RiccatiEquation& p, double tolerance, const RiccatiOptions& options) {
  const PlainProblem plain = without_cross_term(p);
  const PlainProblem in_scale =
      scaled(plain, balancing(plain.A, plain.B * plain.B.transpose(), plain.Q));
  const bool filter = options.problem == RiccatiProblem::filter;
  const double boundary = std::max(1e-8, std::sqrt(tolerance));
  const char* const plane = p.time == Time::discrete ? "z = " : "";
  const auto sentence = [&](const Mode& mode, const std::string& why) {
    return fmt::format("mode at {}{}: {}{} {}", plane, format_mode(mode.value),
                       mode.states.size() == 1 ? "" : "a combination of ", join_names(mode.states),
                       why);
  };
  const Mode unsteered = find_mode(p.time, unreachable_part(in_scale.A, in_scale.B, tolerance),
                                   true, boundary, options.state_names);
  if (unsteered.found && is_unsteered(p, plain.A, tolerance, boundary))
    return {RiccatiStatus::not_stabilizable,
            sentence(unsteered,
                     filter ? "cannot be observed by the measurements" : "cannot be controlled")};
  const Mode unseen =
      find_mode(p.time, unreachable_part(in_scale.A.transpose(), in_scale.Q, tolerance), false,
                boundary, options.state_names);
  if (unseen.found && is_unseen(p, plain, tolerance, boundary))
    return {
        RiccatiStatus::not_detectable,
        sentence(unseen, filter ? "is not driven by the noise" : "is not observable through Q")};
  return {};
}

}  // namespace quadtune::internal
