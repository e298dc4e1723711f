// SPDX-License-Identifier: Apache-2.0
/// quadtune fly, compare, and the missions of design, run as by a user.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "quadtune/logs/flight_log.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/simulation/mission.hpp"
#include "run_program.hpp"
#include "sanitized.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::ProgramResult;
using testing::run_program;
using testing::TemporaryDirectory;

std::string source(const std::string& name) {
  std::ifstream file(testing::source_folder() + "/" + name);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

/// A flight as JSON, whatever its verdict.
Json flown(std::vector<std::string> args) {
  args.push_back("--json");
  const ProgramResult result = run_program(args);
  EXPECT_THAT(result.status, ::testing::AnyOf(0, 1)) << result.err;
  return Json::parse(result.out);
}

/// Removes what depends on the computer and not on the flight.
Json without_time(Json flight) {
  flight.erase("wall_s");
  return flight;
}

TEST(Fly, SaysThatAFlightIsTooShortToSettle) {
  const Json flight = flown({"fly", "mambo", "--sensors", "ideal", "--duration", "5"});
  EXPECT_EQ(flight["verdict"], "fail");
  EXPECT_THAT(flight["reasons"].dump(),
              HasSubstr("settling cannot be evaluated: no reference is constant for window_s = 10 "
                        "s in a flight of 5 s; expected a longer flight"));
  EXPECT_EQ(flight["diagnosis"]["cause"], "mission limits");
  EXPECT_THAT(flight["diagnosis"].dump(), Not(HasSubstr("the law alone fails")));
}

TEST(Fly, FliesWhatPidWritesForALongPeriod) {
  const TemporaryDirectory folder;
  const std::string gains = (folder.path() / "slow.json").string();
  ASSERT_EQ(run_program({"pid", "mambo", "--dt", "1", "--method", "loops", "-o", gains}).status, 0);
  EXPECT_THAT(
      run_program({"fly", "mambo", "--gains", gains, "--sensors", "ideal", "--duration", "15"}).err,
      Not(HasSubstr("back_calculation")));
}

TEST(Fly, HoversEveryVehicleWithIdealSensors) {
  if (testing::kSanitized) GTEST_SKIP() << "minutes of what other tests run too";
  for (const std::string& vehicle : built_in_vehicles())
    for (const std::string law : {"cascaded-pid", "state-feedback"}) {
      const Json flight =
          flown({"fly", vehicle, "--controller", law, "--sensors", "ideal", "--duration", "40"});
      EXPECT_EQ(flight["verdict"], "pass") << vehicle << " " << law << flight;
    }
}

// The Crazyflie without the drag of its rotors, which damps it.
std::string undamped(const TemporaryDirectory& folder) {
  std::string text = load_vehicle("crazyflie").text;
  for (const char* key : {"drag_N_s2", "inflow_N_s2"}) {
    const std::size_t at = text.find(key);
    text.erase(at, text.find('\n', at) + 1 - at);
  }
  return folder.write("undamped.toml", text).string();
}

// An LQR on its 12 states, as if its rotors had no lag, with weights by Bryson's rule.
std::string lqr_without_lag(const TemporaryDirectory& folder) {
  return folder
      .write("lqr.toml", "name = \"c\"\nvehicle = \"" + undamped(folder) + "\"" + R"(
[lqr]
convention = "ned"
inputs = "wrench"
Q = [16, 16, 16, 25, 25, 8.163, 4, 4, 4, 0.25, 0.25, 0.25]
R = [564, 953360, 953360, 766349]
method = "sampled"
dt_s = 0.005
)")
      .string();
}

// `discretize crazyflie --compare` agrees: stable up to 4 ms, flown at 5 ms.
TEST(Fly, LosesALawThatDoesNotKnowOfTheMotorsLag) {
  const TemporaryDirectory folder;
  const Json flight =
      flown({"fly", undamped(folder), "--gains", lqr_without_lag(folder), "--mission", "step-north",
             "--sensors", "ideal", "--estimator", "truth"});
  EXPECT_EQ(flight["verdict"], "fail");
  EXPECT_EQ(flight["events"].back()["name"], "tilt");
}

TEST(Fly, HoldsTheMamboToCentimetresWithItsRealSensors) {
  const Json flight = flown({"fly", "mambo"});
  EXPECT_EQ(flight["verdict"], "pass") << flight;
  EXPECT_LT(flight["metrics"]["tracking_rms_m"], 0.03);
  EXPECT_LT(flight["metrics"]["estimate_rms_m"], 0.03);
  EXPECT_EQ(flight["steps"], 20000);
  EXPECT_EQ(flight["end"], "completed");
  EXPECT_NEAR(flight["final_state"]["pz"], -1.1, 0.05);
}

TEST(Fly, FliesEveryBuiltInMission) {
  for (const std::string& mission : built_in_missions()) {
    // Steps and paths are flown by other tests too.
    if constexpr (testing::kSanitized) {
      const bool special = mission == "keys" || mission == "motor-test" || mission == "waypoints" ||
                           mission == "lemniscate-carried";
      if (!special) continue;
    }
    const Json flight = flown({"fly", "mambo", "--gains", "published", "--mission", mission,
                               "--sensors", "ideal", "--estimator", "truth"});
    EXPECT_EQ(flight["end"], "completed") << mission << flight;
    EXPECT_EQ(flight["mission"], mission);
  }
}

TEST(Fly, HasTheKeysOfItsContract) {
  const Json flight = flown({"fly", "mambo", "--duration", "5"});
  for (const char* key : {"metrics", "events", "final_state", "steps", "wall_s", "verdict",
                          "limits", "reasons", "law", "estimator", "seed"})
    EXPECT_TRUE(flight.contains(key)) << key;
  EXPECT_TRUE(flight["metrics"]["touchdown_speed_m/s"].is_null());
}

TEST(Fly, TheSeedFixesEverythingRandom) {
  if (testing::kSanitized) GTEST_SKIP() << "a sanitizer learns no more from the second run";
  const std::vector<std::string> windy = {"fly",    "mambo", "--duration", "6",
                                          "--wind", "light", "--seed",     "7"};
  const Json one = without_time(flown(windy));
  EXPECT_EQ(one, without_time(flown(windy)));
  std::vector<std::string> other = windy;
  other.back() = "8";
  EXPECT_NE(one["final_state"], flown(other)["final_state"]);
}

TEST(Fly, WritesLogsThatReadBackAlike) {
  const TemporaryDirectory folder;
  const std::string csv = (folder.path() / "f.csv").string();
  const std::string mat = (folder.path() / "f.mat").string();
  for (const std::string& file : {csv, mat})
    ASSERT_EQ(run_program({"fly", "mambo", "--duration", "2", "--log", file}).status, 1)
        << "2 s are too short to settle";
  const LogTable a = read_log(csv);
  const LogTable b = read_log(mat);
  ASSERT_EQ(a.rows(), 401u);
  ASSERT_EQ(a.columns.size(), b.columns.size());
  for (std::size_t i = 0; i < a.columns.size(); ++i) {
    EXPECT_EQ(a.columns[i].name, b.columns[i].name);
    EXPECT_EQ(a.columns[i].unit, b.columns[i].unit);
    for (std::size_t k = 0; k < a.rows(); ++k) {
      const double x = a.columns[i].values[k], y = b.columns[i].values[k];
      ASSERT_TRUE(x == y || (std::isnan(x) && std::isnan(y))) << a.columns[i].name << " " << k;
    }
  }
  ASSERT_EQ(a.events.size(), 2u);  // the climb lasts until 2.6 s
  EXPECT_EQ(a.events[1].name, "take_off");
  EXPECT_DOUBLE_EQ(a.events[1].time, 0.5);
  for (const char* column : {"x.qw", "x.w4", "estimate.r", "reference.pz", "command.T",
                             "accelerometer.z", "sonar", "flow.x"})
    EXPECT_NE(a.find(column), nullptr) << column;
}

TEST(Fly, WritesAReportOfOneFile) {
  const TemporaryDirectory folder;
  const std::string file = (folder.path() / "page.html").string();
  ASSERT_EQ(run_program({"fly", "mambo", "--report", file}).status, 0);
  const std::string page = folder.read("page.html");
  EXPECT_LT(page.size(), 3u << 20);
  EXPECT_THAT(page, HasSubstr("mambo flies hover"));
  EXPECT_THAT(page, HasSubstr("quadtune fly mambo --report"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(Fly, ALostVehicleEndsWithOneAndSaysWhy) {
  const ProgramResult result = run_program(
      {"fly", "mambo", "--controller", "state-feedback", "--estimator", "mambo-original"});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, HasSubstr("fly: safety exit 'tilt' at "));
  EXPECT_THAT(result.out, HasSubstr("verdict: fail"));
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1);
}

TEST(Fly, JudgesSeveralSeeds) {
  if (testing::kSanitized) GTEST_SKIP() << "minutes of what other tests run too";
  const std::vector<std::string> args = {"fly", "mambo", "--duration", "15", "--seeds", "3"};
  const ProgramResult text = run_program(args);
  EXPECT_EQ(text.status, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("verdict of 3 seeds: pass, 3 passed"));
  std::istringstream lines(text.out);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("     ")) {
      EXPECT_LE(line.size(), 80U) << line;
    }
  }
  const Json flights = flown(args);
  ASSERT_EQ(flights.size(), 3U);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(flights[i]["seed"], i + 1);
    EXPECT_EQ(
        without_time(flights[i]),
        without_time(flown({"fly", "mambo", "--duration", "15", "--seed", std::to_string(i + 1)})));
  }
  for (const auto& [more, message] :
       {std::pair(std::vector<std::string>{"--log", "x.csv"},
                  "--log cannot be combined with --seeds 3"),
        std::pair(std::vector<std::string>{"--report", "x.html"},
                  "--report cannot be combined with --seeds 3"),
        std::pair(std::vector<std::string>{"--seeds", "2000"}, "--seeds")}) {
    std::vector<std::string> bad = args;
    bad.insert(bad.end(), more.begin(), more.end());
    const ProgramResult refused = run_program(bad);
    EXPECT_EQ(refused.status, 2);
    EXPECT_THAT(refused.err, HasSubstr(message));
  }
  const ProgramResult many = run_program({"fly", "mambo", "--seeds", "1001"});
  EXPECT_THAT(many.err, HasSubstr("--seeds is 1001, expected at most 1000"));
}

// With a satellite receiver of 0.5 m, the 5 cm of the mission cannot be reached; both numbers are
// reported.
TEST(Fly, TellsTheBoundOfTheSensors) {
  const Json flight = flown({"fly", "uquad", "--duration", "30"});
  const Json& bound = flight["sensor_bound"];
  EXPECT_NEAR(bound["horizontal_rms_m"], 0.32, 0.03);
  EXPECT_EQ(bound["widened"][0]["what"], "tracking_rms");
  EXPECT_EQ(bound["widened"][0]["asked"], 0.05);
  bool told = false;
  for (const Json& limit : flight["limits"])
    if (limit["metric"] == "tracking_rms") {
      told = true;
      EXPECT_EQ(limit["asked"], 0.05);
      EXPECT_EQ(limit["at_most"], bound["widened"][0]["judged_by"]);
    }
  EXPECT_TRUE(told);
  EXPECT_THAT(run_program({"fly", "uquad", "--duration", "30"}).out,
              HasSubstr("limit 0.05 m widened to"));
  for (const auto& more : {std::pair("--estimator", "truth"), std::pair("--sensors", "ideal")}) {
    const Json known = flown({"fly", "uquad", "--duration", "30", more.first, more.second});
    EXPECT_FALSE(known.contains("sensor_bound"));
    for (const Json& limit : known["limits"]) EXPECT_FALSE(limit.contains("asked"));
  }
}

TEST(Fly, AFailureHasAReasonAndACommandThatHelps) {
  const TemporaryDirectory folder;
  const std::vector<std::string> args = {
      "fly",       undamped(folder), "--gains",     lqr_without_lag(folder),
      "--mission", "step-north",     "--estimator", "truth"};
  const Json flight = flown(args);
  EXPECT_EQ(flight["diagnosis"]["cause"], "unstable loop");
  const ProgramResult text = run_program(args);
  EXPECT_THAT(text.out, HasSubstr("\nwhy: the flown loop is unstable, largest |z| 1.00"));
  EXPECT_THAT(text.out, HasSubstr("\nnext: weaker gains, `quadtune tune lqr "));
  EXPECT_FALSE(flown({"fly", "mambo"}).contains("diagnosis"));
}

TEST(Fly, SaysThatItTookTypicalSensors) {
  const std::vector<std::string> args = {"fly", "rolling-spider", "--duration", "3"};
  EXPECT_THAT(run_program(args).err, HasSubstr("has no [sensors]; assumed: accelerometer 200 Hz"));
  std::vector<std::string> ideal = args;
  ideal.insert(ideal.end(), {"--sensors", "ideal"});
  EXPECT_THAT(run_program(ideal).err, Not(HasSubstr("assumed")));
}

/// In flight, half a metre of height along a ramp, without saturation.
constexpr char kClimb[] = R"(name = "climb"
duration_s = 3
[start]
at = "air"
height_m = 1
[[references]]
at_s = 0
height_m = 1
[[references]]
at_s = 0.5
height_m = 1.1
[limits]
tilt_max_rad = 1
)";

// The integrals of the trapezoidal rule and of forward Euler differ by exactly Ki Ts e/2: the
// differences of all samples cancel except at the ends. As the loop has not reacted yet, the thrust
// differs by this in the first sample after a step, and by within a few per cent of it in the next
// samples; the force points down, so T has the opposite sign.
TEST(Compare, IntegratorsDifferByHalfASampleOfTheError) {
  const TemporaryDirectory folder;
  const std::string mission = folder.write("climb.toml", kClimb).string();
  std::array<LogTable, 2> logs;
  for (std::size_t i = 0; i < 2; ++i) {
    const std::string file = (folder.path() / "f.csv").string();
    ASSERT_EQ(run_program({"fly", "mambo", "--gains", "published", "--mission", mission,
                           "--sensors", "ideal", "--estimator", "truth", "--integrator",
                           i == 0 ? "euler" : "tustin", "--log", file})
                  .status,
              0);
    logs[i] = read_log(file);
  }
  constexpr double kKi = 0.1, kTs = 0.005;
  const auto& t = logs[0].find("t")->values;
  for (std::size_t k = 100; k < 104; ++k) {
    ASSERT_GE(t[k], 0.5 - 1e-12);
    const double e =
        logs[1].find("reference.pz")->values[k] - logs[1].find("estimate.pz")->values[k];
    const double difference =
        logs[1].find("command.T")->values[k] - logs[0].find("command.T")->values[k];
    const double predicted = -kKi * kTs * e / 2;
    const double share = k == 100 ? 1e-9 : 0.05 * static_cast<double>(k - 100);
    EXPECT_NEAR(difference, predicted, share * std::abs(predicted)) << t[k];
  }
}

TEST(Compare, HasTheKeysOfItsContract) {
  const Json json = flown({"compare", "integrators", "mambo", "--duration", "10"});
  for (const char* column : {"T", "tau_x", "tau_y", "tau_z"}) {
    EXPECT_GT(json["difference"]["mean_squared"][column], 0) << column;
    EXPECT_GT(json["difference"]["max"][column], 0) << column;
  }
  EXPECT_EQ(json["a"]["name"], "euler");
  EXPECT_EQ(json["b"]["name"], "tustin");
  EXPECT_EQ(json["a"]["steps"], 2000);
}

TEST(Fly, SaysWhatDoesNothing) {
  const ProgramResult windy = run_program({"fly", "mambo", "--wind", "severe", "--duration", "3"});
  EXPECT_THAT(windy.err, HasSubstr("no drag, such as drag_area_m2"));
  EXPECT_THAT(run_program({"fly", "mambo", "--duration", "3"}).err,
              ::testing::Not(HasSubstr("drag")));
}

// The experiments of the model project, unless stated otherwise.
TEST(Compare, FliesThePublishedGainsWithIdealSensors) {
  for (const char* what : {"integrators", "flow"}) {
    const Json json = flown({"compare", what, "mambo", "--duration", "5"});
    EXPECT_EQ(json["a"]["sensors"], "ideal") << what;
    EXPECT_THAT(std::string(json["a"]["law"]), HasSubstr("published")) << what;
  }
  const Json json = flown({"compare", "flow", "mambo", "--duration", "5", "--sensors", "real",
                           "--gains", "designed", "--estimator", "mambo"});
  EXPECT_EQ(json["b"]["sensors"], "real");
  EXPECT_THAT(std::string(json["b"]["law"]), HasSubstr("designed"));
  EXPECT_EQ(json["b"]["estimator"], "mambo");
  EXPECT_EQ(flown({"compare", "integrators", "mambo", "--duration", "5"})["a"]["estimator"],
            "mambo");
  EXPECT_EQ(flown({"compare", "flow", "mambo", "--duration", "5"})["a"]["estimator"],
            "mambo-original");
  EXPECT_THAT(
      std::string(flown({"compare", "integrators", "crazyflie", "--duration", "2"})["a"]["law"]),
      HasSubstr("designed"));  // it has no published gains
}

TEST(Compare, FilterChangesWhatIsBelievedOnly) {
  const Json json =
      flown({"compare", "filter", "mambo", "--mission", "lemniscate-carried", "--duration", "5"});
  EXPECT_EQ(json["a"]["estimator"], "mambo");
  EXPECT_EQ(json["b"]["estimator"], "mambo-raw");
  EXPECT_EQ(json["difference"]["max"]["px"], 0);
  EXPECT_GT(json["difference"]["max"]["believed_px"], 1e-4);
  EXPECT_EQ(json["difference"]["max"]["believed_pz"], 0);
}

TEST(Compare, TheSameGainsDoNotDiffer) {
  const Json json = flown({"compare", "gains", "mambo", "designed", "designed", "--duration", "5"});
  for (const auto& [name, value] : json["difference"]["mean_squared"].items())
    EXPECT_EQ(value, 0) << name;
}

TEST(Compare, FlowTellsTheTwoModelsApart) {
  const Json json = flown({"compare", "flow", "mambo", "--mission", "lemniscate-carried",
                           "--sensors", "ideal", "--estimator", "mambo"});
  // The full flow model, calibrated, recovers the path to a centimetre; the simplified formula
  // lacks the division by the height of 0.6 m.
  EXPECT_LT(json["b"]["estimate_error_m"]["mean_absolute"], 0.01) << json["b"];
  EXPECT_GT(json["a"]["estimate_error_m"]["mean_absolute"], 0.03) << json["a"];
}

/// The design of the Mambo with one mission, whose limit on the tilt is given.
std::vector<std::string> design_with_limit(const TemporaryDirectory& folder, double tilt) {
  folder.write("m.toml",
               replaced(kClimb, "tilt_max_rad = 1", "tilt_max_rad = " + std::to_string(tilt)));
  std::string design = source("designs/uquad-hover.toml");
  design = replaced(design, "name = \"hover\"\nsensors = \"ideal\"", "name = \"m.toml\"");
  return {"design", folder.write("d.toml", design).string(), "-o",
          (folder.path() / "out").string()};
}

TEST(Design, FliesItsMissionsBeforeItWrites) {
  const TemporaryDirectory folder;
  const ProgramResult good = run_program(design_with_limit(folder, 1));
  EXPECT_EQ(good.status, 0) << good.err;
  EXPECT_THAT(good.out, HasSubstr("climb: pass"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "out/K_prop_full.txt"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "out/flight-climb.html"));
}

TEST(Design, RefusesSeedsWithoutAMission) {
  const TemporaryDirectory folder;
  const std::string file = folder
                               .write("d.toml",
                                      "name = \"d\"\nvehicle = \"mambo\"\n[cascade]\ndt_s = 0.005\n"
                                      "[cascade.design]\n")
                               .string();
  const ProgramResult result = run_program({"design", file, "--seeds", "7"});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("--seeds requires a [[mission]] to fly, but"));
  EXPECT_EQ(result.out, "");
}

TEST(Design, WritesNothingWhereAMissionFails) {
  const TemporaryDirectory folder;
  std::vector<std::string> args = design_with_limit(folder, 1e-9);
  const ProgramResult bad = run_program(args);
  EXPECT_EQ(bad.status, 1);
  EXPECT_THAT(bad.err, HasSubstr("nothing is written"));
  EXPECT_THAT(bad.out, HasSubstr("climb: FAIL"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
  args.push_back("--force");
  EXPECT_EQ(run_program(args).status, 1);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "out/K_prop_full.txt"));
}

}  // namespace
}  // namespace quadtune
