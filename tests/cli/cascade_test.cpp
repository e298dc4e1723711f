// SPDX-License-Identifier: Apache-2.0
/// quadtune pid V and discretize V --compare: the reports of a vehicle's loops.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "plants/designed_mambo.hpp"
#include "run_program.hpp"
#include "sanitized.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::ContainsRegex;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::ProgramResult;
using testing::run_program;

Json cascade_json(std::vector<std::string> args) {
  args.emplace_back("--json");
  const ProgramResult result = run_program(args);
  EXPECT_EQ(result.status, 0) << result.err;
  return Json::parse(result.out);
}

std::vector<std::string> loop_names(const Json& loops) {
  std::vector<std::string> names;
  for (const Json& loop : loops) names.push_back(loop["name"]);
  return names;
}

// The JSON of `pid V` is the cascade that `fly V` flies, limits included.
TEST(PidOfAVehicle, JsonIsTheLawThatFlies) {
  const Json loops = cascade_json({"pid", "mambo", "--method", "loops"})["cascade"];
  EXPECT_EQ(loops["attitude_limit_rad"], 3);
  EXPECT_EQ(loops["integrator_limit"], 2);
  EXPECT_EQ(loops["back_calculation_per_s"], 2);
  EXPECT_EQ(loops["velocity_feed_forward"], true);
  EXPECT_EQ(loops["conditional_integration"], true);
  const Json flown = cascade_json({"pid", "mambo"})["cascade"];
  EXPECT_EQ(flown["attitude_limit_rad"], 0.5);
  EXPECT_EQ(flown["integrator_limit"], 2);
}

// The designed gains of flights in other tests and benchmarks are those of the loop-by-loop rules.
TEST(PidOfAVehicle, IsTheMamboThatOthersFly) {
  const Json json = cascade_json({"pid", "mambo", "--method", "loops"});
  for (const testing::DesignedLoop& flown : testing::kDesignedMambo)
    for (const Json& loop : json["loops"]) {
      if (loop["name"] != flown.name) continue;
      EXPECT_NEAR(loop["Kp"], flown.Kp, 5e-4 * std::abs(flown.Kp)) << flown.name;
      EXPECT_NEAR(loop["Ki"], flown.Ki, 5e-4 * std::abs(flown.Ki)) << flown.name;
      EXPECT_NEAR(loop["Kd"], flown.Kd, 5e-4 * std::abs(flown.Kd)) << flown.name;
    }
}

TEST(PidOfAVehicle, IsBetterThanWhatIsPublished) {
  const Json json = cascade_json({"pid", "mambo", "--method", "loops"});
  EXPECT_EQ(json["published"], "table 3.3 of the Mambo thesis");
  EXPECT_EQ(json["dt"], 0.005);
  EXPECT_EQ(json["integrator"], "euler");
  EXPECT_THAT(loop_names(json["loops"]), ElementsAre("roll", "pitch", "yaw", "altitude", "y", "x"));
  EXPECT_THAT(loop_names(json["margins"]["loops"]), ElementsAre("T", "tau_x", "tau_y", "tau_z"));
  EXPECT_LT(double(json["spectral_radius"]), 1);
  for (const Json& loop : json["loops"]) {
    const Json& there = loop["published"];
    EXPECT_LT(double(loop["Ms"]), double(there["Ms"])) << loop["name"];
    EXPECT_TRUE(there["load_integral"].is_null() ||
                double(loop["load_integral"]) < double(there["load_integral"]));
    EXPECT_LE(double(loop["load_peak"]), double(there["load_peak"]) * (1 + 1e-6));
    EXPECT_LE(double(loop["value_noise"]), double(there["value_noise"]) * (1 + 1e-6));
    EXPECT_LE(double(loop["rate_noise"]), double(there["rate_noise"]) * (1 + 1e-6));
  }
  const ProgramResult text = run_program({"pid", "mambo", "--method", "loops"});
  EXPECT_EQ(text.status, 0);
  EXPECT_THAT(text.out, HasSubstr("no regressions"));
  EXPECT_THAT(text.out, HasSubstr("closed      stable"));
}

TEST(PidOfAVehicle, TellsWhatItIsNotBetterAt) {
  const ProgramResult result = run_program({"pid", "mambo", "--free"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("regressions: roll (Ms - 1)"));
}

// A measured vehicle is never exactly symmetric. Any coupling of the axes, however small, made the
// search on the flown plant fail.
TEST(PidOfAVehicle, HardlyDependsOnASmallAsymmetry) {
  const testing::TemporaryDirectory folder;
  const std::string text = load_vehicle("crazyflie").text;
  const auto gains = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    return cascade_json({"pid", folder.write("v.toml", changed).string()})["loops"];
  };
  const Json symmetric = gains("spin", "spin");
  for (const auto& [from, to] :
       {std::pair<std::string, std::string>(
            "inertia_kg_m2 = [1.43e-5, 1.43e-5, 2.89e-5]",
            "inertia_kg_m2 = [[1.43e-5, 0, 1e-17], [0, 1.43e-5, 0], [1e-17, 0, 2.89e-5]]"),
        std::pair<std::string, std::string>("[0.03040559159102154, -0.0304055",
                                            "[0.0305, -0.0304")}) {
    const Json loops = gains(from, to);
    ASSERT_EQ(loops.size(), symmetric.size());
    for (std::size_t i = 0; i < loops.size(); ++i)
      EXPECT_NEAR(double(loops[i]["Kp"]) / double(symmetric[i]["Kp"]), 1, 0.02)
          << to << " " << loops[i]["name"];
  }
}

TEST(PidOfAVehicle, TakesTheVehiclesMotorLag) {
  const Json json = cascade_json({"pid", "crazyflie"});
  EXPECT_EQ(json["motor_lag_s"], 0.072);
  EXPECT_TRUE(json["published"].is_null());
  EXPECT_EQ(cascade_json({"pid", "crazyflie", "--motor-lag", "0"})["motor_lag_s"], 0);
}

/// The flown loop is reported whatever plant the gains were designed for; on the ideal plant rotors
/// have no lag, and `margins` of the same gains agrees.
TEST(PidOfAVehicle, TellsTheFlownLoopToo) {
  const Json ideal = cascade_json({"pid", "crazyflie", "--plant", "ideal"});
  EXPECT_EQ(ideal["plant"], "ideal");
  EXPECT_EQ(ideal["method"], "loops");
  EXPECT_EQ(ideal["motor_lag_s"], 0);
  EXPECT_FALSE(ideal["flown_loop"]["stable"]);
  const ProgramResult warned = run_program({"pid", "crazyflie", "--plant", "ideal"});
  EXPECT_EQ(warned.status, 0);
  EXPECT_THAT(warned.err, HasSubstr("pid: warning: the flown loop is unstable; "));
  EXPECT_THAT(warned.err, HasSubstr("without --plant ideal the design includes the rotors' lag"));
  const testing::TemporaryDirectory folder;
  const std::string file = (folder.path() / "gains.json").string();
  ASSERT_EQ(run_program({"pid", "crazyflie", "--plant", "ideal", "--json", "-o", file}).status, 0);
  const Json margins = cascade_json({"margins", "crazyflie", "--gains", file});
  for (std::size_t i = 0; i < 4; ++i)
    for (const char* key : {"phase_margin_deg", "Ms"}) {
      EXPECT_EQ(ideal["margins"]["loops"][i][key], margins["ideal"]["loops"][i][key]) << key;
      EXPECT_EQ(ideal["flown_loop"]["margins"]["loops"][i][key], margins["loops"][i][key]) << key;
    }
  const Json loops = cascade_json({"pid", "crazyflie", "--method", "loops"});
  EXPECT_EQ(loops["plant"], "lag");
  EXPECT_TRUE(loops["flown_loop"]["stable"]);
  EXPECT_TRUE(cascade_json({"pid", "crazyflie"})["flown_loop"]["stable"]);
  const ProgramResult both = run_program({"pid", "mambo", "--method", "flown", "--plant", "ideal"});
  EXPECT_EQ(both.status, 2);
  EXPECT_THAT(both.err, HasSubstr("--method flown does not support --plant ideal"));
  const auto refused = [](std::vector<std::string> args, const char* message) {
    args.insert(args.begin(), {"pid", "mambo", "--plant", "ideal"});
    const ProgramResult result = run_program(args);
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(result.err, HasSubstr(message));
  };
  refused({"--method", "loop"}, "--method is 'loop', expected flown or loops");
  refused({"--motor-lag", "0.05"}, "--motor-lag does not apply to --plant ideal");
}

TEST(PidOfAVehicle, MeetsABandwidth) {
  const Json json = cascade_json({"pid", "uquad", "--bandwidth", "roll=40,x=1.5", "--integral",
                                  "roll", "--integrator", "tustin", "--dt", "0.01"});
  for (const Json& loop : json["loops"]) {
    if (loop["name"] == "roll") {
      EXPECT_NEAR(loop["rate_crossover"], 40, 1e-6);
    }
    if (loop["name"] == "x") {
      EXPECT_NEAR(loop["rate_crossover"], 1.5, 1e-6);
    }
    EXPECT_EQ(loop["Ki"] != 0, loop["name"] == "roll") << loop["name"];
  }
}

TEST(PidOfAVehicle, SaysTheHighestBandwidthThatCanBeHad) {
  const ProgramResult result = run_program({"pid", "mambo", "--bandwidth", "roll=400"});
  EXPECT_EQ(result.status, 4);
  EXPECT_THAT(result.err, HasSubstr("roll: crossover out of reach"));
  EXPECT_THAT(result.err, HasSubstr("expected less than 115.9"));
  EXPECT_TRUE(result.out.empty());
  // With this bandwidth it succeeds.
  EXPECT_EQ(run_program({"pid", "mambo", "--bandwidth", "roll=114"}).status, 0);
}

TEST(PidOfAVehicle, HasALeadOnRequest) {
  const Json loops = cascade_json({"pid", "crazyflie", "--rate-lead", "0.01"})["loops"];
  for (const Json& loop : loops) {
    const bool tilt = loop["name"] == "roll" || loop["name"] == "pitch";
    EXPECT_EQ(loop.contains("rate_lead_s"), tilt) << loop;
    if (!tilt) continue;
    EXPECT_EQ(loop["rate_lead_s"], 0.01);
    EXPECT_EQ(loop["rate_filter_s"], 0.0025);
  }
  const testing::TemporaryDirectory folder;
  const std::string file =
      folder
          .write("lead.toml",
                 "name = 'lead'\nvehicle = 'crazyflie'\n[cascade]\ndt_s = " +
                     cascade_json({"pid", "crazyflie"})["dt"].dump() +
                     "\n[cascade.design]\nrate_lead_s = 0.01\n[[export]]\nto = 'json'\n")
          .string();
  const std::string out = (folder.path() / "out").string();
  const ProgramResult designed = run_program({"design", file, "-o", out});
  ASSERT_EQ(designed.status, 0) << designed.err;
  std::ifstream stored(out + "/gains.json");
  const Json designed_loops = Json::parse(stored)["cascade"]["loops"];
  for (const Json& loop : loops) {
    const auto same = std::find_if(designed_loops.begin(), designed_loops.end(),
                                   [&](const Json& one) { return one["name"] == loop["name"]; });
    ASSERT_NE(same, designed_loops.end());
    for (const char* key : {"Kp", "Ki", "Kd", "rate_lead_s", "rate_filter_s"})
      EXPECT_EQ(same->value(key, Json(0)), loop.value(key, Json(0))) << key << " of " << loop;
  }
}

TEST(PidOfAVehicle, RefusesALeadThatItCannotDesign) {
  const auto said = [](std::vector<std::string> options) {
    options.insert(options.begin(), "pid");
    const ProgramResult refused = run_program(options);
    EXPECT_EQ(refused.status, 2);
    return refused.err;
  };
  EXPECT_THAT(said({"mambo", "--rate-lead", "2"}),
              HasSubstr("--rate-lead is 2 s, expected 0 to 1"));
  EXPECT_THAT(said({"mambo", "--rate-lead", "nan"}), HasSubstr("--rate-lead"));
  EXPECT_THAT(said({"mambo", "--rate-lead", "0.01", "--Ms-max", "1.5"}),
              HasSubstr("--rate-lead cannot be combined with --Ms-max"));
  EXPECT_THAT(said({"--num", "1", "--den", "1,1", "--rate-lead", "0.01"}),
              HasSubstr("--rate-lead belongs to a vehicle"));
}

// A satellite receiver below 5 Hz alone: such loops are designed one by one.
TEST(DesignOfACascade, RefusesALeadForLoopsThatAreDesignedOneByOne) {
  const testing::TemporaryDirectory folder;
  const std::string vehicle = folder.path() / "slow.toml";
  ASSERT_EQ(run_program({"vehicle", "new", "slow", "--mass", "1240g", "--arm", "225mm",
                         "--propeller", "9.4in", "-o", vehicle})
                .status,
            0);
  std::ifstream file(vehicle);
  std::ostringstream whole;
  whole << file.rdbuf();
  std::string text = whole.str();
  const std::size_t gps = text.find("rate_Hz = 5\n", text.find("[sensors.gps]"));
  ASSERT_NE(gps, std::string::npos);
  text.replace(gps, 11, "rate_Hz = 2");
  folder.write("slow.toml", text);
  const std::string design =
      folder
          .write("lead.toml",
                 "name = 'lead'\nvehicle = 'slow.toml'\n[cascade]\ndt_s = 0.005\n"
                 "[cascade.design]\nrate_lead_s = 0.02\n")
          .string();
  const ProgramResult refused = run_program({"design", design});
  EXPECT_EQ(refused.status, 3);
  EXPECT_THAT(refused.err, HasSubstr("lead.toml: cascade.design.rate_lead_s requires a design on "
                                     "the flown plant"));
}

TEST(DesignOfACascade, FailsWhenTheCascadeDoesNotHoldTheVehicle) {
  const testing::TemporaryDirectory folder;
  const std::string head = "name = \"c\"\nvehicle = \"mambo\"\n[cascade]\ndt_s = 0.005\n";
  const std::string loops =
      "x = { Kp = -0.24, Kd = 0.1 }\ny = { Kp = 0.24, Kd = -0.1 }\n"
      "pitch = { Kp = 0.013, Ki = 0.01, Kd = -0.002 }\n"
      "roll = { Kp = 0.01, Ki = 0.01, Kd = -0.003 }\nyaw = { Kp = 0.004, Kd = -0.0012 }\n";
  const std::string good =
      folder.write("good.toml", head + loops + "altitude = { Kp = 0.8, Ki = 0.1, Kd = -0.5 }\n")
          .string();
  const std::string wrong_sign =
      folder.write("bad.toml", head + loops + "altitude = { Kp = -0.8, Ki = -0.1, Kd = 0.5 }\n")
          .string();
  const ProgramResult held = run_program({"design", good});
  EXPECT_EQ(held.status, 0) << held.err;
  // Its loops of x and y are as weakly damped as in the thesis.
  EXPECT_THAT(held.out, HasSubstr("cascade: loop y: phase margin 8."));
  EXPECT_THAT(held.out, HasSubstr("pass with warnings"));
  const ProgramResult lost = run_program({"design", wrong_sign});
  EXPECT_EQ(lost.status, 1);
  EXPECT_THAT(lost.err, HasSubstr("the cascade does not hold the vehicle"));
  EXPECT_THAT(lost.out, HasSubstr("UNSTABLE"));
  EXPECT_THAT(lost.out, HasSubstr("verdict     fail"));
}

// Without a mission it is not flown: the flown loop alone must prevent the export.
TEST(DesignOfStateFeedback, IsRefusedWhereItsFlownLoopIsUnstable) {
  const testing::TemporaryDirectory folder;
  const auto design = [&](const std::string& R) {
    return folder
        .write("d.toml",
               "name = \"d\"\nvehicle = \"crazyflie\"\n[lqr]\ninputs = \"wrench\"\n"
               "Q = [25, 25, 8.2, 0.25, 0.25, 0.25, 16, 16, 16, 4, 4, 4]\nR = " +
                   R + "\nmethod = \"sampled\"\ndt_s = 0.005\n[[export]]\nto = \"json\"\n")
        .string();
  };
  const std::string out = (folder.path() / "out").string();
  const ProgramResult refused = run_program({"design", design("[810, 3e4, 3e4, 1e7]"), "-o", out});
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.err, HasSubstr("the flown loop is unstable, so nothing is written"));
  EXPECT_THAT(refused.out, HasSubstr("closed loop largest |z| = 0.99"));
  EXPECT_THAT(refused.out, HasSubstr("flown loop  state feedback: hover at 1.1 m"));
  EXPECT_THAT(refused.out, HasSubstr("it would be stable with rotors without lag"));
  EXPECT_FALSE(std::filesystem::exists(out));
  const Json json =
      Json::parse(run_program({"design", design("[810, 3e4, 3e4, 1e7]"), "--json"}).out);
  EXPECT_EQ(json["verdict"], "fail");
  EXPECT_EQ(json["flown"][0]["loop"]["stable"], false);
  EXPECT_EQ(run_program({"design", design("[810, 3e4, 3e4, 1e7]"), "-o", out, "--force"}).status,
            1);
  EXPECT_TRUE(std::filesystem::exists(out + "/gains.json"));
  // Barely stable, which the ideal plant does not show.
  const ProgramResult weak = run_program({"design", design("[810, 1.3e5, 1.3e5, 1e7]")});
  EXPECT_EQ(weak.status, 0) << weak.err;
  EXPECT_THAT(weak.out, HasSubstr("flown loop: loop tau_x: phase margin 0."));
  EXPECT_THAT(weak.out, HasSubstr("verdict     pass with warnings"));
}

// By default, a law is not given states that no sensor can measure.
TEST(Sensors, ThatFeedNoEstimatorAreRefused) {
  const testing::TemporaryDirectory folder;
  std::ostringstream whole;
  whole << std::ifstream(testing::source_folder() + "/vehicles/mambo.toml").rdbuf();
  std::string text = whole.str();
  const std::size_t from = text.find("[sensors.barometer]");
  ASSERT_NE(from, std::string::npos);
  text.erase(from, text.find("# What the model project flies") - from);
  const std::string blind = folder.write("blind.toml", text).string();
  for (const char* verb : {"fly", "lqr"}) {
    const ProgramResult refused = run_program({verb, blind});
    EXPECT_EQ(refused.status, 3) << verb;
    EXPECT_THAT(
        refused.err,
        HasSubstr(blind + ": the sensors do not suffice for any estimator: no optical flow"));
  }
  EXPECT_EQ(run_program({"fly", blind, "--estimator", "truth", "--duration", "5"}).status, 1);
  const ProgramResult designed = run_program({"pid", blind});
  EXPECT_EQ(designed.status, 0) << designed.err;
  EXPECT_THAT(designed.err, HasSubstr("the gains are designed for true states"));
}

TEST(Sensors, WithoutAGyroscopeTheMessageIsNotAboutAnOptionThatWasNotGiven) {
  const testing::TemporaryDirectory folder;
  std::ostringstream whole;
  whole << std::ifstream(testing::source_folder() + "/vehicles/uquad.toml").rdbuf();
  std::string text = whole.str();
  const std::size_t from = text.find("[sensors.gyroscope]");
  ASSERT_NE(from, std::string::npos);
  text.erase(from, text.find('[', from + 1) - from);
  const std::string file = folder.write("no_gyroscope.toml", text).string();
  const ProgramResult refused = run_program({"fly", file});
  EXPECT_EQ(refused.status, 3);
  EXPECT_THAT(refused.err,
              HasSubstr(file + ": the sensors do not suffice for any estimator: no gyroscope"));
}

TEST(Comparison, HasEveryMethodAtThreePeriods) {
  const Json json = cascade_json({"discretize", "mambo", "--compare", "--dt", "0.005"});
  EXPECT_EQ(json["vehicle"], "mambo");
  std::map<std::string, std::map<std::string, std::vector<double>>> poles;
  for (const Json& row : json["methods"]) {
    EXPECT_TRUE(row["stable"]) << row.dump();
    poles[row["law"]][row["name"]].push_back(row["pole_error"]);
    if (row["name"] == "zoh") {
      EXPECT_LT(double(row["step_error"]), 1e-9);
    }
  }
  // The laws on the flown plant, with the estimator: the Mambo has a phase margin of 30 degrees
  // with each.
  ASSERT_EQ(json["flown"].size(), 12U);
  for (const Json& row : json["flown"]) {
    EXPECT_TRUE(row["stable"]) << row.dump();
    EXPECT_EQ(row["estimator"], "general");
    EXPECT_GT(double(row["phase_margin_deg"]), 30) << row.dump();
    EXPECT_LT(double(row["Ms"]), 2.5) << row.dump();
  }
  ASSERT_EQ(poles.size(), 2U);
  EXPECT_EQ(poles["lqr"].size(), 8U);
  EXPECT_EQ(poles["cascade"].size(), 10U);
  for (auto& [law, methods] : poles) {
    for (auto& [name, errors] : methods) EXPECT_EQ(errors.size(), 3U) << law << " " << name;
    EXPECT_LT(methods["matched"][1], 1e-8);
    // Twice the period doubles the error of a first-order method and quadruples that of Tustin's.
    EXPECT_NEAR(methods["euler"][1] / methods["euler"][0], 2, 0.2);
    EXPECT_NEAR(methods["tustin"][1] / methods["tustin"][0], 4, 0.1);
  }
}

TEST(Comparison, LosesStabilityAtThePeriodThatItSays) {
  if (testing::kSanitized) GTEST_SKIP() << "a sanitizer learns no more from the second comparison";
  const Json json =
      cascade_json({"discretize", "mambo", "--compare", "--dt", "0.005", "--plant", "ideal"});
  EXPECT_FALSE(json.contains("flown"));
  for (const Json& row : json["methods"]) {
    if (row["law"] != "lqr" || row["dt"] != 0.005) continue;
    if (row["name"] == "tustin") {
      EXPECT_TRUE(row["stable_up_to_s"].is_null());
    }
    if (row["name"] == "euler") {
      const double limit = row["stable_up_to_s"];
      const std::string beyond = std::to_string(1.01 * limit);
      const std::string within = std::to_string(0.99 * limit);
      for (const auto& [dt, stable] : {std::pair(beyond, false), std::pair(within, true)}) {
        const Json there =
            cascade_json({"discretize", "mambo", "--compare", "--dt", dt, "--plant", "ideal"});
        for (const Json& other : there["methods"])
          if (other["law"] == "lqr" && other["name"] == "euler" &&
              std::abs(double(other["dt"]) - std::stod(dt)) < 1e-9) {
            EXPECT_EQ(other["stable"], stable) << dt;
          }
      }
    }
  }
}

TEST(Comparison, SaysWhatIsLostOnTheFlownPlant) {
  if (testing::kSanitized) GTEST_SKIP() << "a sanitizer learns no more from the second comparison";
  const ProgramResult crazyflie =
      run_program({"discretize", "crazyflie", "--compare", "--dt", "0.005"});
  EXPECT_EQ(crazyflie.status, 0) << crazyflie.err;
  EXPECT_THAT(crazyflie.out,
              HasSubstr("on the flown plant: rotor lag, sensors, estimator general"));
  EXPECT_THAT(crazyflie.out, ContainsRegex("0.01 s: unstable; deviations double in"));
}

}  // namespace
}  // namespace quadtune
