// SPDX-License-Identifier: Apache-2.0
/// A command line that is wrong, and an answer that is no before there is anything to print.
#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>

#include "program/program.hpp"

namespace quadtune::cli {

/// @param where  the option or argument concerned, for scripts
/// @param text   what follows "quadtune VERB: ", a format of the values
/// @throws UsageError
template <class... Values>
[[noreturn]] void refuse(const std::string& verb, const std::string& where,
                         fmt::format_string<const Values&...> text, const Values&... values) {
  throw UsageError(fmt::format("quadtune {}: {}", verb, fmt::format(text, values...)), where);
}

/// Unlike any other AnswerIsNo it is told as an error is: with --json as an object, and without a
/// file that -o names.
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
