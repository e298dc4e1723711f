// SPDX-License-Identifier: Apache-2.0
/// The Allan deviation of a sensor and the noises read off it, as text and as JSON.
#pragma once

#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/logs/allan_of_log.hpp"

namespace quadtune::report {

[[nodiscard]] internal::Json to_json(const SensorAllan& allan);
[[nodiscard]] std::string to_text(const SensorAllan& allan);

}  // namespace quadtune::report
