// SPDX-License-Identifier: Apache-2.0
// Parameter files as written by each firmware or its ground station. docs/formats.md, "Parameters
// of firmware".
#include <fmt/format.h>

#include <algorithm>

#include "firmware/firmware_parts.hpp"
#include "quadtune/exports/firmware.hpp"

namespace quadtune {
namespace {

/// The shortest number that reads back to the same float, or to the same integer.
std::string number(const ParameterFacts& facts, double value) {
  return facts.integer ? fmt::format("{:.0f}", value)
                       : fmt::format("{}", static_cast<float>(value));
}

std::string px4_line(const ParameterFacts& facts, double value) {
  // System and component 1; MAV_PARAM_TYPE 6 is INT32, 9 is REAL32.
  return fmt::format(
      "1\t1\t{}\t{}\t{}\n", facts.name,
      facts.integer ? number(facts, value) : fmt::format("{:.9g}", static_cast<float>(value)),
      facts.integer ? 6 : 9);
}

std::string crazyflie_lines(const ParameterFacts& facts, double value) {
  const auto with_point = [&](double v) {
    std::string text = number(facts, v);
    // Readers of YAML 1.1 take a number without a point for text or an integer.
    if (!facts.integer && text.find('.') == std::string::npos)
      text.insert(std::min(text.find('e'), text.size()), ".0");
    return text;
  };
  return fmt::format("  {}:\n    default_value: {}\n    is_stored: true\n    stored_value: {}\n",
                     facts.name, with_point(facts.usual), with_point(value));
}

struct Frame {
  const char* before;  ///< lines between the comment and the values
  const char* after;
};

Frame frame_of(FirmwareKind kind) {
  switch (kind) {
    case FirmwareKind::px4:
      return {"#\n# Vehicle-Id Component-Id Name Value Type\n", ""};
    case FirmwareKind::ardupilot:
      return {"", ""};
    case FirmwareKind::betaflight:
      // While the sliders are on, they overwrite the gains.
      return {"batch start\nprofile 0\nset simplified_pids_mode = OFF\n", "batch end\nsave\n"};
    case FirmwareKind::crazyflie:
      return {"params:\n", "type: persistent_param_state\nversion: '1'\n"};
  }
  return {"", ""};
}

std::string line_of(FirmwareKind kind, const ParameterFacts& facts, double value) {
  switch (kind) {
    case FirmwareKind::px4:
      return px4_line(facts, value);
    case FirmwareKind::ardupilot:
      return fmt::format("{},{}\n", facts.name, number(facts, value));
    case FirmwareKind::betaflight:
      return fmt::format("set {} = {}\n", facts.name, number(facts, value));
    case FirmwareKind::crazyflie:
      return crazyflie_lines(facts, value);
  }
  return {};
}

}  // namespace

std::string parameter_text(const Firmware& firmware, const std::vector<Parameter>& values,
                           const std::vector<std::string>& header) {
  std::string text;
  for (const std::string& line : header) text += "# " + line + "\n";
  const Frame frame = frame_of(firmware.kind);
  text += frame.before;
  for (const ParameterFacts& facts : parameter_facts(firmware))
    for (const Parameter& parameter : values)
      if (parameter.name == facts.name) text += line_of(firmware.kind, facts, parameter.value);
  return text + frame.after;
}

}  // namespace quadtune
