// SPDX-License-Identifier: Apache-2.0
/// quadtune log.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "log_files/ulog_writer.hpp"
#include "run_program.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;
using testing::ProgramResult;
using testing::run_program;
using testing::TemporaryDirectory;

TEST(LogVerb, TellsChannelsAsTheContractSays) {
  const TemporaryDirectory folder;
  const std::string file =
      folder.write("f.csv", "t,z[m],n\n0,1,\n0.1,2,5\n0.2,4,5\n0.6,5,5\n").string();
  const ProgramResult result = run_program({"log", file, "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json["format"], "text");
  EXPECT_DOUBLE_EQ(json["duration_s"], 0.6);
  EXPECT_EQ(json["whole"], true);
  ASSERT_EQ(json["channels"].size(), 2U);
  const Json& z = json["channels"][0];
  EXPECT_EQ(z["name"], "z");
  EXPECT_EQ(z["unit"], "m");
  EXPECT_EQ(z["samples"], 4);
  EXPECT_EQ(z["gaps"], 1);
  EXPECT_DOUBLE_EQ(z["longest_gap_s"], 0.4);
  EXPECT_NEAR(double(z["rate_hz"]), 10, 1e-9);
  EXPECT_DOUBLE_EQ(z["mean"], 3);
  EXPECT_EQ(json["channels"][1]["nan"], 1);
  EXPECT_EQ(json["channels"][1]["constant"], true);
  const ProgramResult text = run_program({"log", file});
  EXPECT_THAT(text.out,
              HasSubstr("4 rows at 10 Hz from 0 s, 0.6 s long; 1 gap, the longest 0.4 s"));
  EXPECT_THAT(text.out, HasSubstr("constant, 1 without a value"));
  EXPECT_EQ(text.err, "");
}

TEST(LogVerb, NamesChannelsOfGroupsInFull) {
  const TemporaryDirectory folder;
  const std::string file = folder.write("f.ulg", testing::sample_ulog().bytes()).string();
  const ProgramResult result = run_program({"log", file, "--json"});
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json["channels"].back()["name"], "status.armed");
  EXPECT_EQ(json["dropouts"], 1);
  EXPECT_THAT(run_program({"log", file}).err,
              HasSubstr("the logger itself lost records 1 time, 0.025 s in total"));
}

TEST(LogVerb, SaysWhichModelsItFeedsAndWhatOthersNeed) {
  const TemporaryDirectory folder;
  const std::string file =
      folder.write("f.csv", "t,az,height[m],vx[m/s]\n0,1,2,3\n1,2,3,4\n").string();
  const Json models = Json::parse(run_program({"log", file, "--json"}).out)["models"];
  ASSERT_GE(models.size(), 5U);
  EXPECT_EQ(models[2]["name"], "altitude");
  EXPECT_EQ(models[2]["feeds"], true);
  EXPECT_EQ(models[2]["uses"]["az"], "az");
  EXPECT_EQ(models[2]["missing"], Json::array());
  EXPECT_EQ(models[3]["feeds"], false);
  EXPECT_EQ(models[3]["missing"].size(), 4U);
  EXPECT_EQ(models[3]["missing"][2]["name"], "flow_vx");
  EXPECT_EQ(models[3]["missing"][2]["unit"], "m/s");
  EXPECT_EQ(models[3]["missing"][2]["sensor"], "flow");
  EXPECT_EQ(models[3]["missing"][2]["candidates"][0], "vx");
  const std::string text = run_program({"log", file}).out;
  EXPECT_THAT(text, HasSubstr("altitude: fed by az, height\n"));
  EXPECT_THAT(text, HasSubstr("attitude: needs rate [rad/s], tilt [rad]; use --map rate=CHANNEL"));
}

TEST(LogVerb, WarnsOfATornLogAndReadsItUpToThere) {
  const TemporaryDirectory folder;
  const std::string file = folder.write("f.csv", "t,z\n0,1\n1,2\n2,").string();
  const ProgramResult result = run_program({"log", file, "--json"});
  EXPECT_EQ(result.status, 0);
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json["whole"], false);
  EXPECT_THAT(json["torn"].get<std::string>(), HasSubstr("f.csv:4: the line does not end"));
  EXPECT_EQ(json["channels"][0]["samples"], 2);
  EXPECT_THAT(result.err, HasSubstr("log: warning: partial: "));
}

TEST(LogVerb, NamesTheFormatOfArduPilotsTexts) {
  const TemporaryDirectory folder;
  std::string text = "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n";
  for (int i = 0; i < 100; ++i) text += fmt::format("IMU, {}, 0.1, 0.2, 0.3\nBARO, {}, 1\n", i, i);
  const std::string file = folder.write("00000001.log", text).string();
  const ProgramResult result = run_program({"log", file});
  EXPECT_EQ(result.status, 3);
  EXPECT_THAT(result.err,
              HasSubstr(file + ": is an ArduPilot text log with several kinds of rows"));
  const ProgramResult told = run_program({"log", file, "--format", "text"});
  EXPECT_EQ(told.status, 3);
  EXPECT_THAT(told.err, HasSubstr("200 of 201 rows cannot be read"));
}

TEST(LogVerb, TakesColumnsAndARate) {
  const TemporaryDirectory folder;
  const std::string file = folder.write("f.txt", "0 500000 7\n1 0 8\n").string();
  const Json json = Json::parse(
      run_program({"log", file, "--columns", "t_s:1, t_us:2, height[m]:3", "--json"}).out);
  EXPECT_EQ(json["channels"].size(), 1U);
  EXPECT_EQ(json["channels"][0]["name"], "height");
  EXPECT_DOUBLE_EQ(json["duration_s"], 0.5);
  const Json paced = Json::parse(run_program({"log", file, "--rate", "4", "--json"}).out);
  EXPECT_DOUBLE_EQ(paced["duration_s"], 0.25);
  EXPECT_EQ(paced["channels"].size(), 3U);
}

TEST(LogVerb, RefusesInOneLine) {
  const TemporaryDirectory folder;
  const std::string file = folder.write("f.csv", "t,height\n0,1\n").string();
  const auto refusal = [](std::vector<std::string> args, int status) {
    const ProgramResult result = run_program(args);
    EXPECT_EQ(result.status, status) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    return result.err;
  };
  EXPECT_THAT(refusal({"log"}, 2), HasSubstr("FILE is missing"));
  EXPECT_THAT(refusal({"log", "/nowhere.csv"}, 5), HasSubstr("No such file"));
  EXPECT_THAT(refusal({"log", file, "--format", "ulgo"}, 2), HasSubstr("--format is 'ulgo'"));
  EXPECT_THAT(refusal({"log", file, "--columns", "a:"}, 2), HasSubstr("is not a column"));
  EXPECT_THAT(refusal({"log", file, "--columns", "hight"}, 3), HasSubstr("did you mean 'height'?"));
  EXPECT_THAT(refusal({"log", file, "--rate", "-1"}, 2), HasSubstr("--rate"));
}

// The output of `log` is that of docs/cli/log.md.
TEST(LogVerb, PrintsWhatTheDocsShow) {
  std::filesystem::current_path(testing::source_folder());
  std::ifstream page("docs/cli/log.md");
  std::ostringstream text;
  text << page.rdbuf();
  EXPECT_THAT(text.str(), HasSubstr(run_program({"log", "docs/examples/flight.csv"}).out));
}

}  // namespace
}  // namespace quadtune
