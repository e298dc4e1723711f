// SPDX-License-Identifier: Apache-2.0
/// Errors for an invalid command line, also in place of the errors of the libraries about an option,
/// and for a negative answer before anything is printed.
#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>

#include "program/program.hpp"
#include "quadtune/errors.hpp"

namespace quadtune::cli {

/// @param where  the option or argument concerned, for scripts
/// @param text   format of the message that follows "quadtune VERB: "
/// @throws UsageError
template <class... Values>
[[noreturn]] void refuse(const std::string& verb, const std::string& where,
                         fmt::format_string<const Values&...> text, const Values&... values) {
  throw UsageError(fmt::format("quadtune {}: {}", verb, fmt::format(text, values...)), where);
}

/// Calls a function whose options were given on the command line.
/// @throws UsageError  in place of OptionError
template <class Function>
auto option_of_command(const std::string& verb, Function&& function) {
  try {
    return function();
  } catch (const OptionError& error) {
    refuse(verb, "--" + error.option(), "--{}", error.what());
  }
}

/// As option_of_command(). If the control period of --dt is too short for the estimator, the error
/// names --dt.
/// @param has_dt  whether --dt was given
template <class Function>
auto period_of_command(const std::string& verb, bool has_dt, Function&& function) {
  try {
    return option_of_command(verb, function);
  } catch (const InvalidInput& error) {
    if (!has_dt || error.where() != "estimator general") throw;
    refuse(verb, "--dt", "--dt: {}", error.what());
  }
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
