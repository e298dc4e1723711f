// SPDX-License-Identifier: Apache-2.0
#include "report/text/bash_completion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "quadtune/internal/joined.hpp"
#include "quadtune/version.hpp"

namespace quadtune::report {
namespace {

using Words = std::vector<std::string>;

std::vector<std::string> names_of(const std::vector<CompletedCommand>& commands) {
  std::vector<std::string> names;
  names.reserve(commands.size());
  for (const CompletedCommand& command : commands) names.push_back(command.name);
  return names;
}

/// "words=…; values=…" of one command, as bash has it; values by the word before the cursor.
std::string case_of(const CompletedCommand& command) {
  std::string text =
      fmt::format("words=\"{}\" values=\"{}\"; case \"$before\" in",
                  internal::joined(command.options, " "), internal::joined(command.arguments, " "));
  for (const auto& [option, values] : command.values)
    text += fmt::format(" {}) values=\"{}\" ;;", option, internal::joined(values, " "));
  return text +
         fmt::format(" {}) ;; -*) values=\"\" ;; esac", internal::joined(command.flags, "|"));
}

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
  // Placeholders for a list of the user.
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

}  // namespace

Words listed_words(const std::string& description) {
  const std::string text = without_parentheses(description.substr(0, description.find(';')));
  // "integrator of the PID: euler, …" and "ideal, or real: the sensors of …": uses the side that
  // lists more.
  const std::size_t colon = text.find(": ");
  if (colon == std::string::npos) return single_words(text);
  const Words before = single_words(text.substr(0, colon));
  const Words after = single_words(text.substr(colon + 2));
  return before.size() > after.size() ? before : after;
}

std::string bash_completion(const std::vector<CompletedCommand>& commands) {
  std::string cases;
  for (const CompletedCommand& command : commands) {
    if (command.kinds.empty()) {
      cases += fmt::format("    {}) {} ;;\n", command.name, case_of(command));
      continue;
    }
    cases += fmt::format("    {}) kinds=\"{}\"; case \"${{COMP_WORDS[2]}}\" in\n", command.name,
                         internal::joined(names_of(command.kinds), " "));
    for (const CompletedCommand& kind : command.kinds)
      cases += fmt::format("      {}) {} ;;\n", kind.name, case_of(kind));
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
      kVersion, internal::joined(names_of(commands), " "), cases);
}

}  // namespace quadtune::report
