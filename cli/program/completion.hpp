// SPDX-License-Identifier: Apache-2.0
/// The bash completion: commands, options, and the values of options and arguments, all taken from
/// the table of commands and from the descriptions of their options.
#pragma once

#include <string>
#include <vector>

#include "report/text/bash_completion.hpp"

namespace quadtune::cli {

/// The built-in names that an option accepts according to its description: vehicles, missions or
/// filter models.
[[nodiscard]] std::vector<std::string> built_in_names(const std::string& description);

/// All commands with their options and values, for report::bash_completion().
[[nodiscard]] std::vector<report::CompletedCommand> completed_commands();

}  // namespace quadtune::cli
