// SPDX-License-Identifier: Apache-2.0
/// Options that take a number, read as in files: decimal, a dot whatever the locale.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace quadtune::cli {

/// Reads a word as a finite number; "+1" may come, "0x10", "1_000" and "1e999" may not.
/// @return  false, with `value` as it was, for any other word.
[[nodiscard]] bool read_number(std::string_view word, double& value);

/// Adds an option that takes a finite number.
/// @throws UsageError  when parsed, naming the option and the word that is no such number.
CLI::Option* add_number(CLI::App& app, const std::string& option, double& value,
                        const std::string& description);

/// Adds an option that takes a number of more than 0, which stays away where it is not given.
/// @throws UsageError  when parsed, likewise.
CLI::Option* add_positive(CLI::App& app, const std::string& option, std::optional<double>& value,
                          const std::string& description);

/// Adds an option that takes a whole number of at least `least`.
/// @throws UsageError  when parsed, likewise.
CLI::Option* add_count(CLI::App& app, const std::string& option, std::uint64_t& value,
                       std::uint64_t least, const std::string& description);

}  // namespace quadtune::cli
