// SPDX-License-Identifier: Apache-2.0
/// What tuning over missions found: as text, as JSON, as a page.
#pragma once

#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/missions/mission_tuning.hpp"
#include "report/page/gains_page.hpp"

namespace quadtune::report {

[[nodiscard]] internal::Json to_json(const MissionTuningResult& result);
[[nodiscard]] std::string to_text(const MissionTuningResult& result);

/// The page. It flies each mission once more, with start, the best point and the rival, on the
/// first of the fresh draws.
/// @throws Interrupted  where `stop` says so
[[nodiscard]] GainsPage page_of(const MissionTuningResult& result, const MissionTrial::Stop& stop);

}  // namespace quadtune::report
