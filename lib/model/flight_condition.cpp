// SPDX-License-Identifier: Apache-2.0
#include "quadtune/flight_condition.hpp"

#include "quadtune/errors.hpp"
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

std::string to_string(FlightKind kind) {
  switch (kind) {
    case FlightKind::hover:
      return "hover";
    case FlightKind::line:
      return "line";
    case FlightKind::circle:
      return "circle";
    case FlightKind::spin:
      return "spin";
  }
  return "";
}

FlightKind flight_kind(const std::string& name, const std::string& where) {
  for (const FlightKind kind :
       {FlightKind::hover, FlightKind::line, FlightKind::circle, FlightKind::spin})
    if (to_string(kind) == name) return kind;
  throw InvalidInput(where, "'" + name + "', expected hover, line, circle or spin" +
                                internal::did_you_mean(name, {"hover", "line", "circle", "spin"}));
}

}  // namespace quadtune
