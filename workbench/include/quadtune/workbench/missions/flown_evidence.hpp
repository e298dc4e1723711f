// SPDX-License-Identifier: Apache-2.0
/// The flown loops of the initial and the tuned gains, and their effect on the result of a tuning.
#pragma once

#include <optional>
#include <string>

#include "quadtune/simulation/flight.hpp"
#include "quadtune/tuning/mission_search.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"

namespace quadtune {

/// Flown loops with the sensors and the estimator of the first mission.
struct FlownEvidence {
  std::optional<FlownLoop>
      before,       ///< with the initial gains; none without a controller or a flown plant
      after,        ///< with the tuned gains, likewise
      rival;        ///< with the rival's gains, likewise
  std::string why;  ///< why there is no flown plant, or empty
};

/// @param first   plan of the first mission; its controller is replaced
/// @param before  initial gains
/// @param after   tuned gains
/// @param rival   gains that the result is compared with
[[nodiscard]] FlownEvidence flown_evidence(const PlannedFlight& first,
                                           const std::optional<Controller>& before,
                                           const std::optional<Controller>& after,
                                           const std::optional<Controller>& rival);

/// Rejects the result of the search if its flown loop is unstable: the start is kept, and the
/// reason names the growing mode.
void reject_unstable(const FlownEvidence& evidence, const Eigen::VectorXd& start,
                     MissionSearchResult& result);

}  // namespace quadtune
