// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/euler.hpp"

#include "methods/period.hpp"

namespace quadtune {

DiscreteLti discretize_euler(const ContinuousLti& plant, double dt) {
  validate(plant, "euler");
  internal::require_period(dt, "euler");
  DiscreteLti result{.A = plant.A * dt,
                     .B = plant.B * dt,
                     .C = plant.C,
                     .D = plant.D,
                     .dt = dt,
                     .states = plant.states,
                     .inputs = plant.inputs,
                     .outputs = plant.outputs};
  result.A.diagonal().array() += 1;
  if (!result.A.allFinite() || !result.B.allFinite()) internal::refuse_long_period(dt, "euler");
  return result;
}

}  // namespace quadtune
