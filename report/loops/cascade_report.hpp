// SPDX-License-Identifier: Apache-2.0
/// A vehicle's PID cascade as text and JSON, for `pid V` and `design`.
#pragma once

#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/design/cascade_report.hpp"
#include "report/loops/margins_report.hpp"

namespace quadtune::report {

/// "vehicle", "dt", "sensor_delay_s", "integrator", "motor_lag_s", "published", "loops",
/// "margins", "spectral_radius".
[[nodiscard]] internal::Json to_json(const CascadeReport& report);

/// Sections: loops, beside what is published, margins, stability.
[[nodiscard]] std::string to_text(const CascadeReport& report);

}  // namespace quadtune::report
