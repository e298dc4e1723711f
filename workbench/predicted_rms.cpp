// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/predicted_rms.hpp"

#include <fmt/format.h>

#include <Eigen/SparseCore>
#include <cmath>
#include <limits>

#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// x[m] = F x[0] + noise of covariance W, for some number of steps.
struct Steps {
  MatrixXd F, W;
};

/// One step. Most entries of F are 0: samples on their way move on.
struct Step {
  Eigen::SparseMatrix<double> F;
  MatrixXd W;
};

/// F P Fᵀ of a symmetric P.
MatrixXd between(const Eigen::SparseMatrix<double>& F, const MatrixXd& P) {
  const MatrixXd half = F * P;
  return F * half.transpose();
}

/// First `a`, then one step.
Steps then(const Steps& a, const Step& b) { return {b.F * a.F, between(b.F, a.W) + b.W}; }

/// First `a`, then `b`.
Steps then(const Steps& a, const Steps& b) {
  return {b.F * a.F, b.F * a.W * b.F.transpose() + b.W};
}

/// n times the same, by doubling.
Steps repeated(Steps once, long n) {
  const Index nx = once.F.rows();
  Steps all = {MatrixXd::Identity(nx, nx), MatrixXd::Zero(nx, nx)};
  for (;; once = then(once, once)) {
    if (n % 2 == 1) all = then(all, once);
    n /= 2;
    if (n == 0) return all;
  }
}

}  // namespace

PredictedRms predicted_rms(const PlannedFlight& plan, double time,
                           const FlownLoopOptions& options) {
  if (!(time > 0) || !std::isfinite(time))
    throw InvalidInput("predicted rms",
                       fmt::format("the time is {} s, expected a positive number", time));
  FlownPlantOptions of_plant = plant_options(plan.setup, options);
  of_plant.noise = true;
  const FlownPlant plant = flown_plant(plan.setup, of_plant);
  const PeriodicLti loop = cut_at_inputs(plant.plant, flown_law(plan.setup));
  const Eigen::VectorXcd poles = periodic_poles(closed(loop_part(loop)));
  if (poles.size() > 0 && std::log(std::abs(poles(0))) > 1e-4 * of_plant.dt) {
    const double infinity = std::numeric_limits<double>::infinity();
    return {time, VectorXd::Constant(12, infinity), VectorXd::Constant(12, infinity),
            VectorXd::Constant(loop.C.rows(), infinity)};
  }
  const Index nx = loop.C.cols(), nz = plant.plant.C.cols(), nu = loop.C.rows();
  const auto N = static_cast<long>(loop.period());
  std::vector<Step> periods;
  const std::vector<MatrixXd> A = closed(loop);
  Steps round = {MatrixXd::Identity(nx, nx), MatrixXd::Zero(nx, nx)};
  for (long k = 0; k < N; ++k) {
    const MatrixXd& G = plant.noise[static_cast<std::size_t>(k)];
    MatrixXd W = MatrixXd::Zero(nx, nx);
    W.topLeftCorner(nz, nz) = G * G.transpose();
    periods.push_back({A[static_cast<std::size_t>(k)].sparseView(), W});
    round = then(round, periods.back());
  }
  const auto rounds = std::max(1L, std::lround(time / (static_cast<double>(N) * of_plant.dt)));
  MatrixXd P = MatrixXd::Zero(nx, nx);
  P.diagonal().head(nz) = plant.noise_start;
  if (rounds > 1) {
    const Steps before = repeated(round, rounds - 1);
    P = (before.F * P * before.F.transpose() + before.W).eval();
  }
  // The mean over one round: within it samples arrive and age.
  MatrixXd errors = -MatrixXd::Identity(12, nx);
  errors.leftCols(nz) += plant.plant.C;
  VectorXd state = VectorXd::Zero(12), error = VectorXd::Zero(12), command = VectorXd::Zero(nu);
  for (const Step& period : periods) {
    P = between(period.F, P) + period.W;
    state += P.diagonal().head(12) / N;
    error += (errors * P).cwiseProduct(errors).rowwise().sum() / N;
    command += (loop.C * P).cwiseProduct(loop.C).rowwise().sum() / N;
  }
  const auto root = [](const VectorXd& variance) {
    VectorXd result = variance.cwiseMax(0).cwiseSqrt();
    for (double& entry : result)
      if (!std::isfinite(entry)) entry = std::numeric_limits<double>::infinity();
    return result;
  };
  return {static_cast<double>(rounds * N) * of_plant.dt, root(state), root(error), root(command)};
}

}  // namespace quadtune
