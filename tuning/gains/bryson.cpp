// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/bryson.hpp"

#include <fmt/format.h>

#include <cmath>

#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

/// Returns 1 / limit² for each entry.
Eigen::VectorXd inverse_squares(const Eigen::Ref<const Eigen::VectorXd>& limits, const char* name,
                                bool may_be_infinite) {
  for (Eigen::Index i = 0; i < limits.size(); ++i) {
    const bool valid = limits(i) > 0 && (may_be_infinite || std::isfinite(limits(i)));
    if (!valid)
      throw InvalidInput("bryson_weights",
                         fmt::format("{}[{}] is {}, expected a positive {}", name, i + 1, limits(i),
                                     may_be_infinite ? "limit or infinity" : "finite limit"));
  }
  return limits.array().square().inverse();
}

}  // namespace

LqrWeights bryson_weights(const Eigen::Ref<const Eigen::VectorXd>& x_max,
                          const Eigen::Ref<const Eigen::VectorXd>& u_max) {
  LqrWeights weights;
  weights.Q = inverse_squares(x_max, "x_max", true).asDiagonal();
  weights.R = inverse_squares(u_max, "u_max", false).asDiagonal();
  return weights;
}

}  // namespace quadtune
