// SPDX-License-Identifier: Apache-2.0
/// What both formats ask of a table, written or read.
#pragma once

#include <string>

#include "quadtune/logs/log_table.hpp"

namespace quadtune::internal {

/// @param where  What messages begin with: the file, or "log" for a table in memory.
/// @throws InvalidInput  for columns of different length, a column without a name, a name that
///                       stands twice, a text that is not UTF-8.
void require_log(const LogTable& table, const std::string& where);

}  // namespace quadtune::internal
