// SPDX-License-Identifier: Apache-2.0
#include "quadtune/model/vehicle_spread.hpp"

#include <gmock/gmock.h>

#include "quadtune/errors.hpp"
#include "quadtune/simulation/campaign/spread_uncertainty.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Vehicle with_spread(const std::string& lines, const std::string& vehicle = "crazyflie") {
  return parse_vehicle(load_vehicle(vehicle).text + "\n[spread]\n" + lines, "v.toml");
}

TEST(VehicleSpread, IsReadFromTheFile) {
  EXPECT_FALSE(spread_of(load_vehicle("crazyflie")).stated());
  EXPECT_EQ(spread_of(Vehicle{}), VehicleSpread{});
  const VehicleSpread spread = spread_of(with_spread("inertia = 0.3\nmotor_lag = 0.4\n"));
  EXPECT_EQ(spread, (VehicleSpread{0, 0.3, 0, 0.4}));
  EXPECT_TRUE(spread.stated());
  for (const char* line :
       {"mass = 0.1\n", "inertia = 0.1\n", "thrust = 0.1\n", "motor_lag = 0.1\n"})
    EXPECT_TRUE(spread_of(with_spread(line)).stated()) << line;
}

TEST(VehicleSpread, RefusesSharesOutOfRange) {
  for (const char* line : {"mass = 0.95\n", "mass = -0.1\n", "mass = nan\n", "mass = \"2 %\"\n"})
    EXPECT_THAT([&] { (void)with_spread(line); }, ThrowsMessage<InvalidInput>(HasSubstr("mass")))
        << line;
  EXPECT_THAT([&] { (void)with_spread("lag = 0.1\n"); },
              ThrowsMessage<InvalidInput>(HasSubstr("lag")));
}

// 95 of 100 draws of a normal number are within two standard deviations.
TEST(VehicleSpread, AddsWhatACampaignDoesNotVary) {
  const Vehicle vehicle =
      with_spread("mass = 0.02\ninertia = 0.3\nthrust = 0.2\nmotor_lag = 0.4\n");
  Uncertainty uncertainty;
  uncertainty.numbers = {{"mass", {DistributionKind::uniform, 0.9, 1.1}},
                         {"inertia_y", {DistributionKind::uniform, 0.9, 1.1}}};
  uncertainty.correlation = Eigen::Matrix2d{{1, 0.5}, {0.5, 1}};
  add_spread(vehicle, uncertainty);
  ASSERT_NO_THROW(validate(uncertainty, "test"));
  ASSERT_EQ(uncertainty.numbers.size(), 6U);
  EXPECT_EQ(uncertainty.numbers[0].distribution.kind, DistributionKind::uniform);
  EXPECT_EQ(uncertainty.numbers[2].quantity, "inertia_x");
  EXPECT_EQ(uncertainty.numbers[3].quantity, "inertia_z");
  EXPECT_EQ(uncertainty.numbers[4].quantity, "thrust");
  EXPECT_EQ(uncertainty.numbers[5].quantity, "motor_lag");
  const Distribution& thrust = uncertainty.numbers[4].distribution;
  EXPECT_EQ(thrust.first, 1);
  EXPECT_EQ(thrust.second, 0.1);
  EXPECT_DOUBLE_EQ(thrust.min, 0.7);
  EXPECT_DOUBLE_EQ(thrust.max, 1.3);
  EXPECT_EQ(uncertainty.correlation(0, 1), 0.5);
  EXPECT_EQ(uncertainty.correlation.rows(), 6);
  EXPECT_EQ(uncertainty.correlation(5, 5), 1);
  EXPECT_EQ(uncertainty.correlation(5, 0), 0);
}

TEST(VehicleSpread, AddsNoLagWhereThereIsNone) {
  Uncertainty uncertainty;
  add_spread(with_spread("motor_lag = 0.4\n", "uquad"), uncertainty);
  EXPECT_TRUE(uncertainty.numbers.empty());
  add_spread(load_vehicle("crazyflie"), uncertainty);
  EXPECT_TRUE(uncertainty.numbers.empty());
}

}  // namespace
}  // namespace quadtune
