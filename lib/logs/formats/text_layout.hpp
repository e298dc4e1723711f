// SPDX-License-Identifier: Apache-2.0
/// What the columns of a text are: found in its first lines and in what the user says.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "quadtune/logs/log_reader.hpp"

namespace quadtune::internal {

/// What separates the fields of a line.
enum class TextSeparator : char { kComma = ',', kSemicolon = ';', kTab = '\t', kBlanks = ' ' };

/// What a column is read as.
struct TextRole {
  enum class Kind { kPassedOver, kChannel, kTime } kind = Kind::kPassedOver;
  std::size_t index = 0;  ///< of the channel, or of the part of the time
};

/// A clock whose unit nobody stated.
struct UnstatedClock {
  std::string name;    ///< what messages call it
  std::string remedy;  ///< its name or number, as --columns takes it
  bool usual = false;  ///< it is called t, which is in seconds as a rule
};

struct TextLayout {
  TextSeparator separator = TextSeparator::kBlanks;
  std::vector<TextRole> roles;  ///< one a column of the file
  std::vector<LogChannel> channels;
  std::vector<double> ticks;  ///< of the parts of the time, fewest a second first; may be empty
  std::optional<UnstatedClock> unstated;  ///< the only part of the time, its ticks being a guess
  std::vector<std::string> notes;         ///< what was taken without being told
};

/// The separator of a line of names, or of numbers.
[[nodiscard]] TextSeparator separator_of_names(std::string_view line);
[[nodiscard]] TextSeparator separator_of_numbers(std::string_view line);

/// The fields of a line of names, without quotes around them.
[[nodiscard]] std::vector<std::string> split_names(std::string_view line, TextSeparator separator);

/// Whether one of the fields is a number: then the line is no line of names.
[[nodiscard]] bool holds_a_number(std::string_view line, TextSeparator separator);

/// @param names   Of the columns; empty for a text without a line of names.
/// @param count   How many columns there are.
/// @param where   What messages begin with.
/// @throws InvalidInput  if a chosen column is not there.
[[nodiscard]] TextLayout text_layout(const std::vector<std::string>& names, std::size_t count,
                                     TextSeparator separator, const LogOptions& options,
                                     const std::string& where);

}  // namespace quadtune::internal
