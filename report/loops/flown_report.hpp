// SPDX-License-Identifier: Apache-2.0
/// The flown loop as text and JSON, for `margins` and `design`.
#pragma once

#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"

namespace quadtune::report {

/// "stable", "largest_pole", "mode" and where it was looked at; not its margins.
[[nodiscard]] internal::Json to_json(const FlownLoop& loop);

/// Whether it is stable, the first mode to grow, and where it was looked at.
[[nodiscard]] std::string to_text(const FlownLoop& loop);

}  // namespace quadtune::report
