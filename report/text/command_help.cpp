// SPDX-License-Identifier: Apache-2.0
#include "report/text/command_help.hpp"

#include <fmt/format.h>

#include "quadtune/internal/json.hpp"
#include "quadtune/version.hpp"

namespace quadtune::report {
namespace {

using internal::Json;

Json command_json(const CommandHelp& command) {
  Json json = {{"name", command.name}, {"usage", command.usage}, {"summary", command.summary}};
  json["options"] = Json::array();
  for (const OptionHelp& option : command.options)
    json["options"].push_back({{"option", option.names}, {"description", option.description}});
  json["example"] = command.example;
  return json;
}

Json commands_json(const std::vector<CommandHelp>& commands) {
  Json json = Json::array();
  for (const CommandHelp& command : commands) json.push_back(command_json(command));
  return json;
}

std::string usage(const CommandHelp& command) {
  std::string text = fmt::format("usage: quadtune {} {}\n\n{}\n\noptions:\n", command.name,
                                 command.usage, command.summary);
  for (const OptionHelp& option : command.options)
    text += option.names.size() > 26
                ? fmt::format("  {}\n  {:<26} {}\n", option.names, "", option.description)
                : fmt::format("  {:<26} {}\n", option.names, option.description);
  return text + fmt::format("\nexample:\n  {}\n", command.example);
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) result += c == '-' ? std::string("\\-") : std::string(1, c);
  return result;
}

}  // namespace

std::string overview_text(const std::vector<CommandHelp>& commands,
                          const std::string& exit_status) {
  std::string text = fmt::format(
      "quadtune {}: from a small multirotor's numbers to gains that fly\n\nusage: quadtune COMMAND "
      "[options]\n\n",
      kVersion);
  std::size_t width = 0;
  for (const CommandHelp& command : commands) width = std::max(width, command.name.size());
  for (const CommandHelp& command : commands)
    text += fmt::format("  {:<{}}  {}\n", command.name, width, command.summary);
  text += "\n'quadtune help COMMAND' shows a command's options and an example.\nExit status: ";
  return text + exit_status + ".\n";
}

Json overview_json(const std::vector<CommandHelp>& commands, const std::string& exit_status) {
  return {
      {"version", kVersion}, {"commands", commands_json(commands)}, {"exit_status", exit_status}};
}

std::string usage_text(const std::vector<CommandHelp>& commands) {
  std::string text;
  for (const CommandHelp& command : commands) text += (text.empty() ? "" : "\n") + usage(command);
  return text;
}

Json usage_json(const std::vector<CommandHelp>& commands) {
  if (commands.size() == 1) return command_json(commands.front());
  return {{"commands", commands_json(commands)}};
}

std::string man_page(const std::vector<CommandHelp>& commands, const std::string& exit_status) {
  std::string text = fmt::format(
      ".TH QUADTUNE 1 \"\" \"quadtune {}\"\n.SH NAME\nquadtune \\- from a small multirotor's "
      "numbers "
      "to gains that fly\n.SH SYNOPSIS\n.B quadtune\n.I COMMAND\n[options]\n.SH COMMANDS\n",
      kVersion);
  for (const CommandHelp& command : commands) {
    text += fmt::format(".SS {} {}\n{}.\n", command.name, escaped(command.usage),
                        escaped(command.summary));
    for (const OptionHelp& option : command.options)
      text += fmt::format(".TP\n.B {}\n{}\n", escaped(option.names), escaped(option.description));
    text += fmt::format(".PP\nExample:\n.EX\n{}\n.EE\n", escaped(command.example));
  }
  return text + ".SH EXIT STATUS\n" + escaped(exit_status) + ".\n";
}

}  // namespace quadtune::report
