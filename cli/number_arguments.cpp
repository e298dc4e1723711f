// SPDX-License-Identifier: Apache-2.0
#include "number_arguments.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>

#include "program.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune::cli {

bool read_number(std::string_view word, double& value) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  double number = 0;
  const char* end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, number);
  if (error != std::errc() || stop != end || !std::isfinite(number)) return false;
  value = number;
  return true;
}

CLI::Option* add_number(CLI::App& app, const std::string& option, double& value,
                        const std::string& description) {
  const auto read = [&app, &value, option](const std::string& word) {
    if (!read_number(word, value))
      throw UsageError(fmt::format("{}: {}: '{}' is not a finite number, expected one such as 0.01",
                                   app.get_name(), option, internal::printable(word)),
                       option);
  };
  return app.add_option_function<std::string>(option, read, description);
}

CLI::Option* add_positive(CLI::App& app, const std::string& option, std::optional<double>& value,
                          const std::string& description) {
  const auto read = [&app, &value, option](const std::string& word) {
    double number = 0;
    if (!read_number(word, number) || !(number > 0))
      throw UsageError(fmt::format("{}: {}: '{}' came, expected a number of more than 0",
                                   app.get_name(), option, internal::printable(word)),
                       option);
    value = number;
  };
  return app.add_option_function<std::string>(option, read, description);
}

CLI::Option* add_count(CLI::App& app, const std::string& option, std::uint64_t& value,
                       std::uint64_t least, const std::string& description) {
  const auto read = [&app, &value, option, least](const std::string& word) {
    const char* end = word.data() + word.size();
    const auto [stop, error] = std::from_chars(word.data(), end, value);
    if (error != std::errc() || stop != end || value < least)
      throw UsageError(fmt::format("{}: {}: '{}' came, expected a whole number of {} or more",
                                   app.get_name(), option, internal::printable(word), least),
                       option);
  };
  return app.add_option_function<std::string>(option, read, description);
}

}  // namespace quadtune::cli
