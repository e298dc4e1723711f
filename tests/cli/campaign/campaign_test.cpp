// SPDX-License-Identifier: Apache-2.0
/// quadtune campaign, run as by a user.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "quadtune/exports/file_set.hpp"
#include "run_program.hpp"
#include "sanitized.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::ProgramResult;
using testing::run_program;
using ::testing::StartsWith;
using testing::TemporaryDirectory;

constexpr char kCampaign[] = R"(
name = "small"
vehicle = "mambo"
flights = 24
seed = 4
[[design]]
gains = "published"
[[mission]]
mission = "hover"
duration_s = 1
[[vary]]
quantity = "mass"
normal = { deviation = 0.05, least = 0.8, most = 1.2 }
[[vary]]
quantity = "gyroscope_noise"
log_normal = { deviation = 0.3 }
[keep]
failures = 1
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

/// A folder with a campaign file.
class Campaign : public ::testing::Test {
 protected:
  std::string write(const std::string& text = kCampaign, const std::string& name = "c.toml") {
    return directory_.write(name, text).string();
  }
  [[nodiscard]] std::string path(const std::string& name) const {
    return (directory_.path() / name).string();
  }
  [[nodiscard]] std::string bytes(const std::string& name) const { return directory_.read(name); }

  /// The one-line error for an invalid campaign file.
  std::string refusal(const std::string& text) {
    const ProgramResult result = run_program({"campaign", "init", write(text), path("refused")});
    EXPECT_EQ(result.status, 3) << text;
    EXPECT_FALSE(fs::exists(path("refused"))) << text;
    return result.err;
  }

  TemporaryDirectory directory_;
};

TEST_F(Campaign, RunsMergesAndTells) {
  const ProgramResult result = run_program({"campaign", "run", write(), path("out")});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("small: 24 draws of 2 quantities, seed 4"),
                                HasSubstr("published in hover: "), HasSubstr(" of 24 flights pass"),
                                HasSubstr("quadtune campaign replay ")));
  for (const char* file : {"plan.json", "flights.csv", "campaign.sqlite", "statistics.json",
                           "report.html", "slurm.sh", "parallel.sh", "00000.flights"})
    EXPECT_TRUE(fs::exists(path(std::string("out/") + file))) << file;
  const Json statistics = Json::parse(bytes("out/statistics.json"));
  EXPECT_EQ(statistics["cases"].size(), 1);
  EXPECT_EQ(statistics["cases"][0]["flights"], 24);
  EXPECT_GE(statistics["cases"][0]["success"]["high"], statistics["cases"][0]["success"]["value"]);
  // The page contains the flights and loads nothing.
  EXPECT_THAT(bytes("out/report.html"),
              AllOf(HasSubstr("gyroscope_noise"), Not(HasSubstr("src=\"http"))));
  // A second run finds all results.
  const ProgramResult again = run_program({"campaign", "run", write(), path("out"), "--json"});
  EXPECT_EQ(again.status, 0);
  EXPECT_EQ(Json::parse(again.out)["cases"], statistics["cases"]);
}

TEST_F(Campaign, FliesAGainSchedule) {
  ASSERT_EQ(run_program({"lqr", "mambo", "--schedule", "speed=0:1:1", "--inputs", "wrench", "--Q",
                         "4,4,40,2,2,4,2,2,10,0.1,0.1,0.4", "--R", "40,8000,8000,20000", "-o",
                         path("k.toml")})
                .status,
            0);
  const std::string campaign =
      write(replaced(kCampaign, "gains = \"published\"", "gains = \"k.toml\""));
  const ProgramResult result = run_program({"campaign", "run", campaign, path("out")});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("gain schedule of "), HasSubstr("k.toml, 2 points"),
                                HasSubstr("        24  completed")));
  const Json plan = Json::parse(bytes("out/plan.json"));
  const std::string table = plan["designs"][0]["schedule"].get<std::string>();
  EXPECT_TRUE(fs::exists(path("out/" + table))) << table;
}

TEST_F(Campaign, GivesTheSameBytesForAnySplit) {
  ASSERT_EQ(run_program({"campaign", "run", write(), path("one")}).status, 0);
  ASSERT_EQ(
      run_program({"campaign", "run", write(), path("many"), "--shards", "7", "--threads", "1"})
          .status,
      0);
  ASSERT_EQ(run_program({"campaign", "init", write(), path("by-hand"), "--shards", "3"}).status, 0);
  for (const char* shard : {"2", "0", "1"})
    ASSERT_EQ(run_program({"campaign", "work", path("by-hand"), "--shard", shard, "--threads", "2"})
                  .status,
              0);
  ASSERT_EQ(run_program({"campaign", "merge", path("by-hand")}).status, 0);
  for (const char* file : {"flights.csv", "campaign.sqlite"}) {
    const std::string first = bytes(std::string("one/") + file);
    EXPECT_FALSE(first.empty());
    EXPECT_EQ(first, bytes(std::string("many/") + file)) << file;
    EXPECT_EQ(first, bytes(std::string("by-hand/") + file)) << file;
  }
}

TEST_F(Campaign, FliesOneOfThemAgain) {
  ASSERT_EQ(run_program({"campaign", "run", write(), path("out")}).status, 0);
  const ProgramResult result =
      run_program({"campaign", "replay", path("out"), "--flight", "5", "--json", "--report",
                   path("flight.html"), "--log", path("flight.csv")});
  // One second is too short to settle: the flight fails and is reported as failed.
  ASSERT_EQ(result.status, 1) << result.err;
  EXPECT_THAT(result.err, StartsWith("campaign replay: "));
  EXPECT_EQ(Json::parse(result.out)["verdict"], "fail");
  EXPECT_TRUE(fs::exists(path("flight.html")));
  EXPECT_TRUE(fs::exists(path("flight.csv")));
  // Its metrics are those of the table, digit for digit.
  std::istringstream table(bytes("out/flights.csv"));
  std::string line, heads;
  std::getline(table, heads);
  for (int i = 0; i <= 5; ++i) std::getline(table, line);
  EXPECT_THAT(line, StartsWith("5,5,published,hover,"));
  const double tilt = Json::parse(result.out)["metrics"]["tilt_max_rad"];
  EXPECT_THAT(line, HasSubstr(fmt::format(",{},", tilt)));
}

// As `quadtune fly`: status 0 for a flight that passes.
TEST_F(Campaign, AFlightThatPassesEndsWith0) {
  std::string text = replaced(kCampaign, "duration_s = 1", "duration_s = 20");
  text = replaced(text, "gains = \"published\"", "gains = \"designed\"");
  text = replaced(text, "flights = 24", "flights = 1");
  ASSERT_EQ(run_program({"campaign", "init", write(text), path("out")}).status, 0);
  const ProgramResult result = run_program({"campaign", "replay", path("out"), "--flight", "0"});
  EXPECT_EQ(result.status, 0) << result.out;
  EXPECT_EQ(result.err, "");
}

TEST_F(Campaign, RunNamesItsFolderItself) {
  const std::string file = write();
  const std::string expected = fs::path(file).stem().string() + "-campaign";
  const fs::path here = fs::current_path();
  fs::current_path(path(""));
  const ProgramResult result = run_program({"campaign", "run", file});
  fs::current_path(here);
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("note: plan, flights and tables are written to " + expected));
  EXPECT_TRUE(fs::exists(fs::path(path(expected)) / "flights.csv"));
  // Nothing is written if the campaign file does not exist.
  EXPECT_THAT(
      run_program({"campaign", "run", path("none.toml")}).err,
      ::testing::StartsWith(path("none.toml") + ": No such file or directory, expected a campaign "
                                                "file"));
}

TEST_F(Campaign, StatusTellsWhatIsThere) {
  ASSERT_EQ(run_program({"campaign", "init", write(), path("out"), "--shards", "4"}).status, 0);
  EXPECT_THAT(run_program({"campaign", "status", path("out")}).out,
              HasSubstr("small: 0 of 24 flights, 4 shards waiting"));
  ASSERT_EQ(run_program({"campaign", "work", path("out"), "--shard", "1"}).status, 0);
  ASSERT_EQ(run_program({"campaign", "work", path("out"), "--shard", "2"}).status, 0);
  std::string shard = bytes("out/00002.flights");
  shard[200] ^= 1;
  directory_.write("out/00002.flights", shard);
  const ProgramResult text = run_program({"campaign", "status", path("out")});
  EXPECT_THAT(text.out, AllOf(HasSubstr("11 of 24 flights, 1 shard damaged, 1 shard done, 2 shards "
                                        "waiting\n"),  // no worker is running, so the time is
                                                       // unknown
                              HasSubstr("shard 2: damaged, 5 of 6 flights\n  00002.flights: record "
                                        "1 of 6 is damaged (wrong checksum)")));
  const Json json = Json::parse(run_program({"campaign", "status", path("out"), "--json"}).out);
  EXPECT_EQ(json["shards"][1]["state"], "done");
  EXPECT_EQ(json["shards"][2]["state"], "damaged");
  EXPECT_EQ(json["shards"][3]["state"], "waiting");
  EXPECT_TRUE(json["left_s"].is_null());
  // The missing shards are named, and nothing is merged.
  const ProgramResult merge = run_program({"campaign", "merge", path("out")});
  EXPECT_EQ(merge.status, 3);
  EXPECT_THAT(merge.err, HasSubstr("00002.flights: record 1 of 6 is damaged"));
  EXPECT_FALSE(fs::exists(path("out/flights.csv")));
  const ProgramResult work = run_program({"campaign", "work", path("out"), "--shard", "2"});
  EXPECT_EQ(work.status, 0);
  EXPECT_THAT(work.out, HasSubstr("shard 2: 1 flown, 5 found"));
  EXPECT_THAT(work.err, HasSubstr("record 1 of 6 is damaged (wrong checksum): flown again"));
  EXPECT_THAT(run_program({"campaign", "merge", path("out")}).err,
              HasSubstr("shards 0, 3 are not complete; expected all 4: `quadtune campaign work"));
}

// Two workers, one of which has written 3 records in its first 2 s.
TEST_F(Campaign, StatusTellsHowLongItTakesByThoseThatAreAtIt) {
  ASSERT_EQ(run_program({"campaign", "init", write(), path("out"), "--shards", "4"}).status, 0);
  ASSERT_EQ(run_program({"campaign", "work", path("out"), "--shard", "0"}).status, 0);
  ASSERT_EQ(run_program({"campaign", "work", path("out"), "--shard", "1"}).status, 0);
  const std::string shard = bytes("out/00001.flights");
  fs::remove(path("out/00001.flights"));
  // In the future, so that the files look recent however long the test takes.
  const auto now = std::chrono::system_clock::now() + std::chrono::hours(1);
  const auto part = [&](const std::string& number, double seconds, std::size_t size) {
    const auto began = now - std::chrono::duration<double>(seconds);
    const std::string name = fmt::format(
        "out/{}.host-1-{}.part", number,
        std::chrono::duration_cast<std::chrono::milliseconds>(began.time_since_epoch()).count());
    directory_.write(name, shard.substr(0, size));
    fs::last_write_time(path(name),
                        std::chrono::file_clock::from_sys(
                            std::chrono::time_point_cast<std::chrono::file_clock::duration>(now)));
  };
  part("00001", 2, 64 + 3 * 232);
  part("00002", 0.1, 0);
  const Json json = Json::parse(run_program({"campaign", "status", path("out"), "--json"}).out);
  EXPECT_NEAR(json["left_s"].get<double>(), (24 - 6 - 3) / (2 * 1.5), 0.01);
  EXPECT_THAT(
      run_program({"campaign", "status", path("out")}).out,
      HasSubstr("9 of 24 flights, 1 shard done, 2 shards running, 1 shard waiting, about 5 s "
                "left"));
  // All records exist.
  for (const char* number : {"1", "2", "3"})
    ASSERT_EQ(run_program({"campaign", "work", path("out"), "--shard", number}).status, 0);
  EXPECT_EQ(Json::parse(run_program({"campaign", "status", path("out"), "--json"}).out)["left_s"],
            0);
}

TEST_F(Campaign, APlanDoesNotChange) {
  ASSERT_EQ(run_program({"campaign", "init", write(), path("out")}).status, 0);
  // The same file gives the same plan; another file is rejected.
  EXPECT_EQ(run_program({"campaign", "init", write(), path("out")}).status, 0);
  ProgramResult result =
      run_program({"campaign", "init", write(replaced(kCampaign, "seed = 4", "seed = 5"), "d.toml"),
                   path("out")});
  EXPECT_EQ(result.status, 3);
  EXPECT_THAT(result.err, HasSubstr("belongs to another plan: seed is 4 in the folder and 5 "
                                    "in the request; use a new folder"));
  EXPECT_THAT(
      run_program({"campaign", "run", write(), path("out"), "--shards", "2"}).err,
      HasSubstr("its number of shards is 1 and not 2; expected --shards 1, which continues"));
  EXPECT_THAT(
      run_program({"campaign", "run",
                   write(replaced(kCampaign, "deviation = 0.05", "deviation = 0.06")), path("out")})
          .err,
      HasSubstr("uncertainty differs; use a new folder"));
  const std::string plan = bytes("out/plan.json");
  directory_.write("out/plan.json", replaced(plan, "\"seed\": 4", "\"seed\": 5"));
  for (const std::vector<std::string>& args :
       {std::vector<std::string>{"campaign", "work", path("out"), "--shard", "0"},
        {"campaign", "status", path("out")},
        {"campaign", "merge", path("out")},
        {"campaign", "replay", path("out"), "--flight", "0"}}) {
    result = run_program(args);
    EXPECT_EQ(result.status, 3);
    EXPECT_THAT(result.err, HasSubstr("plan.json: has been modified since it was written"));
  }
  directory_.write("out/plan.json", plan);
  EXPECT_EQ(run_program({"campaign", "work", path("out"), "--shard", "0"}).status, 0);
  directory_.write("out/plan.json", "{}");
  EXPECT_THAT(run_program({"campaign", "status", path("out")}).err,
              HasSubstr("is not the plan of a campaign"));
  for (const char* other : {"{\"format\": 3}", "[1, 2]", "[1", "3"}) {
    directory_.write("out/plan.json", other);
    result = run_program({"campaign", "status", path("out")});
    EXPECT_EQ(result.status, 3) << other;
    EXPECT_THAT(result.err, HasSubstr("is not the plan of a campaign")) << other;
  }
  for (const char* version : {"3", "null", "\"0.0.1\""}) {
    directory_.write(
        "out/plan.json",
        fmt::format(R"({{"format": "quadtune campaign plan", "version": {}}})", version));
    result = run_program({"campaign", "status", path("out")});
    EXPECT_EQ(result.status, 3) << version;
    EXPECT_THAT(result.err,
                HasSubstr(fmt::format("was written by version {}, but this is", version)));
  }
}

// A key of the wrong type, or a number that is not a count, although the hash of the plan is right.
TEST_F(Campaign, APlanOfOtherKindsIsRefused) {
  ASSERT_EQ(run_program({"campaign", "init", write(), path("out")}).status, 0);
  const Json plan = Json::parse(bytes("out/plan.json"));
  for (const auto& [key, value] : plan.items()) {
    if (key == "format" || key == "format_version" || key == "version") continue;
    for (const Json& other : {Json("x"), Json(-1.5), Json::array({1}), Json(nullptr)}) {
      if (other.type() == value.type()) continue;
      Json changed = plan;
      changed[key] = other;
      const std::string text = changed.dump();
      directory_.write("out/plan.json", text);
      directory_.write("out/plan.sha256", sha256(text) + "\n");
      const ProgramResult result = run_program({"campaign", "status", path("out")});
      EXPECT_EQ(result.status, 3) << key << " " << other.dump() << "\n" << result.out;
    }
  }
}

// The lines of docs/cli/campaign.md that are not left out there.
TEST_F(Campaign, PrintsWhatTheDocsShow) {
  if (testing::kSanitized) GTEST_SKIP() << "the flights of a whole campaign";
  const std::string root = testing::source_folder();
  const std::string out = replaced(
      run_program({"campaign", "run", root + "/campaigns/mambo-hover.toml", path("out")}).out,
      "campaign replay " + path("out") + " --flight 170",
      "campaign replay out/campaign --flight 170");
  std::ifstream page(root + "/docs/cli/campaign.md");
  int shown = 0;
  bool here = false, inside = false;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("## ")) here = line == "## Example";
    if (here && line == "```") inside = !inside;
    if (!here || !inside || line == "```" || line == "...") continue;
    EXPECT_THAT(out, HasSubstr(line + "\n"));
    ++shown;
  }
  EXPECT_GE(shown, 15);
}

TEST_F(Campaign, TakesGainsAndReferencesAlong) {
  // State feedback from a file, and a mission whose references are in its folder.
  ASSERT_EQ(run_program({"design", testing::source_folder() + "/designs/mambo-hover.toml", "-o",
                         path("gains"), "--force"})
                .status,
            0);
  directory_.write("way.csv", "t_s,north_m,east_m,height_m,yaw_rad\n0,0,0,1,0\n1,0.1,0,1,0\n");
  directory_.write("way.toml", R"(
name = "way"
duration_s = 2
[start]
at = "air"
height_m = 1
[csv]
file = "way.csv"
)");
  const std::string text = R"(
name = "along"
vehicle = "mambo"
flights = 4
[[design]]
name = "feedback"
gains = "gains/"
[[mission]]
mission = "way.toml"
sensors = "ideal"
[[vary]]
quantity = "mass"
uniform = { low = 0.95, high = 1.05 }
)";
  const ProgramResult result = run_program({"campaign", "run", write(text), path("out")});
  ASSERT_EQ(result.status, 0) << result.err;
  const std::string before = bytes("out/flights.csv");
  // The folder contains everything that is needed.
  fs::remove(path("way.csv"));
  fs::remove(path("way.toml"));
  fs::remove_all(path("gains"));
  fs::remove(path("out/00000.flights"));
  EXPECT_EQ(run_program({"campaign", "work", path("out"), "--shard", "0"}).status, 0);
  EXPECT_EQ(run_program({"campaign", "merge", path("out")}).status, 0);
  EXPECT_EQ(before, bytes("out/flights.csv"));
  directory_.write("out/way.csv", "t_s,north_m,east_m,height_m,yaw_rad\n0,0,0,1,0\n1,0.2,0,1,0\n");
  EXPECT_THAT(run_program({"campaign", "status", path("out")}).err,
              HasSubstr("way.csv: has been modified since the plan was written"));
}

TEST_F(Campaign, RefusesBadFiles) {
  const auto with = [](const std::string& from, const std::string& to) {
    return replaced(kCampaign, from, to);
  };
  EXPECT_THAT(refusal(with("flights = 24", "flights = 0")),
              HasSubstr("c.toml:4: flights is 0, expected"));
  EXPECT_THAT(refusal(with("flights = 24", "flights = 3\nshards = 4")),
              HasSubstr("c.toml:5: shards is 4, expected at most 3, the number of flights"));
  EXPECT_THAT(refusal(with("flights", "fligths")), HasSubstr("did you mean 'flights'"));
  EXPECT_THAT(refusal(with("quantity = \"mass\"", "quantity = \"mas\"")),
              HasSubstr("c.toml:12: no quantity 'mas'"));
  EXPECT_THAT(refusal(with("deviation = 0.05", "deviation = -0.05")),
              HasSubstr("mass: deviation is -0.05, expected 0 or more"));
  EXPECT_THAT(refusal(with("mission = \"hover\"", "mission = \"hovr\"")),
              AllOf(HasSubstr("c.toml:9: "), HasSubstr("did you mean 'hover'?")));
  EXPECT_THAT(refusal(with("\"published\"", "\"no/gains.json\"")),
              HasSubstr("c.toml:7: no gains 'no/gains.json', expected designed, published, or a "
                        "file or folder next to this file"));
  EXPECT_THAT(refusal(with("\"published\"", "\"publishd\"")),
              HasSubstr("c.toml:7: no gains 'publishd', expected designed, published, or a file or "
                        "folder next to this file; did you mean 'published'?"));
  EXPECT_THAT(refusal(with("vehicle = \"mambo\"", "vehicle = \"mamba\"")),
              AllOf(HasSubstr("c.toml:3: "), HasSubstr("did you mean 'mambo'?")));
  EXPECT_THAT(refusal(with("duration_s = 1", "duration_s = 1\nwind = \"storm\"")),
              AllOf(HasSubstr("c.toml:8: "), HasSubstr("storm")));
  EXPECT_THAT(refusal(with("[[design]]\n",
                           "[[design]]\nname = \"a\"\ngains = \"published\"\n"
                           "[[design]]\nname = \"a\"\n")),
              HasSubstr("a second design has the name 'a'"));
  EXPECT_THAT(refusal(with("[[mission]]\nmission = \"hover\"\nduration_s = 1\n", "")),
              HasSubstr("[[mission]] is missing; expected at least one"));
  EXPECT_THAT(refusal(with("gains = \"published\"", "gains = \"my,gains.json\"")),
              HasSubstr("no name of a design can be made from the gains 'my,gains.json'"));
  EXPECT_THAT(refusal(with("gains = \"published\"", "gains = \"gains/\"")),
              HasSubstr("no name of a design can be made from the gains 'gains/'"));
  EXPECT_THAT(
      refusal(with("quantity = \"gyroscope_noise\"", "quantity = \"gps_noise\"")),
      HasSubstr("published in hover: gps_noise: the file of the vehicle 'mambo' has nothing "
                "that this quantity (noise of the GPS receiver) changes"));
  EXPECT_THAT(refusal(with("failures = 1", "failures = -1")), HasSubstr("failures"));
  EXPECT_THAT(refusal(with("quantity = \"gyroscope_noise\"\nlog_normal",
                           "quantity = \"wind_north\"\nnormal")),
              HasSubstr("wind_north: the vehicle 'mambo' has no drag"));
}

// Gains whose loop is unstable are rejected before they are flown a thousand times.
TEST_F(Campaign, RefusesADesignThatDoesNotStabilize) {
  const std::string design = testing::source_folder() + "/designs/mambo-hover.toml";
  ASSERT_EQ(run_program({"design", design, "-o", path("mambo"), "--force"}).status, 0);
  ASSERT_EQ(run_program({"export", path("mambo"), "--to", "json", "-o", path("right")}).status, 0);
  const std::string text =
      replaced(kCampaign, "gains = \"published\"", "gains = \"right/gains.json\"");
  EXPECT_EQ(run_program({"campaign", "init", write(text), path("out")}).status, 0);
  Json gains = Json::parse(bytes("right/gains.json"));
  for (Json& row : gains["gains"]["K"])
    for (Json& entry : row) entry = -entry.get<double>();
  directory_.write("turned.json", gains.dump());
  const ProgramResult result =
      run_program({"campaign", "init", write(replaced(text, "right/gains.json", "turned.json")),
                   path("other")});
  EXPECT_EQ(result.status, 4);
  EXPECT_THAT(result.err, AllOf(HasSubstr("c.toml:6: the design 'turned' does not stabilize the "
                                          "vehicle 'mambo' in flight with the estimator "),
                                HasSubstr("deviations double in ")));
  // A mission without a control law before the one with it changes nothing.
  const std::string carried =
      replaced(replaced(text, "right/gains.json", "turned.json"), "[[mission]]",
               "[[mission]]\nmission = \"motor-test\"\n\n[[mission]]");
  EXPECT_EQ(run_program({"campaign", "init", write(carried), path("other")}).status, 4);
  EXPECT_FALSE(fs::exists(path("other")));
}

// A folder with the name of a vehicle or a mission, next to the file, is not used as one.
TEST_F(Campaign, FoldersAreNoVehicles) {
  fs::create_directory(path("mambo"));
  fs::create_directory(path("hover"));
  EXPECT_EQ(run_program({"campaign", "init", write(), path("out")}).status, 0);
}

TEST_F(Campaign, NotesWhatFlyWouldNote) {
  const std::string text =
      replaced(replaced(kCampaign, "\"mambo\"", "\"crazyflie\""), "published", "designed");
  const ProgramResult result = run_program({"campaign", "init", write(text), path("out")});
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err,
            "campaign init: note: the file of 'crazyflie' has no [sensors]; assumed: accelerometer "
            "200 Hz 0.05 m/s2, gyroscope 200 Hz 0.003 rad/s, magnetometer 100 Hz 0.5 uT, barometer "
            "50 Hz 2.5 Pa, sonar 20 Hz 0.01 m, optical flow 60 Hz 0.02 rad/s, GPS 1 Hz 1 m 0.1 m/s "
            "0.2 s late\n"
            "campaign init: note: every flight fails the limit of the settling time, which "
            "requires a constant reference for 10 s; the flight lasts 1 s\n");
}

TEST_F(Campaign, RefusesBadCommandLines) {
  ASSERT_EQ(run_program({"campaign", "init", write(), path("out")}).status, 0);
  const auto refuses = [](const std::vector<std::string>& args, int status,
                          const std::string& message) {
    const ProgramResult result = run_program(args);
    EXPECT_EQ(result.status, status) << message;
    EXPECT_THAT(result.err, HasSubstr(message));
  };
  refuses({"campaign"}, 2, "init, work, status, merge, run or replay");
  refuses({"campaign", "worc"}, 2, "did you mean 'work'?");
  refuses({"campaign", "init"}, 2, "expected a campaign file and a folder");
  refuses({"campaign", "work", path("out")}, 2,
          "--shard is missing, expected the number of the shard to fly");
  refuses({"campaign", "work", path("out"), "--shard", "1"}, 2, "--shard is 1, expected 0 to 0");
  refuses({"campaign", "work", path("nowhere"), "--shard", "0"}, 5, "nowhere/plan.json");
  refuses({"campaign", "replay", path("out"), "--flight", "24"}, 2,
          "--flight is 24, expected 0 to 23");
  refuses({"campaign", "replay", path("out")}, 2, "--flight is missing");
  refuses({"campaign", "replay", path("out"), "--flight", "0", "--report", "x.pdf"}, 2,
          "expected a name that ends in .html");
  refuses({"campaign", "run", write(), path("other"), "--shards", "25"}, 2,
          "--shards is 25, expected at most 24");
  refuses({"campaign", "run", write(), path("other"), "--shards", "4294967297"}, 2,
          "--shards is 4294967297, expected at most the number of flights");
  refuses({"campaign", "merge", path("out")}, 3, "shard 0 is not complete");
  // An unreadable file is not reported as missing.
  fs::create_directory(path("out/00000.flights"));
  refuses({"campaign", "merge", path("out")}, 5, "00000.flights: Is a directory");
  refuses({"campaign", "status", path("out")}, 5, "00000.flights: Is a directory");
  fs::create_symlink("loop", path("loop"));
  refuses({"campaign", "init", write(), path("loop")}, 5, "loop");
}

/// Runs a worker in a separate process.
pid_t start_worker(const std::string& folder, const std::string& shard) {
  const pid_t child = fork();
  if (child != 0) return child;
  _exit(run_program({"campaign", "work", folder, "--shard", shard, "--threads", "1"}).status);
}

// Workers are killed 200 times, and often two work on one shard; the merged result is that of an
// undisturbed run.
TEST_F(Campaign, TwoHundredKilledWorkersLeaveTheSameBytes) {
  const std::string flights = testing::kSanitized ? "flights = 6000" : "flights = 150000";
  const std::string file = write(
      replaced(replaced(kCampaign, "flights = 24", flights), "duration_s = 1", "duration_s = 0.3"));
  ASSERT_EQ(run_program({"campaign", "init", file, path("out"), "--shards", "4"}).status, 0);
  std::mt19937 random(2);
  int killed = 0;
  while (killed < 200) {
    const int i = killed;
    const int shards[] = {std::uniform_int_distribution(0, 3)(random), i % 4};
    const int second = i % 2 == 0 ? shards[0] : shards[1];
    const pid_t workers[] = {start_worker(path("out"), std::to_string(shards[0])),
                             start_worker(path("out"), std::to_string(second))};
    for (const pid_t worker : workers) {
      std::this_thread::sleep_for(
          std::chrono::milliseconds(std::uniform_int_distribution(1, 30)(random)));
      kill(worker, SIGKILL);
    }
    for (const pid_t worker : workers) {
      int status = 0;
      ASSERT_EQ(waitpid(worker, &status, 0), worker);
      if (WIFSIGNALED(status)) {
        ++killed;
        continue;
      }
      // The worker finished before it was killed, e.g. because this process waited for the
      // processor; the next ones must still have work.
      ASSERT_EQ(WEXITSTATUS(status), 0);
      for (const int shard : {shards[0], second})
        fs::remove(path(fmt::format("out/{:05}.flights", shard)));
    }
  }
  ASSERT_EQ(run_program({"campaign", "run", file, path("out"), "--shards", "4"}).status, 0);
  ASSERT_EQ(run_program({"campaign", "run", file, path("alone")}).status, 0);
  EXPECT_EQ(bytes("out/flights.csv"), bytes("alone/flights.csv"));
  EXPECT_EQ(bytes("out/campaign.sqlite"), bytes("alone/campaign.sqlite"));
}

// A full disk: the file and the reason are named, and written records are kept.
TEST_F(Campaign, AFullDiskIsNamedAndLosesNothing) {
  const std::string file = write(replaced(replaced(kCampaign, "flights = 24", "flights = 2000"),
                                          "duration_s = 1", "duration_s = 0.2"));
  ASSERT_EQ(run_program({"campaign", "init", file, path("out")}).status, 0);
  const pid_t child = fork();
  if (child == 0) {
    // Enough space for the first few hundred flights.
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{150000, 150000};
    setrlimit(RLIMIT_FSIZE, &limit);
    const ProgramResult result = run_program({"campaign", "work", path("out"), "--shard", "0"});
    const bool named = result.err.find(".part: File too large") != std::string::npos;
    _exit(named ? result.status : 99);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 5);
  const ProgramResult again = run_program({"campaign", "work", path("out"), "--shard", "0"});
  EXPECT_THAT(again.out, HasSubstr("shard 0: "));
  EXPECT_THAT(again.out, Not(HasSubstr("2000 flown, 0 found")));
  EXPECT_EQ(again.status, 0);
  EXPECT_EQ(run_program({"campaign", "merge", path("out")}).status, 0);
}

}  // namespace
}  // namespace quadtune
