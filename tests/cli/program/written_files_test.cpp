// SPDX-License-Identifier: Apache-2.0
// Every file that a command writes is given to every command that reads its kind; and to commands
// that do not, which name those that do.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "run_program.hpp"
#include "sanitized.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using SortedJson = nlohmann::json;

// A vehicle of the user: no built-in name, and a layout that the Mambo's model project does not
// support.
constexpr char kOwn[] = R"(
name = "own"
[body]
mass_kg = 1.0
inertia_kg_m2 = [1e-2, 1e-2, 1.8e-2]
[rotor]
thrust_a2_N_s2_per_rad2 = 5e-5
torque_d2_N_m_s2_per_rad2 = 1e-6
lag_s = 0.02
[motor]
command = "speed"
min_rad_s = 50
max_rad_s = 400
[[rotors]]
position_m = [0.2, 0, 0]
spin = "cw"
[[rotors]]
position_m = [0, 0.2, 0]
spin = "ccw"
[[rotors]]
position_m = [-0.2, 0, 0]
spin = "cw"
[[rotors]]
position_m = [0, -0.2, 0]
spin = "ccw"
)";

/// A written file: its path, and the laws that it contains.
struct Written {
  std::string path;
  std::string vehicle;  ///< for V
  bool gains = false;
  bool cascade = false;
};

bool is_export(const Written& written) {
  return std::filesystem::exists(written.path + "/manifest.json");
}
bool is_design(const Written& written) { return written.path.ends_with(".toml"); }

class WrittenFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    if (kSanitized) GTEST_SKIP() << "each of these tests takes over a minute under sanitizers";
  }

  static std::string path(const std::string& name) {
    static const TemporaryDirectory folder;
    return (folder.path() / name).string();
  }

  static std::string write(const std::string& name, const std::string& text) {
    std::ofstream(path(name)) << text;
    return path(name);
  }

  static void made(const std::vector<std::string>& args, int status = 0) {
    const ProgramResult result = run_program(args);
    ASSERT_EQ(result.status, status) << ::testing::PrintToString(args) << result.err << result.out;
  }

  /// All files with control laws, written by every command that writes such files.
  static const std::map<std::string, Written>& all() {
    static const std::map<std::string, Written> files = [] {
      std::map<std::string, Written> written;
      make(written);
      return written;
    }();
    return files;
  }

  static void make(std::map<std::string, Written>& files) {
    const std::string own = write("own.toml", kOwn);
    const std::vector<std::string> quick = {
        "--mission", "hover",         "--duration", "12",      "--evaluations", "2",    "--proof",
        "2",         "--monte-carlo", "1",          "--force", "--sensors",     "ideal"};
    const auto tune = [&](const std::string& kind, const std::string& vehicle,
                          const std::string& file) {
      std::vector<std::string> args = {"tune", kind, vehicle, "-o", path(file)};
      args.insert(args.end(), quick.begin(), quick.end());
      (void)run_program(args);  // some of the designs may be rejected
      ASSERT_TRUE(std::filesystem::exists(path(file))) << file;
    };
    made({"design", testing::source_folder() + "/designs/uquad-hover.toml", "-o", path("uquad"),
          "--quiet"});
    files["design: uquad"] = {path("uquad"), "uquad", true, false};
    made({"design", testing::source_folder() + "/designs/mambo-hover.toml", "-o", path("mambo"),
          "--quiet"});
    files["design: mambo"] = {path("mambo"), "mambo", true, true};
    made({"export", path("uquad"), "--to", "json", "-o", path("uquad-json")});
    files["export: gains"] = {path("uquad-json"), "uquad", true, false};
    made({"export", path("mambo"), "--to", "json", "-o", path("mambo-json")});
    files["export: both"] = {path("mambo-json"), "mambo", true, true};
    made({"lqr", own, "--inputs", "wrench", "--R", "0.1,10,10,10", "--method", "sampled", "--dt",
          "0.01", "-o", path("lqr.json")});
    files["lqr"] = {path("lqr.json"), own, true, false};
    made({"export", path("lqr.json"), "--vehicle", own, "--to", "json", "-o", path("lqr-export")});
    files["export: lqr"] = {path("lqr-export"), own, true, false};
    made({"pid", own, "--quiet", "-o", path("pid.json")});
    files["pid"] = {path("pid.json"), own, false, true};
    made({"export", path("pid.json"), "--vehicle", own, "--to", "json", "-o", path("pid-export")});
    files["export: pid"] = {path("pid-export"), own, false, true};
    made({"pid", "mambo", "--quiet", "--integrator", "tustin", "--json", "-o", path("pid-mambo")});
    files["pid, any name"] = {path("pid-mambo"), "mambo", false, true};
    made({"export", path("pid-mambo"), "--to", "mambo", "-o", path("pid-mambo-export")});
    files["export: pid to mambo"] = {path("pid-mambo-export"), "mambo", false, true};
    tune("pid", own, "tuned-pid.toml");
    files["tune pid"] = {path("tuned-pid.toml"), own, false, true};
    made({"design", path("tuned-pid.toml"), "-o", path("tuned-pid"), "--quiet"});
    files["design: tune pid"] = {path("tuned-pid"), own, false, true};
    tune("lqr", own, "tuned-lqr.toml");
    files["tune lqr"] = {path("tuned-lqr.toml"), own, true, false};
    made({"design", path("tuned-lqr.toml"), "-o", path("tuned-lqr"), "--quiet"});
    files["design: tune lqr"] = {path("tuned-lqr"), own, true, false};
    made({"tune", "lqr", "uquad", "--match-gains", path("uquad"), "--R", "0.01", "--method",
          "discrete", "--force", "-o", path("matched.toml"), "--quiet"});
    files["tune lqr --match-gains"] = {path("matched.toml"), "uquad", true, false};
    files["gains.json"] = {path("pid-export/gains.json"), own, false, true};
    files["manifest.json"] = {path("mambo/manifest.json"), "mambo", true, true};
    files["controllerVars.m"] = {path("mambo/controllerVars.m"), "mambo", true, true};
    files["K_prop_full.txt"] = {path("uquad/K_prop_full.txt"), "uquad", true, false};
  }

  /// Runs a command on each file: `takes` selects the files that it accepts. The others are
  /// rejected with a message that names their kind.
  static void each(const std::function<bool(const Written&)>& takes,
                   const std::function<std::vector<std::string>(const Written&)>& command,
                   const std::vector<int>& done = {0}) {
    for (const auto& [name, file] : all()) {
      const std::vector<std::string> args = command(file);
      const ProgramResult result = run_program(args);
      const std::string told = name + ": " + ::testing::PrintToString(args) + "\n" + result.err;
      if (takes(file)) {
        EXPECT_THAT(done, ::testing::Contains(result.status)) << told << result.out;
        continue;
      }
      EXPECT_THAT(result.status, ::testing::AnyOf(3, 5)) << told;
      EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << told;
      EXPECT_THAT(result.err, HasSubstr(std::filesystem::path(file.path).filename().string()))
          << told;
      EXPECT_THAT(result.err,
                  ::testing::AnyOf(HasSubstr("which is for quadtune "), HasSubstr("PID cascade"),
                                   HasSubstr("[lqr]"), HasSubstr("state feedback")))
          << told;
    }
  }
};

constexpr auto kAny = [](const Written&) { return true; };

TEST_F(WrittenFiles, Fly) {
  // The state feedbacks with unit weights may exceed the limits of the mission, which is also a
  // valid answer.
  each(kAny,
       [](const Written& file) -> std::vector<std::string> {
         return {"fly",        file.vehicle, "--gains",   file.path, "--mission", "hover",
                 "--duration", "2",          "--sensors", "ideal",   "--quiet"};
       },
       {0, 1});
}

TEST_F(WrittenFiles, FlyEitherLaw) {
  for (const char* controller : {"state-feedback", "cascaded-pid"})
    each(
        [&](const Written& file) {
          return std::string(controller) == "cascaded-pid" ? file.cascade : file.gains;
        },
        [&](const Written& file) -> std::vector<std::string> {
          return {"fly",        file.vehicle, "--gains",   file.path, "--controller", controller,
                  "--duration", "2",          "--sensors", "ideal",   "--quiet"};
        },
        {0, 1});
}

TEST_F(WrittenFiles, CompareWithItself) {
  each(kAny, [](const Written& file) -> std::vector<std::string> {
    return {"compare", "gains",      file.vehicle, file.path,   file.path,
            "--quiet", "--duration", "2",          "--sensors", "ideal"};
  });
}

TEST_F(WrittenFiles, DiffWithItself) {
  for (const auto& [name, file] : all()) {
    const ProgramResult result = run_program({"diff", file.path, file.path});
    EXPECT_EQ(result.status, 0) << name << result.err;
    EXPECT_EQ(result.out, "equal in every entry\n") << name;
  }
}

// An export and its source contain the same law.
TEST_F(WrittenFiles, DiffWithWhatItWasMadeFrom) {
  for (const auto& [from, to] :
       {std::pair("design: uquad", "export: gains"), std::pair("design: mambo", "export: both"),
        std::pair("lqr", "export: lqr"), std::pair("pid", "export: pid"),
        std::pair("pid, any name", "export: pid to mambo"),
        std::pair("tune pid", "design: tune pid"), std::pair("tune lqr", "design: tune lqr"),
        std::pair("design: mambo", "controllerVars.m"),
        std::pair("design: mambo", "manifest.json")}) {
    const ProgramResult result = run_program({"diff", all().at(from).path, all().at(to).path});
    EXPECT_EQ(result.out, "equal in every entry\n") << from << ", " << to << result.err;
  }
}

TEST_F(WrittenFiles, Margins) {
  each(kAny, [](const Written& file) -> std::vector<std::string> {
    return {"margins", file.vehicle, "--gains", file.path, "--quiet"};
  });
}

TEST_F(WrittenFiles, ExportAndVerifyWhatWasExported) {
  int count = 0;
  for (const auto& [name, file] : all()) {
    const std::string to = path("again-" + std::to_string(++count));
    std::vector<std::string> args = {"export", file.path, "--to", "json", "-o", to, "--quiet"};
    if (!is_design(file)) args.insert(args.end(), {"--vehicle", file.vehicle});
    const ProgramResult result = run_program(args);
    EXPECT_EQ(result.status, 0) << name << result.err;
    const ProgramResult verified = run_program({"verify", to, "--vehicle", file.vehicle});
    EXPECT_EQ(verified.status, 0) << name << verified.err << verified.out;
  }
}

TEST_F(WrittenFiles, Verify) {
  each(is_export, [](const Written& file) -> std::vector<std::string> {
    return {"verify", file.path, "--vehicle", file.vehicle};
  });
}

TEST_F(WrittenFiles, Certify) {
  each(is_export,
       [](const Written& file) -> std::vector<std::string> {
         return {"certify",   file.path, "--vehicle", file.vehicle, "--mass",  "1:1",
                 "--inertia", "1:1",     "--thrust",  "1:1",        "--delay", "0"};
       },
       {0, 1});
}

TEST_F(WrittenFiles, Design) {
  each(is_design, [](const Written& file) -> std::vector<std::string> {
    return {"design", file.path, "--quiet"};
  });
}

TEST_F(WrittenFiles, TunePidBeginsWithACascade) {
  each([](const Written& file) { return file.cascade; },
       [](const Written& file) -> std::vector<std::string> {
         return {"tune",  "pid",           file.vehicle, "--gains",       file.path, "--mission",
                 "hover", "--duration",    "12",         "--evaluations", "1",       "--proof",
                 "2",     "--monte-carlo", "1",          "--sensors",     "ideal",   "--quiet"};
       },
       {0, 1});
}

TEST_F(WrittenFiles, MatchGainsOfAStateFeedback) {
  each([](const Written& file) { return file.gains; },
       [](const Written& file) -> std::vector<std::string> {
         return {"tune",    "lqr",      file.vehicle, "--match-gains",
                 file.path, "--starts", "1",          "--quiet"};
       },
       {0, 1, 4});
}

TEST_F(WrittenFiles, FlyInACampaign) {
  int count = 0;
  for (const auto& [name, file] : all()) {
    const std::string campaign = write(
        "campaign.toml", "name = \"c\"\nvehicle = \"" + file.vehicle +
                             "\"\nflights = 1\n[[design]]\nname = \"d\"\ngains = \"" + file.path +
                             "\"\n[[mission]]\nmission = \"hover\"\nduration_s = "
                             "1\nsensors = \"ideal\"\n");
    const ProgramResult result = run_program(
        {"campaign", "run", campaign, path("campaign-" + std::to_string(++count)), "--quiet"});
    EXPECT_EQ(result.status, 0) << name << result.err;
  }
}

// The printed text is not a file of gains: the message states how to write one.
TEST_F(WrittenFiles, TextIsToldFromWhatCanBeReadBack) {
  const std::string text = path("gains.txt");
  made({"lqr", "mambo", "-o", text});
  const ProgramResult result = run_program({"fly", "mambo", "--gains", text});
  EXPECT_EQ(result.status, 3);
  EXPECT_THAT(result.err, AllOf(HasSubstr("gains.txt: is not a gain file"), HasSubstr("--json"),
                                HasSubstr(".json")));
}

TEST_F(WrittenFiles, FilesInWrongPlacesAreNamed) {
  const std::string own = all().at("lqr").vehicle;
  const std::string text = write("a-file.txt", "no export\n");
  const std::string model = path("model.toml");
  made({"tune", "kalman", "--model", "altitude", "--log",
        testing::source_folder() + "/docs/examples/bobbing.csv", "--force", "--quiet", "-o",
        model});
  const std::string flown = path("flown.csv");
  (void)run_program({"fly", "mambo", "--duration", "1", "--log", flown});
  const std::string schedule = path("schedule.toml");
  made({"lqr", "mambo", "--schedule", "speed=0:1:1", "--quiet", "-o", schedule});
  const std::vector<std::pair<std::vector<std::string>, std::string>> wrong = {
      {{"verify", own}, "this is a vehicle file, which is for quadtune vehicle, design"},
      {{"fly", path("tuned-pid.toml")}, "this is a design file, which is for quadtune design"},
      {{"fly", "mambo", "--mission", own}, "this is a vehicle file"},
      {{"fly", "mambo", "--gains", model},
       "this is a filter model, which is for quadtune tune "
       "kalman --model"},
      {{"margins", "mambo", "--gains", schedule},
       "this is a gain schedule, which is for quadtune fly --gains"},
      {{"fly", "mambo", "--gains", flown}, "this is a flight log, which is for quadtune log"},
      {{"verify", text}, "is not a directory; expected that of an export"},
      {{"verify", path("lqr.json")},
       "this is a file of gains, which is for quadtune fly "
       "--gains"},
      {{"vehicle", "check", path("lqr.json")}, "this is a file of gains"},
      {{"campaign", "run", path("tuned-pid.toml"), path("nowhere")}, "this is a design file"},
      {{"tune", "kalman", "--model", own, "--log", flown}, "this is a vehicle file"},
  };
  for (const auto& [args, words] : wrong) {
    const ProgramResult result = run_program(args);
    EXPECT_THAT(result.status, ::testing::AnyOf(3, 5)) << ::testing::PrintToString(args);
    EXPECT_THAT(result.err, HasSubstr(words)) << ::testing::PrintToString(args);
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
  // No such message for a file of the right kind with an error in it.
  const std::string broken = write("broken.toml", std::string(kOwn) + "\noops = 1\n");
  for (const std::vector<std::string>& right :
       {std::vector<std::string>{"fly", broken},
        {"fly", "--dynamic-environment", broken},
        {"import", "px4", "--defaults", "--vehicle", broken},
        {"export", broken, "--to", "json", "-o", path("nowhere")}})
    EXPECT_THAT(run_program(right).err, ::testing::Not(HasSubstr("this is a")));
}

}  // namespace
}  // namespace quadtune::testing
