// SPDX-License-Identifier: Apache-2.0
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "cascade/cascade_model.hpp"
#include "lyapunov/eigenvalues.hpp"

namespace quadtune {

using Eigen::Index;
using Eigen::MatrixXd;

namespace internal {

LoadStep load_step(const CascadePlant& loop) {
  const Index n = loop.A.rows();
  const double radius = eigenvalues(loop.A).cwiseAbs().maxCoeff();
  if (!(radius < 1)) return {};
  const Eigen::VectorXd rest =
      (MatrixXd::Identity(n, n) - loop.A).partialPivLu().solve(loop.B).col(0);
  LoadStep step;
  step.left = std::abs(loop.C.row(0).dot(rest));
  step.peak = step.left;
  constexpr double kSettled = 1e-4;
  constexpr double kMaxSteps = 1e5;
  const double steps = std::min(kMaxSteps, std::ceil(std::log(kSettled) / std::log(radius)));
  // With z = (x, 1), z[k+1] = M z[k], compute kBlock steps at once: y[k+j] = (C M^j) z[k].
  constexpr Index kBlock = 32;
  MatrixXd M = MatrixXd::Zero(n + 1, n + 1);
  M.topLeftCorner(n, n) = loop.A;
  M.topRightCorner(n, 1) = loop.B.col(0);
  M(n, n) = 1;
  MatrixXd rows = MatrixXd::Zero(kBlock, n + 1);
  rows.row(0).head(n) = loop.C.row(0);
  rows.row(0) = (rows.row(0) * M).eval();
  // By doubling: rows m + 1 … 2m are rows 1 … m times M^m.
  for (Index m = 1; m < kBlock; m *= 2) {
    rows.middleRows(m, m) = rows.topRows(m) * M;
    M = (M * M).eval();
  }
  Eigen::VectorXd z = Eigen::VectorXd::Unit(n + 1, n);
  Eigen::VectorXd y(kBlock), next(n + 1);
  for (Index k = 0; k < static_cast<Index>(steps); k += kBlock) {
    y.noalias() = rows * z;
    step.peak = std::max(step.peak, y.cwiseAbs().maxCoeff());
    next.noalias() = M * z;
    z.swap(next);
  }
  return step;
}

}  // namespace internal

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The plant with its rate fed back by Kd; input and outputs are unchanged.
CascadePlant with_rate_closed(CascadePlant plant, double Kd) {
  plant.A -= Kd * plant.B * plant.C.row(1);
  return plant;
}

/// A frequency well below the slowest pole of the closed loop [rad/s].
double slowest_of(const CascadePlant& plant, const PidGains& gains, PidMethod method) {
  double slowest = std::numbers::pi / plant.dt;
  for (const std::complex<double>& z : internal::eigenvalues(
           internal::closed_loop(plant, gains, method, internal::LoopInput::command).A))
    if (std::abs(z) > 0) slowest = std::min(slowest, std::abs(std::log(z)) / plant.dt);
  return 0.03 * slowest;
}

}  // namespace

CascadeLoopEvidence cascade_loop_evidence(const CascadePlant& plant, const PidGains& gains,
                                          PidMethod method) {
  internal::require_cascade_plant(plant);
  const internal::CascadeResponses responses(plant, method, slowest_of(plant, gains, method));
  CascadeLoopEvidence evidence;
  evidence.margins = loop_margins(OpenLoop(cut_at_command(plant, gains, method)));
  evidence.rate = loop_margins(OpenLoop(cut_at_command(plant, {0, 0, gains.Kd, 0}, method)));
  evidence.bandwidth = loop_margins(OpenLoop(cut_at_command(with_rate_closed(plant, gains.Kd),
                                                            {gains.Kp, gains.Ki, 0, 0}, method)))
                           .crossover;
  evidence.load_integral = gains.Ki != 0 && evidence.margins.stable ? 1 / gains.Ki : kInfinity;
  const internal::LoadStep load = internal::load_step(responses.closed(gains));
  evidence.load_peak = load.peak;
  evidence.load_steady_state = gains.Ki != 0 && std::isfinite(load.left) ? 0 : load.left;
  evidence.tracking_peak = responses.tracking_peak(gains);
  evidence.value_noise = responses.value_noise(gains);
  evidence.rate_noise = std::abs(gains.Kd) * evidence.margins.Ms;
  return evidence;
}

}  // namespace quadtune
