// SPDX-License-Identifier: Apache-2.0
/// A flight as text and as JSON.
#pragma once

#include <optional>
#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/flight/diagnosis.hpp"
#include "quadtune/workbench/flight/fly.hpp"

namespace quadtune::report {

/// "estimator mambo, real sensors, wind calm"
[[nodiscard]] std::string surroundings(const PlannedFlight& plan);
/// "cascaded PID, …; estimator mambo, real sensors, wind calm, seed 1"
[[nodiscard]] std::string circumstances(const PlannedFlight& plan);

/// "metrics", "limits", "verdict", "events", "final_state", "steps", "wall_s" and what was flown.
/// @param diagnosis  of a flight that failed, if it was made: "diagnosis"
[[nodiscard]] internal::Json to_json(const FlownFlight& flight,
                                     const std::optional<Diagnosis>& diagnosis = {});
[[nodiscard]] std::string to_text(const FlownFlight& flight,
                                  const std::optional<Diagnosis>& diagnosis = {});

}  // namespace quadtune::report
