// SPDX-License-Identifier: Apache-2.0
/// Tuned gains whose flown loop is unstable are rejected.
#include "quadtune/workbench/missions/flown_evidence.hpp"

#include <gmock/gmock.h>

#include "quadtune/workbench/design/chosen_law.hpp"

namespace quadtune::cli {
namespace {

/// The published cascade of the Mambo, its pitch and roll loops times `factor`.
CascadeController published(const Vehicle& vehicle, double factor) {
  CascadeController law{vehicle.published_cascade->gains};
  for (PidLoop& loop : law.gains.loops)
    if (loop.name == "pitch" || loop.name == "roll") {
      loop.Kp *= factor;
      loop.Ki *= factor;
      loop.Kd *= factor;
    }
  return law;
}

MissionSearchResult accepted() {
  MissionSearchResult result;
  result.accepted = true;
  result.reason = "it costs less";
  result.best = result.candidate = Eigen::VectorXd::Constant(1, 2);
  return result;
}

TEST(FlownEvidence, RejectsWhatIsUnstableAsItFlies) {
  const Vehicle vehicle = load_vehicle("mambo");
  const CascadeController start = published(vehicle, 1), found = published(vehicle, 10);
  const PlannedFlight plan =
      plan_flight(FlightOptions{}, vehicle, load_mission("hover"), ChosenLaw{start, "published"});
  const FlownEvidence unstable = flown_evidence(plan, start, found, std::nullopt);
  ASSERT_TRUE(unstable.before && unstable.after) << unstable.why;
  EXPECT_FALSE(unstable.before->grows());
  EXPECT_TRUE(unstable.after->grows());
  EXPECT_FALSE(unstable.rival);
  MissionSearchResult result = accepted();
  reject_unstable(unstable, Eigen::VectorXd::Zero(1), result);
  EXPECT_FALSE(result.accepted);
  EXPECT_EQ(result.best(0), 0);
  EXPECT_EQ(result.candidate(0), 2);
  EXPECT_THAT(result.reason, ::testing::ContainsRegex(
                                 "^the flown loop of the result is unstable: deviations double"));

  const FlownEvidence stable = flown_evidence(plan, found, start, std::nullopt);
  result = accepted();
  reject_unstable(stable, Eigen::VectorXd::Zero(1), result);
  EXPECT_TRUE(result.accepted);
  EXPECT_EQ(result.reason, "it costs less");
}

}  // namespace
}  // namespace quadtune::cli
