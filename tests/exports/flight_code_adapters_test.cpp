// SPDX-License-Identifier: Apache-2.0
// Adapters of flight code, compiled against declarations of their firmware and tested with a
// recorded flight in that firmware's units and axes.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "plants/flight_code_designs.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/flight_code.hpp"
#include "quadtune/exports/included_estimator.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using testing::flight_code_content;
using testing::FlightCodeCase;
using ::testing::HasSubstr;
using testing::TemporaryDirectory;
using ::testing::ThrowsMessage;

constexpr char kFlags[] = "-ffp-contract=off -O1 -Wall -Wextra -Wdouble-promotion -Werror";

ExportContent adapted(const std::string& vehicle, const std::string& adapter, double dt,
                      bool cascade = true) {
  FlightCodeCase one;
  one.vehicle = vehicle;
  one.cascade = cascade;
  ExportContent content = flight_code_content(one);
  (cascade ? content.cascade->gains.dt : content.gains->dt) = dt;
  content.estimator->general->dt = dt;
  content.flight_code.name = "prog";
  content.flight_code.adapter = adapter;
  return content;
}

class Adapter : public ::testing::TestWithParam<bool> {
 protected:
  /// Exports, runs a shell command in the folder, and returns its output.
  std::string run(const ExportContent& content, const std::string& command) {
    write_files(folder_.path(), flight_code_files(content));
    const int status =
        std::system(fmt::format("cd '{}' && S='{}' && ( {} ) > log 2>&1", folder_.path().string(),
                                testing::source_folder() + "/tests/exports/stubs", command)
                        .c_str());
    EXPECT_EQ(status, 0) << folder_.read("log");
    return folder_.read("log");
  }

  const TemporaryDirectory folder_;
};

TEST_P(Adapter, OfTheCrazyflieGivesTheForcesOfTheLawInTheFirmwaresAxes) {
  const ExportContent content = adapted("crazyflie", "crazyflie", 0.004, GetParam());
  EXPECT_THAT(run(content, fmt::format("cc -std=c99 {} -Wno-double-promotion -c -I. -I$S/crazyflie "
                                       "$S/crazyflie/fly.c && cc -std=c11 {} -c -I. "
                                       "-I$S/crazyflie prog*.c adapter_crazyflie.c && cc -o fly "
                                       "*.o -lm && ./fly flight.txt {:.17g} 4",
                                       kFlags, kFlags, content.vehicle.rotors[0].thrust_a2)),
              HasSubstr("periods as the law"));
}

TEST_P(Adapter, OfPx4GivesTheThrustsOfTheLawByItsTopics) {
  const ExportContent content = adapted("crazyflie", "px4", 0.004, GetParam());
  const Rotor& rotor = content.vehicle.rotors[0];
  const double max = rotor.thrust_a2 * content.vehicle.motor.max * content.vehicle.motor.max;
  EXPECT_THAT(run(content, fmt::format("c++ -std=c++17 {} -Wno-double-promotion -c -I. -I$S/px4 "
                                       "$S/px4/fly.cpp && cc -std=c99 {} -c prog*.c && "
                                       "c++ -o fly *.o -lm && ./fly flight.txt {:.17g} {:.17g}",
                                       kFlags, kFlags, rotor.thrust_a2, max)),
              HasSubstr("periods as the law"));
}

TEST_P(Adapter, OfTheMamboGivesTheCommandsOfTheLaw) {
  const ExportContent content = adapted("mambo", "mambo", 0.005, GetParam());
  EXPECT_THAT(run(content, fmt::format("cc -std=c99 {} -fPIC -shared -o object.so "
                                       "adapter_mambo.c prog*.c -lm && cc -std=c99 -O1 -I. -o fly "
                                       "$S/mambo_fly.c ./object.so -lm && ./fly flight.txt",
                                       kFlags)),
              HasSubstr("periods, commands apart by "));
}

INSTANTIATE_TEST_SUITE_P(Laws, Adapter, ::testing::Bool(),
                         [](const auto& of) { return of.param ? "Cascade" : "StateFeedback"; });

using AdapterMain = Adapter;

TEST_P(AdapterMain, CallsTheProgramOncePerPeriod) {
  ExportContent content = adapted("crazyflie", "main", 0.005);
  if (!GetParam()) content.estimator.reset();
  EXPECT_THAT(run(content, fmt::format("cc -std=c99 {} -o flight adapter_*.c prog*.c -lm && "
                                       "./flight && make test",
                                       kFlags)),
              HasSubstr("200 control periods"));
}

INSTANTIATE_TEST_SUITE_P(Estimator, AdapterMain, ::testing::Bool(),
                         [](const auto& of) { return of.param ? "OnBoard" : "OfTheCaller"; });

TEST(Adapters, RefuseWhatTheirBoardDoesNotHave) {
  const auto files = [](const ExportContent& content) {
    return [content] { (void)flight_code_files(content); };
  };
  EXPECT_THAT(files(adapted("crazyflie", "crazyflie", 0.005)),
              ThrowsMessage<InvalidInput>(HasSubstr("the law's period is 0.005 s, expected 0.002, "
                                                    "0.004 or 0.01 s")));
  EXPECT_THAT(files(adapted("uquad", "crazyflie", 0.01)),
              ThrowsMessage<InvalidInput>(HasSubstr("expected four in X")));
  ExportContent turned = adapted("crazyflie", "crazyflie", 0.004);
  for (Rotor& rotor : turned.vehicle.rotors)
    rotor.spin = rotor.spin == Spin::clockwise ? Spin::counter_clockwise : Spin::clockwise;
  EXPECT_THAT(files(turned),
              ThrowsMessage<InvalidInput>(HasSubstr("front right counter-clockwise")));
  ExportContent doubled = adapted("mambo", "mambo", 0.005);
  doubled.flight_code.double_precision = true;
  EXPECT_THAT(files(doubled), ThrowsMessage<InvalidInput>(HasSubstr("expected float")));
  ExportContent hexa =
      adapted(testing::source_folder() + "/vehicles/hexa-550.toml", "mambo", 0.005);
  EXPECT_THAT(files(hexa), ThrowsMessage<InvalidInput>(HasSubstr("expected four in X")));
  EXPECT_THAT(files(adapted("crazyflie", "pixhawk", 0.004)),
              ThrowsMessage<InvalidInput>(
                  HasSubstr("no adapter 'pixhawk', expected main, mambo, crazyflie, px4")));
}

// The firmware's motor numbers, for any order of the rotors in the vehicle's file.
TEST(Adapters, FindEachMotorByItsPlaceAndSense) {
  ExportContent content = adapted("crazyflie", "crazyflie", 0.004);
  const auto order = [&] {
    for (const FileContent& file : flight_code_files(content))
      if (file.name == "adapter_crazyflie.c") {
        const std::size_t at = file.bytes.find("rotor_of_motor[4] = {");
        return file.bytes.substr(at + 21, 10);
      }
    return std::string();
  };
  EXPECT_EQ(order(), "1, 2, 3, 0");  // front left is the first of the file, M1 front right
  std::swap(content.vehicle.rotors[0], content.vehicle.rotors[2]);
  EXPECT_EQ(order(), "1, 0, 3, 2");
}

TEST(Adapters, LeaveTheEstimatorOutWhereTheirFirmwareHasOne) {
  const StoredEstimator general{"general", GeneralFilterSettings()}, mambo{"mambo"}, uquad{"uquad"};
  for (const char* adapter : {"", "main"}) {
    EXPECT_EQ(included_estimator(general, adapter), "general");
    EXPECT_EQ(included_estimator(mambo, adapter), "mambo");
    EXPECT_EQ(included_estimator(uquad, adapter), "uquad");
    EXPECT_EQ(included_estimator({}, adapter), "");
  }
  for (const char* adapter : {"mambo", "crazyflie", "px4"})
    EXPECT_EQ(included_estimator(general, adapter), "");
}

TEST(Adapters, AreReadBackFromAnExport) {
  const TemporaryDirectory folder;
  write_files(folder.path(), flight_code_files(adapted("mambo", "mambo", 0.005)));
  EXPECT_EQ(read_flight_code_options(folder.path()).adapter, "mambo");
  EXPECT_THAT(folder.read("README.md"), HasSubstr("-shared -o flightController.so"));
}

}  // namespace
}  // namespace quadtune
