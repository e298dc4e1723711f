// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/logs/filter_choice.hpp"

#include <fmt/format.h>

#include "quadtune/errors.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/words.hpp"

namespace quadtune {

using internal::printable;

NoiseMethod noise_method(const std::string& word) {
  if (word == "ml") return NoiseMethod::likelihood;
  if (word == "als") return NoiseMethod::autocovariances;
  throw OptionError("method", fmt::format("method is '{}', expected ml or als", printable(word)));
}

std::vector<std::pair<std::string, std::string>> named_words(const std::vector<std::string>& texts,
                                                             const std::string& key,
                                                             const std::string& name,
                                                             const std::string& word) {
  std::vector<std::pair<std::string, std::string>> named;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
      throw OptionError(
          key, fmt::format("{} is '{}', expected {}={}", key, printable(text), name, word));
    named.emplace_back(text.substr(0, equals), text.substr(equals + 1));
  }
  return named;
}

std::vector<std::pair<std::string, double>> named_numbers(const std::vector<std::string>& texts,
                                                          const std::string& key) {
  std::vector<std::pair<std::string, double>> named;
  for (const std::string& text : texts) {
    const auto [name, word] = named_words({text}, key, "NAME", "NUMBER").front();
    double value = 0;
    if (!internal::read_number(word, value))
      throw OptionError(key,
                        fmt::format("{}: '{}' for {} is not a number", key, printable(word), name));
    named.emplace_back(name, value);
  }
  return named;
}

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
  validate(model, choice.gate != 0 ? "--gate" : choice.student != 0 ? "--student" : "--start");
  return model;
}

}  // namespace quadtune
