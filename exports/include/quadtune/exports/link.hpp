// SPDX-License-Identifier: Apache-2.0
/// Command frames of the Parrot Mambo's two firmwares: encoding and decoding, with limits.
///
/// Source: Oliveira 2020, sections 5.2 and 5.3, tables 5.1 and 5.2. docs/errata.md lists the
/// contradictions between the tables and the examples. Nothing here opens a connection.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace quadtune {

/// The program that the vehicle runs; it determines the frame format.
enum class LinkFirmware {
  simulink,  ///< of MathWorks' support package for Simulink: table 5.1, over TCP
  native,    ///< of the manufacturer: table 5.2, over UDP
};

/// "simulink" or "native".
[[nodiscard]] std::string to_string(LinkFirmware firmware);

/// @throws OptionError  "firmware", for any other word
[[nodiscard]] LinkFirmware link_firmware(const std::string& word);

/// The port on which a vehicle with this firmware expects commands: TCP 12391 or UDP 6000.
[[nodiscard]] std::uint16_t link_port(LinkFirmware firmware);

/// The bytes of one command, in the order in which they are sent.
using LinkFrame = std::vector<std::uint8_t>;

/// One number of a command. The frame contains round(value * per_unit) + offset as a little-endian
/// integer in two's complement.
struct LinkArgument {
  std::string name;                     ///< e.g. "z"
  std::string unit;                     ///< of the value; empty for a word
  double low = 0,                       ///< minimum of the value [unit], inclusive
      high = 0;                         ///< maximum of the value [unit], inclusive
  std::string why = {};                 ///< reason for the limits, a clause after "because"
  std::size_t bytes = 4;                ///< size of the integer: 1, 2 or 4
  double per_unit = 1;                  ///< [1/unit]
  std::int64_t offset = 0;              ///< added after the scaling
  std::vector<std::string> words = {};  ///< names of the values 0, 1, …, if they have names
};

/// One row of table 5.1 or 5.2.
struct LinkEntry {
  std::string name;     ///< e.g. "takeoff"
  std::string summary;  ///< what the vehicle does
  std::uint32_t id;     ///< little-endian integer of 4 bytes in the frame
  /// In the order of the frame; empty if the command has none.
  std::vector<LinkArgument> arguments = {};
  bool stops = false;     ///< whether it stops the motors or lands
  bool answered = true;   ///< whether the vehicle replies
  LinkFrame before = {};  ///< fixed bytes between the id and the arguments
  LinkFrame after = {};   ///< fixed bytes after the arguments
};

/// The commands of a firmware, in the order of its table.
[[nodiscard]] const std::vector<LinkEntry>& link_entries(LinkFirmware firmware);

/// @throws InvalidInput  "command", for a name that is not in the table
[[nodiscard]] const LinkEntry& link_entry(LinkFirmware firmware, const std::string& name);

/// One command with its values.
struct LinkCommand {
  LinkFirmware firmware = LinkFirmware::simulink;  ///< firmware that receives the command
  std::string name;                                ///< of a LinkEntry
  std::vector<double> values;  ///< one per argument, in its unit; the index for a word
  /// Native firmware: number of the frame, incremented with each frame.
  std::uint8_t sequence = 0;
  /// Native firmware: whether the frame requests an acknowledgement.
  bool acknowledged = true;
};

/// Parses a command whose values are words, e.g. "-0.3" or "left".
/// @throws InvalidInput  if the name is unknown, the number of words is wrong, a word is not a
///                       finite number, or a value exceeds its limits; the message names command
///                       and argument
[[nodiscard]] LinkCommand link_command(LinkFirmware firmware, const std::string& name,
                                       const std::vector<std::string>& words);

/// Encodes a command. Values are rounded to the resolution of the frame.
/// @throws InvalidInput  as link_command()
[[nodiscard]] LinkFrame link_frame(const LinkCommand& command);

/// Decodes a frame; link_frame() of the result gives the same bytes.
/// @throws InvalidInput  "frame", if the frame is too short, its length is not that of its command,
///                       the id is unknown, the header or fixed bytes differ, or a value exceeds
///                       its limits
[[nodiscard]] LinkCommand decode_link_frame(LinkFirmware firmware,
                                            std::span<const std::uint8_t> frame);

/// One field of a frame.
struct LinkField {
  std::string name;     ///< e.g. "length"
  LinkFrame bytes;      ///< the concatenated fields are the frame
  double value = 0;     ///< [unit], as interpreted by the vehicle
  std::string unit;     ///< may be empty
  std::string meaning;  ///< in words; may be empty
};

/// Splits the frame of a command into fields.
/// @throws InvalidInput  as link_command()
[[nodiscard]] std::vector<LinkField> link_fields(const LinkCommand& command);

/// Whether a reply of a vehicle with the native firmware acknowledges a frame: type 1, the buffer
/// of the frame plus 128, any sequence number, length 8, and the sequence number of the frame.
/// Source: Parrot 2015.
[[nodiscard]] bool acknowledges(std::span<const std::uint8_t> reply, const LinkFrame& frame);

/// For example "04 0b 09".
[[nodiscard]] std::string link_hex(std::span<const std::uint8_t> bytes);

/// Parses bytes that are written as pairs of hexadecimal digits, with optional blanks between the
/// bytes and optional 0x before them.
/// @throws InvalidInput  "frame", if the text is malformed or empty
[[nodiscard]] LinkFrame link_bytes(const std::string& text);

}  // namespace quadtune
