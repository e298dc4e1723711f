// SPDX-License-Identifier: Apache-2.0
#include "program/completion.hpp"

#include <algorithm>
#include <set>

#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/simulation/mission.hpp"

namespace quadtune::cli {
namespace {

using Words = std::vector<std::string>;

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

std::string without_parentheses(const std::string& text) {
  std::string result;
  int depth = 0;
  for (const char c : text) {
    if (c == '(') ++depth;
    if (depth == 0) result += c;
    if (c == ')') --depth;
  }
  return result;
}

bool is_word(const std::string& text) {
  // What stands for any list of one's own.
  static const std::set<std::string> stand_ins = {"names", "numbers", "all"};
  return !text.empty() && !stand_ins.contains(text) &&
         text.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-") == std::string::npos;
}

/// The single words of "a, b or c d".
Words single_words(std::string text) {
  replace_all(text, " or ", ",");
  Words words;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    std::string word = text.substr(begin, end - begin);
    word.erase(0, word.find_first_not_of(' '));
    word.erase(word.find_last_not_of(' ') + 1);
    if (is_word(word)) words.push_back(word);
    begin = end + 1;
  }
  return words;
}

Words filter_models() {
  Words names;
  for (const FilterModelTitle& title : built_in_filter_models()) names.push_back(title.name);
  return names;
}

/// What is offered for an option or an argument.
Words values_of(const Option& option) {
  const std::string description = option.description();
  const auto says = [&](const char* words) { return description.find(words) != std::string::npos; };
  if (says("built-in mission")) return built_in_missions();
  if (says("built-in filter model")) return filter_models();
  if (says("built-in vehicle") || option.name() == "--vehicle") return built_in_vehicles();
  if (!option.takes_value()) return {};
  std::string type = option.type_name();
  if (type.find('|') != std::string::npos) {
    std::replace(type.begin(), type.end(), '|', ',');
    return single_words(type);
  }
  return listed_words(description);
}

/// @param name  the last word of the verb
CompletedCommand completed(const Verb& verb, const std::string& name) {
  CompletedCommand command;
  command.name = name;
  CommandLine line;
  (void)verb.define(line);
  for (const Option* option : line.options()) {
    const Words values = values_of(*option);
    if (option->is_argument()) {
      command.arguments.insert(command.arguments.end(), values.begin(), values.end());
      continue;
    }
    const std::string word = option->name();
    if (word.starts_with("--")) command.options.push_back(word);
    if (!option->takes_value()) command.flags.push_back(word);
    if (!values.empty()) command.values[word] = values;
  }
  for (const CommonOption& option : kCommonOptions) {
    command.options.emplace_back(option.name);
    if (*option.type == '\0') command.flags.emplace_back(option.name);
  }
  return command;
}

}  // namespace

Words listed_words(const std::string& description) {
  const std::string text = without_parentheses(description.substr(0, description.find(';')));
  // "of the PID: euler, …" and "ideal, or real: as the vehicle's are": the side that lists more.
  const std::size_t colon = text.find(": ");
  if (colon == std::string::npos) return single_words(text);
  const Words before = single_words(text.substr(0, colon));
  const Words after = single_words(text.substr(colon + 2));
  return before.size() > after.size() ? before : after;
}

std::vector<CompletedCommand> completed_commands() {
  std::vector<CompletedCommand> commands;
  for (const Verb& verb : verbs()) {
    const std::size_t blank = verb.name.find(' ');
    const std::string first = verb.name.substr(0, blank);
    if (blank == std::string::npos) {
      commands.push_back(completed(verb, first));
      continue;
    }
    const auto same = [&](const CompletedCommand& command) { return command.name == first; };
    auto command = std::find_if(commands.begin(), commands.end(), same);
    if (command == commands.end())
      command = commands.insert(command, CompletedCommand{first, {}, {}, {}, {}, {}});
    command->kinds.push_back(completed(verb, verb.name.substr(blank + 1)));
  }
  for (CompletedCommand& command : commands)
    if (command.name == "help")
      for (const Verb& other : verbs())
        command.arguments.push_back(other.name.substr(0, other.name.find(' ')));
  return commands;
}

}  // namespace quadtune::cli
