// SPDX-License-Identifier: Apache-2.0
/// Plants with normally distributed entries.
#pragma once

#include <cmath>
#include <random>

#include "quadtune/lti.hpp"

namespace quadtune::testing {

/// Poles in a disk of radius about 1 around -0.5 [1/s]; D is zero unless requested.
inline ContinuousLti random_plant(Eigen::Index nx, Eigen::Index nu, Eigen::Index ny, bool with_D,
                                  std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  const auto draw = [&] { return normal(generator); };
  ContinuousLti plant;
  plant.A = Eigen::MatrixXd::NullaryExpr(nx, nx, draw) / std::sqrt(static_cast<double>(nx));
  plant.A.diagonal().array() -= 0.5;
  plant.B = Eigen::MatrixXd::NullaryExpr(nx, nu, draw);
  plant.C = Eigen::MatrixXd::NullaryExpr(ny, nx, draw);
  plant.D = Eigen::MatrixXd::Zero(ny, nu);
  if (with_D) plant.D = Eigen::MatrixXd::NullaryExpr(ny, nu, draw);
  return plant;
}

}  // namespace quadtune::testing
