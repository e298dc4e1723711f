// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/logs/filter_choice.hpp"

namespace quadtune {

FilterModel chosen_filter(FilterModel model, const FilterChoice& choice) {
  const auto parameter = [&](const std::string& name, const char* where) -> NoiseParameter& {
    return model.parameters[static_cast<std::size_t>(parameter_index(model, name, where))];
  };
  for (const std::string& name : choice.fixed) parameter(name, "--fix").fixed = true;
  for (const auto& [name, value] : choice.starts) parameter(name, "--start").start = value;
  for (FilterSensor& sensor : model.sensors) {
    if (choice.gate != 0) sensor.gate = choice.gate;
    if (choice.student != 0) sensor.student = choice.student;
  }
  validate(model, choice.gate != 0 || choice.student != 0 ? "--gate, --student" : "--start");
  return model;
}

}  // namespace quadtune
