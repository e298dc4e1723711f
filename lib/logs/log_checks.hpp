// SPDX-License-Identifier: Apache-2.0
/// Checks of a table that both file formats require, when writing and when reading.
#pragma once

#include <string>

#include "quadtune/logs/log_table.hpp"

namespace quadtune::internal {

/// @param where  beginning of messages: the file, or "log" for a table in memory
/// @throws InvalidInput  if columns differ in length, a column has no name, a name appears twice,
///                       or a text is not UTF-8
void require_log(const LogTable& table, const std::string& where);

}  // namespace quadtune::internal
