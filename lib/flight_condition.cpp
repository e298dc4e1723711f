// SPDX-License-Identifier: Apache-2.0
#include "quadtune/flight_condition.hpp"

#include "quadtune/errors.hpp"
#include "quadtune/internal/suggest.hpp"

namespace quadtune {

std::string to_string(FlightKind kind) {
  switch (kind) {
    case FlightKind::hover:
      return "hover";
    case FlightKind::line:
      return "line";
    case FlightKind::circle:
      return "circle";
  }
  return "";
}

FlightKind flight_kind(const std::string& name, const std::string& where) {
  for (const FlightKind kind : {FlightKind::hover, FlightKind::line, FlightKind::circle})
    if (to_string(kind) == name) return kind;
  throw InvalidInput(where, "'" + name + "', expected hover, line or circle" +
                                internal::did_you_mean(name, {"hover", "line", "circle"}));
}

}  // namespace quadtune
