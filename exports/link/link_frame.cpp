// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "quadtune/errors.hpp"
#include "quadtune/exports/link.hpp"
#include "quadtune/internal/counted.hpp"

namespace quadtune {
namespace {

// Native firmware: type and buffer of frames with and without acknowledgement, and the bytes before
// the id.
constexpr std::uint8_t kAcknowledgement = 0x01;
constexpr std::array<std::uint8_t, 2> kAnswered = {0x04, 0x0b};
constexpr std::array<std::uint8_t, 2> kUnanswered = {0x02, 0x0a};
constexpr std::size_t kHeader = 7;
constexpr std::size_t kId = 4;

/// Least significant byte first.
LinkFrame little_endian(std::int64_t value, std::size_t bytes) {
  LinkFrame frame;
  for (std::size_t i = 0; i < bytes; ++i)
    frame.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i)));
  return frame;
}

std::uint64_t natural(std::span<const std::uint8_t> bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) value |= std::uint64_t{bytes[i]} << (8 * i);
  return value;
}

/// Two's complement of 1, 2 or 4 bytes.
std::int64_t whole(std::span<const std::uint8_t> bytes) {
  const std::uint64_t value = natural(bytes);
  const std::uint64_t beyond = std::uint64_t{1} << (8 * bytes.size());
  return value >= beyond / 2 ? static_cast<std::int64_t>(value) - static_cast<std::int64_t>(beyond)
                             : static_cast<std::int64_t>(value);
}

std::string value_text(const LinkArgument& argument, double value) {
  if (!argument.unit.empty()) return fmt::format("{} {}", value, argument.unit);
  return fmt::format("{}", value);
}

void require_limits(const LinkArgument& argument, double value, const std::string& where) {
  const bool in_range = std::isfinite(value) && value >= argument.low && value <= argument.high;
  const bool is_named = argument.words.empty() || value == std::floor(value);
  if (in_range && is_named) return;
  throw InvalidInput(where, fmt::format("{} is {}, expected {} to {}, because {}", argument.name,
                                        value_text(argument, value), argument.low,
                                        value_text(argument, argument.high), argument.why));
}

std::int64_t integer_of(const LinkArgument& argument, double value) {
  return std::llround(value * argument.per_unit) + argument.offset;
}

/// Computed with a single division, so that 10050 is read as 0.05 rad and not as
/// 0.05000000000000071.
double value_of(const LinkArgument& argument, std::int64_t integer) {
  return static_cast<double>(integer - argument.offset) / argument.per_unit;
}

std::size_t length_of(LinkFirmware firmware, const LinkEntry& entry) {
  std::size_t length = kId + entry.before.size() + entry.after.size();
  for (const LinkArgument& argument : entry.arguments) length += argument.bytes;
  return firmware == LinkFirmware::native ? kHeader + length : length;
}

const LinkEntry& checked_entry(const LinkCommand& command) {
  const LinkEntry& entry = link_entry(command.firmware, command.name);
  if (command.values.size() != entry.arguments.size())
    throw InvalidInput(entry.name, fmt::format("number of values is {}, expected {}",
                                               command.values.size(), entry.arguments.size()));
  for (std::size_t i = 0; i < entry.arguments.size(); ++i)
    require_limits(entry.arguments[i], command.values[i], entry.name);
  return entry;
}

[[noreturn]] void refuse_frame(const std::string& message) { throw InvalidInput("frame", message); }

void require_byte(std::span<const std::uint8_t> frame, std::size_t at, std::uint8_t expected,
                  const std::string& what) {
  if (frame[at] != expected)
    refuse_frame(fmt::format("byte {} is {:02x}, expected {:02x}, because it is {}", at + 1,
                             frame[at], expected, what));
}

/// Reads the header of a frame of the native firmware into the command.
void decode_header(std::span<const std::uint8_t> frame, LinkCommand& command) {
  if (frame[0] != kAnswered[0] && frame[0] != kUnanswered[0])
    refuse_frame(
        fmt::format("byte 1, the type, is {:02x}, expected 04 (with acknowledgement) or 02 "
                    "(without)",
                    frame[0]));
  command.acknowledged = frame[0] == kAnswered[0];
  require_byte(frame, 1, command.acknowledged ? kAnswered[1] : kUnanswered[1],
               fmt::format("the buffer of the type {:02x}", frame[0]));
  command.sequence = frame[2];
  const std::uint64_t length = natural(frame.subspan(3, 4));
  if (length != frame.size())
    refuse_frame(
        fmt::format("the header states a length of {} bytes; expected {}, the length of the frame",
                    length, frame.size()));
}

const LinkEntry& entry_of_id(LinkFirmware firmware, std::span<const std::uint8_t> id) {
  for (const LinkEntry& entry : link_entries(firmware))
    if (entry.id == natural(id)) return entry;
  std::string known;
  for (const LinkEntry& entry : link_entries(firmware))
    known += fmt::format("{}{} ({})", known.empty() ? "" : ", ",
                         link_hex(little_endian(entry.id, kId)), entry.name);
  refuse_frame(fmt::format("the id {} is not a command of the firmware {}; expected one of {}",
                           link_hex(id), to_string(firmware), known));
}

}  // namespace

LinkFrame link_frame(const LinkCommand& command) {
  LinkFrame frame;
  for (const LinkField& field : link_fields(command))
    frame.insert(frame.end(), field.bytes.begin(), field.bytes.end());
  return frame;
}

std::vector<LinkField> link_fields(const LinkCommand& command) {
  const LinkEntry& entry = checked_entry(command);
  std::vector<LinkField> fields;
  if (command.firmware == LinkFirmware::native) {
    const auto& [type, buffer] = command.acknowledged ? kAnswered : kUnanswered;
    const auto length = static_cast<std::int64_t>(length_of(command.firmware, entry));
    fields.push_back(
        {"type",
         {type},
         static_cast<double>(type),
         "",
         command.acknowledged ? "requests an acknowledgement" : "requests no acknowledgement"});
    fields.push_back({"buffer", {buffer}, static_cast<double>(buffer), "", ""});
    fields.push_back(
        {"sequence", {command.sequence}, static_cast<double>(command.sequence), "", ""});
    fields.push_back(
        {"length", little_endian(length, 4), static_cast<double>(length), "bytes", ""});
  }
  fields.push_back(
      {"id", little_endian(entry.id, kId), static_cast<double>(entry.id), "", entry.name});
  if (!entry.before.empty())
    fields.push_back({"flag", entry.before, static_cast<double>(natural(entry.before)), "",
                      "attitude control is on"});
  for (std::size_t i = 0; i < entry.arguments.size(); ++i) {
    const LinkArgument& argument = entry.arguments[i];
    const std::int64_t integer = integer_of(argument, command.values[i]);
    const double value = value_of(argument, integer);
    fields.push_back(
        {argument.name, little_endian(integer, argument.bytes), value, argument.unit,
         argument.words.empty() ? "" : argument.words[static_cast<std::size_t>(value)]});
  }
  if (!entry.after.empty())
    fields.push_back({"zeros", entry.after, static_cast<double>(natural(entry.after)), "", ""});
  return fields;
}

LinkCommand decode_link_frame(LinkFirmware firmware, std::span<const std::uint8_t> frame) {
  const bool native = firmware == LinkFirmware::native;
  const std::size_t begin = native ? kHeader : 0;
  if (frame.size() < begin + kId)
    refuse_frame(fmt::format("has {}; expected at least {}, because {}",
                             internal::counted(frame.size(), "byte"), begin + kId,
                             native ? "it starts with a header of 7 and an id of 4 bytes"
                                    : "it starts with an id of 4 bytes"));
  LinkCommand command{firmware, {}, {}};
  if (native) decode_header(frame, command);
  const LinkEntry& entry = entry_of_id(firmware, frame.subspan(begin, kId));
  command.name = entry.name;
  if (const std::size_t length = length_of(firmware, entry); frame.size() != length)
    refuse_frame(fmt::format("has {}; expected {}, the length of {}",
                             internal::counted(frame.size(), "byte"), length, entry.name));
  std::size_t at = begin + kId;
  for (const std::uint8_t byte : entry.before) require_byte(frame, at++, byte, "constant");
  for (const LinkArgument& argument : entry.arguments) {
    command.values.push_back(value_of(argument, whole(frame.subspan(at, argument.bytes))));
    require_limits(argument, command.values.back(), fmt::format("frame: {}", entry.name));
    at += argument.bytes;
  }
  for (const std::uint8_t byte : entry.after) require_byte(frame, at++, byte, "constant");
  return command;
}

bool acknowledges(std::span<const std::uint8_t> reply, const LinkFrame& frame) {
  constexpr std::size_t kLength = kHeader + 1;
  return frame.size() > kHeader && reply.size() == kLength && reply[0] == kAcknowledgement &&
         reply[1] == (frame[1] | 0x80U) && natural(reply.subspan(3, 4)) == kLength &&
         reply[kHeader] == frame[2];
}

}  // namespace quadtune
