// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/impulse.hpp"

#include <fmt/format.h>

#include "kernel/exponential_kernel.hpp"
#include "methods/period.hpp"
#include "methods/written_out.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

void refuse_feedthrough(const Eigen::MatrixXd& D) {
  for (Eigen::Index i = 0; i < D.rows(); ++i)
    for (Eigen::Index j = 0; j < D.cols(); ++j)
      if (D(i, j) != 0)
        throw InvalidInput(
            "impulse",
            fmt::format("D has {:.6g} at ({},{}), expected 0 because otherwise the impulse "
                        "response contains an impulse, which cannot be sampled",
                        D(i, j), i + 1, j + 1));
}

}  // namespace

DiscreteLti discretize_impulse(const ContinuousLti& plant, double dt) {
  validate(plant, "impulse");
  internal::require_period(dt, "impulse");
  refuse_feedthrough(plant.D);
  DiscreteLti result = internal::with_explicit_outputs(plant, dt);
  result.A = plant.A;
  Eigen::MatrixXd integral = plant.B;
  if (internal::exponential_and_integral(plant.A, plant.B, dt, result.A, integral) !=
      ExponentialStatus::solved)
    internal::refuse_long_period(dt, "impulse");
  result.B = result.A * plant.B * dt;
  result.D = result.C * plant.B * dt;
  internal::refuse_overflow(result, "impulse");
  return result;
}

}  // namespace quadtune
