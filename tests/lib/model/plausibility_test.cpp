// SPDX-License-Identifier: Apache-2.0
#include "quadtune/model/plausibility.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "quadtune/model/mixer.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
constexpr double kRpm = 2 * std::numbers::pi / 60;

TEST(Plausibility, FindsNothingInTheBuiltInVehicles) {
  ASSERT_FALSE(built_in_vehicles().empty());
  for (const std::string& name : built_in_vehicles())
    for (const Implausibility& figure : find_implausible_values(load_vehicle(name)))
      ADD_FAILURE() << name << ": " << to_string(figure);
}

void scale(Vehicle& vehicle, double Rotor::*member, double factor) {
  for (Rotor& rotor : vehicle.rotors) rotor.*member *= factor;
}

struct Mistake {
  std::string cause;
  std::function<void(Vehicle&)> make;
};

// Each mistake is detected in each vehicle in which it is possible, with its cause.
TEST(Plausibility, DetectsWrongUnits) {
  const std::vector<Mistake> mistakes = {
      {"g cm2", [](Vehicle& v) { v.inertia *= 1e7; }},
      {"kg cm2", [](Vehicle& v) { v.inertia *= 1e4; }},
      {"g mm2", [](Vehicle& v) { v.inertia *= 1e9; }},
      {"power of ten", [](Vehicle& v) { v.inertia *= 1e-3; }},
      {"mass_kg seems to be in g", [](Vehicle& v) { v.mass *= 1000; }},
      {"mm",
       [](Vehicle& v) {
         for (Rotor& r : v.rotors) r.position *= 1000;
       }},
      {"cm",
       [](Vehicle& v) {
         for (Rotor& r : v.rotors) r.position *= 100;
       }},
      {"inches",
       [](Vehicle& v) {
         for (Rotor& r : v.rotors) r.position *= 39.37;
       }},
      {"drag torque over thrust",
       [](Vehicle& v) {
         scale(v, &Rotor::torque_d2, 1e5);
         scale(v, &Rotor::torque_d1, 1e5);
       }},
      {"drag torque over thrust",
       [](Vehicle& v) {
         scale(v, &Rotor::torque_d2, 1e-5);
         scale(v, &Rotor::torque_d1, 1e-5);
       }},
      {"N mm",
       [](Vehicle& v) {
         scale(v, &Rotor::torque_d2, 1000);
         scale(v, &Rotor::torque_d1, 1000);
       }},
      {"in mN",
       [](Vehicle& v) {
         scale(v, &Rotor::thrust_a2, 1000);
         scale(v, &Rotor::thrust_a1, 1000);
       }},
      {"ms",
       [](Vehicle& v) {
         for (Rotor& r : v.rotors) r.lag = 72;
       }},
      {"cm/s2", [](Vehicle& v) { v.gravity *= 100; }},
      {"g/m3", [](Vehicle& v) { v.air_density *= 1000; }},
      {"mA h",
       [](Vehicle& v) {
         v.battery = Battery{600 * 3600.0, 4.2, 3.2};
       }},
      {"the order of inertia_kg_m2", [](Vehicle& v) { v.inertia(2, 2) *= 0.25; }},
      {"altitude_thrust_fraction is too small",
       [](Vehicle& v) { v.altitude_thrust_fraction = 0.3; }},
      {"takeoff_gain may be in percent", [](Vehicle& v) { v.takeoff_gain = 20; }},
      {"attitude control requires", [](Vehicle& v) { v.sensors.gyroscope->rate = 5; }},
      {"noise seems to be in deg/s", [](Vehicle& v) { v.sensors.gyroscope->noise.setConstant(3); }},
  };
  for (const std::string& name : built_in_vehicles())
    for (const Mistake& mistake : mistakes) {
      Vehicle vehicle = load_vehicle(name);
      mistake.make(vehicle);
      std::string all;
      for (const Implausibility& figure : find_implausible_values(vehicle))
        all += to_string(figure) + "\n";
      EXPECT_THAT(all, HasSubstr(mistake.cause)) << name;
    }
}

TEST(Plausibility, FindsSpeedsInRpm) {
  for (const std::string& name : built_in_vehicles()) {
    Vehicle vehicle = load_vehicle(name);
    // The curves and the limits alike: the vehicle hovers at the same share of its maximum speed.
    scale(vehicle, &Rotor::thrust_a2, kRpm * kRpm);
    scale(vehicle, &Rotor::thrust_a1, kRpm);
    scale(vehicle, &Rotor::torque_d2, kRpm * kRpm);
    scale(vehicle, &Rotor::torque_d1, kRpm);
    vehicle.motor.gain /= vehicle.motor.law == CommandLaw::speed ? kRpm : kRpm * kRpm;
    const std::vector<Implausibility> found = find_implausible_values(vehicle);
    ASSERT_EQ(found.size(), 1) << name;
    EXPECT_THAT(found[0].quantity, HasSubstr("rotor speed at hover")) << name;
    EXPECT_THAT(found[0].cause, HasSubstr("rpm")) << name;
    // The limits alone.
    Vehicle limits = load_vehicle(name);
    limits.motor.gain /= limits.motor.law == CommandLaw::speed ? kRpm : kRpm * kRpm;
    ASSERT_EQ(find_implausible_values(limits).size(), 1) << name;
    EXPECT_THAT(find_implausible_values(limits)[0].quantity, HasSubstr("thrust-to-weight")) << name;
    EXPECT_GT(find_implausible_values(limits)[0].value, 100) << name;
  }
}

// With T = Ct rho n2 D4, Ct is π³/4 times that of T = Ct rho pi r4 w2: the thrust curve is so many
// times too large, and the speed at hover is too low by the square root.
TEST(Plausibility, DetectsTheOtherThrustCoefficient) {
  Vehicle vehicle = load_vehicle("mambo");
  ASSERT_FALSE(std::isnan(vehicle.rotors.front().radius));
  scale(vehicle, &Rotor::thrust_a2, std::pow(std::numbers::pi, 3) / 4);
  std::vector<std::string> causes;
  for (const Implausibility& figure : find_implausible_values(vehicle))
    if (figure.quantity.starts_with("rotor speed at hover")) causes.push_back(figure.cause);
  EXPECT_THAT(causes, ::testing::ElementsAre("Ct may be that of T = Ct rho n2 D4, expected that of "
                                             "T = Ct rho pi r4 w2"));
}

// A thrust curve from Ct is proportional to the fourth power of the radius.
TEST(Plausibility, FindsAWrongRadiusBehindTheThrustCurve) {
  const std::pair<double, std::string> wrong[] = {{2, "radius_m may be the diameter"},
                                                  {39.37, "radius_m seems to be in inches"},
                                                  {100, "radius_m seems to be in cm"},
                                                  {1000, "radius_m seems to be in mm"}};
  for (const auto& [factor, cause] : wrong) {
    Vehicle vehicle = load_vehicle("mambo");
    scale(vehicle, &Rotor::radius, factor);
    scale(vehicle, &Rotor::thrust_a2, std::pow(factor, 4));
    std::vector<std::string> causes;
    for (const Implausibility& figure : find_implausible_values(vehicle))
      if (figure.quantity.starts_with("thrust-to-weight")) causes.push_back(figure.cause);
    EXPECT_THAT(causes, ::testing::ElementsAre(cause));
  }
}

// Thrust is often measured for the whole vehicle.
TEST(Plausibility, ProposesThatTheThrustIsThatOfAllRotors) {
  Vehicle vehicle = load_vehicle("uquad");
  const double factor = 14 / thrust_to_weight(vehicle);  // 3.5 if it is divided by four
  scale(vehicle, &Rotor::thrust_a2, factor);
  scale(vehicle, &Rotor::thrust_a1, factor);
  scale(vehicle, &Rotor::torque_d2, factor);
  scale(vehicle, &Rotor::torque_d1, factor);
  const std::vector<Implausibility> found = find_implausible_values(vehicle);
  ASSERT_FALSE(found.empty());
  EXPECT_THAT(found[0].quantity, HasSubstr("thrust-to-weight"));
  EXPECT_EQ(found[0].cause, "the thrust of one rotor may be that of all rotors together");
}

// A value that is compared with a wrong one is not reported itself.
TEST(Plausibility, NamesTheWrongFigureAlone) {
  for (const std::string& name : built_in_vehicles()) {
    Vehicle heavy = load_vehicle(name), slow = load_vehicle(name);
    slow.inertia *= 1e7;
    ASSERT_EQ(find_implausible_values(slow).size(), 1) << name;
    EXPECT_THAT(find_implausible_values(slow)[0].quantity, HasSubstr("principal moment")) << name;
    heavy.mass *= 1000;
    for (const Implausibility& found : find_implausible_values(heavy))
      EXPECT_THAT(found.quantity, ::testing::Not(HasSubstr("battery"))) << name;
  }
}

// Rounding and plausible differences are not reported: a factor of 2 in any value.
TEST(Plausibility, LeavesRoomForOtherVehicles) {
  for (const char* name : {"mambo", "uquad", "crazyflie"})
    for (const double factor : {0.5, 2.0}) {
      Vehicle vehicle = load_vehicle(name);
      vehicle.inertia *= factor;
      scale(vehicle, &Rotor::inertia, factor);
      for (Rotor& rotor : vehicle.rotors) rotor.position *= std::sqrt(factor);
      EXPECT_TRUE(find_implausible_values(vehicle).empty())
          << name << factor << to_string(find_implausible_values(vehicle).front());
    }
}

// A sensor delay in milliseconds, and one that is too long for the analysis of a flown loop.
TEST(Plausibility, FindsADelayInMilliseconds) {
  Vehicle vehicle = load_vehicle("mambo");
  vehicle.sensors.gyroscope->delay = 5;
  vehicle.sensors.flow->faults.delay = 0.21;
  vehicle.motor.delay = 20;
  const std::vector<Implausibility> found = find_implausible_values(vehicle);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(to_string(found[0]),
            "delay of the gyroscope is 5 s, expected 1e-05 to 0.2 s: delay_s seems to be in ms");
  EXPECT_EQ(found[1].quantity, "delay of the optical flow");
  EXPECT_EQ(found[2].cause, "command_delay_s seems to be in ms");
}

// Rotor drag slows a crazyflie down by 0.22 v per second, inflow by 0.25 v in a climb. With a drag
// area of 10 cm2 its drag is its weight at 22 m/s.
TEST(Plausibility, FindsWrongUnitsOfDragInflowAndFlapping) {
  const Vehicle crazyflie = load_vehicle("crazyflie");
  const double w = rotor_speed_for_thrust(crazyflie.rotors[0], crazyflie.mass * 9.81 / 4);
  const auto found = [&](const std::function<void(Vehicle&)>& change) {
    Vehicle vehicle = crazyflie;
    change(vehicle);
    std::string all;
    for (const Implausibility& figure : find_implausible_values(vehicle))
      all += to_string(figure) + "\n";
    return all;
  };
  EXPECT_THAT(found([&](Vehicle& v) { scale(v, &Rotor::drag, w); }),
              HasSubstr("drag of the rotors at hover over mass is 391.5 1/s, expected 0.002 to 3 "
                        "1/s: drag_N_s2_per_rad_m may be that of a rotor at hover"));
  EXPECT_THAT(found([&](Vehicle& v) { scale(v, &Rotor::inflow, 1e-3); }),
              HasSubstr("inflow of the rotors at hover over mass"));
  const auto flapping = [&](double k) {
    return found([&](Vehicle& v) {
      for (Rotor& rotor : v.rotors) rotor.flapping = k;
    });
  };
  EXPECT_EQ(flapping(1e-9), "");  // an arm of 0.02 mm at 1 m/s
  EXPECT_THAT(flapping(1e-5), HasSubstr("flapping of a rotor at hover over its thrust"));
  EXPECT_EQ(found([](Vehicle& v) { v.drag.cda << 1e-3, 1e-3, 0; }), "");
  EXPECT_THAT(found([](Vehicle& v) { v.drag.cda << 10, 10, 20; }),
              HasSubstr("drag_area_m2 seems to be in cm2"));
  EXPECT_EQ(found([](Vehicle& v) { v.drag.linear.setConstant(0.01); }), "");
  EXPECT_THAT(found([](Vehicle& v) { v.drag.linear.setConstant(10); }),
              HasSubstr("drag_linear_N_s_per_m seems to be in mN s/m"));
  // Rotors that turn 50 times too fast are reported alone.
  const std::string fast = found([](Vehicle& v) {
    scale(v, &Rotor::thrust_a2, 1.0 / (50 * 50));
    scale(v, &Rotor::torque_d2, 1.0 / (50 * 50));
    v.motor.gain *= v.motor.law == CommandLaw::speed ? 50 : 50 * 50;
  });
  EXPECT_THAT(fast, HasSubstr("rotor speed at hover"));
  EXPECT_THAT(fast, ::testing::Not(HasSubstr("over mass")));
}

TEST(Plausibility, ReportsQuantityRangeAndCause) {
  EXPECT_EQ(to_string(Implausibility{"motor lag", "s", 72, 1e-3, 0.5, "lag_s seems to be in ms"}),
            "motor lag is 72 s, expected 0.001 to 0.5 s: lag_s seems to be in ms");
}

}  // namespace
}  // namespace quadtune
