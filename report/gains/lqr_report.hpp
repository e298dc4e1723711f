// SPDX-License-Identifier: Apache-2.0
/// LQR gains of matrices, and of a vehicle about a trim, with their evidence.
#pragma once

#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/design/lqr_report.hpp"

namespace quadtune::report {

/// @param report  solved
[[nodiscard]] internal::Json to_json(const LqrReport& report);
[[nodiscard]] std::string to_text(const LqrReport& report);

/// The same; the JSON holds the law as `fly --gains` takes it.
[[nodiscard]] internal::Json to_json(const VehicleLqrReport& report);
[[nodiscard]] std::string to_text(const VehicleLqrReport& report);

}  // namespace quadtune::report
