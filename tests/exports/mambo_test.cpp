// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/mambo.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <map>

#include "matrix_near.hpp"
#include "plants/export_models.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::hover_gains;
using testing::mambo_content;
using testing::MatrixNear;
using testing::sampled_mambo;
using ::testing::ThrowsMessage;

std::string text_of(const ExportContent& content, const std::string& name) {
  for (const FileContent& file : mambo_files(content))
    if (file.name == name) return file.bytes;
  return "";
}

void expect_refusal(const ExportContent& content, const std::string& message) {
  EXPECT_THAT([&] { (void)mambo_files(content); }, ThrowsMessage<InvalidInput>(HasSubstr(message)));
}

TEST(Mambo, WritesItsFiles) {
  std::vector<std::string> names;
  for (const FileContent& file : mambo_files(mambo_content())) names.push_back(file.name);
  EXPECT_THAT(names,
              ElementsAre("vehicleVars.m", "controllerVars.m", "estimatorVars.m", "sensorsVars.m"));
}

TEST(Mambo, SensorsAreThoseOfTheVehiclesFile) {
  ExportContent content = mambo_content();
  std::map<std::string, Eigen::MatrixXd> numbers;
  for (const NamedMatrix& number : parse_m_file(text_of(content, "sensorsVars.m"), "test"))
    numbers[number.name] = number.value;
  const SensorFaults& gyroscope = *content.vehicle.sensors.gyroscope;
  EXPECT_EQ(numbers.at("Sensors.gyroscope.rate")(0, 0), gyroscope.rate);
  EXPECT_EQ(numbers.at("Sensors.gyroscope.noise"), gyroscope.noise.transpose());
  EXPECT_EQ(numbers.at("Sensors.flow.noise").cols(), 2);
  EXPECT_EQ(numbers.at("Sensors.sonar.delay")(0, 0), content.vehicle.sensors.sonar->faults.delay);
  EXPECT_FALSE(numbers.contains("Sensors.magnetometer.rate") &&
               !content.vehicle.sensors.magnetometer);
  content.vehicle.sensors_known = false;
  EXPECT_EQ(text_of(content, "sensorsVars.m"), "");
}

TEST(Mambo, TakesBothVehiclesOfTheModelProject) {
  for (const char* name : {"mambo", "rolling-spider"}) {
    ExportContent content;
    content.vehicle = load_vehicle(name);
    EXPECT_EQ(mambo_files(content).size(), content.vehicle.sensors_known ? 4U : 3U) << name;
  }
}

TEST(Mambo, StateFeedbackReadsBack) {
  const ExportContent content = mambo_content();
  const Gains read =
      parse_controller_vars(text_of(content, "controllerVars.m"), "controllerVars.m");
  EXPECT_THAT(read.K, MatrixNear(content.gains->K, 0));
  EXPECT_THAT(read.K_int, MatrixNear(content.gains->K_int, 0));
  EXPECT_THAT(read.u0, MatrixNear(content.gains->u0, 0));
  EXPECT_EQ(read.states, content.gains->states);
  EXPECT_EQ(read.inputs, content.gains->inputs);
  EXPECT_EQ(read.integrals, content.gains->integrals);
  EXPECT_EQ(read.dt, 0.005);
  EXPECT_EQ(read.sign_law, SignLaw::set_point_minus_state);
}

TEST(Mambo, CascadeReadsBackWithItsFlags) {
  for (const bool flag : {false, true}) {
    ExportContent content = mambo_content();
    content.cascade->velocity_feed_forward = flag;
    content.cascade->conditional_integration = !flag;
    const auto read = parse_cascade_vars(text_of(content, "controllerVars.m"), "controllerVars.m");
    ASSERT_TRUE(read);
    EXPECT_EQ(read->velocity_feed_forward, flag);
    EXPECT_EQ(read->conditional_integration, !flag);
  }
}

TEST(Mambo, RefusesALawWithLimits) {
  ExportContent content = mambo_content();
  content.cascade->gains.loops[3].rate_lead = 0.02;
  expect_refusal(content, "mambo: the loop 'roll' acts on the derivative of the rate");
  content = mambo_content();
  content.gains->limits.conditional_integration = true;
  expect_refusal(content, "mambo: the law limits its position error or its integrals");
}

// A name must not become code that the model project runs.
TEST(Mambo, KeepsNamesInsideTheirComment) {
  ExportContent content = mambo_content();
  content.vehicle.name = "mambo\nsystem('reboot')";
  EXPECT_THAT(text_of(content, "vehicleVars.m"), HasSubstr("% vehicleVars.m: mambo system("));
  content.cascade->gains.loops[0].name = "x = 1; y";
  expect_refusal(content, "the loop is called 'x = 1; y'; expected a name");
}

TEST(Mambo, WritesAnEmptyMatrixForWhatIsNotKnown) {
  ExportContent content = mambo_content();
  content.vehicle.airframe_height = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(text_of(content, "vehicleVars.m"),
              HasSubstr("Vehicle.Airframe.h = [];  % not known\n"));
}

TEST(Mambo, RefusesAVehicleThatTheModelProjectCannotExpress) {
  ExportContent plus;
  plus.vehicle = load_vehicle("uquad");
  expect_refusal(plus, "rotor 1 is at (0.29, 0) m, expected (");
  ExportContent content = mambo_content();
  content.vehicle.rotors.pop_back();
  expect_refusal(content, "mambo: the vehicle has 3 rotors, expected 4");
  content = mambo_content();
  std::swap(content.vehicle.rotors[0].position, content.vehicle.rotors[1].position);
  expect_refusal(content, "rotor 1 is at (");
  content = mambo_content();
  content.vehicle.rotors[1].spin = Spin::clockwise;
  expect_refusal(content, "rotor 2 turns the other way");
  content = mambo_content();
  content.vehicle.rotors[2].thrust_a1 = 1e-5;
  expect_refusal(content, "rotor 3 has thrust ");
  content = mambo_content();
  content.vehicle.rotors[0].Ct = std::numeric_limits<double>::quiet_NaN();
  expect_refusal(content, "rotor 1 has no Ct, Cq and radius");
  content = mambo_content();
  content.vehicle.motor.law = CommandLaw::speed;
  expect_refusal(content, "the motors are commanded in speed");
  content = mambo_content();
  content.vehicle.drag.cda.x() = 0.001;
  content.vehicle.airframe_diameter = std::numeric_limits<double>::quiet_NaN();
  expect_refusal(content, "drag.cda is 0.001 m^2, but the airframe diameter is unknown");
}

TEST(Mambo, RefusesOtherGainsAndFilters) {
  ExportContent content = mambo_content();
  content.gains->convention = "ned";
  expect_refusal(content, "the gain is in convention 'ned' with inputs wrench, expected 'mambo'");
  content = mambo_content();
  content.filters[0].name = "yaw";
  expect_refusal(content, "filter 'yaw' is not supported; expected 'altitude' or 'velocity'");
  content = mambo_content();
  content.filters[0].M(1, 0) = std::numeric_limits<double>::infinity();
  expect_refusal(content, "Estimator.alt.kf.M has inf at (2,1), expected finite numbers");
}

TEST(MNumbers, ReadsPlainNumbersAndPassesOverExpressions) {
  const std::vector<NamedMatrix> numbers = parse_m_numbers(
      "% about\n\na = 1.5;  % m\nb.c = [1, -2];\nd = 2*a;\nK = [\n  1, 2\n  3, 4\n];  % K\n",
      "x.m");
  ASSERT_EQ(numbers.size(), 3U);
  EXPECT_EQ(numbers[0].name, "a");
  EXPECT_THAT(numbers[1].value, MatrixNear(Eigen::RowVector2d(1, -2), 0));
  EXPECT_EQ(numbers[2].name, "K");
  EXPECT_THAT(numbers[2].value, MatrixNear(Eigen::Matrix2d{{1, 2}, {3, 4}}, 0));
}

TEST(MNumbers, RefusesWhatCannotBeChecked) {
  const auto refusal = [](const std::string& text, const std::string& message) {
    EXPECT_THAT([&] { (void)parse_m_numbers(text, "x.m"); },
                ThrowsMessage<InvalidInput>(HasSubstr(message)))
        << text;
  };
  refusal("a = 1;\na = 2;\n", "x.m:2: a is defined twice");
  refusal("a = 1;\na(2) = 2;\n", "x.m:2: has 'a(2) = 2;'; expected 'Name = value;'");
  refusal("a = 1; b = 2;\n", "expected one value and a semicolon");
  refusal("K = [\n  1, 2\n  3\n];\n", "x.m:3: has 1 numbers, expected 2");
  refusal("K = [\n  1, 2\n  3, nan\n];\n", "K has an entry that is not finite");
  refusal("K = [\n  1, 2\n  3, x\n];\n", "x.m:3: '3, x' is not a row of numbers");
  refusal("K = [\n  1, 2\n", "x.m: ends within a matrix");
  refusal("a. = 1;\n", "x.m:1: has 'a. = 1;'");
  refusal(" = 1;\n", "expected 'Name = value;'");
  // Lines of a megabyte: std::regex, which matches by recursion, overflows the stack on them.
  refusal(std::string(1 << 20, 'a') + "-", "expected 'Name = value;'");
  refusal("a = " + std::string(1 << 20, '[') + "; ;", "expected one value and a semicolon");
}

}  // namespace
}  // namespace quadtune
