// SPDX-License-Identifier: Apache-2.0
/// quadtune help: usage of the program or of a verb, the man page and the bash completion, all from
/// the one table of verbs.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <memory>
#include <ostream>

#include "program/command_line.hpp"
#include "program/completion.hpp"
#include "program/program.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/version.hpp"

namespace quadtune::cli {
namespace {

using internal::Json;

constexpr const char* kExitStatus =
    "0 done; 1 the answer is no; 2 the command line is wrong; 3 the input is wrong; 4 no solution "
    "exists or none was found; 5 a file could not be read or written; 6 an "
    "error in quadtune itself; 130 interrupted";

struct OptionText {
  std::string names;
  std::string description;
};

std::vector<OptionText> option_texts(const Verb& verb) {
  CommandLine line;
  (void)verb.define(line);
  std::vector<OptionText> texts;
  for (const Option* option : line.options()) {
    if (option->is_argument()) continue;
    std::string names = fmt::format("{}", internal::joined(option->all_names(), " "));
    if (option->takes_value()) names += " " + option->type_name();
    texts.push_back({names, option->description()});
  }
  if (line.find("-o") == nullptr)
    texts.push_back({"-o FILE", "write the output to a file, whole or not at all"});
  texts.push_back({"--json", "print one JSON object instead of the text"});
  texts.push_back({"--quiet", "no notes on the error stream"});
  texts.push_back({"--seed N", "fixes everything random; 1"});
  texts.push_back({"--threads N", "at most so many at once; one for each processor"});
  return texts;
}

Json verb_json(const Verb& verb) {
  Json json = {{"name", verb.name}, {"usage", verb.usage}, {"summary", verb.summary}};
  json["options"] = Json::array();
  for (const OptionText& option : option_texts(verb))
    json["options"].push_back({{"option", option.names}, {"description", option.description}});
  json["example"] = verb.example;
  return json;
}

Json overview_json() {
  Json json = {{"version", kVersion}, {"commands", Json::array()}};
  for (const Verb& verb : verbs()) json["commands"].push_back(verb_json(verb));
  json["exit_status"] = kExitStatus;
  return json;
}

std::string overview() {
  std::string text = fmt::format(
      "quadtune {}: from a small multirotor's numbers to gains that fly\n\nusage: quadtune COMMAND "
      "[options]\n\n",
      kVersion);
  for (const Verb& verb : verbs()) text += fmt::format("  {:<11} {}\n", verb.name, verb.summary);
  text += "\n'quadtune help COMMAND' shows a command's options and an example.\nExit status: ";
  return text + kExitStatus + ".\n";
}

std::string usage(const Verb& verb) {
  std::string text =
      fmt::format("usage: quadtune {} {}\n\n{}\n\noptions:\n", verb.name, verb.usage, verb.summary);
  for (const OptionText& option : option_texts(verb))
    text += option.names.size() > 26
                ? fmt::format("  {}\n  {:<26} {}\n", option.names, "", option.description)
                : fmt::format("  {:<26} {}\n", option.names, option.description);
  return text + fmt::format("\nexample:\n  {}\n", verb.example);
}

std::string escaped(std::string text) {
  std::string result;
  for (const char c : text) result += c == '-' ? std::string("\\-") : std::string(1, c);
  return result;
}

std::string man_page() {
  std::string text = fmt::format(
      ".TH QUADTUNE 1 \"\" \"quadtune {}\"\n.SH NAME\nquadtune \\- from a small multirotor's "
      "numbers "
      "to gains that fly\n.SH SYNOPSIS\n.B quadtune\n.I COMMAND\n[options]\n.SH COMMANDS\n",
      kVersion);
  for (const Verb& verb : verbs()) {
    text += fmt::format(".SS {} {}\n{}.\n", verb.name, escaped(verb.usage), escaped(verb.summary));
    for (const OptionText& option : option_texts(verb))
      text += fmt::format(".TP\n.B {}\n{}\n", escaped(option.names), escaped(option.description));
    text += fmt::format(".PP\nExample:\n.EX\n{}\n.EE\n", escaped(verb.example));
  }
  return text + ".SH EXIT STATUS\n" + escaped(kExitStatus) + ".\n";
}

/// Whether a verb takes a word as it is: "imu" of "calibrate imu", "flow" of "compare flow".
bool takes_word(const Verb& verb, const std::string& word) {
  std::string words = " " + verb.usage + " ";
  std::replace(words.begin(), words.end(), '|', ' ');
  return !word.empty() && std::islower(static_cast<unsigned char>(word[0])) != 0 &&
         words.find(" " + word + " ") != std::string::npos;
}

/// The verb of that name, or all kinds of it: those of two words that begin with it.
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
  if (found.empty())
    throw UsageError(
        fmt::format("quadtune help: no command '{}'{}", name, internal::did_you_mean(name, known)),
        name);
  return found;
}

Json verbs_json(const std::vector<Verb>& of) {
  if (of.size() == 1) return verb_json(of.front());
  Json json = {{"commands", Json::array()}};
  for (const Verb& verb : of) json["commands"].push_back(verb_json(verb));
  return json;
}

std::string usages(const std::vector<Verb>& of) {
  std::string text;
  for (const Verb& verb : of) text += (text.empty() ? "" : "\n") + usage(verb);
  return text;
}

}  // namespace

Verb help_verb() {
  struct Options {
    std::vector<std::string> words;
    bool man = false;
    bool completion = false;
  };
  return {"help", "[COMMAND]", "show usage, with an example that works as printed",
          "quadtune help lqr", [](CommandLine& line) -> Action {
            auto options = std::make_shared<Options>();
            line.add_words("COMMAND", options->words, 2, "the command to explain");
            line.add_flag("--man", options->man, "print the man page");
            line.add_flag("--completion", options->completion, "print the bash completion");
            return [options](Context& context) {
              const std::string name = fmt::format("{}", internal::joined(options->words, " "));
              if (context.json) {
                if (options->man || options->completion)
                  throw UsageError(
                      "quadtune help: --json came with --man or --completion, expected one of them",
                      "--json");
                context.out << internal::readable(name.empty() ? overview_json()
                                                               : verbs_json(verbs_of(name)))
                            << "\n";
              } else if (options->man) {
                context.out << man_page();
              } else if (options->completion) {
                context.out << bash_completion();
              } else {
                context.out << (name.empty() ? overview() : usages(verbs_of(name)));
              }
            };
          }};
}

}  // namespace quadtune::cli
