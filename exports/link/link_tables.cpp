// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "quadtune/errors.hpp"
#include "quadtune/exports/link.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune {
namespace {

// --- table 5.1: 32-bit integers [id, arguments...] ---

/// The vehicle subtracts 10 rad, so that the transmitted value is positive.
LinkArgument angle(const std::string& name, double limit, const std::string& why) {
  return {name, "rad", -limit, limit, why, 4, 1000, 10'000};
}

LinkArgument distance(const std::string& name) {
  return {name, "m", -100, 100, "the vehicle has to stay in sight", 4, 100};
}

std::vector<LinkEntry> simulink_entries() {
  // A right angle and a half turn, rounded to the resolution of the frame.
  constexpr double kRightAngle = 1.571, kHalfTurn = 3.142;
  const std::string tilt = "beyond a right angle the rotors push towards the ground";
  return {{"takeoff",
           "turns the motors on",
           1,
           {{"power", "%", 0, 100, "it is a share of full power"}}},
          {"land", "stops the motors", 2, {}, true},
          {"pitch", "sets the pitch reference", 11, {angle("pitch", kRightAngle, tilt)}},
          {"roll", "sets the roll reference", 12, {angle("roll", kRightAngle, tilt)}},
          {"yaw",
           "sets the yaw reference",
           13,
           {angle("yaw", kHalfTurn, "a half turn either way reaches every heading")}},
          {"height",
           "sets the height reference",
           14,
           {{"z", "m", -10, 0, "z points down, so the ground is 0 and above it z is negative", 4,
             100}}},
          {"position", "sets the reference of x and y", 15, {distance("x"), distance("y")}},
          {"read", "requests sensor data", 10},
          {"snapshot", "takes a picture with the camera below", 16, {}, false, false},
          {"abort", "stops the motors and signals an emergency", 3, {}, true}};
}

// --- table 5.2: a header of 7 bytes, an id of 4, arguments of 8, 16 or 32 bits ---

LinkArgument share(const std::string& name) {
  return {name, "%", -100, 100, "it is a share of the largest value", 1};
}

/// An id in project 2 of the manufacturer's protocol, with a class and a 16-bit command number.
constexpr std::uint32_t native_id(std::uint32_t group, std::uint32_t command) {
  return 2U | group << 8U | command << 16U;
}

std::vector<LinkEntry> native_entries() {
  return {{"takeoff", "takes off", native_id(0, 1)},
          {"land", "lands", native_id(0, 3), {}, true},
          // The table prints one zero at the end, but the frame length of 20 has room for four.
          {"move",
           "tilts, turns and climbs by percentages of the maximum values",
           native_id(0, 2),
           {share("roll"), share("pitch"), share("rotation"), share("climb")},
           false,
           true,
           {1},
           {0, 0, 0, 0}},
          {"turn",
           "turns about the vertical axis, clockwise",
           native_id(4, 1),
           {{"angle", "deg", -180, 180, "a half turn either way reaches every heading", 2}}},
          {"flip",
           "flips over",
           native_id(4, 0),
           {{"direction",
             "",
             0,
             3,
             "there are four directions",
             4,
             1,
             0,
             {"front", "back", "right", "left"}}}}};
}

}  // namespace

std::string to_string(LinkFirmware firmware) {
  return firmware == LinkFirmware::simulink ? "simulink" : "native";
}

LinkFirmware link_firmware(const std::string& word) {
  if (word == "simulink") return LinkFirmware::simulink;
  if (word == "native") return LinkFirmware::native;
  throw OptionError(
      "firmware",
      fmt::format("firmware {}, expected simulink or native, because their frames differ{}",
                  word.empty() ? "is missing" : fmt::format("is '{}'", internal::printable(word)),
                  internal::did_you_mean(word, {"simulink", "native"})));
}

std::uint16_t link_port(LinkFirmware firmware) {
  return firmware == LinkFirmware::simulink ? 12391 : 6000;
}

const std::vector<LinkEntry>& link_entries(LinkFirmware firmware) {
  static const std::vector<LinkEntry> simulink = simulink_entries();
  static const std::vector<LinkEntry> native = native_entries();
  return firmware == LinkFirmware::simulink ? simulink : native;
}

const LinkEntry& link_entry(LinkFirmware firmware, const std::string& name) {
  const std::vector<LinkEntry>& entries = link_entries(firmware);
  const auto found = std::find_if(entries.begin(), entries.end(),
                                  [&](const LinkEntry& entry) { return entry.name == name; });
  if (found != entries.end()) return *found;
  std::vector<std::string> names;
  names.reserve(entries.size());
  for (const LinkEntry& entry : entries) names.push_back(entry.name);
  const std::string what =
      name.empty() ? "is empty" : fmt::format("'{}' is not a command", internal::printable(name));
  throw InvalidInput("command", fmt::format("{}, expected a command of the firmware {}: {}{}", what,
                                            to_string(firmware), internal::joined(names, ", "),
                                            internal::did_you_mean(name, names)));
}

}  // namespace quadtune
