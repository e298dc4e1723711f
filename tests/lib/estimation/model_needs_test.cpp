// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/model_needs.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/estimation/record_of_log.hpp"
#include "quadtune/logs/log_channels.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;
using testing::TemporaryDirectory;

ModelNeeds needs(const std::string& model, const std::string& log) {
  const TemporaryDirectory folder;
  const auto reader = open_log(folder.write("log.csv", log).string());
  return model_needs(signals_of(load_filter_model(model)), survey_log(*reader));
}

TEST(ModelNeeds, FindsInputsAndOutputsByName) {
  const ModelNeeds found = needs("altitude", "t,az[m/s^2],height\n0,1,2\n0.1,2,3\n");
  EXPECT_TRUE(found.feeds);
  EXPECT_THAT(found.uses, ElementsAre(Pair("az", "az"), Pair("height", "height")));
  EXPECT_THAT(found.missing, IsEmpty());
  EXPECT_EQ(to_text(found), "altitude: fed by az, height");
}

TEST(ModelNeeds, NamesWhatIsMissingAndWhatMayBeMeant) {
  const ModelNeeds found =
      needs("altitude", "t,sonar_height[m],baro[m],acc_x[m/s^2],mode\n0,1,2,3,4\n1,2,3,4,4\n");
  EXPECT_FALSE(found.feeds);
  ASSERT_EQ(found.missing.size(), 2u);
  EXPECT_EQ(found.missing[0].signal.name, "az");
  EXPECT_EQ(found.missing[0].sensor, "");
  EXPECT_THAT(found.missing[0].candidates, ElementsAre("acc_x"));
  EXPECT_EQ(found.missing[1].sensor, "sonar");
  EXPECT_THAT(found.missing[1].candidates, ElementsAre("sonar_height", "baro"));
  EXPECT_EQ(to_text(found),
            "altitude: needs az [m/s2], height [m]; use --map az=CHANNEL if one of them is "
            "named differently\n"
            "  az may be acc_x\n"
            "  height may be sonar_height, baro");
}

TEST(ModelNeeds, SaysHowToNameOneThatIsMissing) {
  EXPECT_EQ(to_text(needs("altitude", "t,height\n0,1\n1,2\n")),
            "altitude: needs az [m/s2]; use --map az=CHANNEL if it is named differently");
}

TEST(ModelNeeds, RefusesOtherUnitsAndUselessChannels) {
  const auto why = [](const std::string& log) {
    const ModelNeeds found = needs("altitude", log);
    EXPECT_FALSE(found.feeds) << log;
    return found.missing.empty() ? "" : found.missing.back().why;
  };
  EXPECT_EQ(why("t,az,height[cm]\n0,1,2\n1,1,3\n"), "is in cm, expected m");
  EXPECT_EQ(why("t,az,height\n0,1,\n1,1,\n"), "has no values");
  EXPECT_EQ(why("t,az,height\n0,1,3\n1,1,\n"), "has only one sample");
  EXPECT_EQ(why("t,az,height\n0,1,3\n0,1,4\n1,1,5\n"),
            "has times that do not increase; use --rate HZ for a text");
  EXPECT_EQ(why("az,height\n1,3\n1,4\n1,5\n"), "has no time; use --rate HZ for a text");
}

// A log of two accelerometers: records of it need a choice.
TEST(ModelNeeds, LeavesAChoiceBetweenTablesToTheUser) {
  LogSurvey log;
  const auto add = [&](const std::string& group, const std::string& name, const std::string& unit) {
    log.groups.push_back({{group, {{name, unit}}, true}, 10, {}});
    LogChannelSurvey channel;
    channel.group = log.groups.size() - 1;
    channel.channel = {name, unit};
    channel.samples = 10;
    log.channels.push_back(channel);
  };
  const ModelSignals model = signals_of(load_filter_model("altitude"));
  add("imu0", "az", "m/s^2");
  add("sonar", "height", "m");
  EXPECT_THAT(model_needs(model, log).uses,
              ElementsAre(Pair("az", "imu0.az"), Pair("height", "sonar.height")));
  add("imu1", "az", "m/s^2");
  const ModelNeeds found = model_needs(model, log);
  ASSERT_EQ(found.missing.size(), 1u);
  EXPECT_EQ(found.missing[0].why, "is in several groups of the log");
  EXPECT_THAT(found.missing[0].candidates, ElementsAre("imu0.az", "imu1.az"));
}

TEST(ModelNeeds, TakesOneSensorOfSeveral) {
  const ModelSignals model = {
      "two", {}, {{"baro", {{"z", "m"}}}, {"gps", {{"x", "m"}, {"y", "m"}}}}};
  const TemporaryDirectory folder;
  const auto survey = [&](const std::string& text) {
    return survey_log(*open_log(folder.write("log.csv", text).string()));
  };
  const ModelNeeds one = model_needs(model, survey("t,z\n0,1\n1,2\n"));
  EXPECT_TRUE(one.feeds);
  EXPECT_EQ(to_text(one),
            "two: fed by z; --map the measurements that are there, without x [m], y [m]");
  const ModelNeeds half = model_needs(model, survey("t,x\n0,1\n1,2\n"));
  EXPECT_FALSE(half.feeds);
  EXPECT_THAT(to_text(half), HasSubstr("needs z [m] (sensor baro), y [m] (sensor gps)"));
}

TEST(ModelNeeds, DoesNotListForEver) {
  const ModelSignals model = {
      "many",
      {{"a", ""}, {"b", ""}, {"c", ""}, {"d", ""}, {"e", ""}, {"f", ""}, {"g", ""}},
      {{"s", {{"y", ""}}}}};
  const TemporaryDirectory folder;
  const std::string path = folder.write("log.csv", "t,x\n0,1\n1,2\n").string();
  const ModelNeeds found = model_needs(model, survey_log(*open_log(path)));
  EXPECT_EQ(found.missing.size(), 8u);
  EXPECT_THAT(to_text(found),
              HasSubstr("many: needs a, b, c, d, e, f, 2 more; use --map a=CHANNEL"));
}

// What is said to be fed is what the readers take.
TEST(ModelNeeds, EveryBuiltInModelIsFedByALogOfItsOwnNames) {
  for (const ModelSignals& model : signals_of_built_in_models()) {
    std::string head = "t", first = "0", second = "1";
    std::vector<std::string> names;
    const auto add = [&](const Signal& signal) {
      head += "," + signal.name + (signal.unit.empty() ? "" : "[" + signal.unit + "]");
      first += ",1";
      second += ",2";
      names.push_back(signal.name);
    };
    for (const Signal& input : model.inputs) add(input);
    for (const auto& sensor : model.sensors)
      for (const Signal& output : sensor.outputs) add(output);
    const TemporaryDirectory folder;
    const std::string path =
        folder.write("log.csv", fmt::format("{}\n{}\n{}\n", head, first, second)).string();
    EXPECT_TRUE(model_needs(model, survey_log(*open_log(path))).feeds) << model.name;
    const LogChannels channels = read_log_channels(path, names);
    std::vector<ChannelUse> uses;
    for (std::size_t i = 0; i < names.size(); ++i) uses.push_back({names[i], channels.series[i]});
    EXPECT_EQ(records_of_log(load_filter_model(model.name), uses, path).size(), 1u) << model.name;
  }
}

// What stands for anything is not fed by a magnetometer that happens to have a y.
TEST(ModelNeeds, DoesNotGuessWhatStandsForAnything) {
  EXPECT_EQ(to_text(needs("local-level", "t,y\n0,1\n1,2\n")), "local-level: fed by y");
  for (const char* log : {"t,y[uT]\n0,1\n1,2\n", "t,x,y,z\n0,1,1,1\n1,2,2,2\n"}) {
    const ModelNeeds found = needs("local-level", log);
    EXPECT_FALSE(found.feeds) << log;
    EXPECT_EQ(found.missing[0].why, "can be any quantity");
    EXPECT_THAT(found.missing[0].candidates, ElementsAre("y"));
  }
}

}  // namespace
}  // namespace quadtune
