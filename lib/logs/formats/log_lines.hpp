// SPDX-License-Identifier: Apache-2.0
/// Lines of words as logging programs write them, and what all readers of such lines share.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "logs/formats/byte_stream.hpp"
#include "quadtune/logs/log_reader.hpp"

namespace quadtune::internal {

/// The next word of `rest`, which moves behind it and behind what follows: one separator, or with
/// ' ' as separator any blanks.
std::string_view next_word(std::string_view& rest, char separator);

/// `word` as a number that is all of it; nothing for anything else.
[[nodiscard]] std::optional<double> number_of(std::string_view word);

/// Lines of a stream, counted. A line that does not end tears the log.
class LogLines {
 public:
  explicit LogLines(ByteStream stream) : stream_(std::move(stream)) {}

  /// The next line that ends; nothing at the end, which a torn line is noted in `condition` for.
  std::optional<std::string_view> next(LogCondition& condition);
  /// What follows the line that came last, `count` bytes at most, without passing over it.
  [[nodiscard]] std::string_view ahead(std::size_t count) { return stream_.peek(count); }
  /// "file:line" of the line that came last.
  [[nodiscard]] std::string where() const;
  [[nodiscard]] const std::string& name() const { return stream_.name(); }

 private:
  ByteStream stream_;
  std::uint64_t line_ = 0;
};

/// Counts a record that is passed over; the first with its reason.
void skip_record(LogCondition& condition, std::string why);

}  // namespace quadtune::internal
