// SPDX-License-Identifier: Apache-2.0
/// A loop and its margins, ideal and as it flies, as text and JSON.
#pragma once

#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/design/named_loop.hpp"

namespace quadtune::report {

/// The margins, "time", "dt", and of a vehicle's loop "plant", "flown" and "ideal".
[[nodiscard]] internal::Json to_json(const LoopReport& report);
[[nodiscard]] std::string to_text(const LoopReport& report);

}  // namespace quadtune::report
