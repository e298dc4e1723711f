// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/vehicle/new_vehicle.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <random>

#include "quadtune/errors.hpp"
#include "quadtune/workbench/vehicle/quantity.hpp"
#include "quadtune/workbench/vehicle/vehicle_check.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

/// The vehicle of 1.4 kg and 450 mm, as a scale and a ruler measure it.
MeasuredVehicle measured_quad() {
  MeasuredVehicle measured;
  measured.name = "own";
  measured.mass = 1.4;
  measured.arm = 0.225;
  measured.propeller = 2 * 0.1194;
  return measured;
}

double ratio(double value, double reference) { return value / reference; }

TEST(Quantity, ReadsUnits) {
  EXPECT_DOUBLE_EQ(read_quantity("1240g", QuantityUnit::mass, "mass"), 1.24);
  EXPECT_DOUBLE_EQ(read_quantity("1.24 kg", QuantityUnit::mass, "mass"), 1.24);
  EXPECT_DOUBLE_EQ(read_quantity("16oz", QuantityUnit::mass, "mass"), 0.45359237);
  EXPECT_DOUBLE_EQ(read_quantity("225mm", QuantityUnit::length, "arm"), 0.225);
  EXPECT_DOUBLE_EQ(read_quantity("10in", QuantityUnit::length, "arm"), 0.254);
  EXPECT_DOUBLE_EQ(read_quantity("1kgf", QuantityUnit::force, "max-thrust"), 9.80665);
  EXPECT_DOUBLE_EQ(read_quantity("60rpm", QuantityUnit::rotor_speed, "max-speed"),
                   2 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(read_quantity("1e2 rad/s", QuantityUnit::rotor_speed, "max-speed"), 100);
  EXPECT_DOUBLE_EQ(read_quantity("40ms", QuantityUnit::duration, "lag"), 0.04);
  for (const char* inertia : {"0.011kgm2", "11 g m^2", "110000 g cm²", "11000000gmm2"})
    EXPECT_NEAR(read_quantity(inertia, QuantityUnit::inertia, "inertia"), 0.011, 1e-15) << inertia;
}

// A number without a unit may be kilograms or pounds.
TEST(Quantity, RefusesWhatHasNoUnit) {
  for (const char* text : {"1.24", "", "g", "-1g", "0g", "nan g", "1.2.3g", "1,24kg", "1240mg"})
    EXPECT_THAT([&] { (void)read_quantity(text, QuantityUnit::mass, "mass"); },
                ThrowsMessage<OptionError>(
                    HasSubstr("', expected a number greater than 0 with a unit: g, kg, oz or lb")))
        << text;
}

// Closed forms: a sphere of 0.71 m and of the radius 0.28 L, and four points of 0.29 m/4 at L.
TEST(NewVehicle, InertiaIsThatOfASphereAndPoints) {
  const Eigen::Matrix3d J = new_vehicle(measured_quad()).vehicle.inertia;
  const double m = 1.4, L = 0.225;
  const double sphere = 0.4 * 0.71 * m * std::pow(0.28 * L, 2);
  EXPECT_NEAR(J(0, 0), sphere + 0.29 * m * L * L / 2, 1e-6);
  EXPECT_NEAR(J(1, 1), J(0, 0), 1e-9);
  EXPECT_NEAR(J(2, 2), sphere + 0.29 * m * L * L, 1e-6);
}

// The built-in vehicles that were derived from parts, part by part, are within the spreads.
TEST(NewVehicle, IsWithinItsSpreadsOfTheBuiltInVehicles) {
  for (const char* name : {"racer-250", "quad-450", "hexa-550"}) {
    SCOPED_TRACE(name);
    const Vehicle known = load_vehicle(testing::source_folder() + "/vehicles/" + name + ".toml");
    MeasuredVehicle measured;
    measured.name = "own";
    measured.mass = known.mass;
    measured.arm = known.rotors.front().position.norm();
    measured.propeller = 2 * known.rotors.front().radius;
    measured.rotors = static_cast<int>(known.rotors.size());
    const NewVehicle made = new_vehicle(measured);
    const Rotor& rotor = made.vehicle.rotors.front();
    const Rotor& truth = known.rotors.front();
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(ratio(known.inertia(i, i), made.vehicle.inertia(i, i)), 1, made.spread.inertia);
    EXPECT_NEAR(ratio(truth.thrust_a2, rotor.thrust_a2), 1, made.spread.thrust);
    EXPECT_NEAR(ratio(truth.lag, rotor.lag), 1, made.spread.motor_lag);
    // A racing vehicle has far more thrust than the estimate; none has much less.
    EXPECT_GT(ratio(known.motor.max, made.vehicle.motor.max), 0.8);
    EXPECT_NEAR(ratio(truth.drag, rotor.drag), 1, 0.25);
    EXPECT_NEAR(ratio(truth.inflow, rotor.inflow), 1, 0.25);
    for (std::size_t i = 0; i < known.rotors.size(); ++i) {
      EXPECT_NEAR((made.vehicle.rotors[i].position - known.rotors[i].position).norm(), 0, 1e-5);
      EXPECT_EQ(made.vehicle.rotors[i].spin, known.rotors[i].spin);
    }
  }
}

// In hover each rotor carries its share, whatever was measured of thrust and speed.
TEST(NewVehicle, TakesWhatWasMeasured) {
  const double share = 1.4 * 9.81 / 4;
  MeasuredVehicle measured = measured_quad();
  measured.hover_speed = 540;
  measured.thrust_to_weight = 2.5;
  NewVehicle made = new_vehicle(measured);
  EXPECT_NEAR(made.vehicle.rotors[0].thrust_a2 * 540 * 540, share, 1e-4 * share);
  EXPECT_NEAR(made.vehicle.motor.max, 540 * std::sqrt(2.5), 0.05);
  EXPECT_LT(made.spread.thrust, 0.1);
  EXPECT_EQ(made.estimates.size(), 2U);  // inertia and lag

  measured = measured_quad();
  measured.max_speed = 900;
  measured.max_thrust = 8;
  measured.motor_lag = 0.03;
  measured.inertia = Eigen::Vector3d(0.01, 0.012, 0.02);
  made = new_vehicle(measured);
  EXPECT_NEAR(made.vehicle.rotors[0].thrust_a2 * 900 * 900, 8, 1e-3);
  EXPECT_EQ(made.vehicle.motor.max, 900);
  EXPECT_EQ(made.vehicle.rotors[0].lag, 0.03);
  EXPECT_EQ(made.vehicle.inertia(1, 1), 0.012);
  EXPECT_THAT(made.estimates, IsEmpty());
  EXPECT_EQ(spread_of(made.vehicle), made.spread);
}

TEST(NewVehicle, PlacesRotorsClockwiseWithAlternateSpins) {
  MeasuredVehicle measured = measured_quad();
  measured.layout = FrameLayout::plus;
  measured.first_spin = Spin::counter_clockwise;
  const std::vector<Rotor> rotors = new_vehicle(measured).vehicle.rotors;
  EXPECT_NEAR((rotors[0].position - Eigen::Vector3d(0.225, 0, 0)).norm(), 0, 1e-9);   // front
  EXPECT_NEAR((rotors[1].position - Eigen::Vector3d(0, 0.225, 0)).norm(), 0, 1e-9);   // right
  EXPECT_NEAR((rotors[2].position - Eigen::Vector3d(-0.225, 0, 0)).norm(), 0, 1e-9);  // back
  EXPECT_EQ(rotors[0].spin, Spin::counter_clockwise);
  EXPECT_EQ(rotors[1].spin, Spin::clockwise);
  measured.rotors = 8;
  measured.propeller = 0.15;
  measured.layout = FrameLayout::x;
  const std::vector<Rotor> eight = new_vehicle(measured).vehicle.rotors;
  EXPECT_GT(eight[0].position.x(), 0);
  EXPECT_LT(eight[0].position.y(), 0);
}

// Any vehicle that can be measured hovers, has authority, and no implausible figure.
TEST(NewVehicle, HoversWhateverItsSize) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  const testing::TemporaryDirectory folder;
  for (int trial = 0; trial < 60; ++trial) {
    MeasuredVehicle measured;
    measured.name = "own";
    measured.rotors = 4 + 2 * (trial % 3);
    measured.arm = 0.04 * std::pow(20, uniform(random));
    measured.mass = (150 + 200 * uniform(random)) * std::pow(measured.arm, 3);
    measured.propeller = (0.7 + 0.28 * uniform(random)) * 2 * measured.arm *
                         std::sin(std::numbers::pi / measured.rotors);
    measured.blades = 2 + trial % 2;
    measured.layout = trial % 2 == 0 ? FrameLayout::x : FrameLayout::plus;
    measured.brushed = measured.arm < 0.07;
    measured.sensors = trial % 5 == 0 ? SensorSet::flow : SensorSet::gps;
    const NewVehicle made = new_vehicle(measured);
    const VehicleCheck check = check_vehicle(folder.write("own.toml", made.text).string());
    EXPECT_THAT(check.warnings, IsEmpty())
        << made.text << "\n"
        << (check.warnings.empty() ? "" : to_string(check.warnings.front()));
    EXPECT_FALSE(std::isnan(check.vehicle.rotors.front().drag));
  }
}

TEST(NewVehicle, RefusesWhatContradicts) {
  const auto refused = [](const auto& change, const char* words) {
    MeasuredVehicle measured = measured_quad();
    change(measured);
    EXPECT_THAT([&] { (void)new_vehicle(measured); }, ThrowsMessage<OptionError>(HasSubstr(words)));
  };
  using M = MeasuredVehicle;
  refused([](M& m) { m.mass = 1400; }, "mass is 1400 kg, expected more than 0 and at most 200 kg");
  refused([](M& m) { m.mass = std::numeric_limits<double>::quiet_NaN(); }, "mass is nan kg");
  refused([](M& m) { m.arm = 0.11; },
          "expected at most 0.1556 m, the distance between neighbouring rotors with --arm 0.11 m");
  refused([](M& m) { m.propeller = 0.01; },
          "propeller is 0.01 m in diameter: to carry 1.4 kg, 4 of them would turn at ");
  refused([](M& m) { m.rotors = 5; }, "rotors is 5, expected 4, 6 or 8");
  refused([](M& m) { m.max_thrust = 3; },
          "expected more than 3.433 N, one rotor's share of the weight of 1.4 kg");
  refused([](M& m) { m.thrust_to_weight = 0.9; }, "thrust-to-weight is 0.9");
  refused([](M& m) { m.motor_lag = 2; }, "lag is 2 s");
  refused(
      [](M& m) {
        m.max_thrust = 8;
        m.thrust_to_weight = 2;
      },
      "thrust-to-weight and --max-thrust are both given");
  refused(
      [](M& m) {
        m.max_thrust = 8;
        m.max_speed = 900;
        m.hover_speed = 500;
      },
      "hover-speed, --max-speed and one of --max-thrust and --thrust-to-weight are all given, "
      "expected two");
  refused(
      [](M& m) {
        m.max_speed = 400;
        m.hover_speed = 500;
      },
      "max-speed is 400 rad/s, expected more than the 500 rad/s of --hover-speed");
  // Faster than sound at the tips, by the speed that was measured.
  refused([](M& m) { m.hover_speed = 5000; },
          "hover-speed is 5000 rad/s: propellers of 0.2388 m in diameter would turn with tips at "
          "597 m/s, expected less than 340 m/s");
  refused(
      [](M& m) {
        m.max_thrust = 8;
        m.max_speed = 9000;
      },
      "max-speed is 9000 rad/s: with --max-thrust, propellers of ");
}

}  // namespace
}  // namespace quadtune
