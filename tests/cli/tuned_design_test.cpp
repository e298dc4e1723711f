// SPDX-License-Identifier: Apache-2.0
/// quadtune design with covariances from a tuning: from the log to the files and the flight.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "quadtune/internal/json.hpp"
#include "run_program.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using internal::Json;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::ProgramResult;
using testing::run_program;
using testing::TemporaryDirectory;

const std::string kSource = QUADTUNE_SOURCE_DIR;

class TunedDesign : public ::testing::Test {
 protected:
  /// The Mambo's design whose altitude filter takes its noise from that file.
  std::string design_with(const std::string& tuned, const std::string& more = "") const {
    std::ifstream file(kSource + "/designs/mambo-hover.toml");
    std::stringstream text;
    text << file.rdbuf();
    std::string design = text.str();
    const std::size_t begin = design.find("Q = [5e-4]"), end = design.find("\n\n", begin);
    design.replace(begin, end - begin, "tuned = \"" + tuned + "\"" + more);
    return folder_.write("design.toml", design).string();
  }

  /// A tuned altitude model of that variance and verdict.
  void write_tuned(double density, const std::string& verdict) const {
    std::ifstream file(kSource + "/filters/altitude.toml");
    std::stringstream text;
    text << file.rdbuf();
    std::string model = text.str();
    const std::string start = "variance = 0.1";
    model.replace(model.find(start), start.size(), fmt::format("variance = {}", density));
    model.insert(model.find("states ="), "verdict = \"" + verdict + "\"\n");
    (void)folder_.write("tuned.toml", model);
  }

  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  TemporaryDirectory folder_;
};

// The whole way: a log, its tuned model, a design, what the flight program reads.
TEST_F(TunedDesign, WritesWhatTheLogSaid) {
  const ProgramResult tuning =
      run_program({"tune", "kalman", "--model", "altitude", "--log",
                   kSource + "/docs/examples/bobbing.csv", "-o", path("tuned.toml"), "--json"});
  ASSERT_EQ(tuning.status, 0) << tuning.err;
  const double density = Json::parse(tuning.out)["Q"][0][0];
  const double R = Json::parse(tuning.out)["R"]["sonar"][0][0];
  const ProgramResult result =
      run_program({"design", design_with("tuned.toml"), "-o", path("out")});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("noise of tuned.toml, verdict pass"));
  std::string file = folder_.read("out/estimatorVars.m");
  EXPECT_THAT(file, HasSubstr("Q and R were found in logs: tuned.toml, verdict pass."));
  const auto number_after = [&](const std::string& name) {
    return std::stod(file.substr(file.find(name) + name.size()));
  };
  EXPECT_NEAR(number_after("Estimator.alt.kf.Q = ["), density * 0.005, 1e-12);
  EXPECT_NEAR(number_after("Estimator.alt.kf.R = ["), R, 1e-12);
  EXPECT_THAT(folder_.read("out/manifest.json"), HasSubstr("tuned.toml"));
}

TEST_F(TunedDesign, RefusesATuningThatFailed) {
  write_tuned(0.2, "fail");
  const std::string design = design_with("tuned.toml");
  const ProgramResult refused = run_program({"design", design, "-o", path("out")});
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.err, HasSubstr("the verdict on tuned.toml of filter altitude is 'fail'; "
                                     "quadtune design --force takes it all the same"));
  EXPECT_FALSE(std::filesystem::exists(path("out")));
  const ProgramResult exported =
      run_program({"export", design, "--to", "mambo", "-o", path("out")});
  EXPECT_EQ(exported.status, 1);
  EXPECT_FALSE(std::filesystem::exists(path("out")));
  const ProgramResult forced = run_program({"design", design, "-o", path("out"), "--force"});
  EXPECT_EQ(forced.status, 0) << forced.err;
  EXPECT_THAT(forced.err, HasSubstr("design: warning: the verdict on tuned.toml"));
  EXPECT_THAT(folder_.read("out/estimatorVars.m"), HasSubstr("verdict fail"));
}

// The simulated estimator has the covariances as well: another flight comes out.
TEST_F(TunedDesign, FliesWithThem) {
  const auto flown = [&](double density) {
    write_tuned(density, "pass");
    const ProgramResult result = run_program({"design", design_with("tuned.toml"), "--json"});
    EXPECT_LE(result.status, 1) << result.err;
    return Json::parse(result.out)["missions"];
  };
  const Json usual = flown(0.1), again = flown(0.1), trusting = flown(20);
  EXPECT_EQ(usual[0]["estimator"], "mambo");
  EXPECT_EQ(usual[0]["final_estimate"], again[0]["final_estimate"]);
  EXPECT_NE(usual[0]["final_estimate"], trusting[0]["final_estimate"]);
}

TEST_F(TunedDesign, RefusesWhatDoesNotFit) {
  write_tuned(0.1, "pass");
  const ProgramResult both = run_program({"design", design_with("tuned.toml", "\nR = [1]")});
  EXPECT_EQ(both.status, 3);
  EXPECT_THAT(both.err, HasSubstr("R stands beside tuned in [[kalman]] 1, expected one of them"));
  const ProgramResult missing = run_program({"design", design_with("nowhere.toml")});
  EXPECT_EQ(missing.status, 5);
  EXPECT_THAT(missing.err, HasSubstr("nowhere.toml"));
}

}  // namespace
}  // namespace quadtune
