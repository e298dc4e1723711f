// SPDX-License-Identifier: Apache-2.0
/// Riccati equations in 100 digits, by an algorithm that the library does not use.
#pragma once

#include <Eigen/LU>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>
#include <optional>
#include <utility>

#include "plants/riccati_problems.hpp"

namespace quadtune::testing {

using LongReal = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<100>,
                                               boost::multiprecision::et_off>;
using LongMatrix = Eigen::Matrix<LongReal, Eigen::Dynamic, Eigen::Dynamic>;

/// A RiccatiCase in 100 digits; N is never empty.
struct LongRiccatiCase {
  LongMatrix A, B, Q, R, N;

  explicit LongRiccatiCase(const RiccatiCase& c)
      : A(c.A.cast<LongReal>()),
        B(c.B.cast<LongReal>()),
        Q(c.Q.cast<LongReal>()),
        R(c.R.cast<LongReal>()),
        N(LongMatrix::Zero(c.B.rows(), c.B.cols())) {
    if (c.N.size() > 0) N = c.N.cast<LongReal>();
  }
};

struct LongRiccatiSolution {
  LongMatrix X, K;
};

/// The evaluation of a gain with 100 digits.
struct RiccatiJudgement {
  bool stabilizes = false;  ///< A - B K is stable
  /// The stabilizing solution, if it exists.
  std::optional<LongRiccatiSolution> exact;
};

/// Solves A_cᵀX + X A_c + M = 0, or A_cᵀX A_c - X + M = 0, by squaring, in place. Returns false if
/// the powers do not vanish, i.e. A_c is not stable.
inline bool solve_long_lyapunov(const LongMatrix& Ac, bool discrete, LongMatrix& M) {
  const Eigen::Index n = Ac.rows();
  LongMatrix E = Ac;
  if (!discrete) {
    const LongReal gamma = boost::multiprecision::sqrt(Ac.norm());
    E.diagonal().array() -= gamma;
    const LongMatrix F = E.partialPivLu().inverse();
    E = LongReal(2) * gamma * F + LongMatrix::Identity(n, n);
    M = (LongReal(2) * gamma * (F.transpose() * M * F)).eval();
  }
  for (int i = 0; i < 120; ++i) {
    const LongReal size = E.norm();
    if (size < LongReal("1e-55")) return true;
    if (!(size < LongReal("1e80"))) return false;
    M += (E.transpose() * M * E).eval();
    E = (E * E).eval();
  }
  return false;
}

/// Kleinman's iteration (1968; Hewer 1971), which converges from a stabilizing gain to that of the
/// stabilizing solution, if there is one.
inline RiccatiJudgement by_100_digits(const LongRiccatiCase& c, bool discrete, LongMatrix K) {
  RiccatiJudgement judgement;
  for (int step = 0; step < 300; ++step) {
    const LongMatrix NK = c.N * K;
    LongMatrix X = c.Q + K.transpose() * c.R * K - NK - NK.transpose();
    if (!solve_long_lyapunov(c.A - c.B * K, discrete, X)) return judgement;
    judgement.stabilizes = true;
    LongMatrix S = c.R;
    LongMatrix F = c.B.transpose() * X;
    if (discrete) {
      S += F * c.B;
      F = (F * c.A).eval();
    }
    const LongMatrix next = S.partialPivLu().solve(F + c.N.transpose());
    const bool stands = (next - K).norm() <= LongReal("1e-35") * next.norm();
    K = next;
    if (stands) {
      judgement.exact = LongRiccatiSolution{std::move(X), std::move(K)};
      return judgement;
    }
  }
  return judgement;
}

}  // namespace quadtune::testing
