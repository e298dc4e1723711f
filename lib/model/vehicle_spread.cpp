// SPDX-License-Identifier: Apache-2.0
#include "quadtune/model/vehicle_spread.hpp"

#include "model/spread_reader.hpp"

namespace quadtune {

VehicleSpread internal::read_spread(const TomlTable& table) {
  table.allow({{"mass"}, {"inertia"}, {"thrust"}, {"motor_lag"}});
  constexpr Range kShare = {0, Range::Bound::closed, kMaxSpread, Range::Bound::closed};
  VehicleSpread spread;
  spread.mass = table.number_or("mass", 0, kShare);
  spread.inertia = table.number_or("inertia", 0, kShare);
  spread.thrust = table.number_or("thrust", 0, kShare);
  spread.motor_lag = table.number_or("motor_lag", 0, kShare);
  return spread;
}

VehicleSpread spread_of(const Vehicle& vehicle) {
  if (vehicle.text.empty()) return {};
  const internal::TomlTable file = internal::TomlTable::parse(vehicle.text, vehicle.name);
  const auto table = file.maybe_table("spread");
  return table ? internal::read_spread(*table) : VehicleSpread{};
}

}  // namespace quadtune
