// SPDX-License-Identifier: Apache-2.0
/// Lines of words as written by logging programs, and helpers that all line readers share.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "logs/formats/byte_stream.hpp"
#include "quadtune/logs/log_reader.hpp"

namespace quadtune::internal {

/// Removes the next word and the separator after it from `rest`; with ' ' as separator, any number
/// of blanks.
std::string_view next_word(std::string_view& rest, char separator);

/// Converts `word` to a number if all of it is one; otherwise empty.
[[nodiscard]] std::optional<double> number_of(std::string_view word);

/// Reads and counts the lines of a stream. A last line without an end marks the log as torn.
class LogLines {
 public:
  explicit LogLines(ByteStream stream) : stream_(std::move(stream)) {}

  /// Reads the next complete line. Empty at the end; an incomplete last line is then noted in
  /// `condition`.
  std::optional<std::string_view> next(LogCondition& condition);
  /// Peeks at up to `count` bytes after the last line.
  [[nodiscard]] std::string_view ahead(std::size_t count) { return stream_.peek(count); }
  /// "file:line" of the last line.
  [[nodiscard]] std::string where() const;
  [[nodiscard]] const std::string& name() const { return stream_.name(); }

 private:
  ByteStream stream_;
  std::uint64_t line_ = 0;
};

/// Counts a record that is skipped, and keeps the reason for the first one.
void skip_record(LogCondition& condition, std::string why);

}  // namespace quadtune::internal
