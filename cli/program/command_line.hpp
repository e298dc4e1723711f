// SPDX-License-Identifier: Apache-2.0
/// The options and arguments of one command, and the values that were given for them.
///
/// CLI11 parses them. Only one source file includes its headers, since they take seconds to
/// compile.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace quadtune::cli {

/// One option, or one positional argument.
class Option {
 public:
  virtual ~Option() = default;

  /// Whether it was given on the parsed command line.
  [[nodiscard]] bool was_given() const { return !values().empty(); }
  /// Its values in the order of the command line; a flag has "true".
  [[nodiscard]] virtual const std::vector<std::string>& values() const = 0;

  [[nodiscard]] virtual std::string name() const = 0;                    ///< "--dt" or "V"
  [[nodiscard]] virtual std::vector<std::string> all_names() const = 0;  ///< "-h", "--help"
  [[nodiscard]] virtual std::string type_name() const = 0;               ///< e.g. "FILE"
  [[nodiscard]] virtual std::string description() const = 0;
  [[nodiscard]] virtual bool takes_value() const = 0;  ///< false: a flag
  [[nodiscard]] virtual bool is_argument() const = 0;  ///< positional, without dashes
};

/// Options are bound to variables, which keep their values if the option is not given. The name of
/// an option that takes a value is followed by the placeholder of the value in the help: "--log
/// FILE".
class CommandLine {
 public:
  /// Both parameters are for messages.
  /// @param verb   name of the command, e.g. "tune lqr"
  /// @param usage  what follows the name, e.g. "V [options]"
  explicit CommandLine(std::string verb = {}, std::string usage = {});
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  /// Adds an option, whose name begins with a dash, or a positional argument.
  Option* add_option(const std::string& name, std::string& value, const std::string& description);
  Option* add_option(const std::string& name, std::optional<std::string>& value,
                     const std::string& description);
  /// Adds an option that may be repeated; each occurrence takes one word.
  Option* add_list(const std::string& name, std::vector<std::string>& values,
                   const std::string& description);
  /// Adds a positional argument of up to `max` words.
  Option* add_words(const std::string& name, std::vector<std::string>& words, int max,
                    const std::string& description);
  /// Adds an option without a value, e.g. "-h,--help".
  Option* add_flag(const std::string& names, bool& value, const std::string& description);
  /// Adds an option that takes a finite number in the format of read_number().
  Option* add_number(const std::string& name, double& value, const std::string& description);
  Option* add_number(const std::string& name, std::optional<double>& value,
                     const std::string& description);
  /// Adds an option that takes a number greater than 0.
  Option* add_positive(const std::string& name, std::optional<double>& value,
                       const std::string& description);
  /// Adds an option that takes an integer of at least `min`.
  Option* add_count(const std::string& name, std::uint64_t& value, std::uint64_t min,
                    const std::string& description);

  /// Sets the variables.
  /// @throws UsageError  naming the option or argument, what was given and what was expected
  void parse(const std::vector<std::string>& args);

  /// Whether the option was given on the parsed command line.
  /// @throws std::logic_error  if no option of that name was added
  [[nodiscard]] bool was_given(std::string_view name) const;
  /// @throws UsageError  "NAME WHY" for the first of the options that was given
  void refuse_given(const std::vector<std::string>& names, const std::string& why) const;
  /// The option of that name, or null.
  [[nodiscard]] const Option* find(std::string_view name) const;
  /// Options and arguments, in the order in which they were added.
  [[nodiscard]] std::vector<const Option*> options() const;

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
};

}  // namespace quadtune::cli
