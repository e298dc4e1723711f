// SPDX-License-Identifier: Apache-2.0
#include "quadtune/model/environment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <utility>
#include <vector>

#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune {
namespace {

std::string without_blanks(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string::npos) return "";
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

double number_of(const std::string& text, const std::string& key, const std::string& where) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end || !std::isfinite(value))
    throw InvalidInput(
        where, fmt::format("{} is '{}', expected a number", key, internal::printable(text)));
  return value;
}

}  // namespace

Wind parse_wind(const std::string& words, const std::string& where) {
  // Wind speeds at 6 m according to [MIL-F-8785C].
  static const std::vector<std::pair<std::string, double>> kinds = {
      {"calm", 0}, {"light", 7.7}, {"moderate", 15.4}, {"severe", 23.2}};
  Wind wind;
  for (const auto& [name, speed] : kinds)
    if (words == name) {
      wind.turbulence = speed;
      wind.mean.x() = speed;  // the wind speed at 6 m is also what drives the turbulence
      return wind;
    }
  const std::vector<std::pair<std::string, double*>> keys = {
      {"north", &wind.mean.x()},
      {"east", &wind.mean.y()},
      {"down", &wind.mean.z()},
      {"gust_north", &wind.gust.velocity.x()},
      {"gust_east", &wind.gust.velocity.y()},
      {"gust_down", &wind.gust.velocity.z()},
      {"gust_at", &wind.gust.start},
      {"gust_length", &wind.gust.length},
      {"turbulence", &wind.turbulence},
      {"turbulence_height", &wind.turbulence_height}};
  std::vector<std::string> known;
  known.reserve(std::size(keys));
  for (const auto& [name, target] : keys) known.push_back(name);
  std::vector<const double*> given;
  std::size_t begin = 0;
  while (begin <= words.size()) {
    const std::size_t end = std::min(words.find(',', begin), words.size());
    const std::string entry = without_blanks(words.substr(begin, end - begin));
    const std::size_t equals = entry.find('=');
    const std::string key = without_blanks(entry.substr(0, equals));
    double* target = nullptr;
    for (const auto& [name, number] : keys)
      if (name == key) target = number;
    if (equals == std::string::npos && std::isdigit(static_cast<unsigned char>(key[0])) != 0)
      throw InvalidInput(
          where, fmt::format("'{0}' has no direction, expected the direction the wind blows "
                             "to, such as north=3 [m/s], or light, moderate or "
                             "severe for turbulence",
                             internal::printable(entry)));
    if (target != nullptr && equals == std::string::npos)
      throw InvalidInput(where,
                         fmt::format("'{0}' has no value, expected {0}=NUMBER, such as {0}=3",
                                     internal::printable(entry)));
    if (target == nullptr)
      throw InvalidInput(
          where, fmt::format("no wind '{}', expected calm, light, moderate, severe or a list like "
                             "north=3,gust_east=2,gust_at=5 with {}{}",
                             internal::printable(entry), internal::joined(known, ", "),
                             internal::did_you_mean(key, known)));
    if (std::find(given.begin(), given.end(), target) != given.end())
      throw InvalidInput(where, fmt::format("'{}' is given twice, expected once", key));
    given.push_back(target);
    *target = number_of(without_blanks(entry.substr(equals + 1)), key, where);
    begin = end + 1;
  }
  if (wind.gust.start < 0)
    throw InvalidInput(where, fmt::format("gust_at is {} s, expected 0 or more", wind.gust.start));
  if (!(wind.gust.length > 0))
    throw InvalidInput(where,
                       fmt::format("gust_length is {} s, expected more than 0", wind.gust.length));
  const auto require_speed = [&](const char* what, const Eigen::Vector3d& velocity) {
    constexpr double kMaxSpeed = 100;  // no multirotor flies in it [m/s]
    if (velocity.norm() > kMaxSpeed)
      throw InvalidInput(where, fmt::format("the {} has a speed of {:.6g} m/s, expected at most "
                                            "{} m/s",
                                            what, velocity.norm(), kMaxSpeed));
  };
  require_speed("wind (north, east, down)", wind.mean);
  require_speed("gust (gust_north, gust_east, gust_down)", wind.gust.velocity);
  if (!(wind.turbulence >= 0 && wind.turbulence <= 100))
    throw InvalidInput(where,
                       fmt::format("turbulence is {} m/s, expected 0 to 100", wind.turbulence));
  if (!(wind.turbulence_height >= 3 && wind.turbulence_height <= 300))
    throw InvalidInput(where,
                       fmt::format("turbulence_height is {} m, expected 3 to 300, where the scales "
                                   "of turbulence are defined",
                                   wind.turbulence_height));
  return wind;
}

}  // namespace quadtune
