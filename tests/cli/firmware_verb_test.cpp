// SPDX-License-Identifier: Apache-2.0
// Parameters of firmware on the command line: designed, exported, verified, read back, rejected.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "run_program.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using SortedJson = nlohmann::json;
using testing::ProgramResult;
using testing::run_program;
using testing::TemporaryDirectory;

/// A cascade of the Crazyflie that every autopilot can fly.
class FirmwareVerb : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryDirectory;
    const ProgramResult made =
        run_program({"pid", vehicle(), "--structure", "p-pi", "--quiet", "-o", path("gains.json")});
    ASSERT_EQ(made.status, 0) << made.err;
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static std::string path(const std::string& name) { return (folder_->path() / name).string(); }

  static std::string vehicle() { return "crazyflie"; }

  static TemporaryDirectory* folder_;
};
TemporaryDirectory* FirmwareVerb::folder_ = nullptr;

TEST_F(FirmwareVerb, EveryFirmwareIsWrittenVerifiedAndReadBack) {
  const std::pair<const char*, const char*> files[] = {{"px4", "px4.params"},
                                                       {"ardupilot", "ardupilot.param"},
                                                       {"betaflight", "betaflight.txt"},
                                                       {"crazyflie", "crazyflie.yaml"}};
  for (const auto& [name, file] : files) {
    const std::string out = path(name);
    const ProgramResult exported = run_program(
        {"export", path("gains.json"), "--to", name, "--vehicle", vehicle(), "-o", out});
    ASSERT_EQ(exported.status, 0) << exported.err;
    EXPECT_THAT(exported.err,
                HasSubstr("margins of the cascade before and after the conversion, in a model"));
    const ProgramResult verified = run_program({"verify", out, "--vehicle", vehicle()});
    EXPECT_EQ(verified.status, 0) << verified.out;
    EXPECT_THAT(verified.out, HasSubstr("parameters fly the manifest's cascade"));
    const ProgramResult imported =
        run_program({"import", name, out + "/" + file, "--vehicle", vehicle(), "--dt", "0.005",
                     "--quiet", "-o", path(std::string(name) + ".json")});
    ASSERT_EQ(imported.status, 0) << imported.err;
    // The loops of the autopilot belong to another design.
    if (name == std::string("betaflight")) continue;
    const ProgramResult difference =
        run_program({"diff", out, path(std::string(name) + ".json"), "--json"});
    ASSERT_EQ(difference.status, 0) << difference.err;
    EXPECT_LT(SortedJson::parse(difference.out)["max_relative"].get<double>(), 1e-5) << name;
  }
}

// Of a vehicle with slow motors, a cascade that was designed without the firmware's filters.
TEST_F(FirmwareVerb, GainsWithTooSmallMarginsOnBoardAreWrittenOnlyByForce) {
  const std::string own = path("camera.toml"), gains = path("camera.json"), out = path("camera");
  ASSERT_EQ(run_program({"vehicle", "new", "camera", "--mass", "1860g", "--arm", "255mm",
                         "--propeller", "10in", "--max-thrust", "11.5N", "--quiet", "-o", own})
                .status,
            0);
  ASSERT_EQ(
      run_program({"pid", own, "--structure", "p-pi", "--Ms-max", "2.5", "--quiet", "-o", gains})
          .status,
      0);
  std::vector<std::string> words = {"export",    gains, "--to", "ardupilot",
                                    "--vehicle", own,   "-o",   out};
  const ProgramResult refused = run_program(words);
  EXPECT_EQ(refused.status, 1) << refused.err;
  EXPECT_THAT(refused.err, HasSubstr("the margins are too small to fly (pitch phase "));
  EXPECT_THAT(refused.err, HasSubstr("such as those of `quadtune pid V --for ardupilot`"));
  EXPECT_FALSE(std::filesystem::exists(out));
  words.emplace_back("--force");
  EXPECT_EQ(run_program(words).status, 0);
  std::ifstream file(out + "/manifest.json");
  EXPECT_THAT(SortedJson::parse(file)["forced"].dump(), HasSubstr("too small to fly"));
}

// A board with a slow gyroscope filter keeps it: an export of its gains has the margins of the
// import, not those with the default filter.
TEST_F(FirmwareVerb, ParametersThatTheBoardKeepsCountInTheMargins) {
  const std::string file = folder_->write("slow.params", "1\t1\tIMU_GYRO_CUTOFF\t12\t9\n").string();
  const std::string gains = path("kept.json"), out = path("kept");
  const std::string own = testing::source_folder() + "/vehicles/quad-450.toml";
  const ProgramResult imported =
      run_program({"import", "px4", file, "--vehicle", own, "-o", gains});
  ASSERT_EQ(imported.status, 0) << imported.err;
  EXPECT_THAT(imported.err,
              HasSubstr("note: the margins are too small to fly: pitch phase 2.5 deg"));
  std::vector<std::string> words = {"export", gains, "--to", "px4", "--vehicle", own, "-o", out};
  const ProgramResult refused = run_program(words);
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.err, HasSubstr("the margins are too small to fly (pitch phase 2.5 deg"));
  words.emplace_back("--force");
  const ProgramResult forced = run_program(words);
  EXPECT_EQ(forced.status, 0) << forced.err;
  EXPECT_THAT(forced.err, HasSubstr("except IMU_GYRO_CUTOFF 12, which the board keeps"));
}

// `verify` analyses the loop with sensors and estimator, so `export` does too.
TEST_F(FirmwareVerb, GainsWithAnUnstableFlownLoopAreWrittenOnlyByForce) {
  const std::string file =
      folder_->write("strong.params", "1\t1\tMC_ROLLRATE_P\t0.6\t9\n1\t1\tMC_PITCHRATE_P\t0.6\t9\n")
          .string();
  const std::string gains = path("unstable.json"), out = path("unstable");
  const std::string own = testing::source_folder() + "/vehicles/quad-450.toml";
  ASSERT_EQ(run_program({"import", "px4", file, "--vehicle", own, "-o", gains}).status, 0);
  std::vector<std::string> words = {"export", gains, "--to", "json", "--vehicle", own, "-o", out};
  const ProgramResult refused = run_program(words);
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.err, HasSubstr("the flown loop of the PID cascade is unstable"));
  EXPECT_FALSE(std::filesystem::exists(out));
  words.emplace_back("--force");
  EXPECT_EQ(run_program(words).status, 0);
}

// The design file chooses Ms for loops without the firmware's filters, whose phase is then 6 deg.
TEST_F(FirmwareVerb, DesignsWithTooSmallMarginsOnBoardAreWrittenOnlyByForce) {
  ASSERT_EQ(
      run_program({"vehicle", "new", "slow", "--mass", "1860g", "--arm", "255mm", "--propeller",
                   "10in", "--max-thrust", "11.5N", "--quiet", "-o", path("slow.toml")})
          .status,
      0);
  const std::string design = folder_
                                 ->write("slow-design.toml",
                                         "name = 'slow-loops'\nvehicle = 'slow.toml'\n"
                                         "[trim]\nat = 'hover'\n[cascade]\ndt_s = 0.005\n"
                                         "[cascade.design]\nstructure = 'p-pi'\nMs_max = 2.5\n"
                                         "[[export]]\nto = 'ardupilot'\n")
                                 .string();
  const std::string out = path("slow");
  const ProgramResult refused = run_program({"design", design, "-o", out});
  EXPECT_EQ(refused.status, 4) << refused.err;
  EXPECT_THAT(refused.err,
              HasSubstr("slow-design.toml: with the filters and the delay of ardupilot, "
                        "the margins are too small to fly (pitch phase 6.4 deg"));
  EXPECT_FALSE(std::filesystem::exists(out));
  const ProgramResult forced = run_program({"design", design, "-o", out, "--force"});
  EXPECT_EQ(forced.status, 1);
  EXPECT_THAT(forced.err, HasSubstr("WARNING: with the filters and the delay of ardupilot"));
  EXPECT_THAT(forced.err, HasSubstr("design: the margins on a firmware are too small"));
  EXPECT_THAT(forced.out, HasSubstr("verdict     fail"));
  EXPECT_EQ(run_program({"verify", out, "--vehicle", path("slow.toml")}).status, 1);
  std::ifstream file(out + "/manifest.json");
  EXPECT_THAT(SortedJson::parse(file)["forced"].dump(), HasSubstr("too small to fly"));
}

TEST_F(FirmwareVerb, AChangedParameterFailsToVerify) {
  const std::string out = path("changed");
  ASSERT_EQ(run_program({"export", path("gains.json"), "--to", "ardupilot", "--vehicle", vehicle(),
                         "-o", out})
                .status,
            0);
  std::ifstream file(out + "/ardupilot.param");
  std::string text((std::istreambuf_iterator<char>(file)), {});
  const std::size_t at = text.find("ATC_RAT_RLL_P,0.") + 17;
  ASSERT_LT(at, text.size());
  text[at] = text[at] == '5' ? '6' : '5';
  std::ofstream(out + "/ardupilot.param") << text;
  const ProgramResult verified = run_program({"verify", out, "--vehicle", vehicle()});
  EXPECT_EQ(verified.status, 1);
  EXPECT_THAT(verified.out,
              HasSubstr("FAIL parameters fly the manifest's cascade: ardupilot.param: roll"));
}

TEST_F(FirmwareVerb, DefaultsOfEachFirmwareFlyInTheSimulationAsAFileOfGains) {
  const ProgramResult imported = run_program({"import", "ardupilot", "--defaults", "--vehicle",
                                              vehicle(), "--quiet", "-o", path("defaults.json")});
  ASSERT_EQ(imported.status, 0) << imported.err;
  const ProgramResult margins =
      run_program({"margins", vehicle(), "--gains", path("defaults.json"), "--json"});
  EXPECT_EQ(margins.status, 0) << margins.err;
}

// The file of `import` and an export of parameters fly the firmware's loops, and the same ones.
TEST_F(FirmwareVerb, FlightsAreThoseOfTheFirmwaresLoops) {
  const std::string out = path("flown");
  ASSERT_EQ(run_program({"export", path("gains.json"), "--to", "crazyflie", "--vehicle", vehicle(),
                         "-o", out})
                .status,
            0);
  ASSERT_EQ(run_program({"import", "crazyflie", out + "/crazyflie.yaml", "--vehicle", vehicle(),
                         "--quiet", "-o", path("flown.json")})
                .status,
            0);
  const auto flown = [](std::vector<std::string> more) {
    std::vector<std::string> words = {"fly", vehicle(), "--mission", "step-north", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const ProgramResult result = run_program(words);
    EXPECT_EQ(result.status, 0) << result.err;
    return SortedJson::parse(result.out);
  };
  const SortedJson board = flown({"--gains", out}), file = flown({"--gains", path("flown.json")});
  EXPECT_THAT(board["law"].get<std::string>(), HasSubstr("loops of crazyflie 2026.08"));
  EXPECT_EQ(board["metrics"], file["metrics"]);
  EXPECT_EQ(board["verdict"], "pass");
  const SortedJson cascade = flown({"--gains", out, "--controller", "cascaded-pid"});
  EXPECT_THAT(cascade["law"].get<std::string>(), HasSubstr("cascaded PID"));
  EXPECT_NE(cascade["metrics"], board["metrics"]);
}

// Parameters in a file of gains are validated like those of a parameter file.
TEST_F(FirmwareVerb, ParametersInAFileOfGainsAreChecked) {
  const std::string file = path("edited.json");
  ASSERT_EQ(
      run_program({"import", "px4", "--defaults", "--vehicle", vehicle(), "--quiet", "-o", file})
          .status,
      0);
  std::ifstream stream(file);
  const SortedJson whole = SortedJson::parse(stream);
  const auto refused = [&](const char* name, double value, const char* message) {
    SortedJson edited = whole;
    edited["parameters"]["values"][name] = value;
    std::ofstream(file) << edited;
    const ProgramResult result = run_program({"fly", vehicle(), "--gains", file});
    EXPECT_EQ(result.status, 3) << result.err;
    EXPECT_THAT(result.err, HasSubstr(message));
  };
  refused("MC_ROLLRATE_P", -1, "MC_ROLLRATE_P: is -1, expected 0 or more");
  refused("IMU_GYRO_RATEMAX", 0, "IMU_GYRO_RATEMAX: is 0, expected 100 to 2000");
  refused("IMU_GYRO_CUTOFF", 0.5, "IMU_GYRO_CUTOFF: is 0.5 Hz, expected 0 or at least 1");
  refused("MC_ROLRATE_P", 0.1, "is not a parameter of the control loops of px4 1.16");
}

// The filter on the board has the parameters of the file, too.
TEST_F(FirmwareVerb, FlightsTakeTheFilesEstimator) {
  const std::string file = path("estimator.json");
  ASSERT_EQ(run_program({"import", "crazyflie", "--defaults", "--vehicle", vehicle(), "--quiet",
                         "-o", file})
                .status,
            0);
  const auto metrics = [&] {
    const ProgramResult result = run_program({"fly", vehicle(), "--gains", file, "--mission",
                                              "step-north", "--duration", "3", "--json"});
    return SortedJson::parse(result.out)["metrics"];
  };
  const SortedJson before = metrics();
  SortedJson edited = SortedJson::parse(std::ifstream(file));
  edited["estimator"]["gyroscope"]["bias_walk_rad_per_s_per_sqrt_s"] = 0.1;
  std::ofstream(file) << edited;
  EXPECT_NE(metrics(), before);
}

TEST_F(FirmwareVerb, MistakesAreToldInOneLine) {
  const auto refused = [](const std::vector<std::string>& words, int status, const char* message) {
    const ProgramResult result = run_program(words);
    EXPECT_EQ(result.status, status) << result.err;
    EXPECT_THAT(result.err, HasSubstr(message));
  };
  const std::string gains = path("gains.json"), out = path("none");
  refused({"export", gains, "--to", "px4", "-o", out, "--firmware", "1.2"}, 2,
          "px4 has no version '1.2', expected one of 1.17, 1.16, 1.15, 1.14");
  refused({"export", gains, "--to", "px4", "-o", out, "--setup", "legacy"}, 2,
          "--setup: set-up 'legacy' does not apply to px4");
  refused({"export", gains, "--to", "json", "-o", out, "--vehicle", "uquad"}, 2,
          "--vehicle is 'uquad', expected ");
  refused({"export", gains, "--to", "json", "-o", out, "--firmware", "1.15"}, 2,
          "--firmware applies to the parameters of a firmware only");
  refused({"import", "px5", "--defaults", "--vehicle", "mambo"}, 2, "no firmware 'px5'");
  refused({"import", "px4", "--vehicle", "mambo"}, 2,
          "FILE is missing, expected a file of parameters, or --defaults");
  refused({"import", "px4", "--defaults", "--vehicle", "mambo", "--dt", "2"}, 2,
          "--dt is 2 s, expected 0.0001 to 1 s");
  refused({"fly", "mambo", "--controller", "firmware"}, 2, "controller firmware requires gains");
  refused({"fly", vehicle(), "--gains", gains, "--controller", "firmware"}, 3,
          "has no parameters of an autopilot");
  refused({"pid", "mambo", "--structure", "pi"}, 2, "no structure 'pi', expected pid");
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(FirmwareVerb, GainsThatDoNotFactorAreRefusedAndNothingIsWritten) {
  ASSERT_EQ(run_program({"pid", "mambo", "--method", "loops", "--quiet", "-o", path("mambo.json")})
                .status,
            0);
  const ProgramResult refused =
      run_program({"export", path("mambo.json"), "--to", "px4", "-o", path("refused")});
  EXPECT_EQ(refused.status, 3) << refused.err;
  EXPECT_THAT(refused.err, HasSubstr("expected |Ki| <= Kp^2/(4 |Kd|)"));
  EXPECT_FALSE(std::filesystem::exists(path("refused")));
}

/// Kp² ≥ 4 |Kd| Ki in every loop.
void expect_factors(const SortedJson& loops) {
  for (const SortedJson& loop : loops) {
    const double Kp = loop["Kp"], Ki = loop["Ki"], Kd = loop["Kd"];
    EXPECT_LE(4 * std::abs(Kd * Ki), Kp * Kp * (1 + 1e-9)) << loop["name"];
  }
}

TEST_F(FirmwareVerb, GainsDesignedInTheStructureFactor) {
  const ProgramResult by_loops = run_program(
      {"pid", "mambo", "--method", "loops", "--free", "--structure", "p-pi", "--json", "--quiet"});
  ASSERT_EQ(by_loops.status, 0) << by_loops.err;
  expect_factors(SortedJson::parse(by_loops.out)["loops"]);
  std::ifstream file(path("gains.json"));
  expect_factors(SortedJson::parse(file)["loops"]);
}

}  // namespace
}  // namespace quadtune
