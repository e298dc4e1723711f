// SPDX-License-Identifier: Apache-2.0
/// Where two gain sets differ, as text and as JSON.
#pragma once

#include <string>

#include "quadtune/exports/diff.hpp"
#include "quadtune/internal/json_fwd.hpp"

namespace quadtune::report {

[[nodiscard]] internal::Json to_json(const GainsDiff& difference);
/// A table of the entries that differ most.
[[nodiscard]] std::string to_text(const GainsDiff& difference);

}  // namespace quadtune::report
