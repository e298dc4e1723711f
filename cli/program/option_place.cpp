// SPDX-License-Identifier: Apache-2.0
#include "program/option_place.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "program/command_line.hpp"
#include "quadtune/errors.hpp"

namespace quadtune::cli {
namespace {

/// Whether the place is a function or several options, rather than a file or a value.
bool names_no_input(const std::string& where, const CommandLine& line) {
  if (where == "standard input") return false;
  if (where.starts_with("--")) return where.find(", --") != std::string::npos;
  const bool plain = std::all_of(where.begin(), where.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-' || c == ' ';
  });
  if (!plain) return false;
  // A method has the name of its function.
  for (const Option* option : line.options())
    for (const std::string& value : option->values())
      if (value == where && option != line.find("--method")) return false;
  return true;
}

/// The option for a parameter of the libraries; empty if the command has none.
std::string option_for(std::string parameter, const std::string& where, const CommandLine& line) {
  std::replace(parameter.begin(), parameter.end(), '_', '-');
  const auto given = [&](const std::string& option) {
    return line.find(option) != nullptr && line.was_given(option);
  };
  if (parameter == "dt" && given("--sampled")) return "--sampled";
  // The poles of a transfer function are those of its A.
  if (parameter == "A" && given("--den")) return "--den";
  // The filter of a command that has weights, too.
  if (where == "kalman" && given("--noise-" + parameter)) return "--noise-" + parameter;
  return given("--" + parameter) ? "--" + parameter : "";
}

}  // namespace

std::optional<UsageError> told_by_option(const InvalidInput& error, const CommandLine& line) {
  const std::string& where = error.where();
  const std::string& message = error.message();
  if (const Option* argument = line.find(where); argument != nullptr && argument->is_argument())
    return UsageError(fmt::format("{}: {}", where, message), where);
  const std::size_t end = std::min(message.find(' '), message.size());
  const std::string option = option_for(message.substr(0, end), where, line);
  if (!option.empty() && (option == where || names_no_input(where, line))) {
    // The end of the message may name the parameter again: "R has eigenvalue 0, expected R > 0".
    std::string rest = message.substr(end);
    const std::string again = "expected " + message.substr(0, end) + " ";
    if (const std::size_t at = rest.find(again); at != std::string::npos)
      rest.replace(at, again.size(), "expected " + option + " ");
    return UsageError(option + rest, option);
  }
  if (where.starts_with("--") || line.find(where) != nullptr) {
    // "--A '1 2; 3':2" is a row of the matrix of --A; "--num, --den" are two options.
    const bool several = where.find(", --") != std::string::npos;
    return UsageError(fmt::format("{}: {}", where, message),
                      several ? where : where.substr(0, where.find(' ')));
  }
  if (!names_no_input(where, line)) return {};
  // Without a vehicle, the matrices or the transfer function are all that was given.
  for (const char* input : {"--A", "--num"})
    if (line.find(input) != nullptr && line.was_given(input)) return UsageError(message, input);
  return {};
}

}  // namespace quadtune::cli
