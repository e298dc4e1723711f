// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/foh.hpp"

#include "kernel/exponential_kernel.hpp"
#include "methods/period.hpp"
#include "methods/written_out.hpp"

namespace quadtune {

using Eigen::Index;
using Eigen::MatrixXd;

DiscreteLti discretize_foh(const ContinuousLti& plant, double dt) {
  validate(plant, "foh");
  internal::require_period(dt, "foh");
  const Index nx = plant.A.rows();
  const Index nu = plant.B.cols();
  // The input is the integral of its slope, which is held: [x; u] is a plant whose input is the
  // slope.
  MatrixXd Z = MatrixXd::Zero(nx + nu, nx + nu);
  Z.topRows(nx) << plant.A, plant.B;
  MatrixXd slope = MatrixXd::Zero(nx + nu, nu);
  slope.bottomRows(nu).diagonal().setConstant(1 / dt);
  const bool solved =
      internal::exponential_and_integral(Z, slope, dt, Z, slope) == ExponentialStatus::solved;
  if (!solved) internal::refuse_long_period(dt, "foh");
  const MatrixXd B1 = slope.topRows(nx);
  const MatrixXd B0 = Z.topRightCorner(nx, nu) - B1;

  DiscreteLti result = internal::with_explicit_outputs(plant, dt);
  result.A = Z.topLeftCorner(nx, nx);
  result.B = B0 + result.A * B1;
  result.D += result.C * B1;
  internal::refuse_overflow(result, "foh");
  return result;
}

}  // namespace quadtune
