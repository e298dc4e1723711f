// SPDX-License-Identifier: Apache-2.0
/// What each uncertain quantity changes of a flight.
#pragma once

#include <functional>
#include <vector>

#include "quadtune/simulation/uncertainty.hpp"

namespace quadtune::internal {

/// What is changed.
struct UncertainParts {
  Vehicle& flown;
  Environment& environment;
};

struct QuantityEffect {
  UncertainQuantity quantity;
  /// Changes the parts by what was drawn; false where the vehicle lacks the part.
  std::function<bool(UncertainParts&, double)> change;
  bool of_sensor = false;
};

[[nodiscard]] const std::vector<QuantityEffect>& quantity_effects();

}  // namespace quadtune::internal
