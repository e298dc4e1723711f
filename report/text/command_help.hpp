// SPDX-License-Identifier: Apache-2.0
/// Usage of the program and of its commands, as text, as JSON and as a man page.
#pragma once

#include <string>
#include <vector>

#include "quadtune/internal/json_fwd.hpp"

namespace quadtune::report {

struct OptionHelp {
  std::string names;  ///< "-o FILE"
  std::string description;
};

struct CommandHelp {
  std::string name;     ///< "tune lqr"
  std::string usage;    ///< what follows the name
  std::string summary;  ///< one line
  std::string example;
  std::vector<OptionHelp> options;
};

/// A line for each command.
/// @param exit_status  the meaning of the exit statuses, here and below
[[nodiscard]] std::string overview_text(const std::vector<CommandHelp>& commands,
                                        const std::string& exit_status);
/// All commands with their options.
[[nodiscard]] internal::Json overview_json(const std::vector<CommandHelp>& commands,
                                           const std::string& exit_status);

/// Each command with its options.
[[nodiscard]] std::string usage_text(const std::vector<CommandHelp>& commands);
/// The object of a single command, or one object with all of them.
[[nodiscard]] internal::Json usage_json(const std::vector<CommandHelp>& commands);

/// The man page in the format of man(7).
[[nodiscard]] std::string man_page(const std::vector<CommandHelp>& commands,
                                   const std::string& exit_status);

}  // namespace quadtune::report
