// SPDX-License-Identifier: Apache-2.0
/// Determines the columns of a text from its first lines and the user's selection.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "quadtune/logs/log_reader.hpp"

namespace quadtune::internal {

/// Separator between the fields of a line.
enum class TextSeparator : char { kComma = ',', kSemicolon = ';', kTab = '\t', kBlanks = ' ' };

/// How a column is used.
struct TextRole {
  enum class Kind { kPassedOver, kChannel, kTime } kind = Kind::kPassedOver;
  std::size_t index = 0;  ///< index of the channel, or of the part of the time
};

/// A clock whose unit is not stated.
struct UnstatedClock {
  std::string name;    ///< name in messages
  std::string remedy;  ///< its name or number for --columns
  bool usual = false;  ///< its name is t, which usually means seconds
};

struct TextLayout {
  TextSeparator separator = TextSeparator::kBlanks;
  std::vector<TextRole> roles;  ///< one per column of the file
  std::vector<LogChannel> channels;
  /// Ticks per second of the parts of the time, increasing; may be empty
  std::vector<double> ticks;
  std::optional<UnstatedClock> unstated;  ///< the only part of the time, with an assumed unit
  std::vector<std::string> notes;         ///< assumptions that the user did not confirm
};

/// The separator of a line of names, or of numbers.
[[nodiscard]] TextSeparator separator_of_names(std::string_view line);
[[nodiscard]] TextSeparator separator_of_numbers(std::string_view line);

/// Splits a line of names into its fields, without quotes.
[[nodiscard]] std::vector<std::string> split_names(std::string_view line, TextSeparator separator);

/// Whether a field is a number, in which case the line does not contain names.
[[nodiscard]] bool holds_a_number(std::string_view line, TextSeparator separator);

/// @param names   of the columns; empty for a text without a line of names
/// @param count   number of columns
/// @param where   beginning of messages
/// @throws InvalidInput  if a chosen column does not exist
[[nodiscard]] TextLayout text_layout(const std::vector<std::string>& names, std::size_t count,
                                     TextSeparator separator, const LogOptions& options,
                                     const std::string& where);

}  // namespace quadtune::internal
