// SPDX-License-Identifier: Apache-2.0
/// quadtune tune pid and tune lqr over missions, run as by a user.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "program/program.hpp"
#include "run_program.hpp"
#include "sanitized.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::ProgramResult;
using testing::run_program;
using testing::TemporaryDirectory;

constexpr char kRequirements[] = R"(
[cost]
tracking_rms = 1
energy = 0.1
measure = "worst"
draws = 2
[margins]
Ms_max = 1.5
delay_margin_min_s = 0.01
[loops.pitch]
Ms_max = 1.2
[[mission]]
mission = "hover"
duration_s = 12
limits = { tilt_max_rad = 0.6, saturation_time_max_s = 3 }
[[vary]]
quantity = "mass"
normal = { deviation = 0.02, least = 0.9, most = 1.1 }
)";

std::string with_text(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

std::vector<std::string> with(std::vector<std::string> args, const std::vector<std::string>& more) {
  args.insert(args.end(), more.begin(), more.end());
  return args;
}

// Few evaluations: the result may be the start, and then the status is 1.
TEST(TuneMissions, PidTellsStartFoundAndPublished) {
  const TemporaryDirectory directory;
  const std::string file = (directory.path() / "tuned.toml").string();
  const std::vector<std::string> args = {
      "tune", "pid",           "mambo", "--mission", "hover", "--duration", "12",  "--evaluations",
      "60",   "--monte-carlo", "2",     "--proof",   "4",     "--budget",   "600", "-o",
      file,   "--force"};
  const ProgramResult text = run_program(args);
  EXPECT_THAT(text.status, ::testing::AnyOf(0, 1)) << text.err;
  EXPECT_THAT(text.out, AllOf(HasSubstr("published"), HasSubstr("Ms: start"),
                              HasSubstr("flights that end early"), HasSubstr("evaluations in")));
  // The file is a design with the printed gains.
  const ProgramResult json_run = run_program(with(args, {"--json"}));
  const Json json = Json::parse(json_run.out);
  EXPECT_LE(json["cost"]["after"], json["cost"]["before"]);
  EXPECT_LE(json["evaluations"], 60);
  EXPECT_EQ(json["gains"].size(), 6);
  // No loop has a smaller margin than at the start, up to the accuracy of 60 evaluations.
  for (std::size_t i = 0; i < json["margins"]["after"].size(); ++i)
    EXPECT_LE(double(json["margins"]["after"][i]["Ms"]),
              std::max(1.6, 1.01 * double(json["margins"]["before"][i]["Ms"])));
  // The result is better than the published gains in tracking and in the margins of every loop.
  EXPECT_LT(json["after"]["missions"][0]["mean"]["tracking_rms"],
            json["published"]["missions"][0]["mean"]["tracking_rms"]);
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_LE(json["margins"]["after"][i]["Ms"], json["margins"]["published"][i]["Ms"]);
  // On the flown plant, too, the worst loops are better than those of the published gains.
  for (const char* which : {"before", "after"}) {
    EXPECT_EQ(json["flown"][which]["estimator"], "general");
    EXPECT_TRUE(json["flown"][which]["stable"]);
    ASSERT_EQ(json["flown"][which]["margins"].size(), 4U);
    EXPECT_LT(json["flown"][which]["margins"][1]["Ms"],
              json["flown"]["published"]["margins"][1]["Ms"]);
  }
  const bool taken = json["accepted"];
  // The start is kept if no point is better.
  const bool bettered = json.contains("not_taken") && !json["not_taken"].is_null();
  const double Kp = json[taken || !bettered ? "gains" : "not_taken"][0]["Kp"];
  EXPECT_THAT(directory.read("tuned.toml"), HasSubstr(fmt::format("x = {{ Kp = {}, ", Kp)));
  EXPECT_EQ(directory.read("tuned.toml").starts_with("# NOT ACCEPTED. By quadtune"), !taken);
  const ProgramResult design =
      run_program({"design", file, "-o", (directory.path() / "out").string()});
  EXPECT_EQ(design.status, 0) << design.err;
  const ProgramResult flown = run_program({"fly", "mambo", "--mission", "hover", "--gains", file,
                                           "--sensors", "ideal", "--duration", "20"});
  EXPECT_EQ(flown.status, 0) << flown.err;
}

// 0.05 m is below the error bound of GPS. The start, which passes in `fly`, meets the widened
// limits here.
TEST(TuneMissions, LimitsAreWidenedToWhatTheSensorsKnow) {
  if (testing::kSanitized) GTEST_SKIP() << "minutes for the uquad's period of 200 samples";
  const ProgramResult run = run_program(
      {"tune", "pid", "uquad", "--mission", "step-north", "--evaluations", "2", "--json"});
  const Json json = Json::parse(run.out);
  EXPECT_TRUE(json["broken"].empty()) << json["broken"].dump();
  bool distance = false;
  for (const Json& one : json["widened"]) {
    EXPECT_EQ(one["mission"], "step-north");
    EXPECT_GT(one["judged_by"], one["asked"]);
    if (one["what"] == "final_distance") distance = true;
  }
  EXPECT_TRUE(distance) << json["widened"].dump();
}

// The number of threads and the printed output are not recorded in the file.
TEST(TuneMissions, ThreadsDoNotChangeAByteOfTheFile) {
  if (testing::kSanitized) GTEST_SKIP() << "a sanitizer learns no more from the second run";
  const TemporaryDirectory directory;
  const std::string file = (directory.path() / "tuned.toml").string();
  const std::vector<std::string> args = {
      "tune",          "pid", "mambo",   "--mission", "hover",   "--duration",    "12",
      "--evaluations", "3",   "--proof", "2",         "--force", "--monte-carlo", "1",
      "--budget",      "600", "-o",      file};
  std::vector<std::string> files;
  for (const std::vector<std::string>& more : std::vector<std::vector<std::string>>{
           {"--threads", "1"}, {"--threads=2", "--quiet"}, {"--json", "--threads", "3"}, {}}) {
    EXPECT_THAT(run_program(with(args, more)).status, ::testing::AnyOf(0, 1));
    files.push_back(directory.read("tuned.toml"));
  }
  EXPECT_THAT(files[0], HasSubstr("By quadtune tune pid mambo --mission hover"));
  for (const std::string& text : files) EXPECT_EQ(text, files[0]);
}

// A design file is recognized by its name.
TEST(TuneMissions, RefusesANameByWhichADesignIsNotKnown) {
  const ProgramResult result =
      run_program({"tune", "pid", "mambo", "--mission", "hover", "-o", "tuned.txt"});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("-o is 'tuned.txt', expected a name that ends in .toml"));
}

TEST(TuneMissions, LqrSearchesInTheWeights) {
  const TemporaryDirectory directory;
  const std::string file = (directory.path() / "tuned.toml").string();
  const ProgramResult result = run_program(
      {"tune", "lqr", "mambo", "--mission", "step-north", "--sensors", "ideal", "--evaluations",
       "80", "--monte-carlo", "1", "--proof", "2", "--budget", "600", "-o", file, "--json"});
  EXPECT_EQ(result.status, 0) << result.err;
  const Json json = Json::parse(result.out);
  EXPECT_TRUE(json["accepted"]);
  // Equal weights stay equal, and the weight of the first input is kept.
  const Json& weights = json["gains"]["weights"];
  EXPECT_EQ(weights["px"], weights["py"]);
  EXPECT_EQ(weights["roll"], weights["pitch"]);
  EXPECT_EQ(weights["tau_x"], weights["tau_y"]);
  EXPECT_NEAR(weights["T"], 141.14, 0.01);
  const ProgramResult design =
      run_program({"design", file, "-o", (directory.path() / "out").string(), "--json"});
  EXPECT_EQ(design.status, 0) << design.err;
}

TEST(TuneMissions, KeepsRequirements) {
  const TemporaryDirectory directory;
  const std::string file = directory.write("r.toml", kRequirements).string();
  const ProgramResult result =
      run_program({"tune", "pid", "mambo", "--requirements", file, "--evaluations", "40", "--proof",
                   "3", "--budget", "600", "--json"});
  EXPECT_THAT(result.status, ::testing::AnyOf(0, 1)) << result.err;
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json["before"]["flights"], 3);
  bool tilt = false;
  for (const Json& limit : json["after"]["limits"])
    if (limit["metric"] == "tilt_max") {
      EXPECT_EQ(limit["at_most"], 0.6);
      tilt = true;
    }
  EXPECT_TRUE(tilt);
  for (const Json& loop : json["margins"]["after"]) {
    EXPECT_LE(loop["Ms"], 1.5 + 1e-6);
    if (loop["loop"] == "pitch") {
      EXPECT_LE(loop["Ms"], 1.2 + 1e-6);
    }
  }
}

// The start is reported on the draws of the published gains, also if it is kept.
TEST(TuneMissions, ColumnsAreOfTheSameDraws) {
  const ProgramResult result = run_program(
      {"tune", "pid", "mambo", "--gains", "published", "--mission", "hover", "--duration", "12",
       "--evaluations", "1", "--monte-carlo", "1", "--proof", "3", "--json"});
  EXPECT_EQ(result.status, 1) << result.err;
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json["before"]["flights"], 3);
  EXPECT_EQ(json["before"], json["published"]);
  // The time after the climb is shorter than the window of the mission.
  EXPECT_THAT(json["broken"].dump(), HasSubstr("settling_time of hover"));
}

TEST(TuneMissions, WritesTheStatesOfItsProblem) {
  const TemporaryDirectory directory;
  const std::string file = (directory.path() / "tuned.toml").string();
  const ProgramResult result =
      run_program({"tune", "lqr",           "mambo", "--mission", "hover",       "--duration",
                   "12",   "--sensors",     "ideal", "--states",  "no-position", "--Q",
                   "1",    "--R",           "1",     "--method",  "discrete",    "--evaluations",
                   "2",    "--monte-carlo", "1",     "--proof",   "2",           "-o",
                   file,   "--force"});
  EXPECT_THAT(result.status, ::testing::AnyOf(0, 1)) << result.err;
  EXPECT_THAT(directory.read("tuned.toml"), HasSubstr("method = \"discrete\""));
  const ProgramResult design =
      run_program({"design", file, "-o", (directory.path() / "out").string()});
  EXPECT_EQ(design.status, 0) << design.err;
}

constexpr int kTooEarly = 98, kTooLate = 99, kTold = 97;

/// Runs a search in a child process and sends it SIGINT after the delay.
/// @return  kTold: it printed the best design so far and ended with 130; kTooEarly: it had no
///          design yet; kTooLate: it had already ended; otherwise its exit status
int interrupted_after(std::chrono::milliseconds delay, const std::string& folder) {
  const pid_t child = ::fork();
  if (child == 0) {
    cli::install_signal_handlers();
    std::thread([delay] {
      std::this_thread::sleep_for(delay);
      ::kill(::getpid(), SIGINT);
    }).detach();
    const ProgramResult result =
        run_program({"tune", "pid", "mambo", "--mission", "hover", "--duration", "12",
                     "--monte-carlo", "1", "--proof", "2", "--budget", "600", "--json", "--force",
                     "-o", folder + "/tuned.toml", "--report", folder + "/tuned.html"});
    const Json answer = Json::parse(result.out, nullptr, false);
    if (!answer.is_object() || answer.contains("error")) ::_exit(kTooEarly);
    if (answer["end"] != "interrupted") ::_exit(kTooLate);
    ::_exit(result.status == 130 ? kTold : result.status);
  }
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  if (!WIFEXITED(status)) return -1;
  // Before the search begins, the timer ends the process with status 130.
  return WEXITSTATUS(status) == 130 ? kTooEarly : WEXITSTATUS(status);
}

// Regression test: the result was lost when a file was to be written. When a search has a result
// depends on the machine and its load, so the test searches for that moment.
TEST(TuneMissions, AnInterruptLeavesTheBestFound) {
  const TemporaryDirectory directory;
  std::chrono::milliseconds delay(500);
  int status = kTooEarly;
  for (int i = 0; i < 12 && (status == kTooEarly || status == kTooLate); ++i) {
    status = interrupted_after(delay, directory.path().string());
    delay = status == kTooEarly ? 2 * delay : delay * 2 / 3;
  }
  EXPECT_EQ(status, kTold);
  EXPECT_THAT(directory.read("tuned.toml"), HasSubstr("[cascade]"));
  EXPECT_THAT(directory.read("tuned.html"), HasSubstr("interrupted"));
}

TEST(TuneMissions, ASearchIsNotLostWithItsFile) {
  const ProgramResult result = run_program(
      {"tune", "pid", "mambo", "--mission", "hover", "--duration", "12", "--evaluations", "2",
       "--monte-carlo", "1", "--proof", "2", "--json", "--force", "-o", "/dev/null/tuned.toml"});
  EXPECT_EQ(result.status, 5);
  EXPECT_THAT(result.err, HasSubstr("/dev/null"));
  EXPECT_EQ(Json::parse(result.out)["gains"].size(), 6);
}

TEST(TuneMissions, RefusesInOneLine) {
  const TemporaryDirectory directory;
  const auto refuses = [](const std::vector<std::string>& args, int status,
                          const std::string& message) {
    const ProgramResult result = run_program(args);
    EXPECT_EQ(result.status, status) << message;
    EXPECT_THAT(result.err, HasSubstr(message));
  };
  refuses({"tune", "pid"}, 2, "expected a vehicle");
  refuses({"tune", "pid", "mambo", "--gains", "published"}, 2,
          "--mission is missing, expected a mission, or requirements with [[mission]]");
  refuses({"tune", "pid", "mambo", "--gains", "published", "--mission", "hovr"}, 3,
          "did you mean 'hover'?");
  refuses({"tune", "pid", "mambo", "--gains", "published", "--mission", "hover", "--budget", "-1"},
          2, "--budget is -1");
  refuses(
      {"tune", "pid", "mambo", "--gains", "published", "--mission", "hover", "--measure", "men"}, 2,
      "--measure: unknown measure 'men'; expected mean, quantile or worst");
  refuses({"tune", "pid", "mambo", "--gains", "published", "--mission", "hover", "--measure",
           "quantile", "--proof", "19"},
          2, "--proof is 19, expected at least 20 because the 0.9 quantile requires as many draws");
  refuses({"tune", "pid", "mambo", "--gains", "published", "--mission", "hover", "--duration", "2",
           "--budget", "1"},
          3, "mission 'hover': its flight of 2 s yields none of the metrics of the cost (");
  refuses({"tune", "pid", "mambo", "--gains", "published", "--mission", "hover", "--monte-carlo",
           "4294967296"},
          2, "--monte-carlo is 4294967296, expected at most 100000");
  refuses({"tune", "pid", "mambo", "--gains", "published", "--mission", "hover", "--report",
           "page.txt"},
          2, "--report is 'page.txt', expected a name that ends in .html");
  refuses({"tune", "pid", "mambo", "--gains", "published", "--mission", "hover", "--report",
           "a.html", "-o", "a.html"},
          2, "-o is 'a.html', expected a name that ends in .toml");
  const std::string whole = directory.write("whole.toml", kRequirements).string();
  for (const auto& [option, value] :
       {std::pair("--duration", "15"), std::pair("--wind", "calm"), std::pair("--sensors", "ideal"),
        std::pair("--estimator", "truth")})
    refuses(
        {"tune", "pid", "mambo", "--gains", "published", "--requirements", whole, option, value}, 2,
        std::string(option) + " cannot be combined with requirements that have [[mission]]");
  refuses({"tune", "lqr", "mambo", "--mission", "hover", "--at", "line"}, 2,
          "--at is 'line', expected hover");
  refuses({"tune", "lqr", "mambo", "--mission", "hover", "--method", "continuous"}, 2,
          "--method is continuous, expected discrete or sampled");
  refuses({"tune", "lqr", "mambo", "--mission", "hover", "--inputs", "rotor-speed"}, 2,
          "--inputs rotor-speed requires --Q or --R");
  refuses({"tune", "lqr", "mambo", "--match-gains", "K.txt", "--report", "a.html"}, 2,
          "--report applies to flights");
  refuses({"tune", "lqr", "mambo"}, 2, "expected --mission NAME or --requirements FILE");
  refuses({"tune", "lqr", "mambo", "--mission", "hover", "--tie", "x,y"}, 2,
          "--tie requires --match-gains");
  refuses({"tune", "lqr", "mambo", "--match-gains", "K.txt", "--mission", "hover"}, 2,
          "--mission applies to flights");
  refuses({"tune", "lqr", "mambo", "--mission", "hover", "--convention", "mambo"}, 2,
          "--convention and --states require --Q or --R");
  const auto file = [&](const std::string& from, const std::string& to) {
    return directory.write("r.toml", with_text(kRequirements, from, to)).string();
  };
  const auto refuses_file = [&](const std::string& from, const std::string& to,
                                const std::string& message) {
    refuses({"tune", "pid", "mambo", "--gains", "published", "--requirements", file(from, to)}, 3,
            message);
  };
  refuses_file("tracking_rms = 1", "traking_rms = 1", "did you mean 'tracking_rms'?");
  refuses_file("energy = 0.1", "energy = -0.1", "r.toml:4: energy");
  refuses_file("\"worst\"", "\"wurst\"", "r.toml:5: unknown measure 'wurst'");
  refuses_file("draws = 2", "draws = 0", "draws in [cost] is 0, expected a whole number");
  refuses_file("Ms_max = 1.5", "Ms_max = 0.9", "Ms_max");
  refuses_file("[loops.pitch]", "[loops.pich]", "no loop 'pich'; expected one or more of");
  refuses_file("tilt_max_rad", "tilt_rad", "key 'tilt_rad' in [[mission]] 1.limits is not known");
  refuses_file("deviation = 0.02", "deviation = -0.02", "mass: deviation is -0.02");
  refuses_file("mission = \"hover\"", "mission = \"hovr\"", "did you mean 'hover'?");
}

}  // namespace
}  // namespace quadtune
