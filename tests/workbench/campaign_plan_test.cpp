// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/campaign/campaign_plan.hpp"

#include <gmock/gmock.h>

#include "quadtune/errors.hpp"
#include "quadtune/workbench/campaign/campaign_folder.hpp"
#include "same_flight.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr char kCampaign[] = R"(
name = "both"
vehicle = "mambo"
flights = 3
seed = 4
[[design]]
name = "designed"
[[design]]
name = "feedback"
controller = "state-feedback"
[[design]]
name = "lead"
gains = "lead.toml"
[[mission]]
mission = "take-off-and-land"
take_off = "thrust"
duration_s = 2
[[mission]]
mission = "step-north"
estimator = "mambo"
wind = "light"
duration_s = 1
[[vary]]
quantity = "mass"
uniform = { low = 0.9, high = 1.1 }
)";

constexpr char kLead[] = R"(
name = "lead"
vehicle = "mambo"
[trim]
at = "hover"
[cascade]
dt_s = 0.005
x = { Kp = -0.08, Ki = -0.004, Kd = 0.16 }
y = { Kp = 0.08, Ki = 0.004, Kd = -0.16 }
pitch = { Kp = 0.0043, Kd = -8.6e-4, rate_lead_s = 0.01, rate_filter_s = 0.004 }
roll = { Kp = 0.0035, Kd = -7e-4, rate_lead_s = 0.008, rate_filter_s = 0.004 }
yaw = { Kp = 4e-4, Kd = -4e-4 }
altitude = { Kp = 0.38, Ki = 0.09, Kd = -0.25 }
)";

// The plan that was created and the plan that a worker loads give bit-identical flights: a plan
// contains the flights themselves.
TEST(CampaignPlan, IsReadBackAsItWasMade) {
  const testing::TemporaryDirectory directory;
  directory.write("lead.toml", kLead);
  const MadeCampaign made = make_campaign(directory.write("c.toml", kCampaign), 2);
  const std::string folder = (directory.path() / "out").string();
  EXPECT_FALSE(write_campaign(made, folder));
  EXPECT_TRUE(write_campaign(made, folder));  // the same plan was there already
  const CampaignPlan read = load_plan(folder);
  EXPECT_EQ(read.hash, made.plan.hash);
  EXPECT_EQ(read.shards, 2U);
  ASSERT_EQ(read.campaign.records(), 18U);
  for (std::uint64_t i = 0; i < read.campaign.records(); ++i) {
    const FlightSetup setup = setup_of(read.campaign, i);
    const FlightSetup expected = setup_of(made.plan.campaign, i);
    EXPECT_EQ(setup.mission, expected.mission) << i;
    EXPECT_EQ(setup.mambo_estimator, expected.mambo_estimator) << i;
    EXPECT_EQ(setup.uquad_filter, expected.uquad_filter) << i;
    EXPECT_EQ(setup.general_filter, expected.general_filter) << i;
    EXPECT_STREQ(testing::first_difference(fly(setup), fly(expected)), "") << i;
  }
  for (std::size_t i = 0; i < read.words.size(); ++i) {
    EXPECT_EQ(read.words[i].law, made.plan.words[i].law);
    EXPECT_EQ(read.words[i].notes, made.plan.words[i].notes);
    EXPECT_EQ(read.words[i].widened.size(), made.plan.words[i].widened.size());
  }
}

TEST(CampaignPlan, AnotherPlanInTheFolderIsRefused) {
  const testing::TemporaryDirectory directory;
  const std::string folder = (directory.path() / "out").string();
  directory.write("lead.toml", kLead);
  write_campaign(make_campaign(directory.write("c.toml", kCampaign), 2), folder);
  EXPECT_THAT([&] { write_campaign(make_campaign(directory.path() / "c.toml", 3), folder); },
              ThrowsMessage<InvalidInput>(HasSubstr("its number of shards is 2 and not 3")));
  EXPECT_THAT(
      [&] { (void)make_campaign(directory.path() / "c.toml", 4); },
      ThrowsMessage<OptionError>(
          "shards is 4, expected at most 3, the number of draws in the campaign file (flights)"));
}

}  // namespace
}  // namespace quadtune
