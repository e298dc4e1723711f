// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/missions/flown_evidence.hpp"

#include "quadtune/errors.hpp"

namespace quadtune {

FlownEvidence flown_evidence(const PlannedFlight& first, const std::optional<Controller>& before,
                             const std::optional<Controller>& after,
                             const std::optional<Controller>& rival) {
  FlownEvidence evidence;
  const auto loop_of = [&](const Controller& controller) {
    PlannedFlight plan = first;
    plan.setup.controller = controller;
    return flown_loop(plan);
  };
  try {
    if (before) evidence.before = loop_of(*before);
    if (after) evidence.after = loop_of(*after);
    if (rival) evidence.rival = loop_of(*rival);
  } catch (const InvalidInput& error) {
    evidence = {};
    evidence.why = error.what();
  }
  return evidence;
}

void reject_unstable(const FlownEvidence& evidence, const Eigen::VectorXd& start,
                     MissionSearchResult& result) {
  if (!result.accepted || !evidence.after || !evidence.after->grows()) return;
  result.accepted = false;
  result.best = start;
  result.reason = "the flown loop of the result is unstable: " + describe(*evidence.after);
}

}  // namespace quadtune
