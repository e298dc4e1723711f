// SPDX-License-Identifier: Apache-2.0
// quadtune vehicle: implausible values of a file, and assumptions for absent ones.
#include "quadtune/model/vehicle.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "run_program.hpp"
#include "temporary_directory.hpp"

namespace quadtune::testing {
namespace {

using ::testing::HasSubstr;
using SortedJson = nlohmann::json;

std::string with_line(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

std::string crazyflie(const std::string& from, const std::string& to) {
  return with_line(load_vehicle("crazyflie").text, from, to);
}

TEST(VehicleCheck, WarnsInTextAndJson) {
  const TemporaryDirectory folder;
  const std::string file =
      folder
          .write("v.toml", crazyflie("[1.43e-5, 1.43e-5, 2.89e-5]", "[143, 143, 289]"))  // g cm2
          .string();
  const ProgramResult text = run_program({"vehicle", "check", file});
  EXPECT_EQ(text.status, 0) << text.err;
  EXPECT_THAT(
      text.out,
      HasSubstr("v.toml: warning: largest principal moment over mass times the "
                "square of the arm is 5.21e+06, expected 0.03 to 3: inertia_kg_m2 seems to be in g "
                "cm2"));
  const SortedJson json = SortedJson::parse(run_program({"vehicle", "check", file, "--json"}).out);
  ASSERT_EQ(json["warnings"].size(), 1);
  EXPECT_EQ(json["warnings"][0]["cause"], "inertia_kg_m2 seems to be in g cm2");
  EXPECT_EQ(json["warnings"][0]["plausible"], SortedJson({0.03, 3.0}));
  EXPECT_THAT(run_program({"vehicle", "show", file}).out, HasSubstr("warnings    largest"));
}

// The error of a vehicle that cannot hover contains the likely reason.
TEST(VehicleCheck, SaysWhyItMayNotHover) {
  const TemporaryDirectory folder;
  const std::string file =
      folder.write("v.toml", crazyflie("mass_kg = 0.030", "mass_kg = 30")).string();
  const ProgramResult result = run_program({"vehicle", "check", file});
  EXPECT_EQ(result.status, 4);
  EXPECT_THAT(result.err, HasSubstr("mass_kg seems to be in g"));
}

// One rotor speeds up faster: for the others, the lag of slowing down is that of both directions.
TEST(VehicleShow, TellsBothLags) {
  const TemporaryDirectory folder;
  const Vehicle vehicle = load_vehicle("crazyflie");
  std::string text = vehicle.text;
  const std::size_t first = text.find("[[rotors]]");
  ASSERT_NE(first, std::string::npos);
  text.insert(first + std::string("[[rotors]]").size(), "\nlag_up_s = 0.01");
  const ProgramResult shown =
      run_program({"vehicle", "show", folder.write("v.toml", text).string()});
  ASSERT_EQ(shown.status, 0) << shown.err;
  EXPECT_THAT(shown.out, HasSubstr("slowing down with lag "));
  EXPECT_THAT(shown.out, ::testing::Not(HasSubstr("nan")));
}

// The JSON contains the values of the file, under the same keys.
TEST(VehicleShow, JsonHasEveryKeyOfASensor) {
  const TemporaryDirectory folder;
  const std::string file = folder
                               .write("v.toml", load_vehicle("uquad").text + R"(
[sensors.vision]
rate_Hz = 30
bias_turn_on_m = 0.01
bias_walk_m_per_sqrt_s = [0.001, 0.002, 0.003]
correlated_noise_m = 0.05
correlation_s = 60

[sensors.flow]
rate_Hz = 60
half_field_x_rad = 0.3
half_field_y_rad = 0.4
greatest_height_m = 4
noise_per_height_rad_per_s_per_m = 0.02
)")
                               .string();
  const ProgramResult shown = run_program({"vehicle", "show", file, "--json"});
  ASSERT_EQ(shown.status, 0) << shown.err;
  const SortedJson sensors = SortedJson::parse(shown.out)["sensors"];
  EXPECT_EQ(sensors["vision"]["bias_turn_on_m"], SortedJson({0.01, 0.01, 0.01}));
  EXPECT_EQ(sensors["vision"]["bias_walk_m_per_sqrt_s"], SortedJson({0.001, 0.002, 0.003}));
  EXPECT_EQ(sensors["vision"]["correlated_noise_m"], SortedJson({0.05, 0.05, 0.05}));
  EXPECT_EQ(sensors["vision"]["correlation_s"], 60);
  EXPECT_EQ(sensors["flow"]["greatest_height_m"], 4);
  EXPECT_EQ(sensors["flow"]["noise_per_height_rad_per_s_per_m"], 0.02);
  EXPECT_THAT(run_program({"vehicle", "show", file}).out, HasSubstr("and below 4 m"));
}

TEST(VehicleCheck, FindsNothingOddInTheBuiltInVehicles) {
  for (const std::string& name : built_in_vehicles()) {
    const SortedJson json =
        SortedJson::parse(run_program({"vehicle", "check", name, "--json"}).out);
    EXPECT_TRUE(json["warnings"].empty()) << name << json["warnings"];
    EXPECT_THAT(run_program({"vehicle", "check", name}).out, ::testing::Not(HasSubstr("warning")));
  }
}

TEST(VehicleShow, TellsEverything) {
  const std::string crazyflie = run_program({"vehicle", "show", "crazyflie"}).out;
  for (const char* words :
       {"environment gravity 9.81 m/s2", "lag 0.072 s; inertia 0 kg m2", "tolerance 0.011",
        "drag        area 0 0 0 m2", "accelerometer 200 Hz", "assumed: the file has no [sensors]",
        "assumed: a supply that never falls", "body.drag_area_m2 = 0 m2",
        "rotor.inertia_kg_m2 = 0 kg m2", "flight.takeoff_gain = 0"})
    EXPECT_THAT(crazyflie, HasSubstr(words));
  const std::string mambo = run_program({"vehicle", "show", "mambo"}).out;
  for (const char* words :
       {"radius 0.033 m; chord 0.008 m; 2 blades", "signs 1 -1 1 -1", "sonar         200 Hz",
        "rotor.lag_s = 0 s: speeds follow", "1.45 m g; 0.92 of the maximum thrust",
        "published   PID cascade every 0.005 s"})
    EXPECT_THAT(mambo, HasSubstr(words));
  // Values of the file are not listed as assumed.
  EXPECT_THAT(mambo, ::testing::Not(HasSubstr("environment.gravity_m_per_s2 =")));
  EXPECT_THAT(mambo, ::testing::Not(HasSubstr("sensors = typical")));
}

// Lags for rising and falling speed replace lag_s; the one that is absent is listed.
TEST(VehicleShow, LagOfOneDirection) {
  const TemporaryDirectory folder;
  const auto assumed = [&](const std::string& lags) {
    std::string text = load_vehicle("crazyflie").text;
    const std::size_t line = text.find("lag_s");
    text.replace(line, text.find('\n', line) - line, lags);
    const std::string file = folder.write("v.toml", text).string();
    return SortedJson::parse(run_program({"vehicle", "show", file, "--json"}).out)["assumed"];
  };
  for (const char* key : {"rotor.lag_s", "rotor.lag_up_s", "rotor.lag_down_s"}) {
    EXPECT_FALSE(assumed("lag_s = 0.02").contains(key));
    EXPECT_FALSE(assumed("lag_up_s = 0.02\nlag_down_s = 0.03").contains(key));
    EXPECT_EQ(assumed("lag_up_s = 0.02").contains(key), key == std::string("rotor.lag_down_s"));
    EXPECT_EQ(assumed("").contains(key), key == std::string("rotor.lag_s"));
  }
}

TEST(VehicleShow, JsonHasSensorsBatteryAndWhatIsAssumed) {
  const TemporaryDirectory folder;
  const std::string file =
      folder
          .write("v.toml", load_vehicle("mambo").text +
                               "\n[battery]\ncapacity_A_h = 0.6\nfull_voltage_V = 4.2\n"
                               "empty_voltage_V = 3.2\nresistance_ohm = 0.1\n")
          .string();
  const SortedJson json = SortedJson::parse(run_program({"vehicle", "show", file, "--json"}).out);
  EXPECT_EQ(json["battery"]["capacity_A_h"], 0.6);
  EXPECT_EQ(json["battery"]["efficiency"], 0.7);
  EXPECT_EQ(json["sensors"]["sonar"]["noise_m"], 0.01);
  EXPECT_EQ(json["sensors"]["accelerometer"]["bias_m_per_s2"], SortedJson({0.09, -0.06, 0.337}));
  EXPECT_FALSE(json["sensors"].contains("gps"));
  EXPECT_THAT(json["assumed"]["rotor.lag_s"].get<std::string>(), HasSubstr("0 s"));
  EXPECT_FALSE(json["assumed"].contains("battery"));
  EXPECT_FALSE(json["assumed"].contains("rotor.inertia_kg_m2"));
}

}  // namespace
}  // namespace quadtune::testing
