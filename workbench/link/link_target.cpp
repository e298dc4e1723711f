// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>
#include <fmt/format.h>

#include <array>
#include <charconv>

#include "quadtune/errors.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/workbench/link/send_link.hpp"

namespace quadtune {
namespace {

/// Why an address is not that of a single device; null if it is.
const char* why_not_one(const std::array<std::uint8_t, 4>& address) {
  if (address[0] == 0) return "which is the unspecified address";
  if (address == std::array<std::uint8_t, 4>{255, 255, 255, 255})
    return "which is received by the whole network";
  if (address[0] >= 224 && address[0] < 240) return "which is a multicast address";
  if (address[0] >= 240) return "which is reserved";
  if (address[3] == 255) return "which is received by the whole network";
  if (address[3] == 0) return "which denotes a network";
  return nullptr;
}

bool read_port(const std::string& word, std::uint16_t& port) {
  const char* end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, port);
  return error == std::errc() && stop == end && port > 0;
}

[[noreturn]] void refuse_target(LinkFirmware firmware, const std::string& what,
                                const std::string& why) {
  const std::string example = firmware == LinkFirmware::simulink ? "192.168.3.1" : "192.168.99.3";
  throw OptionError("to",
                    fmt::format("to {}, expected the address and port of one vehicle, such as "
                                "{}:{}, because {}",
                                what, example, link_port(firmware), why));
}

}  // namespace

std::string to_string(const LinkTarget& target) {
  return fmt::format("{}:{}", target.host, target.port);
}

LinkTarget link_target(const std::string& word, LinkFirmware firmware) {
  if (word.empty()) refuse_target(firmware, "is missing", "the vehicle must be named");
  const std::string named = fmt::format("is '{}'", internal::printable(word));
  const std::size_t colon = word.rfind(':');
  if (colon == std::string::npos) refuse_target(firmware, named, "there is no default port");
  LinkTarget target{word.substr(0, colon), 0};
  std::array<std::uint8_t, 4> address{};
  // A zero byte would end the text early in inet_pton().
  if (target.host.find('\0') != std::string::npos ||
      inet_pton(AF_INET, target.host.c_str(), address.data()) != 1)
    refuse_target(firmware, named, "a host is four numbers from 0 to 255; names are not resolved");
  if (!read_port(word.substr(colon + 1), target.port))
    refuse_target(firmware, named, "a port is a number from 1 to 65535");
  if (const char* which = why_not_one(address))
    refuse_target(firmware, fmt::format("{}, {}", named, which), "a command is for one vehicle");
  const LinkFirmware other =
      firmware == LinkFirmware::simulink ? LinkFirmware::native : LinkFirmware::simulink;
  if (target.port == link_port(other))
    refuse_target(firmware, named,
                  fmt::format("port {} is that of the firmware {}", target.port, to_string(other)));
  return target;
}

LinkMessage link_message(LinkCommand command, std::optional<std::uint64_t> sequence) {
  const LinkEntry& entry = link_entry(command.firmware, command.name);
  const bool numbered = command.firmware == LinkFirmware::native;
  if (sequence && !numbered)
    throw OptionError("sequence", fmt::format("sequence is {}, but frames of the firmware {} "
                                              "have no sequence number",
                                              *sequence, to_string(command.firmware)));
  if (sequence && *sequence > 255)
    throw OptionError("sequence", fmt::format("sequence is {}, expected 0 to 255, because it is "
                                              "one byte",
                                              *sequence));
  if (!sequence && numbered && !entry.stops)
    throw OptionError(
        "sequence",
        "sequence is missing, expected 0 to 255, one more than in the previous frame, "
        "because the vehicle orders frames by it");
  LinkMessage message;
  if (sequence) command.sequence = static_cast<std::uint8_t>(*sequence);
  message.command = command;
  const int parts = numbered && !sequence ? 4 : 1;
  for (int i = 0; i < parts; ++i) {
    LinkCommand part = command;
    part.sequence = static_cast<std::uint8_t>(command.sequence + 64 * i);
    (void)link_frame(part);  // rejects values beyond their limits
    message.parts.push_back(part);
  }
  return message;
}

}  // namespace quadtune
