// SPDX-License-Identifier: Apache-2.0
#include "quadtune/flight_condition.hpp"

#include "quadtune/errors.hpp"
#include "quadtune/internal/enum_names.hpp"
#include "quadtune/internal/suggest.hpp"

namespace quadtune {

FlightCondition steady_flight(double speed, double climb, double yaw_rate, double yaw) {
  FlightCondition condition;
  condition.yaw = yaw;
  condition.speed = speed;
  condition.climb = climb;
  if (yaw_rate != 0 && speed != 0) {
    condition.kind = FlightKind::circle;
    condition.radius = speed / yaw_rate;
  } else if (yaw_rate != 0) {
    condition.kind = FlightKind::spin;
    condition.yaw_rate = yaw_rate;
  } else if (speed != 0 || climb != 0) {
    condition.kind = FlightKind::line;
  }
  return condition;
}

constexpr internal::EnumName<FlightKind> kFlightKinds[] = {{FlightKind::hover, "hover"},
                                                           {FlightKind::line, "line"},
                                                           {FlightKind::circle, "circle"},
                                                           {FlightKind::spin, "spin"}};

std::string to_string(FlightKind kind) { return internal::name_in(kFlightKinds, kind); }

FlightKind flight_kind(const std::string& name, const std::string& where) {
  if (const auto kind = internal::value_in(kFlightKinds, name)) return *kind;
  throw InvalidInput(where, "'" + name + "', expected hover, line, circle or spin" +
                                internal::did_you_mean(name, internal::names_in(kFlightKinds)));
}

}  // namespace quadtune
