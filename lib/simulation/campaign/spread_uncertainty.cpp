// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/campaign/spread_uncertainty.hpp"

#include <algorithm>
#include <string>

#include "quadtune/model/vehicle_spread.hpp"

namespace quadtune {
namespace {

void add_ratio(Uncertainty& uncertainty, const std::string& quantity, double spread) {
  const auto varied = [&](const UncertainNumber& number) { return number.quantity == quantity; };
  std::vector<UncertainNumber>& numbers = uncertainty.numbers;
  if (!(spread > 0) || std::any_of(numbers.begin(), numbers.end(), varied)) return;
  Distribution distribution{DistributionKind::normal, 1, spread / 2};
  distribution.min = std::max(1 - 1.5 * spread, 0.05);
  distribution.max = 1 + 1.5 * spread;
  numbers.push_back({quantity, distribution});
  if (uncertainty.correlation.size() == 0) return;
  const Eigen::Index n = uncertainty.correlation.rows();
  uncertainty.correlation.conservativeResize(n + 1, n + 1);
  uncertainty.correlation.row(n).setZero();
  uncertainty.correlation.col(n).setZero();
  uncertainty.correlation(n, n) = 1;
}

}  // namespace

void add_spread(const Vehicle& vehicle, Uncertainty& uncertainty) {
  const VehicleSpread spread = spread_of(vehicle);
  add_ratio(uncertainty, "mass", spread.mass);
  for (const char* axis : {"inertia_x", "inertia_y", "inertia_z"})
    add_ratio(uncertainty, axis, spread.inertia);
  add_ratio(uncertainty, "thrust", spread.thrust);
  const bool lags = std::any_of(vehicle.rotors.begin(), vehicle.rotors.end(),
                                [](const Rotor& rotor) { return slower_lag(rotor) > 0; });
  if (lags) add_ratio(uncertainty, "motor_lag", spread.motor_lag);
}

}  // namespace quadtune
