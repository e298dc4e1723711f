// SPDX-License-Identifier: Apache-2.0
#include "program/completion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/simulation/mission.hpp"
#include "quadtune/version.hpp"

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

struct Offer {
  Words options;
  Words flags;                          ///< those of them that take no value
  std::map<std::string, Words> values;  ///< by option
  Words arguments;                      ///< in the place of an argument
};

Offer offer_of(const Verb& verb) {
  Offer offer;
  CommandLine line;
  (void)verb.define(line);
  for (const Option* option : line.options()) {
    const Words values = values_of(*option);
    if (option->is_argument()) {
      offer.arguments.insert(offer.arguments.end(), values.begin(), values.end());
      continue;
    }
    const std::string name = option->name();
    if (name.starts_with("--")) offer.options.push_back(name);
    if (!option->takes_value()) offer.flags.push_back(name);
    if (!values.empty()) offer.values[name] = values;
  }
  for (const CommonOption& option : kCommonOptions) {
    offer.options.emplace_back(option.name);
    if (*option.type == '\0') offer.flags.emplace_back(option.name);
  }
  return offer;
}

/// "words=…; values=…" of one verb, as bash has it; values by the word before the cursor.
std::string case_of(const Offer& offer) {
  std::string text =
      fmt::format("words=\"{}\" values=\"{}\"; case \"$before\" in",
                  internal::joined(offer.options, " "), internal::joined(offer.arguments, " "));
  for (const auto& [option, values] : offer.values)
    text += fmt::format(" {}) values=\"{}\" ;;", option, internal::joined(values, " "));
  return text + fmt::format(" {}) ;; -*) values=\"\" ;; esac", internal::joined(offer.flags, "|"));
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

std::string bash_completion() {
  Words names;
  std::string cases;
  for (const Verb& verb : verbs()) {
    const std::string first = verb.name.substr(0, verb.name.find(' '));
    if (std::find(names.begin(), names.end(), first) != names.end()) continue;
    names.push_back(first);
    const Words kinds = kinds_of(first);
    if (kinds.empty()) {
      Offer offer = offer_of(verb);
      if (verb.name == "help")
        for (const Verb& other : verbs())
          offer.arguments.push_back(other.name.substr(0, other.name.find(' ')));
      cases += fmt::format("    {}) {} ;;\n", verb.name, case_of(offer));
      continue;
    }
    cases += fmt::format("    {}) kinds=\"{}\"; case \"${{COMP_WORDS[2]}}\" in\n", first,
                         internal::joined(kinds, " "));
    for (const Verb& kind : verbs())
      if (kind.name.starts_with(first + " "))
        cases += fmt::format("      {}) {} ;;\n", kind.name.substr(first.size() + 1),
                             case_of(offer_of(kind)));
    cases += "    esac ;;\n";
  }
  return fmt::format(
      "# bash completion for quadtune {}\n"
      "_quadtune() {{\n"
      "  local word=\"${{COMP_WORDS[COMP_CWORD]}}\" before=\"${{COMP_WORDS[COMP_CWORD-1]}}\"\n"
      "  local words=\"\" kinds=\"\" values=\"\"\n"
      "  if [ \"$COMP_CWORD\" -eq 1 ]; then words=\"{}\"; else case \"${{COMP_WORDS[1]}}\" in\n"
      "{}"
      "  esac; fi\n"
      "  case \"$word\" in\n"
      "    -*) COMPREPLY=($(compgen -W \"$words\" -- \"$word\")) ;;\n"
      "    *) if [ \"$COMP_CWORD\" -eq 1 ]; then COMPREPLY=($(compgen -W \"$words\" -- "
      "\"$word\"))\n"
      "       elif [ \"$COMP_CWORD\" -eq 2 ] && [ -n \"$kinds\" ]; then\n"
      "         COMPREPLY=($(compgen -W \"$kinds\" -- \"$word\"))\n"
      "       else compopt -o filenames 2>/dev/null\n"
      "         mapfile -t COMPREPLY < <(compgen -W \"$values\" -- \"$word\"; compgen -f -- "
      "\"$word\")\n"
      "       fi ;;\n"
      "  esac\n"
      "}}\n"
      "complete -F _quadtune quadtune\n",
      kVersion, internal::joined(names, " "), cases);
}

}  // namespace quadtune::cli
