// SPDX-License-Identifier: Apache-2.0
/// quadtune design with covariances from a tuning: from the log to the files and the flight.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "run_program.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::DoubleNear;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Pointwise;
using testing::ProgramResult;
using testing::run_program;
using testing::TemporaryDirectory;

class TunedDesign : public ::testing::Test {
 protected:
  /// The Mambo's design whose altitude filter takes its noise from that file.
  std::string design_with(const std::string& tuned, const std::string& more = "") const {
    std::ifstream file(testing::source_folder() + "/designs/mambo-hover.toml");
    std::stringstream text;
    text << file.rdbuf();
    std::string design = text.str();
    const std::size_t begin = design.find("Q = [5e-4]"), end = design.find("\n\n", begin);
    design.replace(begin, end - begin, "tuned = \"" + tuned + "\"" + more);
    return folder_.write("design.toml", design).string();
  }

  /// A tuned altitude model of that variance and verdict.
  void write_tuned(double density, const std::string& verdict) const {
    std::ifstream file(testing::source_folder() + "/filters/altitude.toml");
    std::stringstream text;
    text << file.rdbuf();
    std::string model = text.str();
    const std::string start = "variance = 0.1";
    model.replace(model.find(start), start.size(), fmt::format("variance = {}", density));
    model.insert(model.find("states ="), "verdict = \"" + verdict + "\"\n");
    (void)folder_.write("tuned.toml", model);
  }

  /// The uquad's design with an estimator of that model, and a mission that it flies.
  std::string uquad_with(const std::string& tuned) const {
    std::ifstream file(testing::source_folder() + "/designs/uquad-hover.toml");
    std::stringstream text;
    text << file.rdbuf();
    text << "\n[estimator]\ntuned = \"" << tuned
         << "\"\n\n[[mission]]\nname = \"take-off-and-land\"\nestimator = \"uquad\"\n";
    return folder_.write("uquad-design.toml", text.str()).string();
  }

  /// A tuned model of its filter, of that density of the rates.
  void write_uquad(double density, const std::string& more = "verdict = \"pass\"\n") const {
    std::ifstream file(testing::source_folder() + "/filters/uquad.toml");
    std::stringstream text;
    text << file.rdbuf();
    std::string model = text.str();
    const std::string start = "variance = 1\n";
    model.replace(model.find(start), start.size(), fmt::format("variance = {}\n", density));
    model.insert(model.find("dynamics ="), more);
    (void)folder_.write("uquad.toml", model);
  }

  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  TemporaryDirectory folder_;
};

// All steps: a log, its tuned model, a design, the files that the flight program reads.
TEST_F(TunedDesign, WritesWhatTheLogSaid) {
  const ProgramResult tuning = run_program({"tune", "kalman", "--model", "altitude", "--log",
                                            testing::source_folder() + "/docs/examples/bobbing.csv",
                                            "-o", path("tuned.toml"), "--json"});
  ASSERT_EQ(tuning.status, 0) << tuning.err;
  const double density = Json::parse(tuning.out)["Q"][0][0];
  const double R = Json::parse(tuning.out)["R"]["sonar"][0][0];
  const ProgramResult result =
      run_program({"design", design_with("tuned.toml"), "-o", path("out")});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("noise from tuned.toml, verdict pass"));
  std::string file = folder_.read("out/estimatorVars.m");
  EXPECT_THAT(file, HasSubstr("Q and R were estimated from logs: tuned.toml, verdict pass."));
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
  EXPECT_THAT(
      refused.err,
      HasSubstr(
          "the verdict on tuned.toml of filter altitude is 'fail'; use --force to accept it"));
  EXPECT_FALSE(std::filesystem::exists(path("out")));
  const ProgramResult exported =
      run_program({"export", design, "--to", "mambo", "-o", path("out")});
  EXPECT_EQ(exported.status, 1);
  EXPECT_FALSE(std::filesystem::exists(path("out")));
  const ProgramResult forced = run_program({"design", design, "-o", path("out"), "--force"});
  EXPECT_EQ(forced.status, 0) << forced.err;
  EXPECT_THAT(forced.err, HasSubstr("design: warning: the verdict on tuned.toml"));
  EXPECT_THAT(folder_.read("out/estimatorVars.m"), HasSubstr("verdict fail"));
  const ProgramResult verified = run_program({"verify", path("out")});
  EXPECT_EQ(verified.status, 1);
  EXPECT_THAT(verified.out, HasSubstr("FAIL the design meets its requirements: written with "
                                      "--force although the verdict on tuned.toml"));
  std::filesystem::remove_all(path("out"));
  EXPECT_EQ(run_program({"export", design, "--to", "mambo", "-o", path("out"), "--force"}).status,
            0);
  EXPECT_THAT(folder_.read("out/manifest.json"), HasSubstr("\"forced\""));
}

// The simulated estimator uses the covariances as well, so the flight differs.
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
  EXPECT_THAT(both.err,
              HasSubstr("R and tuned are both in [[kalman]] 1, expected only one of them"));
  const ProgramResult missing = run_program({"design", design_with("nowhere.toml")});
  EXPECT_EQ(missing.status, 5);
  EXPECT_THAT(missing.err, HasSubstr("nowhere.toml"));
}

TEST_F(TunedDesign, WritesTheUquadsDiagonals) {
  write_uquad(2);
  const ProgramResult result =
      run_program({"design", uquad_with("uquad.toml"), "-o", path("out"), "--force"});
  ASSERT_LE(result.status, 1) << result.err;
  EXPECT_THAT(result.out, HasSubstr("uquad, noise from uquad.toml, verdict pass"));
  const auto numbers = [&](const std::string& name) {
    std::istringstream text(folder_.read("out/" + name));
    return std::vector<double>(std::istream_iterator<double>(text), {});
  };
  // Densities of filters/uquad.toml times 10 ms; the position has no process noise of its own.
  EXPECT_THAT(
      numbers("kalman-Q.txt"),
      Pointwise(DoubleNear(1e-15), std::vector<double>{0., 0., 0., 1e-8, 1e-8, 1e-8, 1e-4, 1e-4,
                                                       1e-4, 0.02, 0.02, 0.02, 1e-7, 1e-7, 1e-7}));
  EXPECT_THAT(
      numbers("kalman-R.txt"),
      Pointwise(DoubleNear(1e-15), std::vector<double>{0.25, 0.25, 0.05, 0.1, 0.1, 0.1, 4e-4, 4e-4,
                                                       4e-4, 0.25, 1., 1., 1., 0.1, 0.1, 0.1}));
  EXPECT_THAT(folder_.read("out/manifest.json"), HasSubstr("uquad.toml"));
  // The diagonals are right; the failed mission was known when --force was given.
  const ProgramResult verified = run_program({"verify", path("out")});
  EXPECT_EQ(verified.status, 1);
  const std::size_t fail = verified.out.find("FAIL ");
  EXPECT_EQ(verified.out.substr(fail, verified.out.find('\n', fail) - fail),
            "FAIL the design meets its requirements: written with --force although a mission "
            "failed");
  EXPECT_EQ(verified.out.rfind("FAIL "), fail) << verified.out;
}

TEST_F(TunedDesign, FliesTheUquadsFilterWithThem) {
  const auto flown = [&](double density) {
    write_uquad(density);
    const ProgramResult result = run_program({"design", uquad_with("uquad.toml"), "--json"});
    EXPECT_LE(result.status, 1) << result.err;
    return Json::parse(result.out);
  };
  const Json usual = flown(1), again = flown(1), trusting = flown(30);
  EXPECT_EQ(usual["estimator"]["verdict"], "pass");
  EXPECT_EQ(usual["missions"][0]["estimator"], "uquad");
  EXPECT_EQ(usual["missions"][0]["final_estimate"], again["missions"][0]["final_estimate"]);
  EXPECT_NE(usual["missions"][0]["final_estimate"], trusting["missions"][0]["final_estimate"]);
}

TEST_F(TunedDesign, RefusesEstimatorsThatDoNotFit) {
  write_uquad(1, "verdict = \"fail\"\n");
  const ProgramResult failed = run_program({"design", uquad_with("uquad.toml"), "-o", path("out")});
  EXPECT_EQ(failed.status, 1);
  EXPECT_THAT(failed.err, HasSubstr("the verdict on uquad.toml of the estimator is 'fail'"));
  EXPECT_FALSE(std::filesystem::exists(path("out")));
  write_tuned(0.1, "pass");
  const ProgramResult linear = run_program({"design", uquad_with("tuned.toml")});
  EXPECT_EQ(linear.status, 3);
  EXPECT_THAT(linear.err, HasSubstr("the tuned model 'altitude' is not a model of the uquad's "
                                    "filter, expected dynamics = \"rigid-body\""));
  std::ifstream file(testing::source_folder() + "/filters/uquad.toml");
  std::stringstream text;
  text << file.rdbuf();
  std::string model = text.str();
  const std::string vehicle = "vehicle = \"uquad\"";
  (void)folder_.write("other.toml", std::string(model).replace(model.find(vehicle), vehicle.size(),
                                                               "vehicle = \"crazyflie\""));
  const ProgramResult other = run_program({"design", uquad_with("other.toml")});
  EXPECT_EQ(other.status, 3);
  EXPECT_THAT(other.err, HasSubstr("is for the vehicle 'crazyflie', expected 'uquad'"));
  const std::string shared = "[[sensors.R]]\nkind = \"shared\"\nparameter = \"R.rates\"";
  ASSERT_NE(model.find(shared), std::string::npos);
  (void)folder_.write("axes.toml", model.replace(model.find(shared), shared.size(),
                                                 "[[sensors.R]]\nkind = \"fixed\"\nentries = "
                                                 "[\"p\"]\nvariance = 1\n\n" +
                                                     shared));
  const ProgramResult axes = run_program({"design", uquad_with("axes.toml")});
  EXPECT_EQ(axes.status, 3);
  EXPECT_THAT(axes.err, HasSubstr("has different variances of 'rates' on its axes"));
}

}  // namespace
}  // namespace quadtune
