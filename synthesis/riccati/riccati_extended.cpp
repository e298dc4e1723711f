// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include "riccati/extended_matrix.hpp"
#include "riccati/riccati_parts.hpp"
#include "riccati/riccati_scaling.hpp"

namespace quadtune::internal {
namespace {

using Matrix = ExtendedMatrix;
using Eigen::Index;
using Eigen::MatrixXd;

/// The problem in 50 digits; N is empty for zero.
struct Problem {
  Time time;
  Matrix A, B, Q, R, N;

  [[nodiscard]] bool continuous() const { return time == Time::continuous; }
};

struct Solution {
  Matrix X;
  Matrix K;
};

Problem extended(const RiccatiEquation& p) {
  return {p.time,      Matrix(p.A), Matrix(p.B),
          Matrix(p.Q), Matrix(p.R), p.has_cross_term() ? Matrix(p.N) : Matrix()};
}

/// K = S⁻¹ F with S = R, F = BᵀX + Nᵀ, or, discrete, S = R + BᵀXB, F = BᵀXA + Nᵀ. S need
/// only be regular: if R is tiny, a Q that is indefinite by rounding may make S indefinite, too.
bool gain(const Problem& p, Solution& at) {
  const Matrix BtX = p.B.transpose() * at.X;
  Matrix F = p.continuous() ? BtX : BtX * p.A;
  if (!p.N.empty()) F += p.N.transpose();
  if (p.continuous()) {
    const ExtendedCholesky R(p.R);
    if (!R.positive_definite()) return false;
    at.K = R.solve(F);
  } else {
    at.K = ExtendedLu(symmetric(p.R + BtX * p.B)).solve(F);
  }
  return at.K.is_finite();
}

/// AᵀX + XA - F K + Q with F = XB + N, or AᵀXA - X - F K + Q with F = AᵀXB + N.
Matrix residual(const Problem& p, const Solution& at) {
  const Matrix XA = at.X * p.A;
  Matrix F = p.continuous() ? at.X * p.B : XA.transpose() * p.B;
  if (!p.N.empty()) F += p.N;
  const Matrix rest = p.Q - F * at.K;
  if (p.continuous()) return symmetric(XA + XA.transpose() + rest);
  return symmetric(p.A.transpose() * XA - at.X + rest);
}

/// Same as RiccatiResult::residual.
double relative_residual(const Problem& p, const Solution& at) {
  const Real size = residual(p, at).norm();
  if (size == 0) return 0;
  const Matrix XA = at.X * p.A;
  Matrix F = p.continuous() ? at.X * p.B : XA.transpose() * p.B;
  if (!p.N.empty()) F += p.N;
  const Real shared = (F * at.K).norm() + p.Q.norm();
  const Real terms = p.continuous() ? Real(2 * XA.norm() + shared)
                                    : Real((p.A.transpose() * XA).norm() + at.X.norm() + shared);
  return Real(size / terms).convert_to<double>();
}

/// Solves the Lyapunov equation of the closed loop for each of `sums` in place by squaring (Smith
/// 1968).
/// @return  false if the powers do not converge to 0, i.e. the loop is not stable
bool solve_lyapunov(const Problem& p, const Matrix& K, const Real& gamma,
                    std::initializer_list<Matrix*> sums) {
  const Index n = p.A.rows();
  Matrix E = p.A - p.B * K;
  if (p.continuous()) {
    E.add_to_diagonal(-gamma);
    const Matrix F = ExtendedLu(E).inverse();
    if (!F.is_finite()) return false;
    E = 2 * gamma * F;
    E.add_to_diagonal(1);
    for (Matrix* M : sums) *M = 2 * gamma * (F.transpose() * *M * F);
  }
  constexpr int kMaxSquarings = 80;
  const Real vanished("1e-26");  // the next term is of the size of its square
  const Real hopeless("1e60");
  for (int i = 0; i < kMaxSquarings; ++i) {
    const Real size = E.norm();
    if (!(size < hopeless)) return false;
    if (size <= vanished) return true;
    for (Matrix* M : sums) *M += E.transpose() * *M * E;
    E = E * E;
  }
  return n == 0;
}

/// Newton–Kleinman iteration from a stabilizing K until K changes by rounding errors at most. The
/// last closed loop is proved to be stable.
bool refine(const Problem& p, const Real& gamma, Solution& at) {
  constexpr int kMaxSteps = 60;
  const Real stands("1e-24");
  const Real rounding("1e-17");
  Real before = 1;
  for (int step = 0; step < kMaxSteps; ++step) {
    Matrix correction = residual(p, at);
    if (!solve_lyapunov(p, at.K, gamma, {&correction})) return false;
    Solution next;
    next.X = symmetric(at.X + correction);
    if (!gain(p, next)) return false;
    const Real size = next.K.norm();
    const Real change = size > 0 ? Real((next.K - at.K).norm() / size) : Real(0);
    at = std::move(next);
    if (change <= stands || (change <= rounding && change > before / 2))
      return solve_lyapunov(p, at.K, gamma, {});
    before = change;
  }
  return false;
}

/// The equation without its cross term and in scaled states, with R and Q increased by `lift` of
/// their norms: this makes a singular R invertible, and every mode observable through Q.
struct Plain {
  Matrix A, G, Q;
};
bool plain_problem(const Problem& p, const Eigen::VectorXd& d, const Real& lift, Plain& plain) {
  Matrix R = symmetric(p.R);
  Real size_R = R.norm();
  // Q weights the inputs after one step or, if BᵀQB is 0, after several.
  if (!p.continuous()) size_R += p.B.squared_norm() * p.Q.norm();
  R.add_to_diagonal(lift * size_R);
  const ExtendedCholesky factor(R);
  if (!factor.positive_definite()) return false;
  const Matrix Rinv_Bt = factor.solve(p.B.transpose());
  plain.A = p.A;
  plain.Q = p.Q;
  if (!p.N.empty()) {
    plain.A -= Rinv_Bt.transpose() * p.N.transpose();
    plain.Q -= p.N * factor.solve(p.N.transpose());
  }
  const Matrix D = Matrix::diagonal(d);
  const Matrix Dinv = Matrix::diagonal(d.cwiseInverse());
  plain.A = Dinv * plain.A * D;
  plain.G = symmetric(Dinv * (p.B * Rinv_Bt) * Dinv);
  plain.Q = symmetric(D * plain.Q * D);
  plain.Q.add_to_diagonal(lift * (plain.Q.norm() + (lift > 0 ? plain.A.norm() : Real(0))));
  return plain.A.is_finite() && plain.G.is_finite() && plain.Q.is_finite();
}

/// Cayley transform at γ; see DoublingSteps::cayley().
bool cayley(const Plain& p, const Real& gamma, Matrix& E, Matrix& G, Matrix& H) {
  const Index n = p.A.rows();
  const Matrix A_gamma = p.A - gamma * Matrix::identity(n);
  const Matrix V = ExtendedLu(A_gamma).inverse();
  const Matrix QV = p.Q * V;
  const Matrix W_inverse = ExtendedLu(A_gamma.transpose() + QV * p.G).inverse();
  E = Matrix::identity(n) + 2 * gamma * W_inverse.transpose();
  G = symmetric(2 * gamma * (V * p.G * W_inverse));
  H = symmetric(2 * gamma * (W_inverse * QV));
  return E.is_finite() && G.is_finite() && H.is_finite();
}

/// Doubling; see DoublingSteps::iterate(). On return H is the X of the scaled problem.
/// @param steps_left  reduced by the number of steps
bool double_up(Matrix& E, Matrix& G, Matrix& H, int& iterations, int& steps_left) {
  constexpr int kMaxIterations = 70;
  const Real stands("1e-20");
  const Index n = E.rows();
  for (iterations = 1; iterations <= kMaxIterations && steps_left > 0; ++iterations) {
    --steps_left;
    const ExtendedLu W(Matrix::identity(n) + G * H);
    const Matrix V = W.solve(E);
    const Matrix change = symmetric(E.transpose() * (H * V));
    H += change;
    if (!H.is_finite()) return false;
    if (change.norm() <= stands * H.norm()) return true;
    G += symmetric(E * W.solve(G) * E.transpose());
    E = E * V;
  }
  return false;
}

/// Computes a γ between the slow and the fast poles; see GeometricSpeed.
double speed(const Plain& p) {
  GeometricSpeed speed;
  const MatrixXd A = p.A.rounded();
  const MatrixXd G = p.G.rounded();
  const MatrixXd Q = p.Q.rounded();
  for (Index i = 0; i < A.rows(); ++i) {
    speed.add(A.row(i).squaredNorm() + G.row(i).squaredNorm(),
              A.row(i).lpNorm<1>() + G.row(i).lpNorm<1>());
    speed.add(A.col(i).squaredNorm() + Q.col(i).squaredNorm(),
              A.col(i).lpNorm<1>() + Q.col(i).lpNorm<1>());
  }
  const double value = speed.value();
  return std::isfinite(value) && value > 0 ? value : 1.0;
}

/// Perturbs every entry by one rounding, randomly up or down.
class Rounding {
 public:
  Matrix of(const Matrix& M, bool symmetric_too) {
    Matrix moved = M;
    for (Index j = 0; j < M.cols(); ++j)
      for (Index i = 0; i < M.rows(); ++i) {
        if (symmetric_too && i < j) {
          moved(i, j) = moved(j, i);  // perturbed before, with column i
          continue;
        }
        moved(i, j) *= Real(1) + Real(random_() % 2 == 0 ? kHalfUnit : -kHalfUnit);
      }
    return moved;
  }

 private:
  static constexpr double kHalfUnit = 0x1p-53;
  std::mt19937_64 random_{1};
};

/// Estimates ‖δK‖/‖K‖ under random roundings of all entries of the problem: the maximum of a few
/// trials, each to first order by one Newton step. Infinite if the rounding decides whether a
/// solution exists.
double change_by_rounding(const Problem& p, const Real& gamma, const Solution& at) {
  constexpr int kTrials = 3;
  const Real size = at.K.norm();
  if (size == 0) return 0;
  Rounding rounding;
  double largest = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Problem moved{p.time,
                        rounding.of(p.A, false),
                        rounding.of(p.B, false),
                        rounding.of(p.Q, true),
                        rounding.of(p.R, true),
                        rounding.of(p.N, false)};
    Solution there = at;
    Matrix correction = residual(moved, there);
    if (!solve_lyapunov(moved, there.K, gamma, {&correction}))
      return std::numeric_limits<double>::infinity();
    there.X += correction;
    if (!gain(moved, there)) return std::numeric_limits<double>::infinity();
    largest = std::max(largest, Real((there.K - at.K).norm() / size).convert_to<double>());
  }
  return largest;
}

double rcond_of(const RiccatiEquation& equation, const Problem& p, const Real& gamma,
                const Solution& at) {
  const Index n = p.A.rows();
  Matrix h0 = Matrix::identity(n);
  const Matrix XAc = p.continuous() ? at.X : at.X * (p.A - p.B * at.K);
  Matrix h2 = XAc.transpose() * XAc;
  if (!solve_lyapunov(p, at.K, gamma, {&h0, &h2})) return std::numeric_limits<double>::min();
  const PlainProblem plain = without_cross_term(equation);
  SquaredNorms norms;
  norms.A = plain.A.squaredNorm();
  norms.G = (plain.B * plain.B.transpose()).squaredNorm();
  norms.Q = plain.Q.squaredNorm();
  norms.X = at.X.squared_norm().convert_to<double>();
  norms.h0 = h0.squared_norm().convert_to<double>();
  norms.h2 = h2.squared_norm().convert_to<double>();
  return norms.reciprocal_condition();
}

/// Solves the problem that is lifted by `lift` by doubling, then applies Newton steps to the
/// problem itself.
bool solve_lifted(const Problem& p, const Eigen::VectorXd& d, const Real& lift, Real& gamma,
                  Solution& at, int& iterations, int& steps_left) {
  Plain plain;
  if (!plain_problem(p, d, lift, plain)) return false;
  Matrix E = plain.A;
  Matrix G = plain.G;
  Matrix H = plain.Q;
  gamma = p.continuous() ? Real(speed(plain)) : Real(1);
  if (p.continuous() && !cayley(plain, gamma, E, G, H)) {
    gamma *= Real(1.6);
    if (!cayley(plain, gamma, E, G, H)) return false;
  }
  if (!double_up(E, G, H, iterations, steps_left)) return false;
  const Matrix Dinv = Matrix::diagonal(d.cwiseInverse());
  at.X = Dinv * H * Dinv;
  return gain(p, at) && refine(p, gamma, at);
}

/// Maximum number of doubling steps of all attempts together. A step costs O(n³): up to 16 states
/// the limit has no effect; with 40 states it suffices for one attempt.
int affordable_steps(Index n) {
  const double states = static_cast<double>(std::max<Index>(n, 1));
  return static_cast<int>(std::clamp(420 * std::pow(16 / states, 3), 40.0, 420.0));
}

}  // namespace

bool fits_extended(Index nx, Index nu) { return std::max(nx, nu) <= 40; }

bool solve_extended(const RiccatiEquation& equation, ExtendedSolution& found) {
  Problem p = extended(equation);
  const PlainProblem plain = without_cross_term(equation);
  const Eigen::VectorXd d = balancing(plain.A, plain.B * plain.B.transpose(), plain.Q);
  Candidate& candidate = found.candidate;
  Solution at;
  Real gamma;
  int steps_left = affordable_steps(p.A.rows());
  const auto solve = [&] {
    // The last lift is for an R that has a negative eigenvalue by rounding.
    for (const char* lift : {"0", "1e-24", "1e-15"})
      if (solve_lifted(p, d, Real(lift), gamma, at, candidate.iterations, steps_left)) return true;
    return false;
  };
  bool decided_by_rounding = false;
  if (!solve()) {
    // The negative eigenvalues of Q due to rounding may be as large as a tiny R.
    const double rounding =
        std::numeric_limits<double>::epsilon() * static_cast<double>(p.A.rows());
    p.Q.add_to_diagonal(rounding * p.Q.norm());
    decided_by_rounding = true;
    if (!solve()) return false;
  }
  candidate.X = at.X.rounded();
  candidate.K = at.K.rounded();
  if (!candidate.X.allFinite() || !candidate.K.allFinite()) return false;
  // K is returned in double precision: the loop of the rounded K must be stable, too.
  const Solution rounded{Matrix(candidate.X), Matrix(candidate.K)};
  if (!solve_lyapunov(p, rounded.K, gamma, {})) return false;
  candidate.residual = relative_residual(p, rounded);
  candidate.rcond = rcond_of(equation, p, gamma, at);
  found.gain_error = decided_by_rounding ? std::numeric_limits<double>::infinity()
                                         : change_by_rounding(p, gamma, at);
  found.poles = eigenvalues(p.A - p.B * rounded.K);
  return found.poles.size() > 0;
}

std::optional<std::complex<double>> axis_eigenvalue(const RiccatiEquation& equation) {
  if (equation.time != Time::continuous) return {};
  const Problem p = extended(equation);
  const PlainProblem rounded = without_cross_term(equation);
  const Eigen::VectorXd d = balancing(rounded.A, rounded.B * rounded.B.transpose(), rounded.Q);
  Plain plain;
  if (!plain_problem(p, d, Real(0), plain)) return {};
  const Index n = plain.A.rows();
  Matrix H(2 * n, 2 * n);
  H.set_block(0, 0, plain.A);
  H.set_block(0, n, -plain.G);
  H.set_block(n, 0, -plain.Q);
  H.set_block(n, n, -plain.A.transpose());
  // Rounding scatters a multiple eigenvalue at 0 over a root of 1e-50, relative to ‖H‖.
  const double scatter = 1e-10 * H.norm().convert_to<double>();
  for (const std::complex<double>& value : eigenvalues(H))
    if (std::abs(value.real()) <= 1e-10 * (std::abs(value) + scatter))
      return std::complex<double>(0, std::abs(value.imag()) <= scatter ? 0 : value.imag());
  return {};
}

}  // namespace quadtune::internal
