// SPDX-License-Identifier: Apache-2.0
/// Recognizes log formats that are not supported, so that messages can name them.
#pragma once

#include <string_view>

namespace quadtune::internal {

/// Describes a file by its first bytes, and how to convert it to a supported format; empty if
/// unknown.
[[nodiscard]] std::string_view foreign_format(std::string_view bytes);

}  // namespace quadtune::internal
