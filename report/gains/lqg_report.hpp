// SPDX-License-Identifier: Apache-2.0
/// State feedback together with its filter, and the deviations that noise causes.
#pragma once

#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/design/lqg_report.hpp"

namespace quadtune::report {

[[nodiscard]] internal::Json to_json(const LqgReport& report, const Vehicle& vehicle);
[[nodiscard]] std::string to_text(const LqgReport& report);

}  // namespace quadtune::report
