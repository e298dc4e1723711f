// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "quadtune/simulation/sensor_channel.hpp"

namespace quadtune {
namespace {

/// Radians per sample beyond which a response settles before the next sample.
constexpr double kFastest = 1e4;

}  // namespace

SampledResponse sampled_response(double natural_frequency, double damping, double dt) {
  // Time in samples; one matrix exponential of (y, y' dt, u, u' dt).
  const double w = natural_frequency * dt;
  if (w == 0 || w > kFastest) return {};
  Eigen::Matrix4d M = Eigen::Matrix4d::Zero();
  M(0, 1) = 1;
  M.row(1) << -w * w, -2 * damping * w, w * w, 0;
  M(2, 3) = 1;
  // Scaling and squaring with a Taylor series: sixteen terms for a matrix of norm at most ½.
  const double norm = M.cwiseAbs().rowwise().sum().maxCoeff();
  const int squarings = std::max(0, static_cast<int>(std::ceil(std::log2(2 * norm))));
  const Eigen::Matrix4d X = M * std::ldexp(1.0, -squarings);
  Eigen::Matrix4d E = Eigen::Matrix4d::Identity();
  for (int k = 16; k >= 1; --k) E = Eigen::Matrix4d::Identity() + X * E / k;
  for (int k = 0; k < squarings; ++k) E = E * E;
  SampledResponse response;
  response.A << E(0, 0), E(0, 1) * dt, E(1, 0) / dt, E(1, 1);
  // u[k-1] contributes through u and, together with u[k], through u' dt = u[k] - u[k-1].
  const Eigen::Vector2d held(E(0, 2), E(1, 2) / dt);
  response.b1 << E(0, 3), E(1, 3) / dt;
  response.b0 = held - response.b1;
  return response;
}

}  // namespace quadtune
