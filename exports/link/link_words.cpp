// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <sstream>

#include "quadtune/errors.hpp"
#include "quadtune/exports/link.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/words.hpp"

namespace quadtune {
namespace {

/// For example "1: z [m]" or "4: roll [%], ...".
std::string expected_values(const LinkEntry& entry) {
  if (entry.arguments.empty()) return "none";
  std::vector<std::string> names;
  for (const LinkArgument& argument : entry.arguments)
    names.push_back(argument.unit.empty() ? argument.name
                                          : fmt::format("{} [{}]", argument.name, argument.unit));
  return fmt::format("{}: {}", names.size(), internal::joined(names, ", "));
}

double value_of_word(const LinkEntry& entry, const LinkArgument& argument,
                     const std::string& word) {
  if (!argument.words.empty()) {
    const auto found = std::find(argument.words.begin(), argument.words.end(), word);
    if (found != argument.words.end()) return static_cast<double>(found - argument.words.begin());
    throw InvalidInput(
        entry.name, fmt::format("{} is '{}', expected one of {}{}", argument.name,
                                internal::printable(word), internal::joined(argument.words, ", "),
                                internal::did_you_mean(word, argument.words)));
  }
  double value = 0;
  if (!internal::read_number(word, value))
    throw InvalidInput(
        entry.name,
        fmt::format("{} is '{}', expected a finite number from {} to {} {}", argument.name,
                    internal::printable(word), argument.low, argument.high, argument.unit));
  return value;
}

}  // namespace

LinkCommand link_command(LinkFirmware firmware, const std::string& name,
                         const std::vector<std::string>& words) {
  const LinkEntry& entry = link_entry(firmware, name);
  if (words.size() != entry.arguments.size())
    throw InvalidInput(name, fmt::format("number of values is {}, expected {}", words.size(),
                                         expected_values(entry)));
  LinkCommand command{firmware, name, {}};
  for (std::size_t i = 0; i < words.size(); ++i)
    command.values.push_back(value_of_word(entry, entry.arguments[i], words[i]));
  (void)link_fields(command);  // rejects values beyond their limits
  return command;
}

std::string link_hex(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes)
    text += fmt::format("{}{:02x}", text.empty() ? "" : " ", byte);
  return text;
}

LinkFrame link_bytes(const std::string& text) {
  LinkFrame bytes;
  std::istringstream stream(text);
  for (std::string word; stream >> word;) {
    const std::string digits = word.starts_with("0x") ? word.substr(2) : word;
    const bool hexadecimal =
        digits.find_first_not_of("0123456789abcdefABCDEF") == std::string::npos;
    if (digits.empty() || digits.size() % 2 != 0 || !hexadecimal)
      throw InvalidInput(
          "frame",
          fmt::format("'{}' is not a list of bytes; expected pairs of hexadecimal digits, e.g. "
                      "04 0b 09",
                      internal::printable(word)));
    for (std::size_t i = 0; i < digits.size(); i += 2) {
      std::uint8_t byte = 0;
      std::from_chars(digits.data() + i, digits.data() + i + 2, byte, 16);
      bytes.push_back(byte);
    }
  }
  if (bytes.empty()) throw InvalidInput("frame", "is empty; expected its bytes, e.g. 02 00 00 00");
  return bytes;
}

}  // namespace quadtune
