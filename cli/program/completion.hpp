// SPDX-License-Identifier: Apache-2.0
/// The bash completion: verbs, options, and the values that options and arguments take, all from
/// the table of verbs and what its options say of themselves.
#pragma once

#include <string>
#include <vector>

#include "report/text/bash_completion.hpp"

namespace quadtune::cli {

/// The words that an option takes, as its description lists them: "uquad, mambo or json", "optical
/// flow: full (default), simplified or off"; empty where it lists none.
[[nodiscard]] std::vector<std::string> listed_words(const std::string& description);

/// All verbs with what they take, for report::bash_completion().
[[nodiscard]] std::vector<report::CompletedCommand> completed_commands();

}  // namespace quadtune::cli
