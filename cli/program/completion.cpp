// SPDX-License-Identifier: Apache-2.0
#include "program/completion.hpp"

#include <algorithm>

#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/simulation/mission.hpp"

namespace quadtune::cli {
namespace {

using Words = std::vector<std::string>;

/// The values that are suggested for an option or an argument.
Words values_of(const Option& option) {
  if (option.name() == "--vehicle") return built_in_vehicles();
  const std::string description = option.description();
  if (Words names = built_in_names(description); !names.empty() || !option.takes_value())
    return names;
  std::string type = option.type_name();
  if (type.find('|') != std::string::npos) {
    std::replace(type.begin(), type.end(), '|', ',');
    return listed_words(type);
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

Words built_in_names(const std::string& description) {
  const auto says = [&](const char* words) { return description.find(words) != std::string::npos; };
  if (says("built-in mission")) return built_in_missions();
  if (says("built-in vehicle")) return built_in_vehicles();
  Words names;
  if (says("built-in filter model"))
    for (const FilterModelTitle& title : built_in_filter_models()) names.push_back(title.name);
  return names;
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
