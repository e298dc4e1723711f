// SPDX-License-Identifier: Apache-2.0
/// Command frames of the Parrot Mambo's two firmwares: commands to bytes and back, with limits.
///
/// Source: Oliveira 2020, sections 5.2 and 5.3, tables 5.1 and 5.2. docs/errata.md lists where the
/// tables and the examples beside them disagree. Nothing here opens a connection.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace quadtune {

/// The program that the vehicle runs, which decides what a frame looks like.
enum class LinkFirmware {
  simulink,  ///< of MathWorks' support package for Simulink: table 5.1, over TCP
  native,    ///< of the manufacturer: table 5.2, over UDP
};

/// "simulink" or "native".
[[nodiscard]] std::string to_string(LinkFirmware firmware);

/// @throws OptionError  "firmware", for any other word than these two
[[nodiscard]] LinkFirmware link_firmware(const std::string& word);

/// The port on which a vehicle with this firmware expects commands: TCP 12391 or UDP 6000.
[[nodiscard]] std::uint16_t link_port(LinkFirmware firmware);

/// The bytes of one command, in the order in which they are sent.
using LinkFrame = std::vector<std::uint8_t>;

/// One number that a command carries. The frame holds round(value * per_unit) + offset as a
/// little-endian integer in two's complement.
struct LinkArgument {
  std::string name;                     ///< e.g. "z"
  std::string unit;                     ///< of the value; empty for a word
  double low = 0, high = 0;             ///< limits of the value [unit]; the limits belong to it
  std::string why = {};                 ///< reason for the limits, a clause after "because"
  std::size_t bytes = 4;                ///< of the integer: 1, 2 or 4
  double per_unit = 1;                  ///< [1/unit]
  std::int64_t offset = 0;              ///< added after the scaling
  std::vector<std::string> words = {};  ///< names of the values 0, 1, …, if they have names
};

/// One row of table 5.1 or 5.2.
struct LinkEntry {
  std::string name;     ///< e.g. "takeoff"
  std::string summary;  ///< what the vehicle does
  std::uint32_t id;     ///< as a little-endian integer of 4 bytes in the frame
  std::vector<LinkArgument> arguments = {};
  bool stops = false;     ///< whether it stops the motors or lands
  bool answered = true;   ///< whether the vehicle answers
  LinkFrame before = {};  ///< fixed bytes between the id and the arguments
  LinkFrame after = {};   ///< fixed bytes after the arguments
};

/// The commands of a firmware, in the order of its table.
[[nodiscard]] const std::vector<LinkEntry>& link_entries(LinkFirmware firmware);

/// @throws InvalidInput  "command", for a name that is not in the table
[[nodiscard]] const LinkEntry& link_entry(LinkFirmware firmware, const std::string& name);

/// One command with its values.
struct LinkCommand {
  LinkFirmware firmware = LinkFirmware::simulink;
  std::string name;            ///< of a LinkEntry
  std::vector<double> values;  ///< one for each argument, in its unit; the number of a word
  /// Native firmware: numbers the frames in the order in which they were made.
  std::uint8_t sequence = 0;
  /// Native firmware: whether the frame asks for an acknowledgement.
  bool acknowledged = true;
};

/// A command whose values are written as words, e.g. "-0.3" or "left".
/// @throws InvalidInput  for an unknown name, another number of words, a word that is not a finite
///                       number, and a value beyond the limits; it names command and argument
[[nodiscard]] LinkCommand link_command(LinkFirmware firmware, const std::string& name,
                                       const std::vector<std::string>& words);

/// The frame of a command. Values are rounded to what the frame can hold.
/// @throws InvalidInput  as link_command()
[[nodiscard]] LinkFrame link_frame(const LinkCommand& command);

/// The command of a frame: link_frame() of it gives the same bytes.
/// @throws InvalidInput  "frame", for a frame that is too short or has another length than its
///                       command, an unknown id, a header or fixed bytes that are different, and a
///                       value beyond its limits
[[nodiscard]] LinkCommand decode_link_frame(LinkFirmware firmware,
                                            std::span<const std::uint8_t> frame);

/// A part of a frame that has a meaning of its own.
struct LinkField {
  std::string name;     ///< e.g. "length"
  LinkFrame bytes;      ///< of the frame; the fields one after the other are the frame
  double value = 0;     ///< [unit], as the vehicle reads it
  std::string unit;     ///< may be empty
  std::string meaning;  ///< in words; may be empty
};

/// The frame of a command, divided into fields.
/// @throws InvalidInput  as link_command()
[[nodiscard]] std::vector<LinkField> link_fields(const LinkCommand& command);

/// Whether what a vehicle with the native firmware sent acknowledges a frame: type 1, the frame's
/// buffer plus 128, any number, the length 8, and the number of the frame.
/// Source: Parrot 2015.
[[nodiscard]] bool acknowledges(std::span<const std::uint8_t> reply, const LinkFrame& frame);

/// "04 0b 09"
[[nodiscard]] std::string link_hex(std::span<const std::uint8_t> bytes);

/// Reads bytes written as pairs of hexadecimal digits, with or without blanks between the bytes and
/// with or without 0x before them.
/// @throws InvalidInput  "frame", for other text and for none
[[nodiscard]] LinkFrame link_bytes(const std::string& text);

}  // namespace quadtune
