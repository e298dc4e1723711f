// SPDX-License-Identifier: Apache-2.0
/// Margins as text and JSON, for `margins`, `lqr` and `design`.
#pragma once

#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/design/margins_report.hpp"

namespace quadtune::report {

/// "loops" and "multivariable". Values that are infinite or were not requested are null.
[[nodiscard]] internal::Json to_json(const MarginsReport& report);

/// A table with a row for each channel, and a line for all loops at once.
[[nodiscard]] std::string to_text(const MarginsReport& report);

}  // namespace quadtune::report
