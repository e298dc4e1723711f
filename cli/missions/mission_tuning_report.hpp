// SPDX-License-Identifier: Apache-2.0
/// What tuning over missions tells: as text, as JSON, as a page.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "quadtune/workbench/missions/flown_evidence.hpp"
#include "missions/mission_tuning.hpp"
#include "report/page/gains_page.hpp"

namespace quadtune::cli {

/// A limit of a mission that is tighter than the sensors can keep.
struct TunedLimit {
  std::string mission;
  WidenedLimit limit;
};

/// A search with its design, and with what its start and its rival are.
struct MissionTuningReport {
  const MissionTuning& tuning;
  const TrialRequest& request;
  const MissionSearchResult& result;
  std::vector<NamedMargins> before, after;  ///< of the loops: start, the best point
  std::vector<DesignLimit> limits;          ///< of the margins, as the best point has them
  std::optional<TrialOutcome> rival;        ///< on the draws of the proof
  FlownEvidence flown = {};
  std::vector<TunedLimit> widened = {};
};

[[nodiscard]] std::string to_text(const MissionTuningReport& report);
[[nodiscard]] internal::Json to_json(const MissionTuningReport& report);

/// The page. It flies each mission once more, with start, the best point and the rival, on the
/// first of the fresh draws.
/// @throws Interrupted  where `stop` says so
[[nodiscard]] GainsPage page_of(const MissionTuningReport& report, const MissionTrial& trial,
                                const MissionTrial::Stop& stop);

}  // namespace quadtune::cli
