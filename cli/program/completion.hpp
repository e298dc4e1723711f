// SPDX-License-Identifier: Apache-2.0
/// The bash completion: verbs, options, and the values that options and arguments take, all from
/// the table of verbs and what its options say of themselves.
#pragma once

#include <string>
#include <vector>

#include "report/text/bash_completion.hpp"

namespace quadtune::cli {

/// The names of what is built in that an option takes, as its description says: vehicles, missions
/// or filter models.
[[nodiscard]] std::vector<std::string> built_in_names(const std::string& description);

/// All verbs with what they take, for report::bash_completion().
[[nodiscard]] std::vector<report::CompletedCommand> completed_commands();

}  // namespace quadtune::cli
