// SPDX-License-Identifier: Apache-2.0
#include "quadtune/model/atmosphere.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using ::testing::StrEq;
using ::testing::ThrowsMessage;

// ISO 2533:1975, table 1: geopotential height, T [K], p [Pa], density [kg/m³], sound [m/s].
TEST(StandardAtmosphere, IsThePublishedTable) {
  struct Row {
    double height, temperature, pressure, density, sound;
  };
  for (const Row& row :
       {Row{-2000, 301.15, 127774, 1.47808, 347.886}, Row{0, 288.15, 101325, 1.225, 340.294},
        Row{1000, 281.65, 89874.6, 1.11164, 336.434}, Row{5000, 255.65, 54019.9, 0.736116, 320.529},
        Row{11000, 216.65, 22632.06, 0.363918, 295.069},
        Row{15000, 216.65, 12044.6, 0.193674, 295.069},
        Row{20000, 216.65, 5474.88, 0.0880349, 295.069}}) {
    const Air air = standard_atmosphere(row.height);
    EXPECT_NEAR(air.temperature, row.temperature, 1e-9) << row.height;
    EXPECT_NEAR(air.pressure / row.pressure, 1, 6e-6) << row.height;
    EXPECT_NEAR(air.density / row.density, 1, 6e-6) << row.height;
    EXPECT_NEAR(air.speed_of_sound / row.sound, 1, 6e-6) << row.height;
  }
}

TEST(StandardAtmosphere, IsContinuousAtTheTropopause) {
  EXPECT_NEAR(standard_atmosphere(11000).pressure, standard_atmosphere(11000 + 1e-6).pressure,
              1e-5);
}

TEST(StandardAtmosphere, RefusesWhereItDoesNotHold) {
  EXPECT_THAT([] { (void)standard_atmosphere(20001); },
              ThrowsMessage<InvalidInput>(StrEq("standard_atmosphere: height is 20001 m, expected "
                                                "-2000 to 20000 m, where this model holds")));
  EXPECT_THROW((void)standard_atmosphere(-2001), InvalidInput);
  EXPECT_THROW((void)standard_atmosphere(std::numeric_limits<double>::quiet_NaN()), InvalidInput);
}

TEST(StillAir, IsTheSameEverywhereAndKeepsItsDensity) {
  const Atmosphere atmosphere{.air = air_of_density(1.184)};
  EXPECT_EQ(atmosphere.at(0).density, atmosphere.at(5000).density);
  EXPECT_NEAR(atmosphere.at(0).density, 1.184, 1e-15);
  EXPECT_THROW((void)air_of_density(0), InvalidInput);
}

TEST(StandardAtmosphere, CountsFromTheGround) {
  const Atmosphere atmosphere{.model = AtmosphereModel::standard, .air = {}, .ground_height = 600};
  EXPECT_EQ(atmosphere.at(400).density, standard_atmosphere(1000).density);
}

}  // namespace
}  // namespace quadtune
