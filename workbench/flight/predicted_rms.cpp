// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/flight/predicted_rms.hpp"

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

/// One step. Most entries of F are 0, because delayed samples only move to the next slot.
struct Step {
  Eigen::SparseMatrix<double> F;
  MatrixXd W;
};

/// F P Fᵀ for a symmetric P.
MatrixXd between(const Eigen::SparseMatrix<double>& F, const MatrixXd& P) {
  const MatrixXd half = F * P;
  return F * half.transpose();
}

/// `a` followed by one step.
Steps then(const Steps& a, const Step& b) { return {b.F * a.F, between(b.F, a.W) + b.W}; }

/// `a` followed by `b`.
Steps then(const Steps& a, const Steps& b) {
  return {b.F * a.F, b.F * a.W * b.F.transpose() + b.W};
}

/// n repetitions of the same steps, by doubling.
Steps repeated(Steps once, long n) {
  const Index nx = once.F.rows();
  Steps all = {MatrixXd::Identity(nx, nx), MatrixXd::Zero(nx, nx)};
  for (;; once = then(once, once)) {
    if (n % 2 == 1) all = then(all, once);
    n /= 2;
    if (n == 0) return all;
  }
}

/// The covariance columns of roll and of the pitch rate in one period of the cycle.
struct Instant {
  std::size_t period = 0;
  VectorXd roll, pitch_rate;
};

/// The variance that d = q φ adds to each row of `read` through ψ' = r + d. Roll and pitch rate are
/// Gaussian, so that E d(t) d(t+τ) = E qq E φφ + E qφ E φq with the covariances over τ (Isserlis),
/// here the mean over the instants of a cycle.
/// @param turn      state after a change of the heading by 1 of vehicle and estimator
/// @param instants  of a cycle
/// @param read      (rows × nx)
VectorXd added_by_turning(const std::vector<Step>& periods, const VectorXd& turn,
                          const std::vector<Instant>& instants, const MatrixXd& read, double dt) {
  // The correlation is negligible beyond 20 s, and motion is slower than 5 ms.
  constexpr double kMax = 20, kFine = 0.005, kNegligible = 1e-4;  // [s], [s], [1]
  const auto N = periods.size();
  const auto stride = static_cast<Index>(std::max(1.0, std::floor(kFine / dt + 1e-9)));
  const double h = dt * static_cast<double>(stride);
  const auto longest = static_cast<Index>(std::ceil(kMax / h));
  const auto advance = [&](VectorXd& x, std::size_t& period) {
    for (Index i = 0; i < stride; ++i, period = (period + 1) % N) x = periods[period].F * x;
  };
  VectorXd of_d = VectorXd::Zero(longest);
  Index lags = 0;  // beyond which q and φ are uncorrelated with their past
  for (const Instant& at : instants) {
    VectorXd roll = at.roll, rate = at.pitch_rate;
    std::size_t of_roll = at.period, of_rate = at.period;
    const double size = std::abs(rate(kRates + 1) * roll(kAttitude));
    double quiet = 0;  // [s]
    for (Index m = 0; m < longest && quiet < 1; ++m) {
      const double both = rate(kRates + 1) * roll(kAttitude) + rate(kAttitude) * roll(kRates + 1);
      of_d(m) += both / static_cast<double>(instants.size());
      quiet = std::abs(both) < kNegligible * size ? quiet + h : 0;
      lags = std::max(lags, m + 1);
      advance(roll, of_roll);
      advance(rate, of_rate);
    }
  }
  MatrixXd response(read.rows(), longest);
  VectorXd x = turn;
  std::size_t period = 0;
  for (Index m = 0; m < longest; ++m) {
    response.col(m) = read * x;
    advance(x, period);
  }
  VectorXd added = VectorXd::Zero(read.rows());
  for (Index i = 0; i < read.rows(); ++i) {
    if (response.row(i).isZero(0)) continue;
    for (Index m = 0; m < lags; ++m)
      added(i) += (m == 0 ? 1 : 2) * of_d(m) *
                  response.row(i).head(longest - m).dot(response.row(i).tail(longest - m));
  }
  return h * h * added.cwiseMax(0);
}

/// The state after a change of the heading by 1, which the estimator follows because it integrates
/// the rates as the vehicle does.
VectorXd turn_of(const FlightSetup& setup, const PeriodicLti& loop) {
  // The attitude of the general filter is a quaternion, with half the angle.
  const double of_estimate = setup.estimator == EstimatorKind::general ? 0.5 : 1;
  VectorXd turn = VectorXd::Zero(loop.C.cols());
  turn(kAttitude + 2) = 1;
  for (std::size_t i = 12; i < loop.states.size(); ++i) {
    if (loop.states[i].name == "filter attitude z") turn(static_cast<Index>(i)) = of_estimate;
    if (loop.states[i].name == "estimated yaw") turn(static_cast<Index>(i)) = 1;
  }
  return turn;
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
            VectorXd::Constant(loop.C.rows(), infinity), VectorXd::Constant(12, infinity)};
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
  // The mean over one cycle, in which samples arrive and age.
  MatrixXd errors = -MatrixXd::Identity(12, nx);
  errors.leftCols(nz) += plant.plant.C;
  VectorXd state = VectorXd::Zero(12), error = VectorXd::Zero(12), command = VectorXd::Zero(nu);
  constexpr long kInstants = 20;  // maximum per cycle
  std::vector<Instant> instants;
  for (long k = 0; k < N; ++k) {
    const Step& period = periods[static_cast<std::size_t>(k)];
    if (k % std::max(1L, N / kInstants) == 0)
      instants.push_back({static_cast<std::size_t>(k), P.col(kAttitude), P.col(kRates + 1)});
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
  MatrixXd read = MatrixXd::Zero(12 + nu, nx);
  read.topLeftCorner(12, 12).setIdentity();
  read.bottomRows(nu) = loop.C;
  const VectorXd turned =
      added_by_turning(periods, turn_of(plan.setup, loop), instants, read, of_plant.dt);
  state += turned.head(12);
  command += turned.tail(nu);
  return {static_cast<double>(rounds * N) * of_plant.dt, root(state), root(error), root(command),
          root(turned.head(12))};
}

}  // namespace quadtune
