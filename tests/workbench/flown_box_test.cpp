// SPDX-License-Identifier: Apache-2.0
/// The flown loop for vehicles of a box.
#include "quadtune/workbench/flown/flown_box.hpp"

#include <gmock/gmock.h>

#include "quadtune/errors.hpp"
#include "quadtune/tuning/uncertain_vehicle.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/flown/flown_gains.hpp"

namespace quadtune {
namespace {

struct Flown {
  Vehicle vehicle = load_vehicle("crazyflie");
  CascadeController law{as_cascade(flown_gains(vehicle), 0.005)};
  PlannedFlight plan =
      plan_flight(FlightOptions{}, vehicle, load_mission("hover"), ChosenLaw{law, "test"});

  [[nodiscard]] LoopFamily family(const VehicleUncertainty& uncertainty) const {
    return uncertain_hover(vehicle, law.gains, law.method, uncertainty);
  }
};

/// The vehicle is unstable in a tilt loop, so that its pole depends on every parameter.
TEST(FlownBox, IsTheFlownLoopOfTheVehicle) {
  const Flown flown;
  VehicleUncertainty one;
  one.lag = {0.072, 0.072};
  FlownBoxOptions options;
  options.also.resize(7);
  options.also << 1.2, 1.1, 1.05, 1.2, 0.95, 0.09, 0.08;
  const FlownBox box = flown_box(flown.plan, flown.family(one), options);
  ASSERT_TRUE(box.worst) << box.why;
  EXPECT_EQ(box.vehicles, 2);
  EXPECT_EQ(box.parameters, options.also);
  PlannedFlight plan = flown.plan;
  plan.setup.flown = flown.vehicle;
  Vehicle& vehicle = *plan.setup.flown;
  vehicle.mass *= 1.2;
  vehicle.inertia.diagonal().array() *= Eigen::Array3d(1.1, 1.05, 1.2);
  for (Rotor& rotor : vehicle.rotors) {
    rotor.thrust_a2 *= 0.95;
    rotor.torque_d2 *= 0.95;
    rotor.lag = rotor.lag_down = 0.09;
  }
  vehicle.motor.delay = 0.08;
  const FlownLoop alone = flown_loop(plan);
  EXPECT_TRUE(alone.grows());
  EXPECT_NEAR(std::abs(box.worst->mode.z), std::abs(alone.mode.z), 1e-12);
}

TEST(FlownBox, FindsTheCornerThatIsUnstable) {
  const Flown flown;
  VehicleUncertainty uncertainty;
  uncertainty.lag = {0.072, 0.072};
  uncertainty.delay = {0, 0.1};
  const FlownBox box = flown_box(flown.plan, flown.family(uncertainty));
  ASSERT_TRUE(box.worst) << box.why;
  EXPECT_EQ(box.vehicles, 2);
  EXPECT_TRUE(box.worst->grows());
  EXPECT_EQ(box.parameters(6), 0.1);
  // One thread or more: the same result.
  FlownBoxOptions one;
  one.threads = 1;
  EXPECT_EQ(flown_box(flown.plan, flown.family(uncertainty), one).worst->mode.z, box.worst->mode.z);
}

TEST(FlownBox, SaysWhyAVehicleHasNoFlownPlant) {
  const Flown flown;
  VehicleUncertainty uncertainty;
  uncertainty.mass = {1, 3};  // more than the motors can lift
  const FlownBox box = flown_box(flown.plan, flown.family(uncertainty));
  EXPECT_FALSE(box.worst);
  EXPECT_THAT(box.why, ::testing::HasSubstr("hover"));
}

TEST(FlownBoxBadInput, OtherParameters) {
  const Flown flown;
  LoopFamily family = flown.family({});
  family.parameters.pop_back();
  EXPECT_THROW((void)flown_box(flown.plan, family), InvalidInput);
}

}  // namespace
}  // namespace quadtune
