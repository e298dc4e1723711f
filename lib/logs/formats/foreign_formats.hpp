// SPDX-License-Identifier: Apache-2.0
/// Logs that are not read, told by name instead of by their broken rows.
#pragma once

#include <string_view>

namespace quadtune::internal {

/// What a file is that begins so, and how to get a log of it that is read; "" for what is unknown.
[[nodiscard]] std::string_view foreign_format(std::string_view bytes);

}  // namespace quadtune::internal
