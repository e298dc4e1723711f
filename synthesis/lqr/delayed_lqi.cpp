// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/delayed_lqi.hpp"

#include <fmt/format.h>

#include "quadtune/errors.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Names for the culprit of a failure: "state 1", …, "integral 1", …
std::vector<Signal> state_names(const std::vector<Signal>& given, Index nx) {
  if (!given.empty()) return given;
  std::vector<Signal> names;
  for (Index i = 0; i < nx; ++i) names.push_back({fmt::format("state {}", i + 1), ""});
  return names;
}

/// @param step  the factor of the outputs in the equation of the integrals
template <class Lti>
AugmentedLqr<Lti> append_integrals(const Lti& plant, const LqrWeights& weights, double pole,
                                   double step) {
  const char* where = "with_output_integrals";
  validate(plant, where);
  const Index nx = plant.A.rows();
  const Index nu = plant.B.cols();
  const MatrixXd C = plant.C.size() ? plant.C : MatrixXd(MatrixXd::Identity(nx, nx));
  const Index ny = C.rows();
  const MatrixXd D = plant.D.size() ? plant.D : MatrixXd(MatrixXd::Zero(ny, nu));
  require_shape(weights.Q, nx + ny, nx + ny, where, "Q",
                fmt::format("states {}, integrals of outputs {}", nx, ny));
  if (weights.N.size())
    require_shape(weights.N, nx + ny, nu, where, "N",
                  fmt::format("states {}, integrals of outputs {}, inputs {}", nx, ny, nu));
  AugmentedLqr<Lti> result{plant, weights};
  Lti& p = result.plant;
  p.A = MatrixXd::Zero(nx + ny, nx + ny);
  p.A.topLeftCorner(nx, nx) = plant.A;
  p.A.bottomLeftCorner(ny, nx) = step * C;
  p.A.bottomRightCorner(ny, ny).diagonal().setConstant(pole);
  p.B.resize(nx + ny, nu);
  p.B << plant.B, step * D;
  p.C.resize(0, 0);
  p.D.resize(0, 0);
  p.outputs.clear();
  p.states = state_names(plant.states, nx);
  for (Index i = 0; i < ny; ++i) p.states.push_back({fmt::format("integral {}", i + 1), ""});
  return result;
}

}  // namespace

AugmentedLqr<ContinuousLti> with_output_integrals(const ContinuousLti& plant,
                                                  const LqrWeights& weights) {
  return append_integrals(plant, weights, 0, 1);
}

AugmentedLqr<DiscreteLti> with_output_integrals(const DiscreteLti& plant,
                                                const LqrWeights& weights) {
  return append_integrals(plant, weights, 1, plant.dt);
}

AugmentedLqr<DiscreteLti> with_input_delay(const AugmentedLqr<DiscreteLti>& problem, int delay) {
  const char* where = "with_input_delay";
  validate(problem.plant, where);
  constexpr int kMaxDelay = 2000;
  if (delay < 0 || delay > kMaxDelay)
    throw InvalidInput(where,
                       fmt::format("delay is {} samples, expected 0 to {}", delay, kMaxDelay));
  if (delay == 0) return problem;
  const DiscreteLti& plant = problem.plant;
  const LqrWeights& weights = problem.weights;
  const Index nx = plant.A.rows();
  const Index nu = plant.B.cols();
  require_shape(weights.Q, nx, nx, where, "Q", "one row and column per state");
  require_shape(weights.R, nu, nu, where, "R", "one row and column per input");
  const Index n = nx + nu * delay;
  AugmentedLqr<DiscreteLti> result;
  DiscreteLti& p = result.plant;
  p.dt = plant.dt;
  // x[k+1] = A x + B u[k-delay]; the block j of past commands becomes the block j + 1.
  p.A = MatrixXd::Zero(n, n);
  p.A.topLeftCorner(nx, nx) = plant.A;
  p.A.block(0, n - nu, nx, nu) = plant.B;
  for (Index j = 1; j < delay; ++j) p.A.block(nx + j * nu, nx + (j - 1) * nu, nu, nu).setIdentity();
  p.B = MatrixXd::Zero(n, nu);
  p.B.middleRows(nx, nu).setIdentity();
  p.states = state_names(plant.states, nx);
  for (int j = 1; j <= delay; ++j)
    for (Index i = 0; i < nu; ++i) p.states.push_back({fmt::format("u{}[k-{}]", i + 1, j), ""});
  // The cost of a command is counted when it is given instead of when it acts, which changes the
  // sum only by the commands that were given before the start. Its cross term with the state is
  // that of the command that acts.
  result.weights.R = weights.R;
  result.weights.Q = MatrixXd::Zero(n, n);
  result.weights.Q.topLeftCorner(nx, nx) = weights.Q;
  if (weights.N.size()) {
    require_shape(weights.N, nx, nu, where, "N", "one row per state, one column per input");
    result.weights.Q.block(0, n - nu, nx, nu) = weights.N;
    result.weights.Q.block(n - nu, 0, nu, nx) = weights.N.transpose();
    // Counted when it acts, so that [Q N; Nᵀ R] of the acting command stays positive semidefinite.
    result.weights.Q.bottomRightCorner(nu, nu) = weights.R;
    result.weights.R = MatrixXd::Zero(nu, nu);
  }
  return result;
}

}  // namespace quadtune
