// SPDX-License-Identifier: Apache-2.0
/// Simulated logs of a stationary sensor with known noise, seeded.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <random>

namespace quadtune::testing {

/// White noise of density N [unit/√Hz]: samples of variance N²/dt.
inline Eigen::VectorXd white_record(Eigen::Index samples, double dt, double N,
                                    std::mt19937_64& random) {
  std::normal_distribution<double> normal(0, N / std::sqrt(dt));
  return Eigen::VectorXd::NullaryExpr(samples, [&] { return normal(random); });
}

/// A random walk of density K [unit/s/√Hz]: steps of variance K² dt.
inline Eigen::VectorXd walk_record(Eigen::Index samples, double dt, double K,
                                   std::mt19937_64& random) {
  std::normal_distribution<double> normal(0, K * std::sqrt(dt));
  Eigen::VectorXd rate(samples);
  double x = 0;
  for (double& value : rate) value = x += normal(random);
  return rate;
}

/// Rates of an angle with independent errors of standard deviation Q [unit s].
inline Eigen::VectorXd quantization_record(Eigen::Index samples, double dt, double Q,
                                           std::mt19937_64& random) {
  std::normal_distribution<double> normal(0, Q);
  Eigen::VectorXd rate(samples);
  double before = normal(random);
  for (double& value : rate) {
    const double x = normal(random);
    value = (x - before) / dt;
    before = x;
  }
  return rate;
}

/// Flicker of bias instability B [unit]: white noise of variance B² integrated by one half
/// [Kasdin and Walter 1992], whose density goes to B²/(2π f) (two-sided halves of B²/(π f)).
inline Eigen::VectorXd flicker_record(Eigen::Index samples, double B, std::mt19937_64& random) {
  const Eigen::VectorXd white = white_record(samples, 1, B, random);
  Eigen::VectorXd weights(samples);
  double weight = 1;
  for (Eigen::Index k = 0; k < samples; ++k) {
    weights(k) = weight;
    weight *= (static_cast<double>(k) + 0.5) / (static_cast<double>(k) + 1);
  }
  const Eigen::VectorXd backwards = weights.reverse();
  Eigen::VectorXd rate(samples);
  for (Eigen::Index k = 0; k < samples; ++k) rate(k) = white.head(k + 1).dot(backwards.tail(k + 1));
  return rate;
}

}  // namespace quadtune::testing
