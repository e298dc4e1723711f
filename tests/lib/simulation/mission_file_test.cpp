// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <set>
#include <sstream>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/simulation/mission.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using Eigen::Vector3d;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::StartsWith;
using ::testing::StrEq;
using testing::TemporaryDirectory;
using ::testing::ThrowsMessage;
using ::testing::UnorderedElementsAre;

Mission parse(const std::string& text) { return parse_mission(text, "m.toml"); }

const std::string kHead = "name = 'm'\nduration_s = 20\n";            // lines 1 and 2
const std::string kAir = "[start]\nat = 'air'\nheight_m = 1\n";       // lines 3 to 5
const std::string kHover = kHead + kAir + "[hover]\nheight_m = 1\n";  // lines 6 and 7

TEST(BuiltInMissions, AreTheFilesOfTheTree) {
  EXPECT_THAT(built_in_missions(),
              ElementsAre("hover", "take-off-and-land", "step-north", "step-east", "step-height",
                          "step-yaw", "waypoints", "line", "circle", "lemniscate", "keys",
                          "motor-test", "lemniscate-carried"));
  for (const std::string& name : built_in_missions()) {
    const Mission mission = load_mission(name);
    EXPECT_EQ(mission.name, name);
    EXPECT_FALSE(mission.description.empty());
    EXPECT_FALSE(mission.limits.empty()) << name;
    EXPECT_TRUE(mission.file.empty());
    const std::filesystem::path path =
        std::filesystem::path(testing::source_folder()) / "missions" / (name + ".toml");
    std::ostringstream bytes;
    bytes << std::ifstream(path, std::ios::binary).rdbuf();
    EXPECT_EQ(mission.text, bytes.str());
    EXPECT_EQ(load_mission(path.string()).file, path);
  }
}

TEST(BuiltInMissions, AreAllFilesOfTheFolder) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(
           std::filesystem::path(testing::source_folder()) / "missions"))
    files += entry.path().extension() == ".toml" ? 1 : 0;
  EXPECT_EQ(files, built_in_missions().size());
}

TEST(BuiltInMissions, HoverIsThatOfTheMambosProject) {
  const Mission mission = load_mission("hover");
  EXPECT_EQ(mission.duration, 100);
  EXPECT_FALSE(mission.start.in_air);
  EXPECT_EQ(std::get<Hover>(mission.kind).position, Vector3d(0, 0, -1.1));
}

TEST(BuiltInMissions, MotorTestRuns1And3Then2And4ForTwoSeconds) {
  const Mission mission = load_mission("motor-test");
  const auto& runs = std::get<MotorTest>(mission.kind).runs;
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_THAT(runs[0].motors, ElementsAre(1, 3));
  EXPECT_THAT(runs[1].motors, ElementsAre(2, 4));
  EXPECT_EQ(runs[0].duration, 2);
  EXPECT_EQ(runs[1].begin, runs[0].begin + 2);
}

// A vehicle that starts on a path's first point is not asked to jump.
TEST(BuiltInMissions, PathsBeginWhereTheVehicleIs) {
  for (const std::string name : {"line", "circle", "lemniscate"}) {
    const Mission mission = load_mission(name);
    const PathPoint first = path_point(std::get<SmoothPath>(mission.kind), 0);
    EXPECT_THAT(first.position, MatrixNear(mission.start.position, 1e-12)) << name;
    EXPECT_NEAR(first.yaw, mission.start.yaw, 1e-12) << name;
    EXPECT_LT(path_end(std::get<SmoothPath>(mission.kind)), mission.duration - 2) << name;
  }
}

TEST(MissionFile, TurnsHeightsIntoNorthEastDown) {
  const Mission mission = parse(
      "name = 'm'\nduration_s = 20\n[start]\nat = 'air'\nnorth_m = 1\neast_m = 2\nheight_m = 3\n"
      "yaw_rad = 0.5\n[[references]]\nat_s = 0\nheight_m = 4\n[[references]]\nat_s = 2\nramp_s = "
      "3\n"
      "north_m = -1\n[[references]]\nat_s = 5\nyaw_rad = 7\n");
  EXPECT_EQ(mission.start.position, Vector3d(1, 2, -3));
  const auto& all = std::get<Script>(mission.kind).references;
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].position, Vector3d(1, 2, -4));  // what is absent is the start's …
  EXPECT_EQ(all[0].yaw, 0.5);
  EXPECT_EQ(all[1].position, Vector3d(-1, 2, -4));  // … and then what it was
  EXPECT_EQ(all[1].until, 5);
  EXPECT_EQ(all[2].position, Vector3d(-1, 2, -4));
  EXPECT_EQ(all[2].yaw, 7);
}

TEST(MissionFile, KeepsTheStartsYaw) {
  const std::string start = kHead + "[start]\nyaw_rad = 2\n";
  EXPECT_EQ(std::get<Hover>(parse(start + "[hover]\nheight_m = 1\n").kind).yaw, 2);
  EXPECT_EQ(std::get<Keys>(parse(start + "[keys]\nheight_m = 1\n").kind).yaw, 2);
  EXPECT_EQ(std::get<Hover>(parse(start + "[hover]\nheight_m = 1\nyaw_rad = 1\n").kind).yaw, 1);
}

TEST(MissionFile, ReadsLimitsInTheMetricsOrder) {
  const Mission mission = parse(
      kHover + "[limits]\ntilt_max_rad = 0.3\nsettling_time_max_s = 4\novershoot_max = 0.2\n");
  ASSERT_EQ(mission.limits.size(), 3u);
  EXPECT_EQ(mission.limits[0].metric, Metric::settling_time);
  EXPECT_EQ(mission.limits[0].max, 4);
  EXPECT_EQ(mission.limits[1].metric, Metric::overshoot);
  EXPECT_EQ(mission.limits[2].metric, Metric::tilt_max);
}

// --- every key of every kind of mission, spoilt in every way ---

// One key a line, every key that the table knows.
const std::vector<std::vector<std::string>>& complete_files() {
  static const std::vector<std::string> head = {"name = 'm'", "description = 'd'",
                                                "duration_s = 60"};
  static const std::vector<std::string> air = {"[start]",    "at = 'air'",   "north_m = 0",
                                               "east_m = 0", "height_m = 1", "yaw_rad = 0"};
  static const std::vector<std::string> ground = {
      "[start]",     "at = 'ground'",    "north_m = 0",   "east_m = 0",
      "yaw_rad = 0", "start_up_s = 0.5", "take_off_s = 1"};
  static const std::vector<std::string> rest = {"[landing]",
                                                "at_s = 40",
                                                "rate_m_per_s = 0.3",
                                                "off_height_m = 0.05",
                                                "[settling]",
                                                "band_m = 0.05",
                                                "yaw_band_rad = 0.05",
                                                "window_s = 5",
                                                "[limits]",
                                                "settling_time_max_s = 1",
                                                "overshoot_max = 1",
                                                "yaw_overshoot_max = 1",
                                                "tracking_rms_max_m = 1",
                                                "tracking_max_m = 1",
                                                "height_rms_max_m = 1",
                                                "height_max_m = 1",
                                                "yaw_rms_max_rad = 1",
                                                "yaw_max_rad = 1",
                                                "tilt_max_rad = 1",
                                                "speed_max_m_per_s = 1",
                                                "saturation_time_max_s = 1",
                                                "energy_max_J = 1",
                                                "estimate_rms_max_m = 1",
                                                "estimate_max_m = 1",
                                                "position_drift_max_m = 1",
                                                "final_distance_max_m = 1",
                                                "touchdown_speed_max_m_per_s = 1",
                                                "height_peak_max_m = 1"};
  const auto joined = [](std::initializer_list<std::vector<std::string>> parts) {
    std::vector<std::string> all;
    for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
  };
  static const std::vector<std::vector<std::string>> files = {
      joined({head,
              ground,
              {"[hover]", "north_m = 0", "east_m = 0", "height_m = 1", "yaw_rad = 0"},
              rest}),
      joined({head,
              air,
              {"[[references]]", "at_s = 0", "north_m = 0", "east_m = 0", "height_m = 1",
               "yaw_rad = 0", "[[references]]", "at_s = 3", "ramp_s = 2", "height_m = 2"},
              rest}),
      joined({head,
              air,
              {"[waypoints]", "points_m = [[0, 0, 1], [1, 0, 1]]", "look_ahead_m = 0.4",
               "transition_radius_m = 0.2", "nose = 'fixed'", "yaw_rad = 0"},
              rest}),
      joined({head,
              air,
              {"[line]", "from_m = [0, 0, 1]", "to_m = [3, 0, 1]", "speed_m_per_s = 0.5",
               "begin_s = 1", "ramp_s = 1", "nose = 'fixed'", "yaw_rad = 0"},
              rest}),
      joined({head,
              air,
              {"[circle]", "north_m = 0", "east_m = 0", "height_m = 1", "radius_m = -1",
               "bearing_rad = 0", "speed_m_per_s = 0.5", "turns = 2", "begin_s = 1", "ramp_s = 1",
               "nose = 'fixed'", "yaw_rad = 0"},
              rest}),
      joined({head,
              air,
              {"[lemniscate]", "north_m = 0", "east_m = 0", "height_m = 1", "length_m = 2",
               "width_m = 1", "heading_rad = 0", "lap_s = 10", "laps = 2", "begin_s = 1",
               "ramp_s = 1", "nose = 'fixed'", "yaw_rad = 0"},
              rest}),
      joined({head,
              air,
              {"[keys]", "north_m = 0", "east_m = 0", "height_m = 1", "yaw_rad = 0",
               "[[keys.press]]", "at_s = 1", "key = 'i'"},
              rest}),
      joined({head,
              {"[[motors]]", "at_s = 1", "for_s = 2", "motors = [1, 3]", "share = 0.1",
               "[settling]", "band_m = 0.1", "[limits]", "tilt_max_rad = 1"}}),
      joined({head,
              {"carried = true", "[lemniscate]", "height_m = 0.6", "length_m = 0.6", "lap_s = 10",
               "[settling]", "band_m = 0.1", "[limits]", "estimate_max_m = 1"}})};
  return files;
}

std::string text_of(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

// Calls f(lines, i, key, value) for each line "key = value" of each complete file.
template <class Function>
void for_each_key(Function&& f) {
  for (const std::vector<std::string>& lines : complete_files()) {
    ASSERT_NO_THROW((void)parse(text_of(lines))) << text_of(lines);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const std::size_t equals = lines[i].find(" = ");
      if (equals != std::string::npos)
        f(lines, i, lines[i].substr(0, equals), lines[i].substr(equals + 3));
    }
  }
}

std::string message_of(std::vector<std::string> lines, std::size_t i, const std::string& line) {
  lines[i] = line;
  try {
    (void)parse(text_of(lines));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "nothing was refused";
}

TEST(MissionFile, RefusesAnotherTypeOfEveryKey) {
  for_each_key([](const auto& lines, std::size_t i, const std::string& key, const std::string&) {
    EXPECT_THAT(message_of(lines, i, key + " = 1979-05-27"),
                AllOf(StartsWith("m.toml:" + std::to_string(i + 1) + ": " + key),
                      HasSubstr("is a date or time, expected")));
  });
}

TEST(MissionFile, RefusesEveryKeyTwice) {
  for_each_key([](const auto& lines, std::size_t i, const std::string& key, const std::string&) {
    EXPECT_THAT(message_of(lines, i, lines[i] + "\n" + lines[i]),
                AllOf(StartsWith("m.toml:" + std::to_string(i + 2) + ": "),
                      HasSubstr("key '" + key + "' is defined twice, expected once")));
  });
}

TEST(MissionFile, RefusesEveryUnitThatIsAbsentOrAnother) {
  int keys = 0;
  for_each_key(
      [&](const auto& lines, std::size_t i, const std::string& key, const std::string& value) {
        std::string stem;
        for (const std::string unit : {"_m_per_s", "_rad", "_m", "_s", "_J"})
          if (stem.empty() && key.ends_with(unit)) stem = key.substr(0, key.size() - unit.size());
        if (stem.empty()) return;
        ++keys;
        for (const std::string& wrong : {stem, stem + "_cm", stem + "_deg"})
          EXPECT_THAT(message_of(lines, i, fmt::format("{} = {}", wrong, value)),
                      AllOf(StartsWith("m.toml:" + std::to_string(i + 1) + ": key '" + wrong + "'"),
                            HasSubstr("is not known, expected '"),
                            HasSubstr("' (the unit is part of the key)")));
      });
  EXPECT_GT(keys, 150);
}

TEST(MissionFile, RefusesNumbersThatAreNotFiniteOrFarOut) {
  for_each_key(
      [](const auto& lines, std::size_t i, const std::string& key, const std::string& value) {
        if (value.find_first_of("0123456789") == std::string::npos || value[0] == '[') return;
        const std::string place = "m.toml:" + std::to_string(i + 1) + ": " + key;
        for (const char* wild : {"nan", "inf", "-inf", "1e300", "-1e300"})
          EXPECT_THAT(message_of(lines, i, key + " = " + wild),
                      AllOf(StartsWith(place), HasSubstr(", expected")));
      });
}

TEST(MissionFile, RefusesUnknownKeysInEveryTable) {
  for (const std::vector<std::string>& lines : complete_files())
    for (std::size_t i = 0; i < lines.size(); ++i)
      if (lines[i][0] == '[' || i == 0) {
        EXPECT_THAT(message_of(lines, i, lines[i] + "\nwind = 3"),
                    AllOf(StartsWith("m.toml:" + std::to_string(i + 2) + ": key 'wind'"),
                          HasSubstr("is not known, expected one of ")));
      }
}

// Without any one key a file is a mission, or lacks just that key.
TEST(MissionFile, NamesTheKeyThatIsMissing) {
  std::set<std::string> needed;
  for_each_key([&](const auto& lines, std::size_t i, const std::string& key, const std::string&) {
    const std::string message = message_of(lines, i, "");
    if (message == "nothing was refused") return;
    // Without these the rest means something else: a start in the air, a carried vehicle, a later
    // reference that changes something.
    if (key == "at" || key == "carried") return;
    if (message.find("changes nothing") != std::string::npos) return;
    EXPECT_THAT(message, AllOf(StartsWith("m.toml:"), HasSubstr("has no key '" + key + "'")));
    std::size_t table = i;
    while (table > 0 && lines[table][0] != '[') --table;
    needed.insert(lines[table][0] == '[' ? lines[table] + "." + key : key);
  });
  EXPECT_THAT(
      needed,
      UnorderedElementsAre(
          "name", "duration_s", "[start].height_m", "[hover].height_m", "[[references]].at_s",
          "[[references]].height_m", "[waypoints].points_m", "[waypoints].look_ahead_m",
          "[waypoints].transition_radius_m", "[line].from_m", "[line].to_m", "[line].speed_m_per_s",
          "[circle].height_m", "[circle].radius_m", "[circle].speed_m_per_s",
          "[lemniscate].height_m", "[lemniscate].length_m", "[lemniscate].lap_s", "[keys].height_m",
          "[[keys.press]].at_s", "[[keys.press]].key", "[[motors]].at_s", "[[motors]].for_s",
          "[[motors]].motors", "[[motors]].share", "[landing].at_s"));
}

// --- the documentation ---

std::string section_of_formats() {
  std::ostringstream bytes;
  bytes
      << std::ifstream(std::filesystem::path(testing::source_folder()) / "docs/formats.md").rdbuf();
  const std::string text = bytes.str();
  const std::size_t begin = text.find("\n## Mission files\n");
  return text.substr(begin, text.find("\n## ", begin + 1) - begin);
}

TEST(MissionFormat, ExampleOfTheDocumentsIsAMission) {
  const std::string section = section_of_formats();
  const std::size_t begin = section.find("```toml\n") + 8;
  const Mission mission = parse(section.substr(begin, section.find("```", begin) - begin));
  EXPECT_EQ(std::get<Script>(mission.kind).references.size(), 2u);
  EXPECT_TRUE(mission.landing);
  EXPECT_EQ(mission.limits.size(), 2u);
}

TEST(MissionFormat, DocumentsNameEveryKey) {
  const std::string section = section_of_formats();
  for_each_key([&](const auto&, std::size_t, const std::string& key, const std::string&) {
    EXPECT_TRUE(section.find("`" + key) != std::string::npos ||
                section.find("\n" + key + " = ") != std::string::npos)
        << key;
  });
}

struct Refusal {
  const char* name;
  std::string text;
  const char* message;
};

class MissionRefusals : public ::testing::TestWithParam<Refusal> {};

TEST_P(MissionRefusals, NameFileLineAndReason) {
  EXPECT_THAT([] { (void)parse(GetParam().text); },
              ThrowsMessage<InvalidInput>(StrEq(GetParam().message)));
}

INSTANTIATE_TEST_SUITE_P(
    All, MissionRefusals,
    ::testing::Values(
        Refusal{"NothingToDo", kHead + kAir,
                "m.toml:1: the file does not define a motion, expected one of hover, references, "
                "csv, waypoints, line, circle, lemniscate, keys, motors"},
        Refusal{"TwoThings", kHover + "[keys]\nheight_m = 1\n",
                "m.toml:8: the file has both 'hover' and 'keys', expected one of them"},
        Refusal{
            "MisspeltTable", kHead + kAir + "[hovr]\nheight_m = 1\n",
            "m.toml:6: key 'hovr' is not known, expected one of name, description, duration_s, "
            "start, carried, landing, settling, limits, event, hover, references, csv, waypoints, "
            "line, circle, lemniscate, keys, motors; did you mean 'hover'?"},
        Refusal{"NotATable", "hover = 1\n" + kHead,
                "m.toml:1: hover is 1, expected one table, [hover]"},
        Refusal{"NotAListOfTables", kHead + "[references]\nat_s = 0\n",
                "m.toml:3: references is a table, expected a list of tables, each under "
                "[[references]]"},
        Refusal{"EmptyReferences", "references = []\n" + kHead,
                "m.toml:1: [[references]] is empty, expected at least one"},
        Refusal{"EmptyMotors", "motors = []\n" + kHead,
                "m.toml:1: [[motors]] is empty, expected at least one"},
        Refusal{"Name", "name = 'a b'\nduration_s = 20\n",
                "m.toml:1: name is 'a b', expected 1 to 64 letters, digits, '.', '_' or '-' "
                "because it is used in file names"},
        Refusal{"Duration", "name = 'm'\nduration_s = 0\n",
                "m.toml:2: duration_s is 0, expected more than 0 and 86400 or less"},
        Refusal{"StartWord", kHead + "[start]\nat = 'roof'\n[hover]\nheight_m = 1\n",
                "m.toml:4: at in [start] is 'roof', expected 'ground' or 'air'"},
        Refusal{
            "HeightOnTheGround",
            kHead + "[start]\nat = 'ground'\nheight_m = 1\n[hover]\nheight_m = 1\n",
            "m.toml:5: height_m in [start] is for a start in the air, expected at = \"air\" or no "
            "height_m"},
        Refusal{"TakeOffInTheAir", kHead + kAir + "take_off_s = 1\n[hover]\nheight_m = 1\n",
                "m.toml:6: take_off_s in [start] is for a start on the ground, expected at = "
                "\"ground\" or no take_off_s"},
        Refusal{
            "LongTakeOff", kHead + "[start]\ntake_off_s = 19.5\n[hover]\nheight_m = 1\n",
            "m.toml:3: start-up and take-off to 1 m last 20 s, expected less than the mission's "
            "duration_s of 20"},
        Refusal{
            "ShortFlight", "name = 'm'\nduration_s = 1\n[hover]\nheight_m = 1\n",
            "m.toml:1: start-up and take-off to 1 m last 2.5 s, expected less than the mission's "
            "duration_s of 1"},
        Refusal{"BelowTheGround", kHead + kAir + "[hover]\nheight_m = -1\n",
                "m.toml:7: height_m in [hover] is -1, expected 0 or more and 100000 or less"},
        Refusal{"FirstReferenceLater", kHead + kAir + "[[references]]\nat_s = 1\nheight_m = 1\n",
                "m.toml:7: at_s in [[references]] 1 is 1, expected 0, because a flight needs a "
                "reference from its beginning"},
        Refusal{"FirstReferenceRamp",
                kHead + kAir + "[[references]]\nat_s = 0\nramp_s = 1\nheight_m = 1\n",
                "m.toml:8: ramp_s in [[references]] 1 is 1, expected 0, because a flight needs a "
                "reference from its beginning"},
        Refusal{"TimesGoBack",
                kHead + kAir +
                    "[[references]]\nat_s = 0\nheight_m = 1\n[[references]]\nat_s = 3\nramp_s = 2\n"
                    "north_m = 1\n[[references]]\nat_s = 4\nnorth_m = 2\n",
                "m.toml:14: at_s in [[references]] 3 is 4, expected later because the previous "
                "reference is complete at 5 s"},
        Refusal{"TwoStepsAtOnce",
                kHead + kAir +
                    "[[references]]\nat_s = 0\nheight_m = 1\n[[references]]\nat_s = 0\n"
                    "height_m = 2\n",
                "m.toml:10: at_s in [[references]] 2 is 0, expected later because the previous "
                "reference is complete at 0 s"},
        Refusal{"ChangesNothing",
                kHead + kAir + "[[references]]\nat_s = 0\nheight_m = 1\n[[references]]\nat_s = 1\n",
                "m.toml:9: [[references]] 2 changes nothing, expected north_m, east_m, height_m or "
                "yaw_rad"},
        Refusal{"AfterTheEnd",
                kHead + kAir +
                    "[[references]]\nat_s = 0\nheight_m = 1\n[[references]]\nat_s = 21\n"
                    "height_m = 2\n",
                "m.toml:10: at_s in [[references]] 2 is 21, expected 0 or more and 20 or less"},
        Refusal{"EqualWaypoints",
                kHead + kAir +
                    "[waypoints]\npoints_m = [\n  [0, 0, 1],\n  [1, 0, 1],\n  [1, 0, 1],\n]\n"
                    "look_ahead_m = 1\ntransition_radius_m = 1\n",
                "m.toml:10: waypoints 2 and 3 are the same point, expected points that differ "
                "because a segment has a direction"},
        Refusal{"OneWaypoint",
                kHead + kAir +
                    "[waypoints]\npoints_m = [[0, 0, 1]]\nlook_ahead_m = 1\n"
                    "transition_radius_m = 1\n",
                "m.toml:7: points_m in [waypoints] has 1 waypoint, expected at least 2"},
        Refusal{"FlatWaypoints", kHead + kAir + "[waypoints]\npoints_m = [[0, 0],\n [1, 0]]\n",
                "m.toml:7: waypoint 1 has 2 numbers, expected 3 (north, east, height)"},
        Refusal{"WaypointBelowTheGround",
                kHead + kAir + "[waypoints]\npoints_m = [[0, 0, 1],\n [1, 0, -1]]\n",
                "m.toml:8: height of waypoint 2 is -1 m, expected 0 or more and 100000 or less"},
        Refusal{"FarWaypoint", kHead + kAir + "[waypoints]\npoints_m = [[0, 1e9, 1], [1, 0, 1]]\n",
                "m.toml:7: east of waypoint 1 is 1000000000 m, expected -100000 or more and 100000 "
                "or less"},
        Refusal{"LookAhead",
                kHead + kAir + "[waypoints]\npoints_m = [[0, 0, 1], [1, 0, 1]]\nlook_ahead_m = 0\n",
                "m.toml:8: look_ahead_m in [waypoints] is 0, expected more than 0 and 100000 or "
                "less"},
        Refusal{"Nose",
                kHead + kAir +
                    "[waypoints]\npoints_m = [[0, 0, 1], [1, 0, 1]]\nlook_ahead_m = 1\n"
                    "transition_radius_m = 1\nnose = 'ahed'\n",
                "m.toml:10: nose in [waypoints] is 'ahed', expected 'fixed' or 'ahead'; did you "
                "mean 'ahead'?"},
        Refusal{"NoseAndYaw",
                kHead + kAir +
                    "[line]\nfrom_m = [0, 0, 1]\nto_m = [9, 0, 1]\nspeed_m_per_s = 1\n"
                    "nose = 'ahead'\nyaw_rad = 1\n",
                "m.toml:11: [line] has both nose = 'ahead' and yaw_rad, expected one of them"},
        Refusal{
            "NoLine",
            kHead + kAir + "[line]\nfrom_m = [0, 0, 1]\nto_m = [0, 0, 1]\nspeed_m_per_s = 1\n",
            "m.toml:6: the line's first and last points are the same, expected different points"},
        Refusal{"NoseOfAVerticalLine",
                kHead + kAir +
                    "[line]\nfrom_m = [0, 0, 1]\nto_m = [0, 0, 9]\nspeed_m_per_s = 1\n"
                    "nose = 'ahead'\n",
                "m.toml:6: the line is vertical, expected a fixed nose because the line has no "
                "heading"},
        Refusal{"ShortLine",
                kHead + kAir + "[line]\nfrom_m = [0, 0, 1]\nto_m = [1, 0, 1]\nspeed_m_per_s = 2\n",
                "m.toml:6: the path takes 0.5 s at full speed, which is less than its ramp of 1 s, "
                "expected a longer path, a lower speed or a shorter ramp"},
        Refusal{"LineOfTwo", kHead + kAir + "[line]\nfrom_m = [0, 0]\n",
                "m.toml:7: from_m in [line] has 2 numbers, expected 3 (north, east, height)"},
        Refusal{"Radius", kHead + kAir + "[circle]\nheight_m = 1\nradius_m = 0\n",
                "m.toml:8: radius_m in [circle] is 0, expected more than 0 (right turn) or less "
                "than 0 (left turn)"},
        Refusal{
            "Key", kHead + kAir + "[keys]\nheight_m = 1\n[[keys.press]]\nat_s = 1\nkey = 'q'\n",
            "m.toml:10: key in [[keys.press]] 1 is 'q', expected one of d a w s j l i k y h r e"},
        Refusal{
            "TwoKeys",
            kHead + kAir + "[keys]\nheight_m = 1\n[[keys.press]]\nat_s = 1\nkey = 'dd'\n",
            "m.toml:10: key in [[keys.press]] 1 is 'dd', expected one of d a w s j l i k y h r e"},
        Refusal{
            "NoKey", kHead + kAir + "[keys]\nheight_m = 1\n[[keys.press]]\nat_s = 1\nkey = ''\n",
            "m.toml:10: key in [[keys.press]] 1 is '', expected one of d a w s j l i k y h r e"},
        Refusal{
            "KeysAtOnce",
            kHead + kAir +
                "[keys]\nheight_m = 1\n[[keys.press]]\nat_s = 1\nkey = 'd'\n[[keys.press]]\n"
                "at_s = 1\nkey = 'a'\n",
            "m.toml:12: at_s in [[keys.press]] 2 is 1, expected more than 1, the time of the key "
            "before"},
        Refusal{"Motor0", kHead + "[[motors]]\nat_s = 1\nfor_s = 1\nmotors = [0]\nshare = 0.1\n",
                "m.toml:6: motors in [[motors]] 1 has 0, expected whole numbers from 1 to 16"},
        Refusal{"HalfAMotor",
                kHead + "[[motors]]\nat_s = 1\nfor_s = 1\nmotors = [1.5]\nshare = 0.1\n",
                "m.toml:6: motors in [[motors]] 1 has 1.5, expected whole numbers from 1 to 16"},
        Refusal{"MotorTwice",
                kHead + "[[motors]]\nat_s = 1\nfor_s = 1\nmotors = [1, 1]\nshare = 0.1\n",
                "m.toml:6: motors in [[motors]] 1 has 1 twice, expected it once"},
        Refusal{"NoMotor", kHead + "[[motors]]\nat_s = 1\nfor_s = 1\nmotors = []\nshare = 0.1\n",
                "m.toml:6: motors in [[motors]] 1 is empty, expected at least one"},
        Refusal{"Share", kHead + "[[motors]]\nat_s = 1\nfor_s = 1\nmotors = [1]\nshare = 1.1\n",
                "m.toml:7: share in [[motors]] 1 is 1.1, expected 0 or more and 1 or less"},
        Refusal{"MotorsOverlap",
                kHead + "[[motors]]\nat_s = 1\nfor_s = 2\nmotors = [1]\nshare = 0.1\n[[motors]]\n"
                        "at_s = 2\nfor_s = 1\nmotors = [2]\nshare = 0.1\n",
                "m.toml:9: at_s in [[motors]] 2 is 2, expected 3 or more, when the previous run "
                "has ended"},
        Refusal{"MotorsInTheAir",
                kHead + kAir + "[[motors]]\nat_s = 1\nfor_s = 2\nmotors = [1]\nshare = 0.1\n",
                "m.toml:3: [start] is not allowed in a mission in which motors run without a law"},
        Refusal{"CarriedHover", "carried = true\n" + kHead + "[hover]\nheight_m = 1\n",
                "m.toml:1: a vehicle is carried along 'hover', expected line, circle or "
                "lemniscate"},
        Refusal{"CarriedLanding",
                "carried = true\n" + kHead +
                    "[line]\nfrom_m = [0, 0, 1]\nto_m = [9, 0, 1]\nspeed_m_per_s = 1\n[landing]\n"
                    "at_s = 3\n",
                "m.toml:8: [landing] is not allowed in a mission in which the vehicle is carried"},
        Refusal{"CarriedWord", "carried = 'yes'\n" + kHead + "[hover]\nheight_m = 1\n",
                "m.toml:1: carried is the string 'yes', expected true or false"},
        Refusal{"LandsBeforeItFlies", kHead + "[hover]\nheight_m = 1\n[landing]\nat_s = 1\n",
                "m.toml:6: at_s in [landing] is 1, expected 2.5 or more, when the take-off has "
                "ended"},
        Refusal{"NegativeLimit", kHover + "[limits]\ntilt_max_rad = -0.1\n",
                "m.toml:9: tilt_max_rad in [limits] is -0.1, expected 0 or more and "
                "1000000000000 or less"},
        Refusal{
            "LimitWithoutMax", kHover + "[limits]\nsettling_time_s = 3\n",
            "m.toml:9: key 'settling_time_s' in [limits] is not known, expected one of "
            "settling_time_max_s, overshoot_max, yaw_overshoot_max, tracking_rms_max_m, "
            "tracking_max_m, height_rms_max_m, height_max_m, yaw_rms_max_rad, yaw_max_rad, "
            "tilt_max_rad, speed_max_m_per_s, saturation_time_max_s, energy_max_J, "
            "estimate_rms_max_m, estimate_max_m, position_drift_max_m, final_distance_max_m, "
            "touchdown_speed_max_m_per_s, height_peak_max_m; did you mean 'settling_time_max_s'?"},
        Refusal{"LimitOfTheDuration", kHover + "[limits]\nduration_max_s = 3\n",
                "m.toml:9: key 'duration_max_s' in [limits] is not known, expected one of "
                "settling_time_max_s, overshoot_max, yaw_overshoot_max, tracking_rms_max_m, "
                "tracking_max_m, height_rms_max_m, height_max_m, yaw_rms_max_rad, yaw_max_rad, "
                "tilt_max_rad, speed_max_m_per_s, saturation_time_max_s, energy_max_J, "
                "estimate_rms_max_m, estimate_max_m, position_drift_max_m, final_distance_max_m, "
                "touchdown_speed_max_m_per_s, height_peak_max_m"},
        Refusal{"Band", kHover + "[settling]\nband_m = 0\n",
                "m.toml:9: band_m in [settling] is 0, expected more than 0 and 100000 or less"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(LoadMission, SuggestsTheNearestName) {
  EXPECT_THAT([] { (void)load_mission("hovr"); },
              ThrowsMessage<InvalidInput>(AllOf(
                  StartsWith("mission: no mission 'hovr', expected hover, take-off-and-land, "),
                  HasSubstr(" or a mission file; did you mean 'hover'?"))));
  EXPECT_THROW((void)load_mission(std::string(5000, 'x')), InvalidInput);
  EXPECT_THAT([] { (void)load_mission("no/such.toml"); },
              ThrowsMessage<FileError>(StrEq("no/such.toml: No such file or directory")));
}

TEST(MissionFile, EveryPrefixIsAMissionOrBadInput) {
  for (const std::string& name : built_in_missions()) {
    const std::string text = load_mission(name).text;
    int missions = 0;
    for (std::size_t length = 0; length <= text.size(); ++length) {
      try {
        missions += parse(text.substr(0, length)).duration > 0 ? 1 : 0;
      } catch (const InvalidInput& error) {
        ASSERT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
        ASSERT_THAT(error.what(), StartsWith("m.toml")) << error.what();
      }
    }
    EXPECT_GE(missions, 1);
  }
}

TEST(MissionFile, EveryChangedByteIsAMissionOrBadInput) {
  std::mt19937_64 random(5);
  for (const std::string& name : built_in_missions()) {
    const std::string good = load_mission(name).text;
    for (int i = 0; i < 1000; ++i) {
      std::string text = good;
      for (int change = 0; change < 1 + i % 3; ++change)
        text[random() % text.size()] = static_cast<char>(random() % 256);
      try {
        validate(parse(text), "again");
      } catch (const InvalidInput& error) {
        ASSERT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
      }
    }
  }
}

TEST(MissionFile, RefusesHugeFiles) {
  EXPECT_THAT([] { (void)parse(std::string(kMissionFileLimit + 1, '#')); },
              ThrowsMessage<InvalidInput>(HasSubstr("is larger than 1 MiB")));
  EXPECT_THAT([] { (void)parse(kHover + std::string(9000, 'x') + " = 1\n"); },
              ThrowsMessage<InvalidInput>(HasSubstr("m.toml:8: line has 9004 bytes")));
  EXPECT_THAT([] { (void)parse(std::string("name = 'm'\0", 11)); },
              ThrowsMessage<InvalidInput>(HasSubstr("has a zero byte at offset 10")));
}

// A file of ten thousand references is a mission like any other.
TEST(MissionFile, ReadsManyReferences) {
  std::string text =
      "name = 'm'\nduration_s = 20000\n" + kAir + "[[references]]\nat_s = 0\nheight_m = 1\n";
  for (int i = 1; i <= 10000; ++i)
    text += "[[references]]\nat_s = " + std::to_string(i) + "\nnorth_m = 1\n";
  EXPECT_EQ(std::get<Script>(parse(text).kind).references.size(), 10001u);
}

// --- references from a table ---

const std::string kCsvMission = kHead + kAir + "[csv]\nfile = 'path.csv'\n";

Mission with_csv(const std::string& csv, const std::string& mission = kCsvMission) {
  const TemporaryDirectory directory;
  directory.write("path.csv", csv);
  return parse_mission(mission, "m.toml", directory.path());
}

TEST(ScriptCsv, GoesFromRowToRow) {
  const Mission mission = with_csv(
      "# a comment\n\nt_s, east_m, height_m, yaw_rad  # names\n0, 0, 1, 0\n2, 3, 1.5, 0.1\n");
  const auto& all = std::get<Script>(mission.kind).references;
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].until, 0);
  EXPECT_EQ(all[1].from, 0);
  EXPECT_EQ(all[1].until, 2);
  EXPECT_EQ(all[1].position, Vector3d(0, 3, -1.5));
  EXPECT_EQ(all[1].yaw, 0.1);
}

TEST(ScriptCsv, Holds) {
  const Mission mission =
      with_csv("height_m,t_s\r\n1,0\r\n2,3\r\n", kCsvMission + "between = 'hold'\n");
  const auto& all = std::get<Script>(mission.kind).references;
  EXPECT_EQ(all[1].from, 3);
  EXPECT_EQ(all[1].until, 3);
  EXPECT_EQ(all[1].position.z(), -2);
}

TEST(ScriptCsv, LiesBesideTheMission) {
  const TemporaryDirectory directory;
  directory.write("path.csv", "t_s,height_m\n0,1\n");
  const std::filesystem::path file = directory.write("m.toml", kCsvMission);
  EXPECT_EQ(std::get<Script>(load_mission(file.string()).kind).references.size(), 1u);
}

TEST(ScriptCsv, IsNamedByTheMissionThatHasNone) {
  EXPECT_THAT([] { (void)parse_mission(kCsvMission, "m.toml", "/no/such"); },
              ThrowsMessage<InvalidInput>(
                  StrEq("m.toml:7: the references cannot be read (/no/such/path.csv: No such file "
                        "or directory), expected a file next to the mission file")));
  for (const std::string name : {"../path.csv", "/dev/zero", "a b", ""})
    EXPECT_THAT(
        [&] { (void)parse(fmt::format("{}{}[csv]\nfile = '{}'\n", kHead, kAir, name)); },
        ThrowsMessage<InvalidInput>(StartsWith("m.toml:7: file in [csv] is '" + name + "'")));
  for (const std::string name : {"-", ".", ".."})  // neither standard input nor a folder
    EXPECT_THAT([&] { (void)parse(fmt::format("{}{}[csv]\nfile = '{}'\n", kHead, kAir, name)); },
                ThrowsMessage<InvalidInput>(StartsWith("m.toml:7: the references cannot be read")));
  EXPECT_THAT([] { (void)with_csv("", kCsvMission + "between = 'jump'\n"); },
              ThrowsMessage<InvalidInput>(
                  StrEq("m.toml:8: between in [csv] is 'jump', expected 'ramp' or 'hold'")));
}

TEST(ScriptCsv, RefusesWithFileAndLine) {
  const auto refusal = [](const std::string& csv) -> std::string {
    try {
      (void)with_csv(csv);
    } catch (const InvalidInput& error) {
      const std::string message = error.what();
      return message.substr(message.find("path.csv"));
    }
    return "nothing";
  };
  EXPECT_EQ(refusal(""), "path.csv: has no rows, expected a line of names and one row per time");
  EXPECT_EQ(refusal("t_s,height_m\n# none\n"),
            "path.csv: has no rows, expected a line of names and one row per time");
  EXPECT_EQ(refusal("t,height_m\n0,1\n"),
            "path.csv:1: column 't' is unknown, expected some of t_s, north_m, east_m, height_m, "
            "yaw_rad, separated by commas");
  EXPECT_EQ(refusal("\nt_s,hight_m\n0,1\n"),
            "path.csv:2: column 'hight_m' is unknown, expected some of t_s, north_m, east_m, "
            "height_m, yaw_rad, separated by commas; did you mean 'height_m'?");
  EXPECT_EQ(refusal("t_s,t_s\n0,1\n"), "path.csv:1: column 't_s' appears twice, expected once");
  EXPECT_EQ(refusal("t_s,north_m\n0,1\n"), "path.csv:1: the column 'height_m' is missing");
  EXPECT_EQ(refusal("height_m,north_m\n0,1\n"), "path.csv:1: the column 't_s' is missing");
  EXPECT_EQ(refusal("t_s,height_m\n0,1,2\n"),
            "path.csv:2: row has 3 numbers, expected 2, one per column");
  EXPECT_EQ(refusal("t_s,height_m\n0,1\n# c\n\n1,2,3\n"),
            "path.csv:5: row has 3 numbers, expected 2 as in row 1");
  EXPECT_EQ(refusal("t_s,height_m\n0,x\n"),
            "path.csv:2: 'x' is not a number, expected numbers separated by blanks or commas");
  EXPECT_EQ(refusal("t_s,height_m\n0,1\n1,nan\n"),
            "path.csv:3: 'nan' is not finite, expected finite numbers");
  EXPECT_EQ(refusal("t_s,height_m\n1,1\n"),
            "path.csv:2: t_s begins with 1, expected 0 because a flight needs a reference from its "
            "beginning");
  EXPECT_EQ(refusal("t_s,height_m\n0,1\n\n2,1\n2,1\n"),
            "path.csv:5: t_s is 2, expected more than 2, that of the previous row");
  EXPECT_EQ(refusal("t_s,height_m\n0,1\n# c\n2,-1\n"),
            "path.csv:4: height_m is -1, expected 0 or more and 100000 or less");
  EXPECT_EQ(refusal("t_s,height_m\n0,1\n1e9,1\n"),
            "path.csv:3: t_s is 1000000000, expected 0 or more and 86400 or less");
  EXPECT_EQ(refusal(std::string(kScriptFileLimit + 1, '#')),
            "path.csv: is larger than 16 MiB (16777216 bytes), expected at most 16 MiB");
  EXPECT_THAT(refusal(std::string("t_s,height_m\n0,1\0\n", 17)), HasSubstr("has a zero byte"));
}

// --- missions made in memory ---

TEST(ValidateMission, RefusesWhatAFileWouldNotHold) {
  const auto refuses = [](Mission mission, const std::string& message) {
    EXPECT_THAT([&] { validate(mission, "here"); },
                ThrowsMessage<InvalidInput>(StrEq("here: " + message)));
  };
  const Mission good = parse(kHover);
  Mission bad = good;
  bad.duration = std::numeric_limits<double>::quiet_NaN();
  refuses(bad, "duration is nan s, expected more than 0 and 86400 or less");
  bad = good;
  bad.start.in_air = false;
  refuses(bad, "the start is on the ground at a height of 1 m, expected 0");
  bad = good;
  bad.start.position.z() = 0;
  refuses(bad, "the start is in the air at a height of 0 m, expected more than 0");
  bad = good;
  bad.kind = Script{};
  refuses(bad, "there are no references, expected at least one");
  bad.kind = Script{{{0, 0, {0, 0, -1}, 0}, {3, 2, {0, 0, -1}, 0}}};
  refuses(bad, "reference 2 ends at 2 s and begins at 3 s, expected a ramp that is not negative");
  bad.kind = Script{{{0, 0, {0, 0, -1}, 0}, {3, 5, {0, 0, -1}, 0}, {4, 6, {0, 0, -1}, 0}}};
  refuses(bad,
          "reference 3 begins at 4 s, expected later because the previous one is complete at 5 s");
  bad.kind = Waypoints{{{0, 0, -1}, {0, 0, -1}}, 1, 1, Nose::fixed, 0};
  refuses(bad,
          "waypoints 1 and 2 are the same point, expected points that differ because a segment has "
          "a direction");
  bad.kind = Waypoints{{{0, 0, -1}}, 1, 1, Nose::fixed, 0};
  refuses(bad, "the mission has 1 waypoint, expected at least 2");
  bad.kind = Keys{{0, 0, -1}, 0, {{1, 'd'}, {1, 'a'}}};
  refuses(bad, "key 'a' is pressed at 1 s, expected later than the previous key 'd', at 1 s");
  bad.kind = Keys{{0, 0, -1}, 0, {{1, '\n'}}};
  refuses(bad, "no key '?', expected one of d a w s j l i k y h r e");
  bad.kind = Keys{{0, 0, -1}, 0, {{1, '\0'}}};
  refuses(bad, "no key '?', expected one of d a w s j l i k y h r e");
  bad.kind = SmoothPath(CirclePath{});
  refuses(bad, "radius is 0 m, expected more than 0 and 100000 or less");
  bad.kind = MotorTest{{{0, 1, {1}, 0.1}}};
  refuses(bad, "a motor test starts in the air, expected on the ground");
  bad = good;
  bad.landing = Landing{};
  bad.landing->rate = 0;
  refuses(bad, "rate of the landing is 0 m/s, expected more than 0 and 1000 or less");
  bad = good;
  bad.limits = {{Metric::tilt_max, 1}, {Metric::tilt_max, 2}};
  refuses(bad, "tilt_max is limited twice, expected once");
  bad.limits = {{Metric::duration, 1}};
  refuses(bad, "a limit is for an unknown metric or the duration, expected another metric");
  bad.limits = {{Metric::energy, -1}};
  refuses(bad, "limit of energy is -1 J, expected 0 or more and 1000000000000 or less");
}

TEST(RequireMotors, KnowsTheVehiclesRotors) {
  const Mission mission = load_mission("motor-test");
  EXPECT_NO_THROW(require_motors(mission, 4, "fly"));
  EXPECT_THAT([&] { require_motors(mission, 3, "fly"); },
              ThrowsMessage<InvalidInput>(StrEq("fly: mission 'motor-test' runs motor 4, expected "
                                                "1 to 3 because the vehicle has no more")));
  EXPECT_NO_THROW(require_motors(load_mission("hover"), 1, "fly"));
}

}  // namespace
}  // namespace quadtune
