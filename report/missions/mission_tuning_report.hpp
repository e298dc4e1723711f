// SPDX-License-Identifier: Apache-2.0
/// The result of tuning over missions as text, JSON and page.
#pragma once

#include <string>
#include <vector>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/missions/mission_tuning.hpp"
#include "report/page/gains_page.hpp"

namespace quadtune::report {

[[nodiscard]] internal::Json to_json(const MissionTuningResult& result);
[[nodiscard]] std::string to_text(const MissionTuningResult& result);

/// The page.
/// @param flights  result of tuned_flights(); one chart for each mission
[[nodiscard]] GainsPage page_of(const MissionTuningResult& result,
                                const std::vector<TunedFlights>& flights);

}  // namespace quadtune::report
