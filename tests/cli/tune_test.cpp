// SPDX-License-Identifier: Apache-2.0
/// quadtune tune kalman.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "golden.hpp"
#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/simulation/random.hpp"
#include "run_program.hpp"
#include "shared_data.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::ProgramResult;
using testing::run_program;
using testing::TemporaryDirectory;

/// A vehicle that moves up and down, logged at 50 Hz with a sonar of 25 Hz: acceleration noise
/// density 0.01 m²/s³, variance of the echoes 4e-4 m².
std::string bobbing(int rows, double smoothing = 0) {
  constexpr double dt = 0.02;
  const RandomSource<1> source{2026, {0}};
  std::string text = "t_s,az[m/s^2],height[m]\n";
  double z = -1, vz = 0, kept = 1;
  for (int k = 0; k < rows; ++k) {
    const double t = k * dt;
    const auto noise = random_normal(source, 0, static_cast<std::uint64_t>(k));
    const double a = 2 * std::sin(3 * t) + std::sin(7 * t);
    const double echo = -z + 0.02 * lane(noise.second, 0);
    kept = smoothing * kept + (1 - smoothing) * echo;
    text += fmt::format("{:.2f},{:.4f},", t, a + std::sqrt(0.01 / dt) * lane(noise.first, 0));
    text += k % 2 == 0 ? fmt::format("{:.4f}\n", kept) : "\n";
    z += vz * dt + 0.5 * a * dt * dt;
    vz += a * dt;
  }
  return text;
}

const std::vector<std::string> kTune = {"tune", "kalman", "--model", "altitude", "--log"};

ProgramResult tune(const std::string& file, const std::vector<std::string>& more = {}) {
  std::vector<std::string> args = kTune;
  args.push_back(file);
  args.insert(args.end(), more.begin(), more.end());
  return run_program(args);
}

// This writes the example of the documentation.
TEST(TuneVerb, ItsExampleIsMadeHere) {
  EXPECT_TRUE(testing::matches_document("docs/examples/bobbing.csv", bobbing(2000)));
}

TEST(TuneVerb, FindsWhatMadeTheLog) {
  const TemporaryDirectory folder;
  const std::string file = folder.write("bobbing.csv", bobbing(6000)).string();
  const std::string tuned = (folder.path() / "tuned.toml").string();
  const ProgramResult result = tune(file, {"--json", "-o", tuned});
  ASSERT_EQ(result.status, 0) << result.err << result.out;
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json["status"], "converged");
  EXPECT_EQ(json["gate"]["verdict"], "pass");
  const Json& Q = json["parameters"][0];
  EXPECT_EQ(Q["name"], "Q.az");
  EXPECT_LT(double(Q["low"]), 0.01);
  EXPECT_GT(double(Q["high"]), 0.01);
  EXPECT_NEAR(double(json["Q"][0][0]), double(Q["value"]), 1e-12);
  EXPECT_NEAR(double(json["R"]["sonar"][0][0]), 4e-4, 5e-5);
  EXPECT_LT(double(json["standard_errors"]["R.sonar"]), 0.1);
  EXPECT_EQ(json["identifiable"], Json::parse("[true, true]"));
  EXPECT_GT(double(json["log_likelihood"]["after"]), double(json["log_likelihood"]["before"]));
  EXPECT_GT(double(json["holdout"]["after"]), double(json["holdout"]["before"]));
  EXPECT_LT(double(json["nis"]["before"][0]["value"]), 0.5);
  EXPECT_NEAR(double(json["nis"]["after"][0]["value"]), 1, 0.02);
  EXPECT_EQ(json["whiteness"][0]["verdict"], "pass");
  // The file is a valid model and states its origin.
  const FilterModel model = load_filter_model(tuned);
  EXPECT_NEAR(model.parameters[0].start, double(Q["value"]), 1e-12);
  std::stringstream text;
  text << std::ifstream(tuned).rdbuf();
  EXPECT_THAT(text.str(), HasSubstr("# verdict: pass"));
  EXPECT_THAT(text.str(),
              HasSubstr("sha256 " + std::string(json["logs"][0]["files"][0]["sha256"])));
  const ProgramResult again =
      run_program({"tune", "kalman", "--model", tuned, "--log", file, "--json", "--starts", "1"});
  EXPECT_NEAR(double(Json::parse(again.out)["Q"][0][0]), double(Q["value"]),
              1e-6 * double(Q["value"]));
}

// The second method, with measurements at every second instant and inputs in between.
TEST(TuneVerb, FindsItByAutocovariancesToo) {
  const TemporaryDirectory folder;
  const std::string file = folder.write("bobbing.csv", bobbing(6000)).string();
  const ProgramResult als = tune(file, {"--method", "als", "--json"});
  ASSERT_EQ(als.status, 0) << als.err << als.out;
  const Json json = Json::parse(als.out);
  EXPECT_EQ(json["method"], "als");
  EXPECT_EQ(json["status"], "converged");
  EXPECT_EQ(json["gate"]["verdict"], "pass");
  EXPECT_NEAR(double(json["autocovariances"]["dt"]), 0.04, 1e-9);
  EXPECT_GT(double(json["autocovariances"]["samples"]), 2000);
  EXPECT_GT(double(json["autocovariances"]["misfit"]), 1);
  const ProgramResult ml = tune(file, {"--method", "ml", "--json"});
  const Json likely = Json::parse(ml.out);
  EXPECT_EQ(likely["method"], "ml");
  EXPECT_FALSE(likely.contains("autocovariances"));
  for (const std::size_t i : {0u, 1u}) {
    const std::string name = json["parameters"][i]["name"];
    EXPECT_LT(double(json["parameters"][i]["low"]), double(likely["parameters"][i]["value"]));
    EXPECT_GT(double(json["parameters"][i]["high"]), double(likely["parameters"][i]["value"]));
    EXPECT_NEAR(double(json["standard_errors"][name]) / double(likely["standard_errors"][name]), 1,
                0.25);
  }
  EXPECT_LE(double(json["log_likelihood"]["after"]), double(likely["log_likelihood"]["after"]));
  const ProgramResult text = tune(file, {"--method", "als"});
  EXPECT_THAT(text.out, HasSubstr("fit         solved by autocovariances: "));
  EXPECT_THAT(text.out, HasSubstr("samples every 0.04 s, lags to 22, "));
}

TEST(TuneVerb, SaysWhyAutocovariancesCannotTellALog) {
  const TemporaryDirectory folder;
  // Some echoes are missing.
  std::string text = bobbing(1500);
  std::size_t at = text.find('\n') + 1;
  for (int row = 0; row < 1500; ++row) {
    const std::size_t end = text.find('\n', at);
    if (row % 40 == 0) text.erase(text.rfind(',', end) + 1, end - text.rfind(',', end) - 1);
    at = text.find('\n', at) + 1;
  }
  const ProgramResult result = tune(folder.write("torn.csv", text).string(), {"--method", "als"});
  EXPECT_EQ(result.status, 4);
  EXPECT_EQ(result.out, "");
  EXPECT_THAT(result.err, HasSubstr("tune kalman: autocovariances require at least 30 successive "
                                    "samples with a constant sample time"));
}

// An on-board filter's output is not a measurement.
TEST(TuneVerb, DoesNotBelieveAFilteredLog) {
  const TemporaryDirectory folder;
  const std::string file = folder.write("filtered.csv", bobbing(3000, 0.9)).string();
  const std::string tuned = (folder.path() / "tuned.toml").string();
  const ProgramResult result = tune(file, {"-o", tuned});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, HasSubstr("tune kalman: sonar: height: innovations are not white"));
  EXPECT_THAT(result.out, HasSubstr("verdict     fail"));
  EXPECT_FALSE(std::filesystem::exists(tuned));
  const ProgramResult forced = tune(file, {"-o", tuned, "--force"});
  EXPECT_EQ(forced.status, 1);
  std::stringstream text;
  text << std::ifstream(tuned).rdbuf();
  EXPECT_THAT(text.str(), HasSubstr("# verdict: fail"));
}

TEST(TuneVerb, MapsFixesAndStarts) {
  const TemporaryDirectory folder;
  std::string renamed = bobbing(3000);
  renamed.replace(0, renamed.find('\n'), "t_s,acc,range");
  const std::string file = folder.write("renamed.csv", renamed).string();
  const ProgramResult result = tune(file, {"--map", "az=acc", "--map", "height=range", "--fix",
                                           "R.sonar", "--start", "R.sonar=0.0004", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json["parameters"][1]["verdict"], "fixed");
  EXPECT_NEAR(double(json["parameters"][1]["value"]), 0.0004, 1e-15);
}

// A signal without --map is read from the channel of the same name.
TEST(TuneVerb, MapsOneOfSeveral) {
  const TemporaryDirectory folder;
  std::string renamed = bobbing(1000);
  renamed.replace(0, renamed.find('\n'), "t_s,acc,height");
  const std::string file = folder.write("renamed.csv", renamed).string();
  const ProgramResult result = tune(file, {"--map", "az=acc", "--json"});
  ASSERT_NE(result.out, "") << result.err;
  EXPECT_EQ(Json::parse(result.out)["logs"][0]["samples"], 1000);
}

TEST(TuneVerb, RefusesInOneLine) {
  const TemporaryDirectory folder;
  const std::string file = folder.write("b.csv", bobbing(300)).string();
  const auto refused = [&](const std::vector<std::string>& args, int status,
                           const std::string& message) {
    const ProgramResult result = run_program(args);
    EXPECT_EQ(result.status, status) << result.out;
    EXPECT_EQ(result.out, "");
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  };
  refused({"tune", "kalmn", "--model", "altitude", "--log", file}, 2,
          "quadtune tune: 'kalmn' is unknown, expected kalman, pid or lqr; did you mean 'kalman'?");
  refused({"tune", "kalman", "--log", file}, 2, "--model is missing");
  refused({"tune", "kalman", "--model", "altitude"}, 2, "--log is missing");
  refused({"tune", "kalman", "--model", "altitude", "--log", "-"}, 2,
          "--log is -, expected a file");
  refused({"tune", "kalman", "--model", "attitud", "--log", file}, 3, "did you mean 'attitude'?");
  refused({"tune", "kalman", "--model", "altitude", "--log", file, "--map", "height"}, 2,
          "--map is 'height', expected NAME=CHANNEL");
  refused({"tune", "kalman", "--model", "altitude", "--log", file, "--map", "az=az", "--map",
           "height=heigth"},
          3, "did you mean 'height'?");
  refused({"tune", "kalman", "--model", "altitude", "--log", file, "--map", "hight=height"}, 2,
          "--map: the model 'altitude' has no input or measurement 'hight', expected az or height");
  refused(
      {"tune", "kalman", "--model", "altitude", "--log", file, "--method", "als", "--student", "4"},
      2, "--student cannot be combined with --method als");
  refused({"tune", "kalman", "--model", "attitude", "--log", file, "--map", "tilt=az"}, 3,
          "has no channel 'rate'");
  refused({"tune", "kalman", "--model", "altitude", "--log", file, "--fix", "R.sona"}, 2,
          "--fix: no parameter 'R.sona', expected one of Q.az, R.sonar; did you mean 'R.sonar'?");
  refused({"tune", "kalman", "--model", "altitude", "--log", file, "--start", "R.sonar=-1"}, 2,
          "the start of 'R.sonar' is -1, expected a positive number");
  refused({"tune", "kalman", "--model", "altitude", "--log", file, "--method", "mle"}, 2,
          "--method is 'mle', expected ml or als");
  refused({"tune", "kalman", "--model", "altitude", "--log", "no.csv"}, 5, "no.csv");
  refused({"tune", "kalman", "--model", "altitude", "--log", file, "--holdout", "1"}, 2,
          "--holdout is 1, expected 0 to 0.9");
}

// A name cannot break out of the comment that it is written in.
/// The columns of a log, in a file of their own: those named, and the time.
std::string columns_of(const std::string& log, const std::vector<std::size_t>& columns) {
  std::stringstream lines(log);
  std::string line, text;
  while (std::getline(lines, line)) {
    std::vector<std::string> words(1);
    for (const char c : line)
      if (c == ',')
        words.emplace_back();
      else
        words.back() += c;
    std::string row;
    for (const std::size_t i : columns) row += (row.empty() ? "" : ",") + words[i];
    if (row.back() != ',') text += row + "\n";
  }
  return text;
}

TEST(TuneVerb, TakesChannelsOfAnotherLogOfTheFlight) {
  const TemporaryDirectory folder;
  const std::string log = bobbing(2000);
  const std::string whole = folder.write("whole.csv", log);
  const std::string imu = folder.write("imu.csv", columns_of(log, {0, 1}));
  const std::string sonar = folder.write("sonar.csv", columns_of(log, {0, 2}));
  const Json expected = Json::parse(tune(whole, {"--json"}).out);
  const ProgramResult result =
      tune(imu, {"--json", "--map", "az=az", "--map", "height=height@" + sonar});
  ASSERT_EQ(result.status, 0) << result.err;
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json["parameters"], expected["parameters"]);
  EXPECT_EQ(json["logs"][0]["files"][1]["file"], sonar);
}

// The same log with the times of a clock that states no unit: nanoseconds since 1970 give the same
// numbers and a warning, microseconds from the start are refused.
TEST(TuneVerb, SaysWhatItTakesAClockFor) {
  const TemporaryDirectory folder;
  const std::string log = bobbing(1000);
  const auto clocked = [&](std::int64_t first, std::int64_t tick) {
    std::istringstream lines(log);
    std::string line, text;
    std::getline(lines, line);
    text = "#timestamp,az[m/s^2],height[m]\n";
    for (std::int64_t k = 0; std::getline(lines, line); ++k)
      text += fmt::format("{}{}\n", first + 20 * tick * k, line.substr(line.find(',')));
    return text;
  };
  const Json expected = Json::parse(tune(folder.write("s.csv", log), {"--json"}).out);
  EXPECT_TRUE(expected["logs"][0]["warnings"].empty());
  const std::string ns = folder.write("ns.csv", clocked(1403636579758555392, 1000000));
  const std::string tuned = (folder.path() / "tuned.toml").string();
  const ProgramResult result = tune(ns, {"--json", "-o", tuned, "--force"});
  const Json json = Json::parse(result.out);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_NEAR(json["parameters"][i]["value"].get<double>(),
                expected["parameters"][i]["value"].get<double>(),
                1e-6 * expected["parameters"][i]["value"].get<double>());
  const std::string said = "states no unit and is taken as nanoseconds since 1970";
  EXPECT_THAT(json["logs"][0]["warnings"][0].get<std::string>(), HasSubstr(said));
  EXPECT_THAT(result.err,
              HasSubstr("tune kalman: warning: " + ns + ": the clock 'timestamp' " + said));
  EXPECT_THAT(folder.read("tuned.toml"), HasSubstr(said));
  const std::string us = folder.write("us.csv", clocked(0, 1000));
  const ProgramResult refused = tune(us);
  EXPECT_EQ(refused.status, 3);
  EXPECT_THAT(refused.err, HasSubstr(us + ": the clock 'timestamp' states no unit, and in seconds "
                                          "its samples would be 20000 s apart"));
  EXPECT_EQ(tune(us, {"--columns", "t_us:timestamp, *", "--quiet"}).err, "");
}

TEST(TuneVerb, SaysHowAChannelOfAnotherFileIsCalled) {
  const TemporaryDirectory folder;
  const std::string imu = folder.write("imu.csv", columns_of(bobbing(100), {0, 1}));
  const ProgramResult result = tune(imu);
  EXPECT_EQ(result.status, 3);
  EXPECT_THAT(result.err, HasSubstr("has no channel 'height'"));
  EXPECT_THAT(result.err,
              HasSubstr("--map NAME=CHANNEL selects another channel, and CHANNEL@FILE one of"));
}

TEST(TuneVerb, RefusesOutliers) {
  const TemporaryDirectory folder;
  std::stringstream lines(bobbing(2000));
  std::string line, text;
  for (int k = 0; std::getline(lines, line); ++k) {
    if (k % 50 == 7) line = line.substr(0, line.rfind(',') + 1) + "3.5";
    text += line + "\n";
  }
  const std::string log = folder.write("spoilt.csv", text);
  EXPECT_EQ(tune(log).status, 1);
  const ProgramResult gated = tune(log, {"--gate", "25"});
  EXPECT_EQ(gated.status, 0) << gated.out << gated.err;
  EXPECT_THAT(gated.out, HasSubstr("refused     sonar: height: 40 of 1000"));
  const Json json = Json::parse(tune(log, {"--gate", "25", "--json"}).out);
  EXPECT_EQ(json["refused"][0]["refused"], 40);
  EXPECT_NEAR(double(json["parameters"][1]["value"]), 4e-4, 5e-5);
  EXPECT_THAT(tune(log, {"--gate", "1"}).err,
              HasSubstr("the gate of sensor 'sonar' is 1, expected at least 4"));
  for (const char* option : {"--gate", "--student"})
    EXPECT_THAT(tune(log, {option, "0"}).err, HasSubstr(option));
}

/// An inertial sensor at rest at 100 Hz and its position at 10 Hz, with two gaps: between them
/// there is one position.
std::string resting_with_gaps() {
  const RandomSource<1> source{7, {0}};
  std::string text =
      "t_s,gyro_x[rad/s],gyro_y[rad/s],gyro_z[rad/s],force_x[m/s^2],force_y[m/s^2],force_z[m/s^2],"
      "x[m],y[m],z[m]\n";
  std::uint64_t drawn = 0;
  const auto noise = [&] { return lane(random_normal(source, 1, drawn++).first, 0); };
  for (int k = 0; k < 1000; ++k) {
    const bool middle = k >= 400 && k < 430;
    const double t = 0.01 * k + (k < 400 ? 0 : 2) + (k < 430 ? 0 : 2);
    text += fmt::format("{:.2f}", t);
    for (int i = 0; i < 3; ++i) text += fmt::format(",{:.6f}", 0.01 * noise());
    for (int i = 0; i < 3; ++i) text += fmt::format(",{:.6f}", (i == 2 ? 9.81 : 0) + 0.3 * noise());
    const bool seen = middle ? k == 410 : k % 10 == 0;
    for (int i = 0; i < 3; ++i) text += seen ? fmt::format(",{:.5f}", 0.1 * noise()) : ",";
    text += "\n";
  }
  return text;
}

// Regression test: the whole log was rejected.
TEST(TuneVerb, LeavesOutWhatHasOneMeasurementBetweenGaps) {
  const TemporaryDirectory folder;
  const std::string log = folder.write("gaps.csv", resting_with_gaps());
  const std::vector<std::string> args = {
      "tune",  "kalman",         "--model",  "inertial", "--log", log,     "--map",
      "x=x",   "--map",          "y=y",      "--map",    "z=z",   "--fix", "Q.gyro_offset",
      "--fix", "Q.force_offset", "--starts", "1"};
  const ProgramResult result = run_program(args);
  EXPECT_THAT(result.status, ::testing::AnyOf(0, 1)) << result.err;
  EXPECT_THAT(result.out, HasSubstr("left out    " + log +
                                    ": 6 to 6.29 s, 1 instant of measurements between two gaps"));
  std::vector<std::string> json_args = args;
  json_args.push_back("--json");
  const Json json = Json::parse(run_program(json_args).out);
  ASSERT_EQ(json["left_out"].size(), 1);
  EXPECT_EQ(json["left_out"][0]["record"], log);
  EXPECT_EQ(json["left_out"][0]["measurements"], 1);
  EXPECT_NEAR(double(json["left_out"][0]["from_s"]), 6, 1e-9);
  EXPECT_NEAR(double(json["left_out"][0]["to_s"]), 6.29, 1e-9);
}

TEST(TuneVerb, EndsWithTheBestOfItsBudget) {
  const TemporaryDirectory folder;
  const std::string log = folder.write("log.csv", bobbing(2000));
  const std::string file = (folder.path() / "tuned.toml").string();
  const ProgramResult result = tune(log, {"--budget", "1e-9", "-o", file});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.out,
              HasSubstr("fit         out of time after 0 evaluations: the best so far"));
  EXPECT_THAT(result.err, HasSubstr("the fit is out of time"));
  EXPECT_THAT(result.out, HasSubstr("innovations output"));  // the start is evaluated nevertheless
  EXPECT_FALSE(std::filesystem::exists(file));
  const Json json =
      Json::parse(tune(log, {"--budget", "1e-9", "--json", "-o", file, "--force"}).out);
  EXPECT_EQ(json["status"], "out of time");
  EXPECT_EQ(json["gate"]["verdict"], "fail");
  EXPECT_EQ(load_filter_model(file).verdict, "fail");
  EXPECT_EQ(tune(log, {"--budget", "600"}).status, 0);
  EXPECT_EQ(tune(log, {"--budget", "0"}).status, 2);
}

/// Ends the process with the status of a tuning that a signal interrupts: after twice the time that
/// a tuning with few searches takes.
[[noreturn]] void be_interrupted(const std::string& log, const std::string& file) {
  const auto begin = std::chrono::steady_clock::now();
  (void)tune(log, {"--starts", "1"});
  const auto one = std::chrono::steady_clock::now() - begin;
  cli::install_signal_handlers();
  std::thread([one] {
    std::this_thread::sleep_for(2 * one + std::chrono::milliseconds(300));
    ::kill(::getpid(), SIGTERM);
  }).detach();
  const ProgramResult result =
      tune(log, {"--starts", "1000", "--threads", "1", "--json", "-o", file, "--force"});
  const Json json = Json::parse(result.out, nullptr, false);
  const bool told = !json.is_discarded() && json["status"] == "interrupted" &&
                    json["parameters"][0]["value"] > 0 &&
                    json["log_likelihood"]["after"] >= json["log_likelihood"]["before"] &&
                    json["gate"]["verdict"] == "fail" &&
                    result.err == "interrupted; " + file + " is written and complete\n";
  ::_exit(told ? result.status : 99);
}

TEST(TuneVerb, AnInterruptLeavesTheBestFound) {
  const TemporaryDirectory folder;
  const std::string log = folder.write("log.csv", bobbing(20000));
  const std::string file = (folder.path() / "tuned.toml").string();
  EXPECT_EXIT(be_interrupted(log, file), ::testing::ExitedWithCode(130), "");
  EXPECT_THAT(folder.read("tuned.toml"), HasSubstr("the fit is interrupted"));
  EXPECT_EQ(load_filter_model(file).verdict, "fail");
}

TEST(TuneVerb, JudgesErrorsByATruth) {
  const TemporaryDirectory folder;
  // The true motion, by integration.
  std::string text = "t_s,z[m]\n";
  double z = -1, vz = 0;
  for (int k = 0; k < 2000; ++k) {
    const double t = 0.02 * k, a = 2 * std::sin(3 * t) + std::sin(7 * t);
    text += fmt::format("{:.2f},{:.9f}\n", t, z);
    z += vz * 0.02 + 0.5 * a * 0.0004;
    vz += a * 0.02;
  }
  const std::string truth = folder.write("truth.csv", text);
  const std::string log = folder.write("log.csv", bobbing(2000));
  const ProgramResult result = tune(log, {"--truth", "z=z@" + truth});
  EXPECT_EQ(result.status, 0) << result.out << result.err;
  EXPECT_THAT(result.out, HasSubstr("errors      z: squared error "));
  const ProgramResult unknown = tune(log, {"--truth", "height=height"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(
      unknown.err,
      HasSubstr("--truth: the model 'altitude' has no state 'height', expected one of z, vz"));
}

TEST(TuneVerb, WritesHostileNamesAsComments) {
  const TemporaryDirectory folder;
  const std::string file = folder.write("a\nname = 'b'.csv", bobbing(6000)).string();
  const std::string tuned = (folder.path() / "tuned.toml").string();
  ASSERT_EQ(tune(file, {"-o", tuned}).status, 0);
  EXPECT_EQ(load_filter_model(tuned).name, "altitude");
}

// A barometer on a bench, motors off: R between 0.5² and 0.6² m², and white.
TEST(TuneVerb, BelievesAStillBarometer) {
  QUADTUNE_REQUIRE_DATA(data);
  const ProgramResult result =
      run_program({"tune", "kalman", "--model", "local-level", "--log",
                   (data / "uquad2" / "log_test_IMU_3.txt").string(), "--columns",
                   "t_s:17, t_us:18, height[m]:19", "--map", "y=height", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const Json json = Json::parse(result.out);
  const double R = json["R"]["y"][0][0];
  EXPECT_GT(R, 0.5 * 0.5);
  EXPECT_LT(R, 0.6 * 0.6);
  EXPECT_EQ(json["whiteness"][0]["verdict"], "pass");
}

// The Mambo logs the output of its estimator.
TEST(TuneVerb, RefusesTheMambosEstimates) {
  QUADTUNE_REQUIRE_DATA(data);
  const ProgramResult result =
      run_program({"tune", "kalman", "--model", "constant-velocity", "--log",
                   (data / "mambo" / "flight_A.csv").string(), "--map", "position=z"});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.out, HasSubstr("position: position: innovations are not white"));
}

TEST(TuneVerb, SaysWhenALogIsTooShort) {
  const TemporaryDirectory folder;
  const std::string file = folder.write("short.csv", bobbing(120)).string();
  const ProgramResult result = tune(file);
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.out, HasSubstr("too short to tell"));
}

/// Rows t and columns of one kind each: 0 constant, 1 noisy up to the middle and then constant, 2
/// with two values, 3 a ramp that a model may predict to the last digit, 4 constant except one
/// sample.
std::string shaped(const std::vector<std::string>& columns, int shape, int rows) {
  const RandomSource<1> source{7, {0}};
  std::string text = "t_s";
  for (const std::string& column : columns) text += "," + column;
  text += "\n";
  for (int k = 0; k < rows; ++k) {
    text += fmt::format("{:.3f}", 0.004 * k);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const double noise = lane(
          random_normal(source, static_cast<std::uint32_t>(i), static_cast<std::uint64_t>(k)).first,
          0);
      const double values[] = {3, k < rows / 2 ? 3 + 0.1 * noise : 3, noise > 0 ? 3.01 : 3.0,
                               3 + 0.25 * 0.004 * k, k == rows / 3 ? 3.5 : 3.0};
      text += fmt::format(",{}", values[shape]);
    }
    text += "\n";
  }
  return text;
}

// A stuck sensor does not determine its noise: both methods report it in one line.
TEST(TuneVerb, RefusesWhatNeverChanges) {
  const TemporaryDirectory folder;
  const std::string log = folder.write("c.csv", shaped({"position[m]"}, 0, 1000)).string();
  for (const char* method : {"ml", "als"}) {
    const ProgramResult result = run_program(
        {"tune", "kalman", "--model", "constant-velocity", "--log", log, "--method", method});
    EXPECT_EQ(result.status, 4) << result.out;
    EXPECT_EQ(result.out, "");
    EXPECT_THAT(
        result.err,
        HasSubstr("tune kalman: position: position is constant over the fitted part: all 800 "
                  "measurements are 3 m; expected varying ones, because their noise is "
                  "estimated from them"));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
  // Its noise cannot be estimated.
  const ProgramResult held = run_program(
      {"tune", "kalman", "--model", "constant-velocity", "--log", log, "--fix", "R.position"});
  EXPECT_EQ(held.status, 1) << held.err;
  EXPECT_THAT(held.out, Not(HasSubstr("nan")));
}

// Whatever a channel contains, the command ends as documented and prints no NaN.
TEST(TuneVerb, EndsAsDocumentedWhateverAChannelHolds) {
  const TemporaryDirectory folder;
  struct Case {
    std::string model;
    std::vector<std::string> columns;
  };
  const std::vector<Case> cases = {
      {"local-level", {"y"}},
      {"constant-velocity", {"position[m]"}},
      {"altitude", {"az[m/s^2]", "height[m]"}},
      {"velocity-xy", {"ax[m/s^2]", "ay[m/s^2]", "flow_vx[m/s]", "flow_vy[m/s]"}},
      {"attitude", {"rate[rad/s]", "tilt[rad]"}},
  };
  for (const Case& one : cases)
    for (int shape = 0; shape < 5; ++shape) {
      const std::string log = folder.write("log.csv", shaped(one.columns, shape, 250)).string();
      for (const char* method : {"ml", "als"}) {
        SCOPED_TRACE(fmt::format("{} {} {}", one.model, shape, method));
        const ProgramResult result = run_program(
            {"tune", "kalman", "--model", one.model, "--log", log, "--method", method, "--json"});
        EXPECT_THAT(result.status, ::testing::AnyOf(0, 1, 4)) << result.err;
        if (shape == 0) {
          EXPECT_EQ(result.status, 4) << result.out;
        }
        if (result.status == 0 || result.status == 1) {
          EXPECT_TRUE(Json::accept(result.out));
        }
        EXPECT_THAT(result.err, Not(HasSubstr("nan")));
      }
    }
}

TEST(TuneVerb, TakesAModelWithoutProcessNoise) {
  const TemporaryDirectory folder;
  const std::string model = folder
                                .write("m.toml", R"(name = "still"
dynamics = "inertial"
gravity_m_per_s2 = [0, 0, -9.81]
[[sensors]]
name = "height"
outputs = ["height [m]"]
C = [[0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0]]
[[sensors.R]]
parameter = "R.height"
variance = 1
)")
                                .string();
  const RandomSource<1> source{2027, {0}};
  std::string text = "t_s,gyro_x,gyro_y,gyro_z,force_x,force_y,force_z,height\n";
  for (std::uint64_t k = 0; k < 2000; ++k)
    text += fmt::format("{:.2f},0,0,0,0,0,9.81,{:.6f}\n", 0.02 * static_cast<double>(k),
                        1 + 0.1 * lane(random_normal(source, 0, k).first, 0));
  const ProgramResult result = run_program({"tune", "kalman", "--model", model, "--log",
                                            folder.write("log.csv", text).string(), "--json"});
  ASSERT_LE(result.status, 1) << result.err;
  const Json found = Json::parse(result.out)["parameters"][0];
  EXPECT_EQ(found["name"], "R.height");
  EXPECT_NEAR(found["value"].get<double>(), 0.01, 0.002);
}

// Autocovariances need measurements at a constant period, which likelihoods do not.
TEST(TuneVerb, SaysWhyItDoesNotCompareMethods) {
  const TemporaryDirectory folder;
  const std::string model = folder
                                .write("m.toml", R"(name = "irregular"
states = ["position [m]", "velocity [m/s]"]
noises = ["velocity"]
A = [[0, 1], [0, 0]]
G = [[0], [1]]
[[Q]]
entries = ["velocity"]
variance = 1
[[sensors]]
name = "height"
outputs = ["height [m]"]
C = [[1, 0]]
[[sensors.R]]
variance = 0.01
)")
                                .string();
  const RandomSource<1> source{2028, {0}};
  std::string log = "t_s,height[m]\n";
  double t = 0;
  for (std::uint64_t k = 0; k < 400; ++k) {
    const auto noise = random_normal(source, 0, k);
    t += 0.01 * (1 + std::abs(lane(noise.first, 0)));
    log += fmt::format("{:.4f},{:.4f}\n", t, std::sin(t) + 0.1 * lane(noise.second, 0));
  }
  const ProgramResult result =
      run_program({"tune", "kalman", "--model", model, "--log",
                   folder.write("log.csv", log).string(), "--starts", "1"});
  ASSERT_LE(result.status, 1) << result.err;
  EXPECT_THAT(result.out, HasSubstr("compared    not compared with als: "));
}

// Exact accelerations: the likelihood is largest without process noise. A filter without it would
// ignore its measurements after some time, and `design` rejects it.
TEST(TuneVerb, WritesTheBoundOfAVarianceThatIsZero) {
  const TemporaryDirectory folder;
  const RandomSource<1> source{2029, {0}};
  constexpr double kDt = 0.02;
  std::string log = "t_s,az[m/s^2],height[m]\n";
  double z = -1, v = 0;
  for (std::uint64_t k = 0; k < 1500; ++k) {
    const double t = kDt * static_cast<double>(k), a = 2 * std::sin(3 * t);
    log += fmt::format("{:.2f},{:.9f},{:.5f}\n", t, a,
                       -z + 0.02 * lane(random_normal(source, 0, k).first, 0));
    z += v * kDt + 0.5 * a * kDt * kDt;
    v += a * kDt;
  }
  const std::string tuned = (folder.path() / "tuned.toml").string();
  const ProgramResult result =
      run_program({"tune", "kalman", "--model", "altitude", "--starts", "1", "--log",
                   folder.write("log.csv", log).string(), "-o", tuned, "--force", "--json"});
  ASSERT_LE(result.status, 1) << result.err;
  const Json parameter = Json::parse(result.out)["parameters"][0];
  ASSERT_EQ(parameter["name"], "Q.az");
  EXPECT_EQ(parameter["value"], 0);
  const FilterModel model = load_filter_model(tuned);
  EXPECT_DOUBLE_EQ(model.parameters[0].start, parameter["high"].get<double>());
  EXPECT_GT(model.parameters[0].start, 1e-12);
  std::stringstream text;
  text << std::ifstream(tuned).rdbuf();
  EXPECT_THAT(text.str(), HasSubstr(", at zero; the upper bound is used"));
}

TEST(TuneVerb, NamesTheChannelsThatItTook) {
  const TemporaryDirectory folder;
  const std::string log = bobbing(3000);
  const std::string file = folder.write("whole.csv", log);
  const std::string sonar = folder.write("sonar.csv", columns_of(log, {0, 2}));
  const std::string tuned = (folder.path() / "tuned.toml").string();
  const ProgramResult result = tune(file, {"-o", tuned});
  EXPECT_THAT(result.out,
              HasSubstr("channels    az: az [m/s^2]\n            height: height [m]\n"));
  std::stringstream text;
  text << std::ifstream(tuned).rdbuf();
  EXPECT_THAT(text.str(), HasSubstr("# height: height [m] of " + file));
  const Json json = Json::parse(tune(file, {"--map", "height=height@" + sonar, "--json"}).out);
  const Json& channels = json["logs"][0]["channels"];
  ASSERT_EQ(channels.size(), 2);
  EXPECT_EQ(channels[1]["signal"], "height");
  EXPECT_EQ(channels[1]["channel"], "height [m]");
  EXPECT_EQ(channels[1]["file"], sonar);
}

TEST(TuneVerb, AsksWhatALocalLevelIs) {
  const TemporaryDirectory folder;
  std::string text = bobbing(1000);
  text.replace(0, text.find('\n'), "t_s,x,y[uT]");
  const std::string log = folder.write("field.csv", text).string();
  const ProgramResult asked =
      run_program({"tune", "kalman", "--model", "local-level", "--log", log});
  EXPECT_EQ(asked.status, 3);
  EXPECT_THAT(asked.err,
              HasSubstr("'y' of the model 'local-level' can be any quantity, and the channel 'y' "
                        "[uT] may be a different one, expected --map y=CHANNEL"));
  const ProgramResult told =
      run_program({"tune", "kalman", "--model", "local-level", "--log", log, "--map", "y=y"});
  EXPECT_THAT(told.out, HasSubstr("channels    y: y [uT]\n"));
}

// Logs of simulated flights suffice for the built-in models.
TEST(TuneVerb, TakesFlightLogsAsTheyAre) {
  const TemporaryDirectory folder;
  for (const char* ending : {"csv", "mat"}) {
    const std::string log = (folder.path() / "flight.").string() + ending;
    ASSERT_EQ(
        run_program({"fly", "mambo", "--mission", "step-north", "--sensors", "real", "--log", log})
            .status,
        0);
    for (const char* model : {"altitude", "velocity-xy", "attitude", "constant-velocity"}) {
      const ProgramResult result =
          run_program({"tune", "kalman", "--model", model, "--log", log, "--json"});
      ASSERT_LE(result.status, 1) << model << " " << result.err;
      EXPECT_GT(Json::parse(result.out)["logs"][0]["samples"], 100) << model;
    }
    EXPECT_EQ(run_program({"tune", "kalman", "--model", "local-level", "--log", log}).status, 3);
    const ProgramResult survey = run_program({"log", log});
    EXPECT_THAT(survey.out, HasSubstr("altitude: fed by accelerometer.* along world z, sonar"));
  }
}

// The errors in the units of the states, over the part that was held out.
TEST(TuneVerb, TellsRootMeanSquareErrors) {
  const TemporaryDirectory folder;
  std::string text = "t_s,z[m]\n";
  double z = -1, vz = 0;
  for (int k = 0; k < 2000; ++k) {
    const double t = 0.02 * k, a = 2 * std::sin(3 * t) + std::sin(7 * t);
    text += fmt::format("{:.2f},{:.9f}\n", t, z);
    z += vz * 0.02 + 0.5 * a * 0.0004;
    vz += a * 0.02;
  }
  const std::string truth = folder.write("truth.csv", text);
  const std::string log = folder.write("log.csv", bobbing(2000));
  const Json json = Json::parse(tune(log, {"--truth", "z=z@" + truth, "--json"}).out);
  EXPECT_EQ(json["accuracy"]["held_out"], true);
  const Json& state = json["accuracy"]["states"][0];
  EXPECT_EQ(state["name"], "z");
  EXPECT_EQ(state["unit"], "m");
  EXPECT_EQ(state["samples"], 400);
  // The echoes have an error of 0.02 m, the tuned filter a smaller one, and the filter before a
  // larger one.
  EXPECT_LT(double(state["after"]), 0.015);
  EXPECT_GT(double(state["before"]), double(state["after"]));
  EXPECT_EQ(json["warnings"].size(), 0);
  EXPECT_THAT(tune(log, {"--truth", "z=z@" + truth}).out, HasSubstr("accuracy    rms error"));
  // A slowly varying error of the echoes: the tuned filter follows it, the start did not.
  std::stringstream lines(bobbing(2000));
  std::string line, swaying;
  for (int k = -1; std::getline(lines, line); ++k) {
    const std::size_t comma = line.rfind(',');
    if (k >= 0 && comma + 1 < line.size())
      line = fmt::format("{},{:.4f}", line.substr(0, comma),
                         std::stod(line.substr(comma + 1)) + 0.1 * std::sin(4 * 0.02 * k));
    swaying += line + "\n";
  }
  const ProgramResult worse =
      tune(folder.write("swaying.csv", swaying),
           {"--truth", "z=z@" + truth, "--start", "Q.az=0.01", "--start", "R.sonar=0.04"});
  EXPECT_THAT(worse.out, HasSubstr("less accurate on the held-out part: z: error 0."));
}

}  // namespace
}  // namespace quadtune
