// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <limits>

#include "lyapunov/schur_lyapunov.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/matrix_checks.hpp"
#include "quadtune/synthesis/diagonal_lqr.hpp"
#include "riccati/riccati_parts.hpp"

namespace quadtune {

using Eigen::MatrixXd;
using internal::SchurLyapunov;
using internal::Time;

namespace {

constexpr char kDerivativeWhere[] = "lqr_derivative";

MatrixXd symmetric_part(const MatrixXd& M) { return 0.5 * (M + M.transpose()); }

MatrixXd not_a_number(Eigen::Index rows, Eigen::Index cols) {
  return MatrixXd::Constant(rows, cols, std::numeric_limits<double>::quiet_NaN());
}

/// The direction of a weight; zero if it is empty.
MatrixXd direction_of(const MatrixXd& M, Eigen::Index rows, Eigen::Index cols, const char* name,
                      bool symmetric) {
  if (M.size() == 0) return MatrixXd::Zero(rows, cols);
  require_shape(M, rows, cols, kDerivativeWhere, name, "it has the shape of the weight");
  require_finite(M, kDerivativeWhere, name);
  if (symmetric) require_symmetric(M, kDerivativeWhere, name);
  return M;
}

template <class Lti>
void check(const Lti& plant, const LqrWeights& weights, const RiccatiResult& solution) {
  validate(plant, kDerivativeWhere);
  if (!solution.solved())
    throw InvalidInput(kDerivativeWhere,
                       fmt::format("the Riccati equation has status '{}', expected "
                                   "'solved' because only a solution has a derivative",
                                   to_string(solution.status)));
  const Eigen::Index nx = plant.A.rows();
  const Eigen::Index nu = plant.B.cols();
  require_shape(solution.X, nx, nx, kDerivativeWhere, "X", "it has the shape of A");
  require_shape(solution.K, nu, nx, kDerivativeWhere, "K",
                "one row per input, one column per state");
  require_shape(weights.R, nu, nu, kDerivativeWhere, "R", "one row and column per input");
}

}  // namespace

/// The data that all directions share.
struct LqrDerivative::Parts {
  MatrixXd B;                 ///< (nx × nu)
  MatrixXd K;                 ///< (nu × nx)
  MatrixXd E;                 ///< (nx × nx) I, or A - B K if discrete
  Eigen::LLT<MatrixXd> S;     ///< factor of R, or of R + BᵀXB if discrete
  SchurLyapunov closed_loop;  ///< for A - B K

  Parts(Time time, const MatrixXd& A, const MatrixXd& input, const MatrixXd& R,
        const RiccatiResult& solution)
      : B(input),
        K(solution.K),
        E(time == Time::discrete ? MatrixXd(A - B * K)
                                 : MatrixXd(MatrixXd::Identity(A.rows(), A.rows()))),
        S(time == Time::discrete ? MatrixXd(R + symmetric_part(B.transpose() * solution.X * B))
                                 : R),
        closed_loop(time, A - B * K) {}
};

LqrDerivative::LqrDerivative(const ContinuousLti& plant, const LqrWeights& weights,
                             const RiccatiResult& solution) {
  check(plant, weights, solution);
  parts_ = std::make_unique<Parts>(Time::continuous, plant.A, plant.B, weights.R, solution);
}

LqrDerivative::LqrDerivative(const DiscreteLti& plant, const LqrWeights& weights,
                             const RiccatiResult& solution) {
  check(plant, weights, solution);
  parts_ = std::make_unique<Parts>(Time::discrete, plant.A, plant.B, weights.R, solution);
}

LqrDerivative::~LqrDerivative() = default;
LqrDerivative::LqrDerivative(LqrDerivative&&) noexcept = default;
LqrDerivative& LqrDerivative::operator=(LqrDerivative&&) noexcept = default;

LqrTangent LqrDerivative::along(const LqrWeights& direction) const {
  const auto& [B, K, E, S, closed_loop] = *parts_;
  const Eigen::Index nx = B.rows();
  const Eigen::Index nu = B.cols();
  const MatrixXd dQ = direction_of(direction.Q, nx, nx, "dQ", true);
  const MatrixXd dR = direction_of(direction.R, nu, nu, "dR", true);
  const MatrixXd dN = direction_of(direction.N, nx, nu, "dN", false);
  LqrTangent tangent{not_a_number(nx, nx), not_a_number(nu, nx)};
  if (!closed_loop.ok()) return tangent;
  // A_cᵀ dX + dX A_c + dC = 0, or A_cᵀ dX A_c - dX + dC = 0. By the envelope theorem the terms in
  // dK cancel: dC = dQ + Kᵀ dR K - dN K - Kᵀ dNᵀ.
  const MatrixXd dRK = dR * K;
  const MatrixXd dNK = dN * K;
  const MatrixXd dC = dQ + K.transpose() * dRK - dNK - dNK.transpose();
  tangent.dX = symmetric_part(closed_loop.solve_transposed(dC));
  // dK = S⁻¹ (Bᵀ dX E + dNᵀ - dR K)
  tangent.dK = S.solve(B.transpose() * tangent.dX * E + dN.transpose() - dRK);
  return tangent;
}

LqrWeights LqrDerivative::gradient(const Eigen::Ref<const MatrixXd>& Y) const {
  const auto& [B, K, E, S, closed_loop] = *parts_;
  const Eigen::Index nx = B.rows();
  const Eigen::Index nu = B.cols();
  require_shape(Y, nu, nx, kDerivativeWhere, "Y", "it has the shape of K");
  require_finite(Y, kDerivativeWhere, "Y");
  if (!closed_loop.ok()) return {not_a_number(nx, nx), not_a_number(nu, nu), not_a_number(nx, nu)};
  const MatrixXd W = S.solve(Y);
  // Λ solves the Lyapunov equation of the transposed loop for sym(B W Eᵀ); then
  // Σ Y∘dK = Σ Λ∘dC + Σ W∘(dNᵀ - dR K).
  const MatrixXd L = symmetric_part(closed_loop.solve(symmetric_part(B * W * E.transpose())));
  const MatrixXd KL = K * L;
  return {L, symmetric_part(KL * K.transpose() - W * K.transpose()),
          W.transpose() - 2 * KL.transpose()};
}

}  // namespace quadtune
