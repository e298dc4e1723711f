// SPDX-License-Identifier: Apache-2.0
#include "report/vehicles/new_vehicle_report.hpp"

#include <fmt/format.h>

#include "quadtune/internal/json.hpp"

namespace quadtune::report {

std::vector<std::string> estimate_notes(const NewVehicle& made) {
  std::vector<std::string> notes;
  for (const EstimatedNumber& one : made.estimates)
    notes.push_back(fmt::format(
        "{} {:.3g} {} is an estimate{}, from {}; to measure it: {}", one.quantity, one.value,
        one.unit, one.spread > 0 ? fmt::format(" within {:.0f} %", 100 * one.spread) : "",
        one.source, one.measure));
  return notes;
}

internal::Json new_vehicle_json(const NewVehicle& made) {
  internal::Json json;
  json["name"] = made.vehicle.name;
  json["file"] = made.text;
  json["spread"] = {{"mass", made.spread.mass},
                    {"inertia", made.spread.inertia},
                    {"thrust", made.spread.thrust},
                    {"motor_lag", made.spread.motor_lag}};
  json["estimates"] = internal::Json::array();
  for (const EstimatedNumber& one : made.estimates)
    json["estimates"].push_back({{"quantity", one.quantity},
                                 {"value", one.value},
                                 {"unit", one.unit},
                                 {"spread", one.spread},
                                 {"source", one.source},
                                 {"measure", one.measure}});
  return json;
}

}  // namespace quadtune::report
