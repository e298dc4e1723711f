// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "lyapunov/schur_lyapunov.hpp"
#include "riccati/riccati_parts.hpp"
#include "riccati/riccati_scaling.hpp"

namespace quadtune::internal {
namespace {

/// Cholesky factor of R. If R is singular, 1e-8 of its norm is first added to its diagonal, which
/// preserves controllability.
Eigen::MatrixXd cholesky_or_nearby(const ConstRef& R) {
  const Eigen::LLT<Eigen::MatrixXd> exact(R);
  if (exact.info() == Eigen::Success) return exact.matrixL();
  const double size = R.cwiseAbs().maxCoeff();
  Eigen::MatrixXd nearby = R;
  nearby.diagonal().array() += size > 0 ? 1e-8 * size : 1.0;
  return Eigen::LLT<Eigen::MatrixXd>(nearby).matrixL();
}

}  // namespace

PlainProblem without_cross_term(const RiccatiEquation& p) {
  const Eigen::MatrixXd L = cholesky_or_nearby(p.R);
  const auto lower = L.triangularView<Eigen::Lower>();
  PlainProblem plain{p.A, lower.solve(p.B.transpose()).transpose(), p.Q};
  if (p.has_cross_term()) {
    const Eigen::MatrixXd Ns = lower.solve(p.N.transpose()).transpose();
    plain.A -= plain.B * Ns.transpose();
    plain.Q -= Ns * Ns.transpose();
  }
  return plain;
}

Eigen::VectorXd balancing(const Eigen::MatrixXd& A, const Eigen::MatrixXd& G,
                          const Eigen::MatrixXd& Q) {
  const Eigen::Index n = A.rows();
  const Eigen::MatrixXd columns = A.cwiseAbs();
  const Eigen::MatrixXd rows = columns.transpose();
  const Eigen::MatrixXd absolute_G = G.cwiseAbs();
  const Eigen::MatrixXd absolute_Q = Q.cwiseAbs();
  Eigen::VectorXd scale(n);
  Eigen::VectorXd inverse(n);
  const auto dot = [n](const double* a, const double* b) {
    return Eigen::Map<const Eigen::VectorXd>(a, n).dot(Eigen::Map<const Eigen::VectorXd>(b, n));
  };
  level_scales(rows.data(), columns.data(), absolute_G.data(), absolute_Q.data(), n, n,
               scale.data(), inverse.data(), dot);
  return scale;
}

ResidualTerms residual_terms(const RiccatiEquation& p, const Eigen::MatrixXd& X,
                             const Eigen::MatrixXd& K) {
  ResidualTerms terms;
  const Eigen::MatrixXd XA = X * p.A;
  if (p.time == Time::continuous) {
    Eigen::MatrixXd F = X * p.B;  // XB + N
    if (p.has_cross_term()) F += p.N;
    const Eigen::MatrixXd FK = F * K;
    terms.residual = XA + XA.transpose() - FK + p.Q;
    terms.scale = 2 * XA.norm() + FK.norm() + p.Q.norm();
  } else {
    const Eigen::MatrixXd AXA = p.A.transpose() * XA;
    Eigen::MatrixXd F = XA.transpose() * p.B;  // AᵀXB + N
    if (p.has_cross_term()) F += p.N;
    const Eigen::MatrixXd FK = F * K;
    terms.residual = AXA - X - FK + p.Q;
    terms.scale = AXA.norm() + X.norm() + FK.norm() + p.Q.norm();
  }
  return terms;
}

bool evaluate(const RiccatiEquation& p, Candidate& candidate) {
  const Eigen::MatrixXd& X = candidate.X;
  Eigen::MatrixXd S = p.R;
  Eigen::MatrixXd F = p.B.transpose() * X;
  if (p.time == Time::discrete) {
    S += F * p.B;
    F = (F * p.A).eval();
  }
  if (p.has_cross_term()) F += p.N.transpose();
  const Eigen::LLT<Eigen::MatrixXd> llt(0.5 * (S + S.transpose()));
  if (llt.info() != Eigen::Success) return false;
  candidate.K = llt.solve(F);
  const ResidualTerms terms = residual_terms(p, X, candidate.K);
  const double size = terms.residual.norm();
  candidate.residual = size == 0 ? 0 : size / terms.scale;
  return std::isfinite(candidate.residual) && candidate.K.allFinite();
}

double gain_rounding(const RiccatiEquation& p, const Candidate& solution) {
  const Eigen::MatrixXd Bt = p.B.transpose();
  Eigen::MatrixXd S = p.R;
  Eigen::MatrixXd F = Bt.cwiseAbs() * solution.X.cwiseAbs();
  if (p.time == Time::discrete) {
    S += Bt * solution.X * p.B;
    F = (F * p.A.cwiseAbs()).eval();
  }
  if (p.has_cross_term()) F += p.N.transpose().cwiseAbs();
  const double error = (S.partialPivLu().inverse().cwiseAbs() * F).norm();
  const double size = solution.K.norm();
  return error == 0 ? 0 : std::numeric_limits<double>::epsilon() * error / size;
}

void refine_by_newton(const RiccatiEquation& p, Candidate& candidate) {
  constexpr int kMaxSteps = 12;
  for (int step = 0; step < kMaxSteps; ++step) {
    const SchurLyapunov closed_loop(p.time, p.A - p.B * candidate.K);
    if (!closed_loop.ok()) return;
    Eigen::MatrixXd residual = residual_terms(p, candidate.X, candidate.K).residual;
    residual = (0.5 * (residual + residual.transpose())).eval();
    const Eigen::MatrixXd correction = closed_loop.solve_transposed(residual);
    if (!correction.allFinite()) return;
    bool improved = false;
    Candidate next = candidate;
    for (double length = 1; length > 0.05 && !improved; length /= 2) {
      next.X = candidate.X + 0.5 * length * (correction + correction.transpose());
      improved = evaluate(p, next) && next.residual < candidate.residual;
    }
    if (!improved) return;
    const bool paid = next.residual < 0.5 * candidate.residual;
    candidate = next;
    if (!paid) return;
  }
}

}  // namespace quadtune::internal
