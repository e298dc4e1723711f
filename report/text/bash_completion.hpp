// SPDX-License-Identifier: Apache-2.0
/// The bash completion of the program, generated from its commands and their options.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace quadtune::report {

/// One command, or the first word of several two-word commands.
struct CompletedCommand {
  std::string name;
  std::vector<std::string> options;
  std::vector<std::string> flags;                          ///< options that take no value
  std::map<std::string, std::vector<std::string>> values;  ///< values of each option
  std::vector<std::string> arguments;                      ///< values of positional arguments
  std::vector<CompletedCommand> kinds = {};  ///< the two-word commands, named by the second word;
                                             ///< then all other members are empty
};

/// The values of an option that its description lists: "uquad, mambo or json", "optical flow: full
/// (default), simplified or off"; empty if it lists none.
[[nodiscard]] std::vector<std::string> listed_words(const std::string& description);

/// A script for bash's `source`.
[[nodiscard]] std::string bash_completion(const std::vector<CompletedCommand>& commands);

}  // namespace quadtune::report
