// SPDX-License-Identifier: Apache-2.0
/// `lqr V`: on the flown plant by default, on the ideal plant on request.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "matrix_near.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/flown/flown_lqi.hpp"
#include "run_json.hpp"
#include "run_program.hpp"
#include "sanitized.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using SortedJson = nlohmann::json;
using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::Not;
using testing::ProgramResult;
using testing::run_json;
using testing::run_program;
using testing::TemporaryDirectory;

Eigen::MatrixXd matrix_of(const SortedJson& value) {
  return internal::matrix_from_json(internal::Json::parse(value.dump()), "test");
}

TEST(LqrOfVehicle, HasItsMarginsInTheFlownLoop) {
  for (const char* vehicle : {"mambo", "crazyflie"}) {
    const SortedJson found = run_json({"lqr", vehicle});
    EXPECT_EQ(found["plant"], "flown");
    EXPECT_TRUE(found["flown"]["stable"]);
    EXPECT_TRUE(found["weights"]["margins_met"]);
    ASSERT_EQ(found["margins"]["loops"].size(), 4u);
    for (const SortedJson& loop : found["margins"]["loops"]) {
      EXPECT_GE(loop["phase_margin_deg"], 45) << vehicle << loop["name"];
      EXPECT_GE(loop["gain_margin_db"], 6.02);
      EXPECT_GE(loop["disk_alpha"], 0.5);
    }
  }
}

TEST(LqrOfVehicle, IsTheLawThatFliesByDefault) {
  if (testing::kSanitized) GTEST_SKIP() << "minutes of what other tests run too";
  const TemporaryDirectory folder;
  const std::string file = (folder.path() / "gains.json").string();
  const ProgramResult made = run_program({"lqr", "crazyflie", "--json", "--quiet", "-o", file});
  ASSERT_EQ(made.status, 0) << made.err;
  const std::vector<std::string> fly = {"fly",        "crazyflie", "--mission",
                                        "step-north", "--quiet",   "--json"};
  std::vector<std::string> read = fly, designed = fly;
  read.insert(read.end(), {"--gains", file});
  designed.insert(designed.end(), {"--controller", "state-feedback"});
  const SortedJson one = SortedJson::parse(run_program(read).out);
  const SortedJson other = SortedJson::parse(run_program(designed).out);
  EXPECT_EQ(one["metrics"], other["metrics"]);
  EXPECT_EQ(one["verdict"], "pass");
}

/// Given weights are not changed: the gains are those of the library for the same problem.
TEST(LqrOfVehicle, KeepsGivenWeights) {
  const SortedJson found =
      run_json({"lqr", "crazyflie", "--Q", "4,4,4,9,9,9,1,1,1,0.1,0.1,0.1,1,1,1,1", "--R",
                "1e3,1e6,1e6,1e7", "--past", "2", "--change", "1,2,3,4", "--dt", "0.01"});
  const Vehicle vehicle = load_vehicle("crazyflie");
  ActuatorLqiWeights weights;
  weights.Q =
      Eigen::VectorXd((Eigen::VectorXd(12) << 4, 4, 4, 9, 9, 9, 1, 1, 1, 0.1, 0.1, 0.1).finished())
          .asDiagonal();
  weights.Q_integral = Eigen::MatrixXd::Identity(4, 4);
  weights.R = Eigen::Vector4d(1e3, 1e6, 1e6, 1e7).asDiagonal();
  weights.R_change = Eigen::Vector4d(1, 2, 3, 4).asDiagonal();
  ActuatorLqiOptions options;
  options.dt = 0.01;
  options.past = 2;
  options.integrals = {"px", "py", "pz", "yaw"};
  const ActuatorLqi lqi = actuator_lqi(vehicle, weights, options);
  ASSERT_TRUE(lqi.solved());
  EXPECT_THAT(matrix_of(found["K"]), MatrixNear(lqi.gains.K, 1e-8 * lqi.gains.K.norm()));
  EXPECT_THAT(matrix_of(found["K_int"]),
              MatrixNear(lqi.gains.K_int, 1e-8 * lqi.gains.K_int.norm()));
  EXPECT_THAT(matrix_of(found["memory"]["K_past"]),
              MatrixNear(lqi.gains.memory->K_past, 1e-8 * lqi.gains.memory->K_past.norm()));
  EXPECT_EQ(found["weights"]["softened"], SortedJson({1, 1, 1, 1}));
}

/// A larger weight on changes of the commands gives a law that moves its commands less.
TEST(LqrOfVehicle, WeightsOnChangesSlowTheCommands) {
  if (testing::kSanitized) GTEST_SKIP() << "minutes of what other tests run too";
  const SortedJson without =
      run_json({"lqr", "mambo", "--past", "2", "--R", "141,113273,113273,3.8e7"});
  const SortedJson with = run_json({"lqr", "mambo", "--past", "2", "--R", "141,113273,113273,3.8e7",
                                    "--change", "1e3,1e6,1e6,1e9"});
  for (int i = 1; i < 4; ++i)
    EXPECT_LT(with["margins"]["loops"][i]["crossover"],
              without["margins"]["loops"][i]["crossover"]);
}

/// A file does not request true states as an estimator.
TEST(LqrOfVehicle, AFileNamesAnEstimatorOrNone) {
  EXPECT_EQ(run_json({"lqr", "mambo"})["estimator"]["name"], "general");
  EXPECT_TRUE(run_json({"lqr", "mambo", "--estimator", "truth"}).at("estimator").is_null());
}

TEST(LqrOfVehicle, IntegratesWhatIsAsked) {
  if (testing::kSanitized) GTEST_SKIP() << "minutes of what other tests run too";
  EXPECT_EQ(run_json({"lqr", "mambo"})["integrals"], SortedJson({"px", "py", "pz", "yaw"}));
  EXPECT_EQ(run_json({"lqr", "mambo", "--integral", "pz"})["integrals"], SortedJson({"pz"}));
  EXPECT_EQ(run_json({"lqr", "mambo", "--integral", "none"})["integrals"], SortedJson::array());
}

TEST(LqrOfVehicle, TellsOfTheFlownLoopOfTheIdealPlantsGains) {
  // Weights that give a fast loop on the ideal plant: stable there, unstable with a lag of 72 ms.
  const std::vector<std::string> fast = {
      "lqr",      "crazyflie",      "--plant", "ideal",
      "--inputs", "wrench",         "--Q",     "16,16,16,25,25,8,4,4,4,0.25,0.25,0.25",
      "--R",      "400,7e5,7e5,2e7"};
  const SortedJson found = run_json(fast);
  EXPECT_EQ(found["plant"], "ideal");
  for (const SortedJson& loop : found["margins"]["loops"]) EXPECT_TRUE(loop["stable"]);
  EXPECT_FALSE(found["flown"]["stable"]);
  const ProgramResult text = run_program(fast);
  EXPECT_EQ(text.status, 0);
  EXPECT_THAT(text.out, HasSubstr("UNSTABLE"));
  EXPECT_THAT(text.err, HasSubstr("warning: with the rotors' lag, the sensors and the estimator "
                                  "the loop is unstable"));
  // The flown loop is defined for a hover whose heading is north, in all states.
  for (const std::vector<std::string>& other :
       {std::vector<std::string>{"--at", "line", "--speed", "1"},
        {"--yaw", "1.5"},
        {"--states", "no-position"}}) {
    std::vector<std::string> args = {"lqr", "mambo"};
    args.insert(args.end(), other.begin(), other.end());
    EXPECT_TRUE(run_json(args)["flown"].is_null()) << other[0];
    EXPECT_THAT(run_program(args).err, Not(HasSubstr("unstable")));
  }
  // A period that cannot be flown does not change the design.
  const ProgramResult quick =
      run_program({"lqr", "mambo", "--method", "sampled", "--dt", "0.00005"});
  EXPECT_EQ(quick.status, 0);
  EXPECT_THAT(quick.err, HasSubstr("note: the flown loop is not analysed: "));
}

TEST(LqrOfVehicle, OptionsOfTheIdealPlantImplyIt) {
  const ProgramResult implied = run_program({"lqr", "mambo", "--convention", "mambo"});
  EXPECT_EQ(implied.status, 0);
  EXPECT_THAT(implied.err, HasSubstr("lqr: note: --convention implies --plant ideal"));
  const ProgramResult named =
      run_program({"lqr", "mambo", "--convention", "mambo", "--plant", "ideal"});
  EXPECT_THAT(named.err, Not(HasSubstr("implies")));
  EXPECT_EQ(named.out, implied.out);
}

TEST(LqrOfVehicle, RefusesWhatDoesNotGoTogether) {
  const auto refused = [](std::vector<std::string> args, const char* message) {
    args.insert(args.begin(), {"lqr", "mambo"});
    const ProgramResult result = run_program(args);
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_EQ(result.out, "");
  };
  refused({"--plant", "idea"}, "--plant is 'idea', expected flown or ideal; did you mean 'ideal'?");
  refused({"--plant", "flown", "--at", "line"}, "--at belongs to --plant ideal");
  refused({"--plant", "ideal", "--past", "2"}, "--past belongs to the flown plant");
  refused({"--method", "sampled", "--dt", "0.01", "--past", "2"},
          "--past belongs to the flown plant and cannot be combined with --method");
  refused({"--past", "2.5"}, "--past is 2.5, expected an integer from 0 to 40");
  refused({"--change", "1", "--past", "0"}, "expected --past of at least 1");
  refused({"--height", "-1"}, "--height is -1, expected a positive number of metres");
  refused({"--sensors", "bad"}, "--sensors is 'bad', expected ideal or real");
  refused({"--Q", "1,2"}, "--Q has 2 entries, expected 16 or a single one for all");
  refused({"--integral", "pw"}, "unknown state 'pw'");
  refused({"--dt", "0.0005"},
          "quadtune lqr: --dt is too short for the estimator: gyroscope.lag is 0.01469");
  refused({"--structure", "matri"}, "--structure is 'matri', expected dynamic or matrix");
  for (const char* option : {"--past", "--change", "--integral"})
    refused({"--structure", "matrix", option, "1"},
            "cannot be combined with --structure matrix, because that law always integrates "
            "px,py,pz,yaw");
  refused({"--plant", "ideal", "--structure", "matrix"}, "--structure belongs to the flown plant");
  refused({"--structure", "matrix", "--at", "line"}, "--structure belongs to the flown plant");
}

/// A matrix, exported to each program that can store one: its signs are those of a published law,
/// it is verified, and the gains that are read back fly and have the same margins.
TEST(LqrMatrix, IsExportedVerifiedAndFlown) {
  if (testing::kSanitized) GTEST_SKIP() << "minutes of flights that other tests fly, too";
  const testing::TemporaryDirectory folder;
  for (const std::string program : {"uquad", "mambo"}) {
    const bool uquad = program == "uquad";
    const std::string file =
        folder
            .write(program + ".toml",
                   fmt::format("name = 'm'\nvehicle = '{0}'\n"
                               "[lqr]\nplant = 'flown'\nstructure = 'matrix'\n"
                               "convention = '{0}'\ninputs = '{1}'\ndt_s = {2}\n"
                               "[[mission]]\nname = 'take-off-and-land'\n"
                               "[[export]]\nto = '{0}'\n",
                               program, uquad ? "rotor-speed" : "wrench", uquad ? 0.01 : 0.005))
            .string();
    const std::string out = (folder.path() / program).string();
    const ProgramResult made = run_program({"design", file, "-o", out, "--json"});
    ASSERT_EQ(made.status, 0) << made.err;
    const SortedJson report = SortedJson::parse(made.out);
    EXPECT_EQ(report["verdict"], "pass");
    EXPECT_EQ(report["lqr"]["structure"], "matrix");
    EXPECT_EQ(report["lqr"]["flown"]["estimator"], program);
    EXPECT_EQ(report["missions"][0]["estimator"], program);
    EXPECT_EQ(run_program({"verify", out}).status, 0);
    EXPECT_EQ(run_json({"margins", program, "--gains", file})["loops"],
              report["lqr"]["margins"]["loops"]);
    const ProgramResult flown =
        run_program({"fly", program, "--gains", out, "--estimator", program, "--mission", "hover"});
    EXPECT_EQ(flown.status, 0) << flown.out << flown.err;
    EXPECT_THAT(run_program({"design", file}).out, HasSubstr("plants of the design\n"));
    if (!uquad) continue;
    const SortedJson published =
        run_json({"design", testing::source_folder() + "/designs/uquad-hover.toml"});
    const SortedJson &K = report["lqr"]["K"], &there = published["lqr"]["K"];
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 12; ++j) {
        EXPECT_GE(double(K[i][j]) * double(there[i][j]), 0) << i << " " << j;
        EXPECT_EQ(double(K[i][j]) == 0, std::abs(double(there[i][j])) < 1e-9) << i << " " << j;
      }
  }
}

TEST(LqrMatrix, TellsWhatItNeeds) {
  const ProgramResult zero = run_program({"lqr", "mambo", "--structure", "matrix", "--Q", "0"});
  EXPECT_EQ(zero.status, 2);
  EXPECT_THAT(zero.err, HasSubstr("--Q: the weight of px is 0; expected more than 0"));
  const ProgramResult dynamic =
      run_program({"lqr", "mambo", "--structure", "dynamic", "--convention", "mambo"});
  EXPECT_EQ(dynamic.status, 2);
  EXPECT_THAT(
      dynamic.err,
      HasSubstr(
          "--convention cannot be combined with --structure dynamic; expected --structure matrix"));
}

}  // namespace
}  // namespace quadtune
