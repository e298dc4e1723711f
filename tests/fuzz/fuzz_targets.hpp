// SPDX-License-Identifier: Apache-2.0
/// The function that each fuzz target calls with an input; every test run also calls it with the
/// stored corpus.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz_log.hpp"
#include "logs/mat/mat_content.hpp"

namespace quadtune::fuzz {

/// The options of a text: the first line of the input is the list, the rest the text.
inline void columns(std::string_view bytes) {
  const std::size_t feed = bytes.find('\n');
  if (feed == std::string_view::npos) return;
  LogOptions options;
  options.format = "text";
  try {
    options.columns = parse_log_columns(std::string(bytes.substr(0, feed)), "--columns");
  } catch (const InvalidInput&) {
    return;
  }
  read(bytes.substr(feed + 1), options);
}

/// At most 4 MiB.
inline void mat(std::string_view bytes) {
  constexpr std::size_t kMax = std::size_t{1} << 22U;
  internal::ByteStream stream(bytes, "f");
  try {
    const internal::MatContent content = internal::decode_mat(stream, kMax);
    for (const internal::MatTable& table : content.tables) {
      for (const std::vector<double>& column : table.columns)
        require(column.size() == table.rows(), "columns have one length");
      require(table.time.empty() || table.time.size() == table.rows(),
              "the clock has a time for each row");
    }
  } catch (const InvalidInput&) {
  }
}

inline void replay(std::string_view bytes) { read(bytes, "replay"); }

inline void text(std::string_view bytes) { read(bytes, "text"); }

inline void ulog(std::string_view bytes) { read(bytes, "ulog"); }

inline void uquad(std::string_view bytes) {
  read(bytes, "uquad-frames");
  read(bytes, "uquad-log");
}

struct Target {
  const char* name;  ///< of its folder in the corpus
  void (*feed)(std::string_view bytes);
};

inline constexpr std::array<Target, 6> kTargets = {{{"columns", columns},
                                                    {"mat", mat},
                                                    {"replay", replay},
                                                    {"text", text},
                                                    {"ulog", ulog},
                                                    {"uquad", uquad}}};

}  // namespace quadtune::fuzz
