// SPDX-License-Identifier: Apache-2.0
/// LQI gains that were designed on the flown plant, with their evidence.
#pragma once

#include <optional>
#include <string>

#include "quadtune/exports/stored_estimator.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/design/lqi_report.hpp"
#include "quadtune/workbench/design/margins_report.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"

namespace quadtune::report {

/// The gains with their evidence.
[[nodiscard]] internal::Json to_json(const LqiReport& report, const Vehicle& vehicle);
[[nodiscard]] std::string to_text(const LqiReport& report);

/// What every law of the flown plant tells: its gains with their names, the flown loop, the ideal
/// one, and the law as `fly --gains` takes it.
void add_gains(internal::Json& json, const Gains& gains);
void add_loops(internal::Json& json, const FlownLoop& flown, const MarginsReport& ideal);
void add_export(internal::Json& json, const Vehicle& vehicle, const Gains& gains,
                const std::optional<StoredEstimator>& estimator);

}  // namespace quadtune::report
