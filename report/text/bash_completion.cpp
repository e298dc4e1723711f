// SPDX-License-Identifier: Apache-2.0
#include "report/text/bash_completion.hpp"

#include <fmt/format.h>

#include "quadtune/internal/joined.hpp"
#include "quadtune/version.hpp"

namespace quadtune::report {
namespace {

std::vector<std::string> names_of(const std::vector<CompletedCommand>& commands) {
  std::vector<std::string> names;
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

}  // namespace

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
