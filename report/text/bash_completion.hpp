// SPDX-License-Identifier: Apache-2.0
/// The bash completion of the program, from what its commands take.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace quadtune::report {

/// One command, or a first word with the second words that may follow it.
struct CompletedCommand {
  std::string name;
  std::vector<std::string> options;
  std::vector<std::string> flags;                          ///< those of them that take no value
  std::map<std::string, std::vector<std::string>> values;  ///< by option
  std::vector<std::string> arguments;                      ///< in the place of an argument
  std::vector<CompletedCommand> kinds = {};  ///< by the second word; then all others are empty
};

/// The words that an option takes, as its description lists them: "uquad, mambo or json", "optical
/// flow: full (default), simplified or off"; empty where it lists none.
[[nodiscard]] std::vector<std::string> listed_words(const std::string& description);

/// A script for `source`.
[[nodiscard]] std::string bash_completion(const std::vector<CompletedCommand>& commands);

}  // namespace quadtune::report
