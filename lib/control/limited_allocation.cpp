// SPDX-License-Identifier: Apache-2.0
#include "quadtune/control/limited_allocation.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "quadtune/errors.hpp"
#include "quadtune/internal/enum_names.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/model/mixer.hpp"

namespace quadtune {

constexpr internal::EnumName<AllocationRule> kAllocationRules[] = {
    {AllocationRule::prioritized, "prioritized"}, {AllocationRule::clipped, "clipped"}};

std::string to_string(AllocationRule rule) { return internal::name_in(kAllocationRules, rule); }

AllocationRule allocation_rule(const std::string& name, const std::string& where) {
  if (const auto rule = internal::value_in(kAllocationRules, name)) return *rule;
  throw InvalidInput(
      where, fmt::format("no allocation '{}', expected prioritized or clipped{}",
                         internal::printable(name),
                         internal::did_you_mean(name, internal::names_in(kAllocationRules))));
}

ThrustLimits<double> thrust_limits(const Vehicle& vehicle) {
  const Allocation<double> hover = allocation(vehicle);
  ThrustLimits<double> limits;
  double min = 0;
  for (int i = 0; i < hover.rotors; ++i) {
    const auto k = static_cast<std::size_t>(i);
    limits.min[k] = rotor_thrust(vehicle.rotors[k], min_speed(vehicle));
    limits.max[k] = rotor_thrust(vehicle.rotors[k], max_speed(vehicle));
    min += limits.min[k];
  }
  // If the motors' idle thrust is above the floor, the idle thrust is the lower bound.
  limits.floor = std::max(kMinCollective * vehicle.mass * vehicle.gravity, min);
  return limits;
}

}  // namespace quadtune
