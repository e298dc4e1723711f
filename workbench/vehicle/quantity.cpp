// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/vehicle/quantity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <string_view>
#include <vector>

#include "quadtune/errors.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/words.hpp"

namespace quadtune {
namespace {

struct NamedUnit {
  const char* name;
  double factor;  ///< to the SI unit
};

constexpr double kTurn = 2 * std::numbers::pi;  // [rad]

std::vector<NamedUnit> units_of(QuantityUnit unit) {
  switch (unit) {
    case QuantityUnit::mass:
      return {{"g", 1e-3}, {"kg", 1}, {"oz", 0.028349523125}, {"lb", 0.45359237}};
    case QuantityUnit::length:
      return {{"mm", 1e-3}, {"cm", 1e-2}, {"m", 1}, {"in", 0.0254}};
    case QuantityUnit::force:
      return {{"N", 1}, {"gf", 9.80665e-3}, {"kgf", 9.80665}};
    case QuantityUnit::rotor_speed:
      return {{"rpm", kTurn / 60}, {"rad/s", 1}, {"Hz", kTurn}};
    case QuantityUnit::duration:
      return {{"ms", 1e-3}, {"s", 1}};
    case QuantityUnit::inertia:
      return {{"kgm2", 1}, {"gm2", 1e-3}, {"gcm2", 1e-7}, {"gmm2", 1e-9}};
  }
  return {};
}

/// "g, kg, oz or lb".
std::string listed(const std::vector<NamedUnit>& units) {
  std::string text;
  for (std::size_t i = 0; i < units.size(); ++i)
    text += fmt::format("{}{}", i == 0 ? "" : i + 1 == units.size() ? " or " : ", ", units[i].name);
  return text;
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at))
    text.replace(at, from.size(), to);
}

}  // namespace

double read_quantity(const std::string& text, QuantityUnit unit, const std::string& key) {
  std::string word = text;
  std::erase(word, ' ');
  replace_all(word, "²", "2");
  replace_all(word, "^2", "2");
  // The unit begins after the last character of the number; "1e3g" is a number with a unit, too.
  const std::vector<NamedUnit> units = units_of(unit);
  for (const NamedUnit& named : units) {
    const std::string_view name = named.name;
    if (!word.ends_with(name)) continue;
    double value = 0;
    const std::string number = word.substr(0, word.size() - name.size());
    if (internal::read_number(number, value) && value > 0) return value * named.factor;
  }
  const bool comma = word.find(',') != std::string::npos;
  throw OptionError(
      key, fmt::format("{} is '{}', expected a number greater than 0 with a unit: {}{}", key,
                       internal::printable(text), listed(units),
                       comma ? "; the decimal mark is a point" : ""));
}

}  // namespace quadtune
