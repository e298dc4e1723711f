// SPDX-License-Identifier: Apache-2.0
#include "program/command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <deque>
#include <functional>
#include <stdexcept>
#include <utility>

#include "program/program.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/words.hpp"

namespace quadtune::cli {

// A member of Parser has this type, so it cannot be in the unnamed namespace.
class ParsedOption final : public Option {
 public:
  explicit ParsedOption(CLI::Option* option) : option_(option) {}

  [[nodiscard]] const std::vector<std::string>& values() const override {
    return option_->results();
  }
  [[nodiscard]] std::string name() const override { return option_->get_name(); }
  [[nodiscard]] std::vector<std::string> all_names() const override {
    std::vector<std::string> names;
    for (const std::string& name : option_->get_snames()) names.push_back("-" + name);
    for (const std::string& name : option_->get_lnames()) names.push_back("--" + name);
    return names;
  }
  [[nodiscard]] std::string type_name() const override { return option_->get_type_name(); }
  [[nodiscard]] std::string description() const override { return option_->get_description(); }
  [[nodiscard]] bool takes_value() const override { return option_->get_items_expected_max() > 0; }
  [[nodiscard]] bool is_argument() const override { return option_->get_positional(); }

 private:
  CLI::Option* option_;
};

namespace {

std::string without_type(const std::string& name) { return name.substr(0, name.find(' ')); }

/// " in s", if the description of an option states its unit in brackets.
std::string in_unit(const std::string& description) {
  const std::size_t open = description.find('[');
  const std::size_t close = description.find(']', std::min(open, description.size()));
  return close == std::string::npos ? "" : " in " + description.substr(open + 1, close - open - 1);
}

std::string number_mistake(const std::string& word, double& value, const std::string& description) {
  if (internal::read_number(word, value)) return "";
  return " is not a finite number, expected a number" + in_unit(description) + " such as 0.01";
}

}  // namespace

struct CommandLine::Parser {
  std::string verb, usage;
  CLI::App app;
  std::deque<ParsedOption> options;

  Parser(std::string name, std::string use) : verb(std::move(name)), usage(std::move(use)) {
    app.set_help_flag();
    app.allow_extras();
  }

  /// @param name  with the placeholder of its value, if it takes one
  Option* add(CLI::Option* option, const std::string& name) {
    if (const std::size_t blank = name.find(' '); blank != std::string::npos)
      option->type_name(name.substr(blank + 1));
    return &options.emplace_back(option);
  }

  [[noreturn]] void refuse(const std::string& option, const std::string& message) const {
    throw UsageError(message, option);
  }

  /// Adds an option that takes a value.
  /// @param read  sets the variable and returns an empty text, or the end of the error message
  Option* add_read(const std::string& name, const std::string& description,
                   const std::function<std::string(const std::string& word)>& read) {
    const auto take = [this, option = without_type(name), read](const std::string& word) {
      if (const std::string why = read(word); !why.empty())
        refuse(option, fmt::format("{}: '{}'{}", option, internal::printable(word), why));
    };
    return add(app.add_option_function<std::string>(without_type(name), take, description), name);
  }

  [[noreturn]] void refuse_missing_value(const std::string& option) const {
    refuse(option, fmt::format("{} requires a value", option));
  }

  [[noreturn]] void refuse_extras() const;
  [[noreturn]] void refuse(const CLI::ParseError& error,
                           const std::vector<std::string>& args) const;
  void refuse_options_for_values(const std::vector<std::string>& args) const;
  void refuse_empty_values() const;
};

/// Rejects the first word that CLI11 could not assign, and suggests the most similar option.
void CommandLine::Parser::refuse_extras() const {
  const std::string extra = app.remaining().front();
  double number = 0;
  if (extra.empty() || extra[0] != '-')
    refuse(extra, fmt::format("unexpected argument '{}'{}, expected: quadtune {} {}", extra,
                              internal::read_number(extra, number)
                                  ? " (the numbers of a list are one word, such as 1,10,10)"
                                  : "",
                              verb, usage));
  std::vector<std::string> known;
  for (const ParsedOption& option : options)
    for (const std::string& name : option.all_names())
      if (name.starts_with("--")) known.push_back(name);
  const std::string name = extra.substr(0, extra.find('='));
  const std::string near = internal::did_you_mean(name, known);
  refuse(name,
         fmt::format(
             "no option '{}'{}", name,
             near.empty() ? fmt::format("; 'quadtune help {}' lists the options", verb) : near));
}

/// Without this check, CLI11 would use the option that follows as the value: "-o --json" as a file
/// "--json".
void CommandLine::Parser::refuse_options_for_values(const std::vector<std::string>& args) const {
  for (std::size_t i = 0; i + 1 < args.size(); ++i) {
    if (!args[i].starts_with('-') || !args[i + 1].starts_with("--")) continue;
    const CLI::Option* option = app.get_option_no_throw(args[i]);
    if (option && option->get_items_expected_max() > 0) refuse_missing_value(args[i]);
  }
}

/// Messages of CLI11 begin with the option; the rest is replaced in the style of all other
/// messages.
void CommandLine::Parser::refuse(const CLI::ParseError& error,
                                 const std::vector<std::string>& args) const {
  std::string message = error.what();
  std::replace(message.begin(), message.end(), '\n', ' ');
  std::string option = "command line";
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error)) {  // "--dt: 1 required T missing"
    option = message.substr(0, message.find(':'));
    const auto times = std::count_if(args.begin(), args.end(), [&](const std::string& arg) {
      return arg == option || arg.starts_with(option + "=");
    });
    if (times == 0)
      refuse(option, fmt::format("too many arguments; expected: quadtune {} {}", verb, usage));
    if (times == 1) refuse_missing_value(option);
    message = fmt::format("{} is given {} times; expected once", option, times);
  } else if (dynamic_cast<const CLI::ConversionError*>(&error)) {  // "…: --json = maybe"
    const std::size_t start = message.find("--");
    option = message.substr(std::min(start, message.size()), message.find(" =") - start);
    message = fmt::format("{} was given a value; expected {} alone", option, option);
  }
  refuse(option, message);
}

void CommandLine::Parser::refuse_empty_values() const {
  for (const ParsedOption& option : options)
    for (const std::string& value : option.values())
      if (value.empty())
        refuse(option.name(), fmt::format("{} is empty, expected a value", option.name()));
}

CommandLine::CommandLine(std::string verb, std::string usage)
    : parser_(std::make_unique<Parser>(std::move(verb), std::move(usage))) {}

CommandLine::~CommandLine() = default;

Option* CommandLine::add_option(const std::string& name, std::string& value,
                                const std::string& description) {
  return parser_->add(parser_->app.add_option(without_type(name), value, description), name);
}

Option* CommandLine::add_option(const std::string& name, std::optional<std::string>& value,
                                const std::string& description) {
  return parser_->add_read(name, description, [&value](const std::string& word) {
    value = word;
    return "";
  });
}

Option* CommandLine::add_list(const std::string& name, std::vector<std::string>& values,
                              const std::string& description) {
  return parser_->add(parser_->app.add_option(without_type(name), values, description)
                          ->take_all()
                          ->expected(1)
                          ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll),
                      name);
}

Option* CommandLine::add_words(const std::string& name, std::vector<std::string>& words, int max,
                               const std::string& description) {
  return parser_->add(parser_->app.add_option(name, words, description)->expected(0, max), name);
}

Option* CommandLine::add_flag(const std::string& names, bool& value,
                              const std::string& description) {
  return parser_->add(parser_->app.add_flag(names, value, description), names);
}

Option* CommandLine::add_number(const std::string& name, double& value,
                                const std::string& description) {
  return parser_->add_read(name, description, [&value, description](const std::string& word) {
    return number_mistake(word, value, description);
  });
}

Option* CommandLine::add_number(const std::string& name, std::optional<double>& value,
                                const std::string& description) {
  return parser_->add_read(name, description, [&value, description](const std::string& word) {
    return number_mistake(word, value.emplace(), description);
  });
}

Option* CommandLine::add_positive(const std::string& name, std::optional<double>& value,
                                  const std::string& description) {
  return parser_->add_read(name, description, [&value, description](const std::string& word) {
    double number = 0;
    if (!internal::read_number(word, number) || !(number > 0))
      return " is invalid; expected a number greater than 0" + in_unit(description);
    value = number;
    return std::string();
  });
}

Option* CommandLine::add_count(const std::string& name, std::uint64_t& value, std::uint64_t min,
                               const std::string& description) {
  return parser_->add_read(name, description, [&value, min](const std::string& word) {
    const char* end = word.data() + word.size();
    const auto [stop, error] = std::from_chars(word.data(), end, value);
    const bool right = error == std::errc() && stop == end && value >= min;
    return right ? "" : fmt::format(" is invalid; expected an integer of at least {}", min);
  });
}

void CommandLine::parse(const std::vector<std::string>& args) {
  parser_->refuse_options_for_values(args);
  try {
    std::vector<std::string> reversed(args.rbegin(), args.rend());
    parser_->app.parse(reversed);
  } catch (const CLI::ParseError& error) {
    parser_->refuse(error, args);
  }
  if (!parser_->app.remaining().empty()) parser_->refuse_extras();
  parser_->refuse_empty_values();
}

bool CommandLine::was_given(std::string_view name) const {
  const Option* const option = find(name);
  if (option == nullptr) throw std::logic_error(fmt::format("no option {} was added", name));
  return option->was_given();
}

void CommandLine::refuse_given(const std::vector<std::string>& names,
                               const std::string& why) const {
  for (const std::string& name : names)
    if (was_given(name)) parser_->refuse(name, fmt::format("{} {}", name, why));
}

const Option* CommandLine::find(std::string_view name) const {
  for (const ParsedOption& option : parser_->options) {
    if (option.name() == name) return &option;
    for (const std::string& other : option.all_names())
      if (other == name) return &option;
  }
  return nullptr;
}

std::vector<const Option*> CommandLine::options() const {
  std::vector<const Option*> all;
  for (const ParsedOption& option : parser_->options) all.push_back(&option);
  return all;
}

}  // namespace quadtune::cli
