// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/van_loan.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/exponential_kernel.hpp"
#include "methods/period.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using MatrixArgument = Eigen::Ref<const MatrixXd>;

// With ‖Z h‖ ≤ 1/2 the n-th term of both series below is at most 1/n! of the first.
constexpr double kSeriesNorm = 0.5;
constexpr int kTerms = 20;

double infinity_norm(const MatrixXd& M) { return M.cwiseAbs().rowwise().sum().maxCoeff(); }

// e^X - I for ‖X‖ ≤ kSeriesNorm.
MatrixXd exponential_minus_identity(const MatrixXd& X) {
  MatrixXd F = X;
  MatrixXd term = X;
  for (int k = 2; k <= kTerms; ++k) {
    term = (term * X / k).eval();
    F += term;
  }
  return F;
}

// W = ∫₀^T e^(Zᵀτ) Y e^(Zτ) dτ, symmetric.
//
// Van Loan obtains W from the exponential of [-Zᵀ Y; 0 Z] T. Its block e^(-ZᵀT) grows as e^(ZT)
// decays, so the digits of W are lost. Instead, the period is halved until ‖Z h‖ ≤ 1/2, where the
// series
//   W(h) = h Σ Lᵏ(Y) hᵏ / (k+1)!,  L(Y) = ZᵀY + YZ
// is as accurate as his method and cheaper; then it is doubled:
//   W(2h) = W + e^(Zᵀh) W e^(Zh) = 2W + FᵀW + WF + FᵀWF,  F = e^(Zh) - I.
// For Y ≥ 0 every step adds matrices that are ≥ 0.
MatrixXd integrate(const MatrixXd& Z, const MatrixXd& Y, double T) {
  double h = T;
  int halvings = 0;
  for (double size = infinity_norm(Z) * T; size > kSeriesNorm && std::isfinite(size); size /= 2) {
    h /= 2;
    ++halvings;
  }
  const MatrixXd X = Z * h;
  MatrixXd term = Y * h;  // stays symmetric: a matrix plus its own transpose
  MatrixXd W = term;
  for (int k = 1; k <= kTerms; ++k) {
    const MatrixXd half = term * X / (k + 1);
    term = half + half.transpose();
    W += term;
  }
  MatrixXd F = exponential_minus_identity(X);
  for (; halvings > 0; --halvings) {
    const MatrixXd WF = W * F;
    W = (2 * W + WF + WF.transpose() + F.transpose() * WF).eval();
    /// FᵀW = (WF)ᵀ requires a symmetric W; otherwise asymmetry grows.
    W = (0.5 * (W + W.transpose())).eval();
    F = (2 * F + F * F).eval();
  }
  return W;
}

// Powers of two that scale the columns of B to the size of A: inputs in N m move a 60 g vehicle at
// 10⁴ rad/s², and would require unnecessary halvings of the period.
Eigen::VectorXd column_scales(const MatrixArgument& A, const MatrixArgument& B) {
  const double target = A.cwiseAbs().maxCoeff();
  Eigen::VectorXd scales = Eigen::VectorXd::Ones(B.cols());
  for (Index j = 0; j < B.cols(); ++j) {
    const double size = B.col(j).cwiseAbs().maxCoeff();
    if (size > 0 && target > 0)
      scales[j] = std::scalbn(1.0, std::clamp(std::ilogb(target) - std::ilogb(size), -400, 400));
  }
  return scales;
}

void require_plant(const MatrixArgument& A, const char* where) {
  require_shape(A, std::max<Index>(A.rows(), 1), std::max<Index>(A.rows(), 1), where, "A",
                "A must be square");
  require_finite(A, where, "A");
}

void require_weight(const MatrixArgument& M, Index rows, const char* where, const char* name,
                    const std::string& why) {
  require_shape(M, rows, rows, where, name, why);
  require_finite(M, where, name);
  require_symmetric(M, where, name);
}

}  // namespace

SampledCost sampled_cost(const MatrixArgument& A, const MatrixArgument& B, const MatrixArgument& Q,
                         const MatrixArgument& R, const MatrixArgument& N, double dt) {
  const char* where = "sampled_cost";
  require_plant(A, where);
  const Index nx = A.rows();
  const Index nu = B.cols();
  require_shape(B, nx, std::max<Index>(nu, 1), where, "B", "A is " + shape(A));
  require_finite(B, where, "B");
  require_weight(Q, nx, where, "Q", "A is " + shape(A));
  require_weight(R, nu, where, "R", "B is " + shape(B));
  if (N.size()) require_shape(N, nx, nu, where, "N", "one row per state, one column per input");
  require_finite(N, where, "N");
  internal::require_period(dt, where);

  // With z = [x; u] and u held: ż = Z z, and the cost is ∫ zᵀ Y z.
  const Eigen::VectorXd D = column_scales(A, B);  // u = D v
  MatrixXd Z = MatrixXd::Zero(nx + nu, nx + nu);
  Z.topLeftCorner(nx, nx) = A;
  Z.topRightCorner(nx, nu) = B * D.asDiagonal();
  MatrixXd Y = MatrixXd::Zero(nx + nu, nx + nu);
  Y.topLeftCorner(nx, nx) = 0.5 * (Q + Q.transpose());
  Y.bottomRightCorner(nu, nu) = D.asDiagonal() * (0.5 * (R + R.transpose())) * D.asDiagonal();
  if (N.size()) {
    Y.topRightCorner(nx, nu) = N * D.asDiagonal();
    Y.bottomLeftCorner(nu, nx) = Y.topRightCorner(nx, nu).transpose();
  }
  const MatrixXd W = integrate(Z, Y, dt);
  const Eigen::VectorXd D_inverse = D.cwiseInverse();

  SampledCost cost{.A = A, .B = B, .Q = W.topLeftCorner(nx, nx), .R = {}, .N = {}};
  cost.R = D_inverse.asDiagonal() * W.bottomRightCorner(nu, nu) * D_inverse.asDiagonal();
  cost.N = W.topRightCorner(nx, nu) * D_inverse.asDiagonal();
  const bool solved =
      internal::exponential_and_integral(A, B, dt, cost.A, cost.B) == ExponentialStatus::solved;
  if (!solved || !cost.Q.allFinite() || !cost.R.allFinite() || !cost.N.allFinite())
    internal::refuse_long_period(dt, where);
  return cost;
}

SampledNoise sampled_noise(const MatrixArgument& A, const MatrixArgument& Q, double dt) {
  const char* where = "sampled_noise";
  require_plant(A, where);
  require_weight(Q, A.rows(), where, "Q", "A is " + shape(A));
  internal::require_period(dt, where);
  SampledNoise noise{.A = A, .Q = integrate(A.transpose(), 0.5 * (Q + Q.transpose()), dt)};
  const MatrixXd no_inputs(A.rows(), 0);
  MatrixXd no_integral = no_inputs;
  const bool solved = internal::exponential_and_integral(A, no_inputs, dt, noise.A, no_integral) ==
                      ExponentialStatus::solved;
  if (!solved || !noise.Q.allFinite()) internal::refuse_long_period(dt, where);
  return noise;
}

}  // namespace quadtune
