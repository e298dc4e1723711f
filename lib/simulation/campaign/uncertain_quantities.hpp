// SPDX-License-Identifier: Apache-2.0
/// Effects of the uncertain quantities on a flight.
#pragma once

#include <functional>
#include <vector>

#include "quadtune/simulation/campaign/uncertainty.hpp"

namespace quadtune::internal {

/// The objects that a quantity can change.
struct UncertainParts {
  Vehicle& flown;
  Environment& environment;
};

struct QuantityEffect {
  UncertainQuantity quantity;
  /// Applies a drawn value; false if the vehicle does not have the affected component.
  std::function<bool(UncertainParts&, double)> change;
  bool of_sensor = false;
  bool of_air = false;
};

[[nodiscard]] const std::vector<QuantityEffect>& quantity_effects();

}  // namespace quadtune::internal
