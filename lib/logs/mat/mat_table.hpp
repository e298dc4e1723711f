// SPDX-License-Identifier: Apache-2.0
/// The project's own logs as MAT files, by libmatio: what bytes_of_mat() and table_of_mat() call.
#pragma once

#include <string>

#include "quadtune/logs/log_table.hpp"

namespace quadtune::internal {

[[nodiscard]] std::string bytes_by_matio(const LogTable& table);
[[nodiscard]] LogTable table_by_matio(const std::string& bytes, const std::string& origin);

}  // namespace quadtune::internal
