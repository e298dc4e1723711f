// SPDX-License-Identifier: Apache-2.0
/// Options that say how a log is to be read, shared by all verbs that read one.
#pragma once

#include <optional>
#include <string>

#include "quadtune/logs/log_reader.hpp"

namespace CLI {
class App;
}

namespace quadtune::cli {

struct LogArguments {
  std::string format, columns;
  std::optional<double> rate_hz;
};

/// Adds --format, --columns and --rate.
void add_log_options(CLI::App& app, LogArguments& arguments);

/// @param verb  For messages.
/// @throws UsageError, InvalidInput  naming the option.
[[nodiscard]] LogOptions log_options(const LogArguments& arguments, const std::string& verb);

}  // namespace quadtune::cli
