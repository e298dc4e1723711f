// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/backward_euler.hpp"

#include "methods/implicit_rule.hpp"
#include "methods/period.hpp"

namespace quadtune {

DiscreteLti discretize_backward_euler(const ContinuousLti& plant, double dt) {
  validate(plant, "backward-euler");
  internal::require_period(dt, "backward-euler");
  return internal::discretize_by_rule(plant, dt, {.alpha = 1, .step = dt, .forbidden = "1/dt"},
                                      "backward-euler");
}

}  // namespace quadtune
