// SPDX-License-Identifier: Apache-2.0
/// quadtune pid: known values, evidence, and infeasible requirements.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "run_program.hpp"

namespace quadtune {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;
using testing::ProgramResult;
using testing::run_program;

Json pid_json(std::vector<std::string> args) {
  args.insert(args.begin(), "pid");
  args.emplace_back("--json");
  const ProgramResult result = run_program(args);
  EXPECT_EQ(result.status, 0) << result.err;
  return Json::parse(result.out);
}

// Åström, Hägglund 2006: 1/(s + 1)³.
TEST(PidVerb, ByRequirement) {
  const Json json = pid_json({"--num", "1", "--den", "1,3,3,1", "--type", "PI", "--crossover",
                              "0.5205", "--phase-margin", "60"});
  EXPECT_NEAR(json["Kp"], 1.14, 5e-3);
  EXPECT_NEAR(json["Ki"], 0.454, 5e-4);
  EXPECT_EQ(json["Kd"], 0);
  EXPECT_TRUE(json["stable"]);
  EXPECT_NEAR(json["crossover"], 0.5205, 1e-9);
  EXPECT_NEAR(json["phase_margin_deg"], 60, 1e-7);
  EXPECT_GT(double(json["Ms"]), 1);
  EXPECT_EQ(json["margins"]["loops"].size(), 1U);
}

TEST(PidVerb, ByRule) {
  const Json pid = pid_json({"--num", "1", "--den", "0.5,1", "--delay", "0.3", "--rule", "amigo"});
  EXPECT_NEAR(pid["Kp"], 0.95, 5e-3);
  EXPECT_NEAR(double(pid["Kp"]) / double(pid["Ki"]), 0.446, 5e-4);  // Ti
  EXPECT_NEAR(double(pid["Kd"]) / double(pid["Kp"]), 0.127, 5e-4);  // Td
  const Json pi = pid_json(
      {"--num", "1", "--den", "0.5,1", "--delay", "0.3", "--rule", "amigo", "--type", "PI"});
  EXPECT_NEAR(pi["Kp"], 0.343, 5e-4);
  EXPECT_NEAR(double(pi["Kp"]) / double(pi["Ki"]), 0.469, 5e-4);
  // SIMC, tight: K = T/(2 L), Ti = min(T, 8 L).
  const Json simc = pid_json(
      {"--num", "1", "--den", "0.5,1", "--delay", "0.3", "--rule", "simc", "--type", "PI"});
  EXPECT_NEAR(simc["Kp"], 0.5 / 0.6, 1e-9);
  EXPECT_NEAR(double(simc["Kp"]) / double(simc["Ki"]), 0.5, 1e-9);
}

TEST(PidVerb, BestWithinBounds) {
  const Json json = pid_json({"--num", "1", "--den", "1,3,3,1", "--type", "PI", "--Ms-max", "1.4"});
  EXPECT_NEAR(json["Kp"], 0.633, 1e-2);  // Åström, Panagopoulos, Hägglund 1998
  EXPECT_NEAR(json["Ms"], 1.4, 2e-3);
  EXPECT_THAT(std::string(json["how"]), HasSubstr("active bounds: Ms"));
}

TEST(PidVerb, WhatCannotBeHad) {
  const ProgramResult result =
      run_program({"pid", "--num", "1", "--den", "1,1", "--delay", "1", "--type", "PI",
                   "--crossover", "5", "--phase-margin", "60"});
  EXPECT_EQ(result.status, 4);
  EXPECT_THAT(result.err, HasSubstr("rad/s"));
  EXPECT_EQ(result.out, "");
}

}  // namespace
}  // namespace quadtune
