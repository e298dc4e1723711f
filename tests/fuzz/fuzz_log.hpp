// SPDX-License-Identifier: Apache-2.0
/// Reads arbitrary bytes as a log and aborts if the contract of LogReader is violated.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "logs/open_log.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/logs/log_survey.hpp"

namespace quadtune::fuzz {

inline void require(bool promise, const char* what) {
  if (promise) return;
  std::fprintf(stderr, "broken promise: %s\n", what);
  std::abort();
}

inline void require_rows(const LogReader& reader, const LogBlock& block) {
  require(block.group < reader.groups().size(), "a block is of a group that is known");
  const LogGroup& group = reader.groups()[block.group];
  require(block.values.size() == block.rows() * group.channels.size(), "a row has all channels");
  for (const double time : block.time)
    require(!std::isnan(time) == group.timed, "a row of a timed group has a time");
}

/// Reads the bytes twice, row by row and as a survey.
inline void read(std::string_view bytes, const LogOptions& options) {
  try {
    const auto reader = internal::open_log(internal::ByteStream(bytes, "f"), options);
    LogBlock block;
    while (reader->next(block)) {
      require(block.rows() > 0, "a block has rows");
      require_rows(*reader, block);
    }
    (void)survey_log(*internal::open_log(internal::ByteStream(bytes, "f"), options));
  } catch (const InvalidInput& refusal) {
    const std::string_view what = refusal.what();
    require(!what.empty() && what.find('\n') == std::string_view::npos, "a refusal is one line");
  }
}

inline void read(std::string_view bytes, const char* format) {
  LogOptions options;
  options.format = format;
  read(bytes, options);
}

}  // namespace quadtune::fuzz
