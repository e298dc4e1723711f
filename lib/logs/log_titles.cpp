// SPDX-License-Identifier: Apache-2.0
#include "logs/log_titles.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

namespace quadtune::internal {
namespace {

using Pair = std::pair<std::string_view, std::string_view>;

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

// ROS names the time of a measurement header.stamp, after a path.
bool is_clock(std::string_view name) {
  const std::string word = lower(name);
  return word == "t" || word == "time" || word == "timestamp" || word == "stamp" ||
         word.ends_with("header.stamp");
}

// "TimeUS" is ArduPilot's clock in microseconds.
std::string_view unit_of_clock_name(std::string_view name) {
  const std::string word = lower(name);
  for (const std::string_view unit : {"us", "ms", "ns"})
    for (const std::string_view clock : {"time", "timestamp"})
      if (word.size() == clock.size() + unit.size() && word.starts_with(clock) &&
          word.ends_with(unit))
        return unit;
  return {};
}

// Suffixes of quadtune's own keys. Single letters other than m are not units, since they occur as
// names (v_N is north).
constexpr std::array<Pair, 14> kEndings = {{{"_m_per_s2", "m/s^2"},
                                            {"_m_per_s", "m/s"},
                                            {"_rad_per_s", "rad/s"},
                                            {"_deg_per_s", "deg/s"},
                                            {"_m_s2", "m/s^2"},
                                            {"_rad", "rad"},
                                            {"_deg", "deg"},
                                            {"_hPa", "hPa"},
                                            {"_Pa", "Pa"},
                                            {"_degC", "degC"},
                                            {"_uT", "uT"},
                                            {"_Hz", "Hz"},
                                            {"_kg", "kg"},
                                            {"_m", "m"}}};

// Splits a text into the name and the content of brackets at its end.
Pair bracketed(std::string_view text) {
  for (const Pair& brackets : {Pair{"[", "]"}, Pair{"(", ")"}}) {
    const std::size_t open = text.rfind(brackets.first);
    if (!text.ends_with(brackets.second) || open == std::string_view::npos || open == 0) continue;
    return {trimmed(text.substr(0, open)), trimmed(text.substr(open + 1, text.size() - open - 2))};
  }
  return {text, ""};
}

// An index as in state[0] belongs to the name.
bool is_index(std::string_view text) {
  return !text.empty() && text != "1" && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isdigit(c) != 0 || c == ',';
  });
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

double ticks_of(std::string_view unit_as_written) {
  const std::string unit = lower(unit_as_written);
  if (unit == "s" || unit == "sec" || unit == "seconds") return 1;
  if (unit == "ms" || unit == "msec") return 1e3;
  if (unit == "us" || unit == "usec" || unit == "\xc2\xb5s" || unit == "\xce\xbcs") return 1e6;
  if (unit == "ns" || unit == "nsec") return 1e9;
  return 0;
}

std::string common_unit(std::string_view unit) {
  constexpr std::array<Pair, 12> kSpellings = {{{"rad s^-1", "rad/s"},
                                                {"deg s^-1", "deg/s"},
                                                {"m s^-1", "m/s"},
                                                {"m s^-2", "m/s^2"},
                                                {"m/s2", "m/s^2"},
                                                {"m/s\xc2\xb2", "m/s^2"},
                                                {"m/s/s", "m/s^2"},
                                                {"rads", "rad/s"},
                                                {"rad s-1", "rad/s"},
                                                {"m s-1", "m/s"},
                                                {"m s-2", "m/s^2"},
                                                {"metres", "m"}}};
  const std::string_view plain = trimmed(unit);
  for (const auto& [spelling, common] : kSpellings)
    if (plain == spelling) return std::string(common);
  return std::string(plain);
}

LogTitle title_of(std::string_view text) {
  text = trimmed(text);
  auto [name, unit] = bracketed(text);
  if (is_index(unit) && !is_clock(name)) return {std::string(text), "", 0, false};
  LogTitle title{std::string(name), common_unit(unit), 0, false};
  if (is_clock(name)) {
    title.ticks = unit.empty() ? 1 : ticks_of(unit);
    title.guessed = unit.empty();
    return title;
  }
  if (!unit.empty()) return title;
  if (const std::string_view ending = unit_of_clock_name(name); !ending.empty()) {
    title.unit = ending;
    title.ticks = ticks_of(ending);
    return title;
  }
  const std::size_t bar = name.rfind('_');
  if (bar != std::string_view::npos && is_clock(name.substr(0, bar))) {
    title.ticks = ticks_of(name.substr(bar + 1));
    if (title.ticks > 0) title.unit = name.substr(bar + 1);
    return title;
  }
  for (const auto& [ending, meaning] : kEndings)
    if (name.size() > ending.size() && name.ends_with(ending)) {
      title.unit = meaning;
      break;
    }
  return title;
}

}  // namespace quadtune::internal
