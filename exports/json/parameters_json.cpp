// SPDX-License-Identifier: Apache-2.0
// An autopilot's parameters as JSON: the values of a parameter file, by name.
#include <fmt/format.h>

#include <algorithm>

#include "firmware/firmware_parts.hpp"
#include "json/to_json.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/firmware.hpp"
#include "quadtune/internal/json.hpp"

namespace quadtune::exports {

Json parameters_to_json(const StoredParameters& parameters) {
  const Firmware& firmware = parameters.firmware;
  Json json = {{"firmware", to_string(firmware.kind)},
               {"version", firmware.version},
               {"setup", firmware.setup},
               {"values", Json::object()}};
  for (const Parameter& parameter : parameters.values)
    json["values"][parameter.name] =
        internal::number_to_json(parameter.value, "parameters." + parameter.name);
  return json;
}

StoredParameters parameters_from_json(const Json& json, const std::string& where) {
  const auto word = [&](const char* key) {
    return internal::string_from_json(internal::member(json, key, where), where + "." + key);
  };
  StoredParameters parameters;
  parameters.firmware =
      firmware(firmware_kind(word("firmware"), where + ".firmware"),
               FirmwareOptions{.version = word("version"), .setup = word("setup")}, where);
  const Json& values = internal::member(json, "values", where);
  if (!values.is_object())
    throw InvalidInput(where + ".values",
                       fmt::format("is {}, expected parameters by name", values.type_name()));
  const std::vector<ParameterFacts> known = parameter_facts(parameters.firmware);
  for (const std::string& name : values.keys()) {
    const std::string place = where + ".values." + internal::printable(name);
    const auto facts = std::find_if(known.begin(), known.end(),
                                    [&](const ParameterFacts& one) { return one.name == name; });
    if (facts == known.end())
      throw InvalidInput(
          place, fmt::format("is not a parameter of the control loops of {} {}",
                             to_string(parameters.firmware.kind), parameters.firmware.version));
    const double number = internal::number_from_json(values[name], place);
    if (const std::string why = why_no_value(*facts, number); !why.empty())
      throw InvalidInput(place, why);
    parameters.values.push_back({name, number});
  }
  return parameters;
}

}  // namespace quadtune::exports
