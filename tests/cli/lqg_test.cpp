// SPDX-License-Identifier: Apache-2.0
/// `lqg V`: state feedback with its filter.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "run_json.hpp"
#include "run_program.hpp"
#include "sanitized.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using SortedJson = nlohmann::json;
using ::testing::HasSubstr;
using testing::ProgramResult;
using testing::run_json;
using testing::run_program;
using testing::TemporaryDirectory;

TEST(Lqg, IsTheLawOfLqrWithWhatTheSensorsMakeOfIt) {
  const SortedJson lqr = run_json({"lqr", "crazyflie"}), lqg = run_json({"lqg", "crazyflie"});
  for (const char* key : {"K", "K_int", "memory", "margins", "estimator", "gains"})
    EXPECT_EQ(lqg[key], lqr[key]) << key;
  const SortedJson& rms = lqg["predicted_rms"];
  EXPECT_EQ(rms["time_s"], 60);
  for (const char* state :
       {"px", "py", "pz", "roll", "pitch", "yaw", "u", "v", "w", "p", "q", "r"}) {
    EXPECT_GT(rms["state"][state], 0) << state;
    EXPECT_GT(rms["estimate_error"][state], 0) << state;
  }
  // Optical flow does not observe the position; the height is observed.
  EXPECT_GT(rms["state"]["px"], 3 * rms["state"]["pz"].get<double>());
  EXPECT_FALSE(lqg["margins_at_estimates"]["loops"].empty());
  for (const SortedJson& loop : lqg["margins_at_estimates"]["loops"]) EXPECT_TRUE(loop["stable"]);
  EXPECT_EQ(lqg["recovery"]["factor"], 1);
}

TEST(Lqg, DriftsGrowWithTheTimeAndTheOthersDoNot) {
  if (testing::kSanitized) GTEST_SKIP() << "minutes of what other tests run too";
  const SortedJson first = run_json({"lqg", "mambo", "--time", "60"})["predicted_rms"]["state"];
  const SortedJson later = run_json({"lqg", "mambo", "--time", "240"})["predicted_rms"]["state"];
  EXPECT_GT(later["px"], 1.2 * first["px"].get<double>());
  EXPECT_GT(later["yaw"], 1.5 * first["yaw"].get<double>());
  EXPECT_NEAR(later["roll"].get<double>() / first["roll"].get<double>(), 1, 0.02);
  EXPECT_NEAR(later["p"].get<double>() / first["p"].get<double>(), 1, 0.02);
}

TEST(Lqg, RecoveryStaysWithinItsBudget) {
  if (testing::kSanitized) GTEST_SKIP() << "minutes of what other tests run too";
  const TemporaryDirectory folder;
  const SortedJson found = run_json({"lqg", "mambo", "--recover", "--noise-budget", "1.2"});
  const SortedJson& tried = found["recovery"]["tried"];
  ASSERT_EQ(tried.size(), 7u);
  const double factor = found["recovery"]["factor"];
  double chosen = 0, usual = tried[0]["share_of_margins"];
  for (const SortedJson& one : tried) {
    EXPECT_EQ(one["affordable"], one["command_noise"] <= 1.2);
    if (one["factor"] == factor) chosen = one["share_of_margins"];
  }
  for (const SortedJson& one : tried) {
    if (!one["affordable"]) continue;
    EXPECT_LE(one["share_of_margins"], 1.001 * chosen);
  }
  EXPECT_GE(chosen, usual);
}

/// The selected filter is the one in the file, and the one that flies.
TEST(Lqg, TheFileFliesWithTheRecoveredFilter) {
  if (testing::kSanitized) GTEST_SKIP() << "minutes of what other tests run too";
  const TemporaryDirectory folder;
  const std::string file = (folder.path() / "g.json").string();
  const ProgramResult made = run_program(
      {"lqg", "mambo", "--recover", "--noise-budget", "100", "--json", "--quiet", "-o", file});
  ASSERT_EQ(made.status, 0) << made.err;
  std::ifstream in(file);
  const SortedJson found = SortedJson::parse(in);
  const SortedJson usual = run_json({"lqr", "mambo"});
  const double factor = found["recovery"]["factor"];
  const auto density = [](const SortedJson& of) {
    return of["estimator"]["accelerometer"]["density_m_per_s2_per_sqrt_Hz"][0].get<double>();
  };
  EXPECT_NEAR(density(found), factor * density(usual), 1e-12 * density(found));
  // An export of the file contains the filter, and verify analyses the loop with it.
  const std::string out = (folder.path() / "out").string();
  ASSERT_EQ(run_program({"export", file, "--to", "json", "-o", out}).status, 0);
  std::ifstream exported(out + "/gains.json");
  EXPECT_EQ(SortedJson::parse(exported)["estimator"], found["estimator"]);
  EXPECT_EQ(run_program({"verify", out}).status, 0);
  const SortedJson margins = run_json({"margins", "mambo", "--gains", file});
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(margins["loops"][i]["phase_margin_deg"].get<double>(),
                found["margins"]["loops"][i]["phase_margin_deg"].get<double>(), 1e-6);
}

TEST(Lqg, RefusesWhatItCannotDo) {
  const auto refused = [](std::vector<std::string> args, const char* message) {
    args.insert(args.begin(), "lqg");
    const ProgramResult result = run_program(args);
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_EQ(result.out, "");
  };
  refused({}, "quadtune lqg: expected a built-in vehicle");
  // Weights through which a state is not observable are an error of --Q, as for lqr.
  const ProgramResult unseen = run_program({"lqg", "crazyflie", "--Q", "0", "--json"});
  EXPECT_EQ(unseen.status, 4);
  EXPECT_EQ(SortedJson::parse(unseen.out)["error"]["where"], "--Q");
  refused({"mambo", "--time", "0"}, "--time is 0, expected a positive number of seconds");
  refused({"mambo", "--noise-budget", "2"}, "--noise-budget requires --recover");
  refused({"mambo", "--recover", "--noise-budget", "0.5"},
          "noise-budget is 0.5, expected a number of at least 1");
  refused({"mambo", "--recover", "--sensors", "ideal"},
          "expected the general filter and real sensors");
  refused({"mambo", "--recover", "--estimator", "truth"}, "expected the general filter");
  refused({"mambo", "--time", "1e300"}, "--time is 1e+300, expected at most 1e+06 s");
  refused({"mambo", "--dt", "0.0005"},
          "quadtune lqg: --dt is too short for the estimator: gyroscope.lag");
  refused({"mambo", "--height", "0"}, "--height is 0, expected a positive number of metres");
}

}  // namespace
}  // namespace quadtune
