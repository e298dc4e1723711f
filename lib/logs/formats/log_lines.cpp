// SPDX-License-Identifier: Apache-2.0
#include "logs/formats/log_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <system_error>
#include <utility>

namespace quadtune::internal {

std::string_view next_word(std::string_view& rest, char separator) {
  constexpr std::string_view kBlanks = " \t";
  const std::size_t end =
      std::min(separator == ' ' ? rest.find_first_of(kBlanks) : rest.find(separator), rest.size());
  const std::string_view word = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  if (separator == ' ') rest.remove_prefix(std::min(rest.find_first_not_of(kBlanks), rest.size()));
  return word;
}

std::optional<double> number_of(std::string_view word) {
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

std::optional<std::string_view> LogLines::next(LogCondition& condition) {
  if (!condition.torn.empty()) return std::nullopt;
  const std::optional<ByteStream::Line> line = stream_.line();
  if (!line) return std::nullopt;
  ++line_;
  if (line->end == ByteStream::LineEnd::kFeed) return line->text;
  condition.torn = line->end == ByteStream::LineEnd::kTorn
                       ? where() +
                             ": the line does not end, expected a line feed; it may be cut "
                             "short and is left out"
                       : fmt::format("{}: the line is longer than {} bytes, expected a record",
                                     where(), ByteStream::kWindow);
  return std::nullopt;
}

std::string LogLines::where() const { return fmt::format("{}:{}", stream_.name(), line_); }

void skip_record(LogCondition& condition, std::string why) {
  if (condition.skipped++ == 0) condition.first_skipped = std::move(why);
}

}  // namespace quadtune::internal
