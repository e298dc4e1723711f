// SPDX-License-Identifier: Apache-2.0
#include "quadtune/model/vehicle.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>
#include <sstream>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"
#include "source_folder.hpp"

namespace quadtune {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::StrEq;
using ::testing::ThrowsMessage;

// Lines that the refusals below replace one at a time.
const std::vector<std::string> kPlus = {
    "name = 'plus'",
    "[body]",
    "mass_kg = 1",
    "inertia_kg_m2 = [1e-2, 1e-2, 1.5e-2]",
    "[rotor]",
    "thrust_a2_N_s2_per_rad2 = 5e-5",
    "torque_d2_N_m_s2_per_rad2 = 1e-6",
    "[motor]",
    "command = 'speed'",
    "min_rad_s = 50",
    "max_rad_s = 400",
    "[[rotors]]",
    "position_m = [0.3, 0, 0]",
    "spin = 'cw'",
    "[[rotors]]",
    "position_m = [0, 0.3, 0]",
    "spin = 'ccw'",
    "[[rotors]]",
    "position_m = [-0.3, 0, 0]",
    "spin = 'cw'",
    "[[rotors]]",
    "position_m = [0, -0.3, 0]",
    "spin = 'ccw'",
};

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

// The plus vehicle with `line` (1-based) replaced.
std::string plus_with(std::size_t line, const std::string& replacement) {
  std::vector<std::string> lines = kPlus;
  lines.at(line - 1) = replacement;
  return joined(lines);
}

std::string without_lines(std::size_t first, std::size_t last) {
  std::vector<std::string> lines = kPlus;
  lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(first - 1),
              lines.begin() + static_cast<std::ptrdiff_t>(last));
  return joined(lines);
}

Vehicle parse(const std::string& text) { return parse_vehicle(text, "v.toml"); }

TEST(BuiltInVehicles, AreTheFourOfTheDocumentation) {
  EXPECT_THAT(built_in_vehicles(), ElementsAre("mambo", "rolling-spider", "uquad", "crazyflie"));
  for (const std::string& name : built_in_vehicles()) {
    const Vehicle vehicle = load_vehicle(name);
    EXPECT_EQ(vehicle.name, name);
    EXPECT_FALSE(vehicle.source.empty());
    EXPECT_TRUE(vehicle.file.empty());
    EXPECT_EQ(vehicle.rotors.size(), 4u);
  }
}

// The program carries the bytes of vehicles/*.toml.
TEST(BuiltInVehicles, AreTheFilesOfTheTree) {
  for (const std::string& name : built_in_vehicles()) {
    const std::filesystem::path path =
        std::filesystem::path(testing::source_folder()) / "vehicles" / (name + ".toml");
    std::ostringstream bytes;
    bytes << std::ifstream(path, std::ios::binary).rdbuf();
    EXPECT_EQ(load_vehicle(name).text, bytes.str());
    EXPECT_EQ(load_vehicle(path.string()).file, path);
  }
}

TEST(Mambo, HasThePublicNumbers) {
  const Vehicle mambo = load_vehicle("mambo");
  EXPECT_EQ(mambo.mass, 0.063);
  EXPECT_EQ(mambo.air_density, 1.184);
  EXPECT_THAT(mambo.inertia.diagonal(),
              MatrixNear(Eigen::Vector3d(5.82857e-5, 7.16914e-5, 1.0e-4), 0));
  const Rotor& rotor = mambo.rotors[0];
  EXPECT_NEAR(rotor.thrust_a2 / 4.7199903669e-8, 1, 1e-10);
  EXPECT_NEAR(rotor.torque_d2 / 1.13928386e-10, 1, 1e-8);
  EXPECT_EQ(rotor.thrust_a1, 0);
  EXPECT_NEAR(rotor.Cq / (0.0107 * std::sqrt(0.0107 / 2)), 1, 1e-15);
  EXPECT_NEAR(rotor.inertia / (3.75e-4 * 0.033 * 0.033 / 4), 1, 1e-15);
  EXPECT_NEAR(rotor.position.norm(), 0.0624, 1e-16);
  EXPECT_THAT(mambo.motor.direction, ElementsAre(1, -1, 1, -1));
  EXPECT_EQ(mambo.takeoff_gain, 0.45);
  EXPECT_EQ(mambo.altitude_thrust_fraction, 0.92);
  EXPECT_EQ(load_vehicle("rolling-spider").takeoff_gain, 0.2);
  // 236.5088 counts hold it up.
  const double w = rotor_speed_for_thrust(rotor, mambo.mass * mambo.gravity / 4);
  EXPECT_NEAR(command_of_speed(mambo.motor, w) / 236.5088, 1, 1e-6);
}

TEST(Uquad, HoversAtThePublishedSpeeds) {
  const Vehicle uquad = load_vehicle("uquad");
  EXPECT_NEAR(rotor_speed_for_thrust(uquad.rotors[0], 1.741 * 9.81 / 4), 316.103650939028, 1e-9);
  Rotor first_version;
  first_version.thrust_a2 = 3.5296e-5;
  first_version.thrust_a1 = -4.9293e-4;
  EXPECT_NEAR(rotor_speed_for_thrust(first_version, 1.541 * 9.81 / 4), 334.279741754537, 1e-9);
  EXPECT_THAT(uquad.motor.direction, ElementsAre(1, 1, 1, 1));
}

TEST(RotorSpeedForThrust, InvertsTheCurveForEitherSignOfTheLinearTerm) {
  for (const double a1 : {-1e-3, 0.0, 1e-3, 1.0}) {
    Rotor rotor;
    rotor.thrust_a2 = 4.6e-5;
    rotor.thrust_a1 = a1;
    for (const double w : {30.0, 300.0, 3000.0})
      EXPECT_NEAR(rotor_speed_for_thrust(rotor, rotor_thrust(rotor, w)) / w, 1, 1e-13) << a1;
  }
  EXPECT_THROW((void)rotor_speed_for_thrust(Rotor(), -1), InvalidInput);
}

TEST(MotorCommand, ReadsBack) {
  for (const std::string& name : built_in_vehicles()) {
    const MotorCommand motor = load_vehicle(name).motor;
    for (const double command : {motor.min, 0.5 * motor.max, motor.max})
      EXPECT_NEAR(command_of_speed(motor, speed_of_command(motor, command)), command,
                  1e-13 * motor.max);
  }
  EXPECT_NEAR(speed_of_command(load_vehicle("mambo").motor, 500), std::sqrt(500 * 13840.8), 1e-9);
}

TEST(VehicleFile, OverridesTheSharedRotorOneByOne) {
  std::vector<std::string> lines = kPlus;
  lines[5] += "\nlag_s = 0.02";                                // of all rotors
  lines.push_back("Ct = 0.01\nradius_m = 0.1\nlag_s = 0.05");  // of the fourth rotor
  const Vehicle vehicle = parse(joined(lines));
  EXPECT_EQ(vehicle.rotors[2].thrust_a2, 5e-5);
  EXPECT_NEAR(vehicle.rotors[3].thrust_a2, 0.01 * 1.225 * std::numbers::pi * 1e-4, 1e-18);
  EXPECT_EQ(vehicle.rotors[3].torque_d2, 1e-6);
  EXPECT_EQ(vehicle.rotors[2].lag, 0.02);
  EXPECT_EQ(vehicle.rotors[3].lag, 0.05);
  EXPECT_TRUE(std::isnan(vehicle.rotors[2].radius));
}

TEST(VehicleFile, TakesInertiaFromGeometry) {
  std::vector<std::string> lines = kPlus;
  lines[2] = "[body.geometry]\nspheres = [{ mass_kg = 0.8, radius_m = 0.1 }]";
  lines[3] =
      "points = [{ mass_kg = 0.1, position_m = [0.3, 0, 0] },"
      "{ mass_kg = 0.1, position_m = [-0.3, 0, 0] }]";
  const Vehicle vehicle = parse(joined(lines));
  EXPECT_NEAR(vehicle.mass, 1, 1e-15);
  const double sphere = 0.4 * 0.8 * 0.01;
  EXPECT_THAT(vehicle.inertia.diagonal(),
              MatrixNear(Eigen::Vector3d(sphere, sphere + 0.018, sphere + 0.018), 1e-16));
}

TEST(VehicleFile, TakesAFullInertia) {
  const Vehicle vehicle =
      parse(plus_with(4, "inertia_kg_m2 = [[1e-2, 1e-4, 0], [1e-4, 1e-2, 0], [0, 0, 1.5e-2]]"));
  EXPECT_EQ(vehicle.inertia(0, 1), 1e-4);
}

// The Crazyflie's published moments are measured, and no body has them: Izz exceeds Ixx + Iyy by a
// hundredth. Its file says so.
TEST(VehicleFile, AcceptsMeasuredMomentsWithinTheirTolerance) {
  const std::string moments = "inertia_kg_m2 = [1.43e-5, 1.43e-5, 2.89e-5]";
  EXPECT_THROW((void)parse(plus_with(4, moments)), InvalidInput);
  EXPECT_EQ(parse(plus_with(4, moments + "\ninertia_tolerance = 0.011")).inertia_tolerance, 0.011);
  EXPECT_THROW((void)parse(plus_with(4, moments + "\ninertia_tolerance = 0.5")), InvalidInput);
}

// A vehicle that is too heavy for its rotors is valid; trim() reports it.
TEST(VehicleFile, AcceptsAVehicleThatCannotHover) {
  EXPECT_EQ(parse(plus_with(3, "mass_kg = 1000")).mass, 1000);
}

struct Refusal {
  const char* name;
  std::string text;
  const char* message;
};

class VehicleRefusals : public ::testing::TestWithParam<Refusal> {};

TEST_P(VehicleRefusals, NameFileLineAndReason) {
  EXPECT_THAT([] { (void)parse(GetParam().text); },
              ThrowsMessage<InvalidInput>(HasSubstr(GetParam().message)));
}

INSTANTIATE_TEST_SUITE_P(
    All, VehicleRefusals,
    ::testing::Values(
        Refusal{"WrongKey", plus_with(3, "weight_kg = 1"),
                "v.toml:3: key 'weight_kg' in [body] is not known"},
        Refusal{"WrongUnit", plus_with(3, "mass_g = 1"),
                "v.toml:3: key 'mass_g' in [body] is not known, expected 'mass_kg' (the unit is "
                "part of the key)"},
        Refusal{"WrongUnitOfCurve", plus_with(6, "thrust_a2_N_s2 = 5e-5"),
                "v.toml:6: key 'thrust_a2_N_s2' in [rotor] is not known, expected "
                "'thrust_a2_N_s2_per_rad2'"},
        Refusal{"LaterKeys", "payload = 1\n" + joined(kPlus),
                "v.toml:1: key 'payload' is not known"},
        Refusal{"MissingKey", without_lines(3, 3), "v.toml:2: [body] has no key 'mass_kg'"},
        Refusal{"MissingBody", without_lines(2, 4), "the file has no key 'body'"},
        Refusal{"DuplicateKey", plus_with(4, "mass_kg = 2"),
                "v.toml:4: key 'mass_kg' is defined twice, expected once"},
        Refusal{"NegativeMass", plus_with(3, "mass_kg = -1"),
                "v.toml:3: mass_kg in [body] is -1, expected more than 0"},
        Refusal{"NaNMass", plus_with(3, "mass_kg = nan"), "v.toml:3: mass_kg in [body] is nan"},
        Refusal{"TriangleInequality", plus_with(4, "inertia_kg_m2 = [1, 1, 3]"),
                "v.toml:4: inertia violates the triangle inequality: about z it is 3 kg m2, which "
                "exceeds the sum of the other two, 2, by 1"},
        Refusal{"AsymmetricInertia",
                plus_with(4, "inertia_kg_m2 = [[1, 0.1, 0], [0, 1, 0], [0, 0, 1]]"),
                "v.toml:4: inertia is not symmetric"},
        Refusal{"ShapeOfInertia", plus_with(4, "inertia_kg_m2 = [[1, 0], [0, 1]]"),
                "v.toml:4: inertia_kg_m2 in [body] is 2x2, expected 3x3 or 3 numbers"},
        Refusal{"ZeroRotors", without_lines(12, 23), "the file has no [[rotors]]"},
        Refusal{"EmptyRotors", "rotors = []\n" + without_lines(12, 23),
                "v.toml:1: the file has no [[rotors]]"},
        Refusal{"OneSense",
                [] {
                  std::string text = joined(kPlus);
                  for (std::size_t at = 0; (at = text.find("'ccw'")) != std::string::npos;)
                    text.replace(at, 5, "'cw'");
                  return text;
                }(),
                "rotors cannot balance yaw: all 4 turn clockwise, which leaves 0.196 N m of drag "
                "torque in hover, expected both spin directions"},
        Refusal{"Spin", plus_with(14, "spin = 'left'"),
                "v.toml:14: spin in [[rotors]] 1 is 'left', expected 'cw'"},
        Refusal{"Position", plus_with(13, "position_m = [0.3, 0]"),
                "v.toml:13: position_m in [[rotors]] 1 has 2 entries, expected 3 (x, y, z)"},
        Refusal{"NoThrustCurve", plus_with(6, ""), "has no thrust curve, expected"},
        Refusal{"NoTorqueCurve", plus_with(7, ""), "has no torque curve, expected"},
        Refusal{"TwoThrustCurves", plus_with(5, "[rotor]\nCt = 0.01\nradius_m = 0.1"),
                "[rotor] has both 'Ct' and 'thrust_a2_N_s2_per_rad2', expected one of them"},
        Refusal{"CoefficientWithoutRadius", plus_with(6, "Ct = 0.01"),
                "has Ct or Cq but no radius_m"},
        Refusal{"NegativeLag", plus_with(6, "thrust_a2_N_s2_per_rad2 = 5e-5\nlag_s = -1"),
                "v.toml:7: lag_s in [rotor] is -1, expected 0 or more"},
        Refusal{"LagOfOneRotor", plus_with(14, "spin = 'cw'\nlag_s = 0.04"),
                "rotor 1 has a lag of 0.04 s and rotor 2 of 0 s, expected a lag of all rotors or "
                "of none"},
        Refusal{"NoThrustAtFullSpeed",
                plus_with(6, "thrust_a2_N_s2_per_rad2 = 5e-5\nthrust_a1_N_s_per_rad = -1"),
                "rotor 1 gives -392 N at its maximum speed of 400 rad/s, expected more than 0"},
        Refusal{"Limits", plus_with(11, "max_rad_s = 40"),
                "v.toml:11: max_rad_s in [motor] is 40, expected more than min_rad_s, 50"},
        Refusal{"LimitsInCounts", plus_with(11, "max_count = 400"),
                "v.toml:11: key 'max_count' in [motor] is not known, expected 'max_rad_s'"},
        Refusal{"CommandLaw", plus_with(9, "command = 'pwm'"),
                "v.toml:9: command in [motor] is 'pwm', expected 'speed' or 'speed-squared'"},
        Refusal{"Direction", plus_with(9, "command = 'speed'\ndirection = [1, 1]"),
                "v.toml:10: direction in [motor] has 2 entries, expected 4, one per rotor"},
        Refusal{"HalfDirection", plus_with(9, "command = 'speed'\ndirection = [1, 1, 1, 0.5]"),
                "direction in [motor] has 0.5, expected 1 or -1"},
        Refusal{"GeometryAndInertia", plus_with(3, "geometry = {}"),
                "v.toml:4: [body] has both inertia_kg_m2 and a geometry"},
        Refusal{"GeometryOffCentre",
                plus_with(4, "geometry = { points = [{ mass_kg = 1, position_m = [0.1, 0, 0] }] }"),
                "have their centre of mass at [0.1, 0, 0] m, expected [0, 0, 0]"},
        Refusal{"GeometryMass",
                plus_with(4, "geometry = { spheres = [{ mass_kg = 2, radius_m = 0.1 }] }"),
                "v.toml:3: mass_kg in [body] is 1 but the total mass of the parts of "
                "[body.geometry] is 2 kg"},
        Refusal{"Name", plus_with(1, "name = ''"),
                "v.toml:1: name is '', expected 1 to 64 letters"},
        Refusal{"Density", plus_with(2, "[environment]\nair_density_kg_per_m3 = 0\n[body]"),
                "v.toml:3: air_density_kg_per_m3 in [environment] is 0, expected more than 0"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(LoadVehicle, SuggestsTheNearestName) {
  EXPECT_THAT([] { (void)load_vehicle("mabmo"); },
              ThrowsMessage<InvalidInput>(
                  StrEq("vehicle: no vehicle 'mabmo', expected mambo, rolling-spider, uquad, "
                        "crazyflie or a vehicle file; did you mean 'mambo'?")));
  EXPECT_THROW((void)load_vehicle(std::string(5000, 'x')), InvalidInput);
  EXPECT_THAT([] { (void)load_vehicle("no/such.toml"); },
              ThrowsMessage<FileError>(StrEq("no/such.toml: No such file or directory")));
}

// A truncated file is either a valid vehicle or InvalidInput, never another outcome.
TEST(VehicleFile, EveryPrefixIsAVehicleOrBadInput) {
  std::vector<std::string> texts = {joined(kPlus)};
  for (const std::string& name : built_in_vehicles()) texts.push_back(load_vehicle(name).text);
  for (const std::string& text : texts) {
    int vehicles = 0;
    for (std::size_t length = 0; length <= text.size(); ++length) {
      try {
        vehicles += parse(text.substr(0, length)).rotors.empty() ? 0 : 1;
      } catch (const InvalidInput& error) {
        ASSERT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
        ASSERT_EQ(std::string(error.what()).rfind("v.toml", 0), 0u) << error.what();
      }
    }
    EXPECT_GE(vehicles, 1);
  }
}

// Nor does a byte changed at random make anything else.
TEST(VehicleFile, EveryChangedByteIsAVehicleOrBadInput) {
  std::mt19937_64 random(3);
  for (const std::string& name : built_in_vehicles()) {
    const std::string good = load_vehicle(name).text;
    for (int i = 0; i < 2000; ++i) {
      std::string text = good;
      for (int change = 0; change < 1 + i % 3; ++change)
        text[random() % text.size()] = static_cast<char>(random() % 256);
      try {
        (void)parse(text);
      } catch (const InvalidInput& error) {
        ASSERT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
      }
    }
  }
}

}  // namespace
}  // namespace quadtune
