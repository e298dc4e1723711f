// SPDX-License-Identifier: Apache-2.0
/// quadtune help: usage of the program or of a verb, the man page and the bash completion, all from
/// the one table of verbs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <ostream>

#include "program.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/version.hpp"

namespace quadtune::cli {
namespace {

using internal::Json;

constexpr const char* kExitStatus =
    "0 done; 1 the answer is no; 2 the command line is wrong; 3 the input is wrong; 4 no solution "
    "exists or none was found; 5 a file could not be read or written; 130 interrupted";

struct OptionText {
  std::string names;
  std::string description;
};

std::vector<OptionText> option_texts(const Verb& verb) {
  CLI::App app;
  app.set_help_flag();
  (void)verb.define(app);
  std::vector<OptionText> texts;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_positional()) continue;
    std::string names = option->get_name(false, true);
    std::replace(names.begin(), names.end(), ',', ' ');
    if (option->get_items_expected_max() > 0) names += " " + option->get_type_name();
    texts.push_back({names, option->get_description()});
  }
  if (!app.get_option_no_throw("-o"))
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

std::string completion() {
  std::string names;
  std::string cases;
  for (const Verb& verb : verbs()) {
    names += (names.empty() ? "" : " ") + verb.name;
    std::string options;
    for (const OptionText& option : option_texts(verb)) {
      const std::size_t start = option.names.find("--");
      if (start == std::string::npos) continue;
      options += " " + option.names.substr(start, option.names.find(' ', start) - start);
    }
    cases += fmt::format("    {}) words=\"{}\" ;;\n", verb.name, options.substr(1));
  }
  return fmt::format(
      "# bash completion for quadtune {}\n"
      "_quadtune() {{\n"
      "  local word=\"${{COMP_WORDS[COMP_CWORD]}}\" words=\"\"\n"
      "  if [ \"$COMP_CWORD\" -eq 1 ]; then words=\"{}\"; else case \"${{COMP_WORDS[1]}}\" in\n"
      "{}"
      "  esac; fi\n"
      "  case \"$word\" in\n"
      "    -*) COMPREPLY=($(compgen -W \"$words\" -- \"$word\")) ;;\n"
      "    *) [ \"$COMP_CWORD\" -eq 1 ] && COMPREPLY=($(compgen -W \"$words\" -- \"$word\")) ||\n"
      "       COMPREPLY=($(compgen -f -- \"$word\")) ;;\n"
      "  esac\n"
      "}}\n"
      "complete -F _quadtune quadtune\n",
      kVersion, names, cases);
}

const Verb& verb_of(const std::string& name) {
  std::vector<std::string> known;
  for (const Verb& verb : verbs()) {
    if (verb.name == name) return verb;
    known.push_back(verb.name);
  }
  throw UsageError(
      fmt::format("quadtune help: no command '{}'{}", name, internal::did_you_mean(name, known)),
      name);
}

}  // namespace

Verb help_verb() {
  struct Options {
    std::string verb;
    bool man = false;
    bool completion = false;
  };
  return {"help", "[COMMAND]", "show usage, with an example that works as printed",
          "quadtune help lqr", [](CLI::App& app) -> Action {
            auto options = std::make_shared<Options>();
            app.add_option("COMMAND", options->verb, "the command to explain");
            app.add_flag("--man", options->man, "print the man page");
            app.add_flag("--completion", options->completion, "print the bash completion");
            return [options](Context& context) {
              if (context.json) {
                if (options->man || options->completion)
                  throw UsageError(
                      "quadtune help: --json came with --man or --completion, expected one of them",
                      "--json");
                context.out << internal::readable(options->verb.empty()
                                                      ? overview_json()
                                                      : verb_json(verb_of(options->verb)))
                            << "\n";
              } else if (options->man) {
                context.out << man_page();
              } else if (options->completion) {
                context.out << completion();
              } else {
                context.out << (options->verb.empty() ? overview() : usage(verb_of(options->verb)));
              }
            };
          }};
}

}  // namespace quadtune::cli
