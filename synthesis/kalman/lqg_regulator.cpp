// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/lqg_regulator.hpp"

#include <Eigen/LU>
#include <cmath>

#include "lyapunov/eigenvalues.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/synthesis/lyapunov.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

template <class Lti>
MatrixXd feed_through_of(const Lti& plant) {
  return plant.D.size() ? plant.D : MatrixXd(MatrixXd::Zero(plant.C.rows(), plant.B.cols()));
}

/// The closed loop of x' = A x + B u + w, y = C x + D u + v and the controller, with the states
/// [x | x̂].
struct ClosedLoop {
  MatrixXd A;       // (2 nx × 2 nx)
  MatrixXd from_v;  // (2 nx × ny)
  MatrixXd U;       // (nu × 2 nx): u of the states
  MatrixXd U_v;     // (nu × ny): u of v
};

template <class Lti>
ClosedLoop close(const Lti& plant, const Lti& c) {
  const Index n = plant.A.rows();
  const Index nu = plant.B.cols();
  const MatrixXd D = feed_through_of(plant);
  // u = -Cc x̂ - Dc (C x + D u + v), hence (I + Dc D) u = -Dc C x - Cc x̂ - Dc v.
  const Eigen::PartialPivLU<MatrixXd> lu(MatrixXd::Identity(nu, nu) + c.D * D);
  ClosedLoop loop;
  loop.U.resize(nu, 2 * n);
  loop.U << lu.solve(-c.D * plant.C), lu.solve(-c.C);
  loop.U_v = lu.solve(-c.D);
  MatrixXd Y(plant.C.rows(), 2 * n);  // y of the states
  Y << plant.C, MatrixXd::Zero(plant.C.rows(), n);
  Y += D * loop.U;
  const MatrixXd Y_v = MatrixXd::Identity(plant.C.rows(), plant.C.rows()) + D * loop.U_v;
  loop.A = MatrixXd::Zero(2 * n, 2 * n);
  loop.A.topLeftCorner(n, n) = plant.A;
  loop.A.bottomRightCorner(n, n) = c.A;
  loop.A.topRows(n) += plant.B * loop.U;
  loop.A.bottomRows(n) += c.B * Y;
  loop.from_v.resize(2 * n, plant.C.rows());
  loop.from_v << plant.B * loop.U_v, c.B * Y_v;
  return loop;
}

/// Fills the predicted deviations, the mean cost and the poles of a solved regulator.
template <class Lti>
void predict(LqgRegulator<Lti>& result, const Lti& plant, const LqrWeights& weights,
             const KalmanNoise& noise, bool is_discrete) {
  const Index n = plant.A.rows();
  const MatrixXd G = noise.G.size() ? noise.G : MatrixXd(MatrixXd::Identity(n, n));
  const ClosedLoop loop = close(plant, result.controller);
  MatrixXd from_w = MatrixXd::Zero(2 * n, G.cols());
  from_w.topRows(n) = G;
  MatrixXd W =
      from_w * noise.Q * from_w.transpose() + loop.from_v * noise.R * loop.from_v.transpose();
  if (noise.N.size()) {
    const MatrixXd cross = from_w * noise.N * loop.from_v.transpose();
    W += cross + cross.transpose();
  }
  W = 0.5 * (W + W.transpose()).eval();
  result.poles = internal::eigenvalues(loop.A);
  const LyapunovResult stationary =
      is_discrete ? lyapunov_discrete(loop.A, W) : lyapunov_continuous(loop.A, W);
  if (!stationary.solved()) return;
  const MatrixXd& P = stationary.X;
  // A continuous u without feed-through of v; a discrete u[k] contains v[k].
  MatrixXd U = loop.U * P * loop.U.transpose();
  if (is_discrete) U += loop.U_v * noise.R * loop.U_v.transpose();
  result.state_rms = P.diagonal().head(n).cwiseMax(0).cwiseSqrt();
  result.input_rms = U.diagonal().cwiseMax(0).cwiseSqrt();
  result.cost = (weights.Q * P.topLeftCorner(n, n)).trace() + (weights.R * U).trace();
  if (weights.N.size())  // E[x uᵀ]
    result.cost += 2 * (weights.N.transpose() * (P * loop.U.transpose()).topRows(n)).trace();
}

}  // namespace

LqgRegulator<ContinuousLti> lqg_regulator(const ContinuousLti& plant, const LqrWeights& weights,
                                          const KalmanNoise& noise, const RiccatiOptions& options) {
  LqgRegulator<ContinuousLti> result;
  result.lqr = lqr(plant, weights, options);
  result.filter = kalman(plant, noise, options);
  if (!result.solved()) return result;
  const MatrixXd& K = result.lqr.K;
  const MatrixXd& L = result.filter.L;
  ContinuousLti& c = result.controller;
  c.A = plant.A - plant.B * K - L * (plant.C - feed_through_of(plant) * K);
  c.B = L;
  c.C = K;
  c.D = MatrixXd::Zero(K.rows(), L.cols());
  predict(result, plant, weights, noise, false);
  return result;
}

LqgRegulator<DiscreteLti> lqg_regulator(const DiscreteLti& plant, const LqrWeights& weights,
                                        const KalmanNoise& noise, LqgEstimate estimate,
                                        const RiccatiOptions& options) {
  LqgRegulator<DiscreteLti> result;
  result.lqr = lqr(plant, weights, options);
  result.filter = kalman(plant, noise, options);
  if (!result.solved()) return result;
  const Index n = plant.A.rows();
  const Index nu = plant.B.cols();
  const MatrixXd& K = result.lqr.K;
  const MatrixXd& L = result.filter.L;
  const MatrixXd D = feed_through_of(plant);
  const MatrixXd M = estimate == LqgEstimate::current ? result.filter.M
                                                      : MatrixXd(MatrixXd::Zero(n, plant.C.rows()));
  // u = -K x̂ - K M (y - C x̂ - D u), hence (I - K M D) u = -K (I - M C) x̂ - K M y.
  const Eigen::PartialPivLU<MatrixXd> lu(MatrixXd::Identity(nu, nu) - K * M * D);
  if (!(lu.rcond() > 1e-14))
    throw InvalidInput("lqg",
                       "the law is algebraic (I - K M D is singular), expected a D for which "
                       "it is not, or the delayed estimate");
  DiscreteLti& c = result.controller;
  c.dt = plant.dt;
  c.C = lu.solve(K * (MatrixXd::Identity(n, n) - M * plant.C));
  c.D = lu.solve(K * M);
  c.A = plant.A - L * plant.C - (plant.B - L * D) * c.C;
  c.B = L - (plant.B - L * D) * c.D;
  predict(result, plant, weights, noise, true);
  return result;
}

}  // namespace quadtune
