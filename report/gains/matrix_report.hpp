// SPDX-License-Identifier: Apache-2.0
/// Gains of a given structure, for programs that hold matrices alone, with their evidence.
#pragma once

#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/design/matrix_report.hpp"
#include "quadtune/workbench/flown/flown_gains.hpp"

namespace quadtune::report {

/// Margins of each group of axes on each plant of the family that gains were designed for.
[[nodiscard]] std::string family_text(const FlownGains& flown);
[[nodiscard]] internal::Json family_json(const FlownGains& flown);

/// The gains with their evidence.
[[nodiscard]] internal::Json to_json(const MatrixReport& report, const Vehicle& vehicle);
[[nodiscard]] std::string to_text(const MatrixReport& report);

}  // namespace quadtune::report
