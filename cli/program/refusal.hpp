// SPDX-License-Identifier: Apache-2.0
/// Errors for an invalid command line, and for a negative answer before anything is printed.
#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>

#include "program/program.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune::cli {

/// @param where  the option or argument concerned, for scripts
/// @param text   format of the message; run_verb() adds the name of the command
/// @throws UsageError
template <class... Values>
[[noreturn]] void refuse(const std::string& where, fmt::format_string<const Values&...> text,
                         const Values&... values) {
  throw UsageError(fmt::format(text, values...), where);
}

/// The end of a message: ", so FILE is not written; --force writes it"; empty if no file was
/// requested or --force was given.
[[nodiscard]] inline std::string so_not_written(const std::string& file, bool force) {
  return file.empty() || force
             ? ""
             : fmt::format(", so {} is not written; --force writes it", internal::printable(file));
}

/// A negative answer that, unlike any other AnswerIsNo, is reported like an error: with --json as
/// an object, and without writing the file of -o.
class Refusal : public AnswerIsNo {
 public:
  /// @param where  the file or vehicle concerned, for scripts.
  Refusal(const std::string& message, std::string where)
      : AnswerIsNo(message), where_(std::move(where)) {}

  [[nodiscard]] const std::string& where() const { return where_; }

 private:
  std::string where_;
};

}  // namespace quadtune::cli
