// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/design/linearize_or_refuse.hpp"

#include <fmt/format.h>

#include "quadtune/errors.hpp"

namespace quadtune {

Linearization linearize_or_refuse(const Vehicle& vehicle, const FlightCondition& condition,
                                  const LinearizeOptions& options, const std::string& where) {
  Linearization model = linearize(vehicle, condition, options);
  if (!model.solved())
    throw NoSolution(fmt::format("{}: no {} trim: {}", place_of(vehicle), to_string(condition.kind),
                                 model.trim.culprit),
                     where);
  return model;
}

}  // namespace quadtune
