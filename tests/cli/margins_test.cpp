// SPDX-License-Identifier: Apache-2.0
/// quadtune margins, and the margins in lqr and design.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "quadtune/internal/json.hpp"
#include "run_program.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using internal::Json;
using ::testing::HasSubstr;
using testing::ProgramResult;
using testing::run_program;
using testing::TemporaryDirectory;

Json json_of(std::vector<std::string> args) {
  args.emplace_back("--json");
  const ProgramResult result = run_program(args);
  EXPECT_EQ(result.status, 0) << result.err;
  return Json::parse(result.out);
}

TEST(MarginsVerb, OfATransferFunction) {
  const Json json = json_of({"margins", "--num", "25", "--den", "1,10,10,10"});
  ASSERT_EQ(json["loops"].size(), 1U);
  const Json& loop = json["loops"][0];
  EXPECT_TRUE(loop["stable"]);
  EXPECT_NEAR(loop["disk_alpha"], 0.4581, 5e-5);
  EXPECT_NEAR(loop["disk_frequency"], 1.955, 5e-4);
  EXPECT_NEAR(loop["disk_gain_margin_db"], 4.051, 5e-4);
  EXPECT_NEAR(loop["disk_phase_margin_deg"], 25.80, 5e-3);
  EXPECT_TRUE(loop["gain_reduction_db"].is_null());
  EXPECT_NEAR(json["multivariable"]["disk_alpha_destabilizing"], 0.4581, 5e-5);
  const ProgramResult text = run_program({"margins", "--num", "24", "--den", "1,6,11,6"});
  EXPECT_THAT(text.out, HasSubstr("35.4"));
  EXPECT_EQ(text.err, "");
}

TEST(MarginsVerb, WarnsByName) {
  const ProgramResult low = run_program({"margins", "--num", "25", "--den", "1,10,10,10"});
  EXPECT_EQ(low.status, 0);
  EXPECT_EQ(low.err, "margins: warning: the loop: phase margin 29.1 deg, less than 30 deg\n");
  const ProgramResult unstable = run_program({"margins", "--num", "1", "--den", "1,0,0"});
  EXPECT_THAT(unstable.out, HasSubstr("UNSTABLE"));
  EXPECT_THAT(unstable.err, HasSubstr("the loop: unstable"));
}

// A delay of whole samples is the same given as an option and as poles at 0.
TEST(MarginsVerb, DelayOfDiscreteLoops) {
  const Json option =
      json_of({"margins", "--num", "0.1", "--den", "1,-1", "--dt", "0.01", "--delay", "0.02"});
  const Json states = json_of({"margins", "--num", "0.1", "--den", "1,-1,0,0", "--dt", "0.01"});
  EXPECT_NEAR(option["loops"][0]["gain_margin_db"], states["loops"][0]["gain_margin_db"], 1e-9);
  const TemporaryDirectory folder;
  const std::string A = folder.write("A", "1\n").string();
  const std::string B = folder.write("B", "0.1\n").string();
  const std::string K = folder.write("K", "1\n").string();
  const Json matrices =
      json_of({"margins", "--A", A, "--B", B, "--K", K, "--dt", "0.01", "--delay", "0.02"});
  EXPECT_EQ(matrices["loops"][0]["name"], "u1");
  EXPECT_NEAR(matrices["loops"][0]["gain_margin_db"], option["loops"][0]["gain_margin_db"], 1e-9);
  const Json at_states = json_of({"margins", "--A", A, "--B", B, "--K", K, "--cut", "states"});
  EXPECT_EQ(at_states["loops"][0]["name"], "x1");
}

// The same loop by lqr, by design, and by margins from what design wrote.
TEST(MarginsVerb, OfAVehiclesGains) {
  const TemporaryDirectory folder;
  const std::string out = (folder.path() / "out").string();
  const std::string design = std::string(QUADTUNE_SOURCE_DIR) + "/designs/uquad-hover.toml";
  const Json designed = json_of({"design", design, "-o", out});
  const Json& expected = designed["lqr"]["margins"];
  EXPECT_EQ(designed["verdict"], "pass");
  EXPECT_TRUE(designed["warnings"].empty());
  const Json read = json_of({"margins", "uquad", "--gains", out});
  ASSERT_EQ(read["loops"].size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(read["loops"][i]["name"], expected["loops"][i]["name"]);
    for (const char* key : {"gain_margin_db", "phase_margin_deg", "delay_margin_s", "disk_alpha"})
      EXPECT_NEAR(read["loops"][i][key], expected["loops"][i][key], 1e-6) << key;
    EXPECT_GT(expected["loops"][i]["phase_margin_deg"], 60);
  }
  // All at once is never better than one at a time.
  EXPECT_LE(expected["multivariable"]["disk_alpha"], expected["loops"][0]["disk_alpha"]);
  // Fourteen samples later the loop is lost; the delay margin is less than ten.
  const double samples = double(expected["loops"][0]["delay_margin_s"]) / 0.01;
  EXPECT_LT(samples, 10);
  const Json late = json_of({"margins", "uquad", "--gains", out, "--delay", "0.14"});
  EXPECT_FALSE(late["loops"][0]["stable"]);
  EXPECT_TRUE(
      json_of({"margins", "uquad", "--gains", out, "--delay", "0.01"})["loops"][0]["stable"]);
}

TEST(MarginsVerb, OfLqrAreTheGuaranteed) {
  const TemporaryDirectory folder;
  const std::string A = folder.write("A", "0 1\n0 0\n").string();
  const std::string B = folder.write("B", "0\n1\n").string();
  const std::string Q = folder.write("Q", "1 0\n0 1\n").string();
  const std::string R = folder.write("R", "1\n").string();
  const Json json = json_of({"lqr", "--A", A, "--B", B, "--Q", Q, "--R", R});
  const Json& loop = json["margins"]["loops"][0];
  EXPECT_TRUE(loop["gain_margin_db"].is_null());  // infinite
  EXPECT_GE(double(loop["phase_margin_deg"]), 60);
  EXPECT_NEAR(loop["Ms"], 1, 1e-6);
}

}  // namespace
}  // namespace quadtune
