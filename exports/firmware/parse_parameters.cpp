// SPDX-License-Identifier: Apache-2.0
// Reads parameter files, complete dumps of a board as well as short lists; parameters of other
// parts of the firmware are counted.
#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <sstream>

#include "firmware/firmware_parts.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/firmware.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/words.hpp"

namespace quadtune {
namespace {

using internal::printable;

/// The contents of a file, validated line by line.
class Collector {
 public:
  Collector(const Firmware& firmware, const std::string& origin)
      : facts_(parameter_facts(firmware)), firmware_(firmware), origin_(origin) {}

  [[noreturn]] void refuse(int line, const std::string& what) const {
    throw InvalidInput(fmt::format("{}:{}", origin_, line), what);
  }

  /// Rejects another type, because a board ignores such a value.
  void require_type(int line, const std::string& name, const std::string& type) const {
    for (const ParameterFacts& one : facts_)
      if (one.name == name && type != (one.integer ? "6" : "9"))
        refuse(line, fmt::format("type of {} is '{}', expected {}", name, printable(type),
                                 one.integer ? "6 (INT32)" : "9 (REAL32)"));
  }

  void add(int line, const std::string& name, const std::string& word) {
    const auto facts = std::find_if(facts_.begin(), facts_.end(),
                                    [&](const ParameterFacts& one) { return one.name == name; });
    if (facts == facts_.end()) {
      pass_over(line, name);
      return;
    }
    for (const Parameter& earlier : file.values)
      if (earlier.name == name)
        refuse(line, name + " occurs twice; expected once, because only one value is used");
    double value = 0;
    if (!internal::read_number(word, value) || !std::isfinite(value))
      refuse(line, fmt::format("{} is '{}', expected a finite number", name, printable(word)));
    if (const std::string why = exports::why_no_value(*facts, value); !why.empty())
      refuse(line, name + " " + why);
    file.values.push_back({name, value});
  }

  [[nodiscard]] ParameterFile finish() {
    if (file.values.empty())
      throw InvalidInput(
          origin_, fmt::format("has no parameter of the control loops of {} {}; expected "
                               "at least one such as {}",
                               to_string(firmware_.kind), firmware_.version, facts_.front().name));
    return std::move(file);
  }

  ParameterFile file;

 private:
  std::vector<ParameterFacts> facts_;
  const Firmware& firmware_;
  std::string origin_;

  void pass_over(int line, const std::string& name) {
    require_version(line, name);
    std::vector<std::string> known;
    for (const ParameterFacts& one : facts_) known.push_back(one.name);
    const std::string near = internal::nearest(name, known);
    // The first letter tells apart short names, such as p_roll and s_roll of Betaflight.
    constexpr std::size_t kMaxNotes = 10;
    if (file.notes.size() < kMaxNotes && !near.empty() &&
        internal::edit_distance(name, near) == 1 && name.front() == near.front())
      file.notes.push_back(fmt::format("{}:{}: {} is ignored; did you mean {}?", origin_, line,
                                       printable(name), near));
    else
      ++file.others;
  }

  /// Rejects a name of another version, because the board would silently ignore it.
  void require_version(int line, const std::string& name) const {
    for (const auto& [other, version] : others_)
      if (other == name)
        refuse(line, fmt::format("{} belongs to {} {}, expected names of version {}, because the "
                                 "board silently ignores the others; --firmware selects the "
                                 "version",
                                 name, to_string(firmware_.kind), version, firmware_.version));
  }

  /// Names that exist only in other versions.
  std::vector<std::pair<std::string, std::string>> others_ = [this] {
    std::vector<std::pair<std::string, std::string>> names;
    for (const std::string& version : firmware_versions(firmware_.kind))
      for (const ParameterFacts& other :
           parameter_facts({firmware_.kind, version, firmware_.setup}))
        if (std::none_of(facts_.begin(), facts_.end(),
                         [&](const ParameterFacts& own) { return own.name == other.name; }))
          names.emplace_back(other.name, version);
    return names;
  }();
};

/// Calls `use` with each line and its number, without its end.
void each_line(const std::string& text, const std::function<void(int, std::string)>& use) {
  std::istringstream stream(text.starts_with("\xef\xbb\xbf") ? text.substr(3) : text);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    if (line.ends_with('\r')) line.pop_back();
    use(number, line);
  }
}

std::vector<std::string> split(const std::string& line, const char* separators) {
  std::vector<std::string> words;
  std::size_t at = line.find_first_not_of(separators);
  while (at != std::string::npos) {
    const std::size_t end = line.find_first_of(separators, at);
    words.push_back(line.substr(at, end - at));
    at = line.find_first_not_of(separators, end);
  }
  return words;
}

void parse_px4(const std::string& text, Collector& collector) {
  each_line(text, [&](int number, const std::string& line) {
    if (line.empty() || line[0] == '#') return;
    const std::vector<std::string> words = split(line, "\t");
    if (words.size() != 5)
      collector.refuse(number, fmt::format("has {} column{}, expected 5, separated by tabs: "
                                           "vehicle, component, name, value, type",
                                           words.size(), words.size() == 1 ? "" : "s"));
    if (words[1] != "1") return;  // of another component, such as a gimbal
    collector.require_type(number, words[2], words[4]);
    collector.add(number, words[2], words[3]);
  });
}

void parse_ardupilot(const std::string& text, Collector& collector) {
  each_line(text, [&](int number, const std::string& line) {
    if (line.empty() || line[0] == '#') return;
    const std::vector<std::string> words = split(line, ", =\t");
    const bool read_only = words.size() == 3 && words[2] == "@READONLY";
    if (words.size() != 2 && !read_only)
      collector.refuse(number,
                       fmt::format("has {} words, expected a name and a value", words.size()));
    collector.add(number, words[0], words[1]);
  });
}

/// The profile that the file selects last, which is the one that the board flies; empty if there is
/// none.
std::string last_profile(const std::string& text) {
  std::string last;
  each_line(text, [&](int, const std::string& line) {
    const std::vector<std::string> words = split(line, " \t=");
    if (words.size() == 2 && words[0] == "profile") last = words[1];
  });
  return last;
}

void parse_betaflight(const std::string& text, Collector& collector) {
  const std::string flown = last_profile(text);
  bool of_other_profile = false, sliders_off = false;
  std::vector<std::string>& notes = collector.file.notes;
  each_line(text, [&](int number, const std::string& line) {
    const std::vector<std::string> words = split(line, " \t=");
    if (words.empty() || words[0].starts_with("#")) return;
    if (words[0] == "profile" && words.size() == 2) of_other_profile = words[1] != flown;
    if (words[0] != "set" || of_other_profile) return;
    if (words.size() != 3) {
      if (words.size() < 3)
        collector.refuse(number, "is not a setting; expected `set NAME = VALUE`");
      ++collector.file.others;  // a list or a text
    } else if (words[1] == "simplified_pids_mode") {
      sliders_off = words[2] == "OFF";
    } else {
      if ((words[1] == "thrust_linear" && words[2] != "0") ||
          (words[1] == "yaw_motors_reversed" && words[2] == "ON") ||
          (words[1] == "use_integrated_yaw" && words[2] == "ON"))
        notes.push_back(fmt::format("{} is {}, which is not modelled", words[1], words[2]));
      collector.add(number, words[1], words[2]);
    }
  });
  if (!flown.empty())
    notes.push_back("profile " + flown + " is read, because the file selects it last");
  if (!sliders_off)
    notes.emplace_back(
        "the file does not set simplified_pids_mode = OFF: the sliders may overwrite its gains");
}

void parse_crazyflie(const std::string& text, const std::string& origin, Collector& collector) {
  const auto line_of = [](const YAML::Node& node) { return node.Mark().line + 1; };
  try {
    const YAML::Node file = YAML::Load(text);
    if (!file.IsMap() || !file["params"] || !file["params"].IsMap())
      throw InvalidInput(origin, "has no map 'params'; expected a file of persistent parameters");
    if (!file["type"] || file["type"].as<std::string>() != "persistent_param_state" ||
        !file["version"] || file["version"].as<std::string>() != "1" ||
        file["version"].Tag() != "!")
      throw InvalidInput(origin,
                         "is not a file of persistent parameters, expected the lines \"type: "
                         "persistent_param_state\" and \"version: '1'\", in which 1 is in quotes");
    for (const auto& entry : file["params"]) {
      const std::string name = entry.first.as<std::string>();
      const YAML::Node& state = entry.second;
      if (!state.IsMap() || !state["is_stored"] || !state["default_value"] ||
          !state["stored_value"])
        collector.refuse(line_of(entry.first),
                         fmt::format("{} lacks default_value, is_stored or stored_value; expected "
                                     "all three, without which the client fails",
                                     printable(name)));
      const bool stored = state["is_stored"].as<bool>();
      const YAML::Node value = state[stored ? "stored_value" : "default_value"];
      collector.add(line_of(entry.first), name,
                    value.IsScalar() ? value.as<std::string>() : std::string());
    }
  } catch (const YAML::Exception& error) {
    throw InvalidInput(fmt::format("{}:{}", origin, error.mark.line + 1),
                       "is not YAML: " + error.msg);
  }
}

}  // namespace

ParameterFile parse_parameters(const Firmware& firmware, const std::string& text,
                               const std::string& origin) {
  internal::require_text(text, origin, std::size_t{16} << 20);
  Collector collector(firmware, origin);
  switch (firmware.kind) {
    case FirmwareKind::px4:
      parse_px4(text, collector);
      break;
    case FirmwareKind::ardupilot:
      parse_ardupilot(text, collector);
      break;
    case FirmwareKind::betaflight:
      parse_betaflight(text, collector);
      break;
    case FirmwareKind::crazyflie:
      parse_crazyflie(text, origin, collector);
      break;
  }
  return collector.finish();
}

namespace exports {

std::string why_no_value(const ParameterFacts& facts, double value) {
  if (!std::isfinite(value)) return fmt::format("is {}, expected a finite number", value);
  if (std::abs(value) > std::numeric_limits<float>::max())
    return fmt::format("is {}, expected a number that fits a float", value);
  const std::string& name = facts.name;
  // A vehicle with strong or weak motors hovers outside the published range of this parameter.
  if (name == "MOT_THST_HOVER")
    return value > 0 && value < 1
               ? ""
               : fmt::format("is {}, expected more than 0 and less than 1", value);
  // Ranges of gains are only advice; other parameters are invalid outside their ranges.
  const bool strict = facts.integer || name.starts_with("MOT_") || name.starts_with("THR_") ||
                      name.starts_with("CA_");
  if (strict && (value < facts.min.value_or(value) || value > facts.max.value_or(value)))
    return fmt::format("is {}, expected {:g} to {:g}", value, facts.min.value_or(-INFINITY),
                       facts.max.value_or(INFINITY));
  if (facts.unit == "Hz" && value != 0 && value < 1)
    return fmt::format("is {} Hz, expected 0 or at least 1", value);
  if (facts.integer && value != std::round(value))
    return fmt::format("is {}, expected a whole number", value);
  if (value < 0 && facts.min.value_or(0) >= 0)
    return fmt::format(
        "is {}, expected 0 or more, because a negative gain drives a rotor the "
        "wrong way",
        value);
  return "";
}

}  // namespace exports
}  // namespace quadtune
