// SPDX-License-Identifier: Apache-2.0
// Version 2 of gains.json: laws with a memory, limits and axes.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "matrix_near.hpp"
#include "plants/export_models.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/general_filter_settings.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/exports/read_gains.hpp"
#include "quadtune/model/sensors.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;
using testing::MatrixNear;
using testing::TemporaryDirectory;
using ::testing::ThrowsMessage;

ExportContent dynamic_content() {
  ExportContent content = testing::mambo_content();
  Gains& gains = *content.gains;
  gains.axes = PositionAxes::heading;
  gains.limits.position_error = 0.7;
  gains.limits.conditional_integration = true;
  CommandMemory memory;
  memory.lag = Eigen::Vector4d(0.05, 0.06, 0.07, 0.08);
  memory.K_lag = Eigen::Matrix4d::Identity() / 3;
  memory.past = 2;
  memory.K_past = Eigen::MatrixXd::Constant(4, 8, 1.0 / 7);
  gains.memory = memory;
  return content;
}

Json json_of(const ExportContent& content) { return Json::parse(gains_json_text(content)); }

/// Every sensor of the general filter, with distinct numbers.
StoredEstimator every_number() {
  Sensors sensors = typical_sensors();
  sensors.gps = GpsSensor();
  sensors.gps->position.rate = 5;
  sensors.gps->position.noise.setConstant(0.7);
  sensors.gps->velocity_noise.setConstant(0.09);
  sensors.vision = SensorFaults();
  sensors.vision->rate = 30;
  sensors.vision->noise.setConstant(0.011);
  StoredEstimator estimator{"general",
                            general_filter_settings(sensors, 0.004, 9.79, {17.0, 2.0, 44.0})};
  GeneralFilterSettings& settings = *estimator.general;
  settings.gyroscope.lag = 0.0031;
  settings.gyroscope.scale = {1.01, 1.02, 1.03};
  settings.accelerometer.walk = 1.0 / 3000;
  settings.start.tilt = 0.0123;
  settings.gate = 21;
  settings.recovery_time = 1.7;
  settings.lift_off_velocity = 0.061;
  settings.jerk = 11;
  return estimator;
}

TEST(DynamicGains, ReadBackAsWritten) {
  const TemporaryDirectory directory;
  const ExportContent content = dynamic_content();
  const Gains& written = *content.gains;
  EXPECT_EQ(json_of(content)["format_version"], 2);
  (void)write_export(directory.path() / "out", ExportKind::json, content);
  for (const char* file : {"out", "out/gains.json", "out/manifest.json"}) {
    const Gains read = read_gains(directory.path() / file);
    EXPECT_EQ(read.axes, written.axes) << file;
    EXPECT_EQ(read.limits, written.limits) << file;
    ASSERT_TRUE(read.memory) << file;
    EXPECT_THAT(read.memory->lag, MatrixNear(written.memory->lag, 0));
    EXPECT_THAT(read.memory->K_lag, MatrixNear(written.memory->K_lag, 0));
    EXPECT_EQ(read.memory->past, written.memory->past);
    EXPECT_THAT(read.memory->K_past, MatrixNear(written.memory->K_past, 0));
    EXPECT_THAT(read.K, MatrixNear(written.K, 0));
  }
}

TEST(DynamicGains, StayInVersionOneWhereItCanHoldThem) {
  EXPECT_EQ(json_of(testing::mambo_content())["format_version"], 1);
  ExportContent turned = testing::mambo_content();
  turned.gains->axes = PositionAxes::heading;
  EXPECT_EQ(json_of(turned)["format_version"], 2);
  EXPECT_TRUE(json_of(turned)["gains"]["memory"].is_null());
}

TEST(DynamicGains, AreRefusedWithAPartMissing) {
  const TemporaryDirectory directory;
  const auto refusal = [&](auto&& change, const std::string& message) {
    Json json = json_of(dynamic_content());
    change(json["gains"]);
    const std::filesystem::path path = directory.write("gains.json", json.dump());
    EXPECT_THAT([&] { (void)read_gains(path); }, ThrowsMessage<InvalidInput>(HasSubstr(message)))
        << message;
  };
  for (const char* part : {"axes", "limits", "memory"})
    refusal([&](Json& gains) { gains.erase(part); },
            "gains.json: gains: has no \"" + std::string(part));
  for (const char* part : {"lag_s", "K_lag", "past", "K_past"})
    refusal([&](Json& gains) { gains["memory"].erase(part); },
            "gains.json: gains.memory: has no \"" + std::string(part));
  for (const char* part : {"position_error_m", "conditional_integration"})
    refusal([&](Json& gains) { gains["limits"].erase(part); },
            "gains.json: gains.limits: has no \"" + std::string(part));
  refusal([](Json& gains) { gains["axes"] = "north"; },
          "gains.axes: axes is 'north', expected world or heading");
  refusal([](Json& gains) { gains["memory"]["past"] = 1.5; },
          "gains.memory.past: is 1.5, expected a whole number from 0 to 40");
  refusal([](Json& gains) { gains["memory"]["past"] = 3; }, "K_past");
  refusal([](Json& gains) { gains["memory"]["lag_s"][2] = -1; },
          "lag is -1 s, expected more than 0");
  refusal([](Json& gains) { gains["limits"]["conditional_integration"] = 1; },
          "limits.conditional_integration: is a number, expected true or false");
  refusal([](Json& gains) { gains["limits"]["position_error_m"] = -1; },
          "the limit of the position error is -1 m, expected more than 0");
}

// A missing part must be an error, because a reader would have to guess it.
TEST(DynamicGains, HaveAnEstimatorAndAWholeCascade) {
  const TemporaryDirectory directory;
  ExportContent content = dynamic_content();
  content.cascade = testing::mambo_content().cascade;
  ASSERT_TRUE(content.cascade);
  content.estimator = every_number();
  content.gains->dt = content.cascade->gains.dt = content.estimator->general->dt;
  const Json whole = json_of(content);
  const auto refusal = [&](auto&& change, const std::string& message) {
    Json json = whole;
    change(json);
    const std::filesystem::path path = directory.write("gains.json", json.dump());
    EXPECT_THAT([&] { (void)read_laws(path); }, ThrowsMessage<InvalidInput>(HasSubstr(message)))
        << message;
  };
  for (const auto& [part, value] : whole["cascade"].items())
    refusal([&, name = part](Json& json) { json["cascade"].erase(name); },
            "gains.json: cascade: has no \"" + part);
  refusal([](Json& json) { json.erase("estimator"); }, "gains.json: has no \"estimator");
  refusal([](Json& json) { json["estimator"]["dt_s"] = 0.01; },
          "estimator.dt_s: is 0.01 s, expected 0.004 s, the sample period of the law");
  refusal([](Json& json) { json["estimator"]["flow"]["lag_s"] = 0.2; },
          "flow.lag is 0.2 s, expected 0 to 40 control periods of 0.004 s");
  // True states are stored explicitly as "no estimator".
  content.estimator.reset();
  const Json truth = json_of(content);
  EXPECT_TRUE(truth["estimator"].is_null());
  EXPECT_FALSE(read_laws(directory.write("gains.json", truth.dump())).estimator);
}

// A program that supports only a matrix on the states would fly another law.
TEST(DynamicGains, AreRefusedByProgramsThatHoldAMatrixOnly) {
  EXPECT_THAT([] { (void)export_files(ExportKind::mambo, dynamic_content()); },
              ThrowsMessage<InvalidInput>(
                  HasSubstr("mambo: the law feeds back its past commands, expected a matrix")));
  ExportContent uquad = testing::uquad_content();
  uquad.gains->axes = PositionAxes::heading;
  EXPECT_THAT(
      [&] { (void)export_files(ExportKind::uquad, uquad); },
      ThrowsMessage<InvalidInput>(HasSubstr("the law sees the position error in heading axes")));
}

// In a file that claims version 1, only the word "law" reveals a memory.
TEST(DynamicGains, AreRefusedInAFileOfVersionOne) {
  const TemporaryDirectory directory;
  for (const char* part : {"axes", "limits", "memory"}) {
    Json json = json_of(testing::mambo_content());
    ASSERT_EQ(json["format_version"], 1);
    json["gains"][part] = json_of(dynamic_content())["gains"][part];
    const std::filesystem::path path = directory.write("gains.json", json.dump());
    EXPECT_THAT([&] { (void)read_gains(path); },
                ThrowsMessage<InvalidInput>(
                    HasSubstr(fmt::format("gains.{}: requires version 2 of the file", part))));
  }
}

/// The uquad's filter with covariances other than those of the library.
StoredEstimator tuned_uquad(double dt) {
  StoredEstimator estimator{"uquad"};
  UquadFilterSettings<double>& settings = estimator.uquad.emplace(uquad_filter_in_si<double>());
  settings.dt = dt;
  settings.Q = UquadVector<double>::LinSpaced(1e-3, 1.5e-2);
  double R = 0.1;
  for (double* variance :
       {&settings.R_tilt, &settings.R_yaw, &settings.R_force, &settings.R_rates, &settings.R_height,
        &settings.R_gps_position, &settings.R_gps_velocity, &settings.R_vision})
    *variance = R += 0.3;
  return estimator;
}

TEST(StoredEstimator, ReadsBackAsWritten) {
  const TemporaryDirectory directory;
  ExportContent content = testing::mambo_content();
  content.estimator = every_number();
  content.gains->dt = content.plant->dt = content.estimator->general->dt;
  ASSERT_TRUE(content.estimator->general->flow && content.estimator->general->range &&
              content.estimator->general->pressure && content.estimator->general->heading &&
              content.estimator->general->gps_position && content.estimator->general->vision);
  EXPECT_EQ(json_of(content)["format_version"], 2);
  (void)write_export(directory.path() / "out", ExportKind::json, content);
  const StoredLaws laws = read_laws(directory.path() / "out");
  ASSERT_TRUE(laws.estimator);
  EXPECT_EQ(*laws.estimator, *content.estimator);
  EXPECT_EQ(read_laws(directory.path() / "out/manifest.json").estimator, content.estimator);
  EXPECT_THAT(laws.gains->K, MatrixNear(content.gains->K, 0));

  // A missing sensor is not read; an infinite range stays infinite.
  GeneralFilterSettings& settings = *content.estimator->general;
  settings.vision.reset();
  settings.range->max = std::numeric_limits<double>::infinity();
  content.estimator->name = "general";
  const std::filesystem::path again = directory.write("again.json", gains_json_text(content));
  EXPECT_EQ(*read_laws(again).estimator, *content.estimator);

  content.estimator = StoredEstimator{"mambo"};
  const std::filesystem::path named = directory.write("named.json", gains_json_text(content));
  EXPECT_EQ(*read_laws(named).estimator, *content.estimator);

  content.estimator = tuned_uquad(content.gains->dt);
  const std::filesystem::path tuned = directory.write("tuned.json", gains_json_text(content));
  EXPECT_EQ(*read_laws(tuned).estimator, *content.estimator);
}

TEST(StoredEstimator, GivesItsNumbersToAFlightThatHasIt) {
  FlightSetup setup;
  setup.uquad_filter = uquad_filter_in_si<double>();
  const FlightSetup before = setup;
  take_numbers(StoredEstimator{"uquad"}, setup);
  EXPECT_EQ(setup.uquad_filter, before.uquad_filter);
  setup.uquad_filter.position = false;
  const StoredEstimator tuned = tuned_uquad(0.01);
  take_numbers(tuned, setup);
  EXPECT_EQ(setup.uquad_filter.Q, tuned.uquad->Q);
  EXPECT_EQ(setup.uquad_filter.R_vision, tuned.uquad->R_vision);
  EXPECT_FALSE(setup.uquad_filter.position);
  EXPECT_FALSE(setup.general_filter);
  take_numbers(every_number(), setup);
  EXPECT_EQ(setup.general_filter, every_number().general);
}

TEST(StoredEstimator, IsRefusedWithAMistake) {
  const TemporaryDirectory directory;
  const auto refusal = [&](auto&& change, const std::string& message) {
    ExportContent content = testing::mambo_content();
    content.estimator = every_number();
    Json json = json_of(content);
    change(json["estimator"]);
    const std::filesystem::path path = directory.write("gains.json", json.dump());
    EXPECT_THAT([&] { (void)read_laws(path); }, ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  refusal([](Json& json) { json["name"] = "kalman9"; },
          "estimator.name: is 'kalman9', expected one of general, mambo, uquad");
  refusal([](Json& json) { json["name"] = "generall"; }, "did you mean 'general'?");
  refusal([](Json& json) { json.erase("name"); }, "estimator: has no \"name\"");
  refusal([](Json& json) { json.erase("gyroscope"); }, "estimator: has no \"gyroscope\"");
  refusal([](Json& json) { json["flow"].erase("lag_s"); }, "estimator.flow: has no \"lag_s\"");
  refusal(
      [](Json& json) {
        json["gyroscope"]["scale"] = {1, 1};
      },
      "estimator.gyroscope.scale: has 2 numbers, expected 3");
  refusal([](Json& json) { json["gate"] = 0; }, "gate is 0, expected");
  refusal([](Json& json) { json["gate"] = "25"; }, "estimator.gate");
  refusal([](Json& json) { json["vision"]["variance_m2"] = -1; }, "vision");

  const auto of_uquad = [&](auto&& change, const std::string& message) {
    refusal(
        [&](Json& json) {
          ExportContent content = testing::mambo_content();
          content.estimator = tuned_uquad(content.gains->dt);
          json = json_of(content)["estimator"];
          change(json);
        },
        message);
  };
  of_uquad([](Json& json) { json["Q_per_period"] = {1, 2}; }, "has 2 numbers, expected 15");
  of_uquad([](Json& json) { json.erase("R_yaw_rad2"); }, "estimator: has no \"R_yaw_rad2\"");
  of_uquad([](Json& json) { json["R_tilt_rad2"] = 0; }, "R_tilt is 0 rad2");
  of_uquad([](Json& json) { json["dt_s"] = 0.5; },
           "expected 0.005 s, the sample period of the law");
}

}  // namespace
}  // namespace quadtune
