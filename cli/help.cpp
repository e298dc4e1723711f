// SPDX-License-Identifier: Apache-2.0
/// quadtune help: usage of the program or of a command, the man page and the bash completion, all
/// generated from the table of commands.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "program/command_line.hpp"
#include "program/completion.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/suggest.hpp"
#include "report/text/command_help.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::vector<std::string> words;
  bool man = false;
  bool completion = false;
};

constexpr const char* kExitStatus =
    "0 done; 1 the answer is no; 2 the command line is invalid; 3 the input is invalid; 4 no "
    "solution exists or none was found; 5 a file could not be read or written, or a vehicle could "
    "not be "
    "reached; 6 an error in quadtune itself; 130 interrupted";

CommandHelp help_of(const Verb& verb) {
  CommandLine line;
  (void)verb.define(line);
  CommandHelp help{verb.name, verb.usage, verb.summary, verb.example, {}};
  for (const Option* option : line.options())
    if (!option->is_argument())
      help.options.push_back({internal::joined(option->all_names(), " ") +
                                  (option->takes_value() ? " " + option->type_name() : ""),
                              option->description()});
  if (line.find("-o") == nullptr)
    help.options.push_back({"-o FILE", "write the output to a file, whole or not at all"});
  for (const CommonOption& option : kCommonOptions)
    help.options.push_back({fmt::format("{}{}", option.name, option.type), option.description});
  return help;
}

std::vector<CommandHelp> help_of(const std::vector<Verb>& some) {
  std::vector<CommandHelp> all;
  all.reserve(some.size());
  for (const Verb& verb : some) all.push_back(help_of(verb));
  return all;
}

/// Whether a command accepts a literal word: "imu" of "calibrate imu", "flow" of "compare flow".
bool takes_word(const Verb& verb, const std::string& word) {
  std::string words = " " + verb.usage + " ";
  std::replace(words.begin(), words.end(), '|', ' ');
  return !word.empty() && std::islower(static_cast<unsigned char>(word[0])) != 0 &&
         words.find(" " + word + " ") != std::string::npos;
}

/// The command of that name, or all two-word commands that begin with it.
std::vector<Verb> verbs_of(const std::string& name) {
  std::vector<Verb> found;
  const std::size_t blank = std::min(name.find(' '), name.size());
  std::vector<std::string> known;
  for (const Verb& verb : verbs()) {
    if (verb.name == name || verb.name.starts_with(name + " ") ||
        (verb.name == name.substr(0, blank) &&
         takes_word(verb, name.substr(std::min(blank + 1, name.size())))))
      found.push_back(verb);
    known.push_back(verb.name);
  }
  if (found.empty()) refuse(name, "no command '{}'{}", name, internal::did_you_mean(name, known));
  return found;
}

void run_help(const Options& options, Context& context) {
  const std::string name = internal::joined(options.words, " ");
  if (context.json && (options.man || options.completion))
    refuse("help", "--json", "--json cannot be combined with --man or --completion");
  const std::vector<CommandHelp> commands =
      help_of(name.empty() || options.man || options.completion ? verbs() : verbs_of(name));
  context.print(
      [&] { return name.empty() ? overview_json(commands, kExitStatus) : usage_json(commands); },
      [&] {
        if (options.man) return man_page(commands, kExitStatus);
        if (options.completion) return bash_completion(completed_commands());
        return name.empty() ? overview_text(commands, kExitStatus) : usage_text(commands);
      });
}

void add_options(CommandLine& line, Options& options) {
  line.add_words("COMMAND", options.words, 2, "the command to explain");
  line.add_flag("--man", options.man, "print the man page");
  line.add_flag("--completion", options.completion, "print the bash completion");
}

}  // namespace

Verb help_verb() {
  return {"help", "[COMMAND]", "show usage, with an example that works as printed",
          "quadtune help lqr", with_options(add_options, run_help)};
}

}  // namespace quadtune::cli
