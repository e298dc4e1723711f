// SPDX-License-Identifier: Apache-2.0
#include "quadtune/model/battery.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "quadtune/simulation/pack.hpp"

namespace quadtune {
namespace {

Battery three_cells() {
  Battery battery;
  battery.capacity = 1.5 * 3600;
  battery.full_voltage = 12.6;
  battery.empty_voltage = 9.6;
  battery.resistance = 0.05;
  battery.efficiency = 0.6;
  battery.idle_power = 3;
  battery.rated_voltage = 12;
  return battery;
}

TEST(Battery, CurrentAndVoltageGiveThePower) {
  const Battery battery = three_cells();
  for (const double shaft : {0.0, 10.0, 100.0, 200.0})
    for (const double charge : {0.0, 1000.0, 5400.0, 9000.0}) {
      BatteryState<double> state = full_battery<double>(battery);
      state.charge = charge;
      step(battery, state, shaft, 0.01);
      EXPECT_NEAR(state.voltage * state.current, shaft / 0.6 + 3, 1e-10);
      const double open = 12.6 - 3 * std::min(1.0, charge / 5400);
      EXPECT_NEAR(state.voltage, open - 0.05 * state.current, 1e-12);
      EXPECT_GE(state.voltage, open / 2);  // the smaller current of the two
      EXPECT_NEAR(state.charge, charge + 0.01 * state.current, 1e-12);
    }
}

TEST(Battery, FullAndWithoutLoadHasItsVoltage) {
  const BatteryState<double> state = full_battery<double>(three_cells());
  EXPECT_EQ(state.voltage, 12.6);
  EXPECT_EQ(state.current, 0);
  EXPECT_EQ(state.charge, 0);
  EXPECT_DOUBLE_EQ(voltage_ratio(three_cells(), state), 1.05);
}

// Above V₀²/4R the current is that of the maximum power.
TEST(Battery, GivesNoMorePowerThanItCan) {
  const Battery battery = three_cells();
  BatteryState<double> state = full_battery<double>(battery);
  step(battery, state, 1e5, 0.01);
  EXPECT_DOUBLE_EQ(state.voltage, 6.3);
  EXPECT_DOUBLE_EQ(state.current, 126);
  Battery ideal = battery;
  ideal.resistance = 0;
  state = full_battery<double>(ideal);
  step(ideal, state, 1e5, 0.01);
  EXPECT_DOUBLE_EQ(state.voltage, 12.6);
  EXPECT_DOUBLE_EQ(state.current, (1e5 / 0.6 + 3) / 12.6);
}

// The cells supply the power of the motors and the loss in the resistance.
TEST(Battery, BalancesItsEnergy) {
  const Battery battery = three_cells();
  BatteryState<double> state = full_battery<double>(battery);
  double drawn = 0, heat = 0;
  const double dt = 0.01;
  int steps = 0;
  for (; state.charge < battery.capacity; ++steps) {
    const double shaft = 40 + 20 * std::sin(0.01 * steps);
    step(battery, state, shaft, dt);
    drawn += (shaft / 0.6 + 3) * dt;
    heat += 0.05 * state.current * state.current * dt;
  }
  // ∫ V₀ dq over a line from full to empty.
  EXPECT_NEAR(drawn + heat, 5400 * (12.6 + 9.6) / 2, 5);
}

TEST(Battery, EachLaneIsABatteryAlone) {
  const Battery battery = three_cells();
  BatteryState<Pack<4>> together = full_battery<Pack<4>>(battery);
  std::array<BatteryState<double>, 4> alone;
  alone.fill(full_battery<double>(battery));
  for (int k = 0; k < 100; ++k) {
    Pack<4> power = 0;
    for (int l = 0; l < 4; ++l) {
      set_lane(power, l, 10.0 * l * l * l * l + k);
      step(battery, alone[static_cast<std::size_t>(l)], 10.0 * l * l * l * l + k, 1.0);
    }
    step(battery, together, power, 1.0);
    for (int l = 0; l < 4; ++l) {
      ASSERT_EQ(lane(together.charge, l), alone[static_cast<std::size_t>(l)].charge);
      ASSERT_EQ(lane(together.voltage, l), alone[static_cast<std::size_t>(l)].voltage);
    }
  }
}

}  // namespace
}  // namespace quadtune
