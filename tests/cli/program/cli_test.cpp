// SPDX-License-Identifier: Apache-2.0
/// The program, run as by a user: results, JSON keys, help.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "matrix_near.hpp"
#include "plants/hover_model.hpp"
#include "program/program.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/version.hpp"
#include "quadtune/workbench/verify/verify_directory.hpp"
#include "run_program.hpp"
#include "sanitized.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using testing::MatrixNear;
using testing::MatrixRelativelyNear;
using testing::ProgramResult;
using testing::run_program;
using testing::TemporaryDirectory;

const std::string kSource = testing::source_folder();

/// Runs with --json and parses the output.
nlohmann::ordered_json json_of(std::vector<std::string> args) {
  args.push_back("--json");
  const ProgramResult result = run_program(args);
  EXPECT_EQ(result.status, 0) << result.err;
  return nlohmann::ordered_json::parse(result.out);
}

Eigen::MatrixXd matrix(const nlohmann::ordered_json& json, const char* key) {
  return internal::matrix_from_json(internal::Json::parse(json.at(key).dump()), key);
}

/// Runs the examples as printed from the project's root; their output goes to a temporary
/// directory.
class Examples : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::current_path(kSource); }

  std::vector<std::string> arguments(const std::string& example) const {
    std::istringstream words(example);
    std::vector<std::string> args;
    for (std::string word; words >> word;)
      args.push_back(word.starts_with("out/") ? (folder_.path() / word.substr(4)).string() : word);
    args.erase(args.begin());  // "quadtune"
    return args;
  }

  TemporaryDirectory folder_;
};

TEST_F(Examples, OfTheHelpPagesWorkAsPrinted) {
  if (testing::kSanitized) GTEST_SKIP() << "minutes of what other tests run too";
  for (const cli::Verb& verb : cli::verbs()) {  // design is first and writes what other examples
                                                // read
    const ProgramResult result = run_program(arguments(verb.example));
    EXPECT_EQ(result.status, 0) << verb.example << "\n" << result.err;
    EXPECT_NE(result.out, "") << verb.example;
    EXPECT_THAT(verb.example, ::testing::StartsWith("quadtune " + verb.name));
  }
}

TEST_F(Examples, PrintJsonToo) {
  if (testing::kSanitized) GTEST_SKIP() << "the same computations as the test before";
  for (const cli::Verb& verb : cli::verbs()) {
    std::vector<std::string> args = arguments(verb.example);
    args.push_back("--json");
    const ProgramResult result = run_program(args);
    EXPECT_EQ(result.status, 0) << verb.example << "\n" << result.err;
    EXPECT_TRUE(nlohmann::json::parse(result.out).is_object()) << verb.example;
  }
}

/// Splits "tune lqr" into its two words.
std::vector<std::string> words_of(const std::string& name, std::vector<std::string> after = {}) {
  std::istringstream stream(name);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  words.insert(words.end(), after.begin(), after.end());
  return words;
}

std::vector<std::string> help_of(const std::string& name) {
  std::vector<std::string> args = words_of(name);
  args.insert(args.begin(), "help");
  return args;
}

TEST(Help, ListsEveryVerbAndEveryOption) {
  const std::string overview = run_program({"help"}).out;
  const std::string man = run_program({"help", "--man"}).out;
  const std::string completion = run_program({"help", "--completion"}).out;
  for (const cli::Verb& verb : cli::verbs()) {
    EXPECT_THAT(overview, HasSubstr(verb.name));
    EXPECT_THAT(man, HasSubstr(".SS " + verb.name));
    EXPECT_THAT(completion, HasSubstr(" " + words_of(verb.name).back() + ") words=\""));
    const std::string help = run_program(help_of(verb.name)).out;
    EXPECT_THAT(help, HasSubstr(verb.example));
    EXPECT_EQ(run_program(words_of(verb.name, {"--help"})).out, help);
  }
  EXPECT_THAT(man, HasSubstr("\\-\\-convention"));
  EXPECT_THAT(run_program({"--version"}).out, MatchesRegex(std::string("quadtune ") + kVersion +
                                                           "\nkernels: (AVX-512|AVX2|baseline)\n"));
}

TEST(Help, TellsScriptsTheSameAsPeople) {
  const nlohmann::ordered_json all = json_of({"help"});
  EXPECT_EQ(all["version"], kVersion);
  ASSERT_EQ(all["commands"].size(), cli::verbs().size());
  for (std::size_t i = 0; i < cli::verbs().size(); ++i) {
    const cli::Verb& verb = cli::verbs()[i];
    EXPECT_EQ(all["commands"][i], json_of(help_of(verb.name)));
    EXPECT_EQ(all["commands"][i], json_of(words_of(verb.name, {"--help"})));
    EXPECT_EQ(all["commands"][i]["example"], verb.example);
    const std::string text = run_program(help_of(verb.name)).out;
    for (const nlohmann::ordered_json& option : all["commands"][i]["options"])
      EXPECT_THAT(text, HasSubstr(option["option"].get<std::string>()));
  }
  EXPECT_EQ(run_program({"help", "--man", "--json"}).status, 2);
}

TEST(Help, OfAFirstWordIsThatOfAllItsKinds) {
  const std::string all = run_program({"help", "tune"}).out;
  EXPECT_EQ(all, run_program({"help", "tune", "kalman"}).out + "\n" +
                     run_program({"help", "tune", "pid"}).out + "\n" +
                     run_program({"help", "tune", "lqr"}).out);
  EXPECT_EQ(run_program({"tune", "--help"}).out, all);
  EXPECT_EQ(json_of({"help", "tune"})["commands"].size(), 3u);
  EXPECT_THAT(run_program({"tune"}).err,
              HasSubstr("quadtune tune: the second word is missing, expected kalman, pid or lqr"));
  EXPECT_THAT(run_program({"help", "tune", "lqrr"}).err,
              HasSubstr("no command 'tune lqrr'; did you mean 'tune lqr'?"));
}

TEST(Linearize, GivesThePublicHoverModelOfTheUquad) {
  const nlohmann::ordered_json json = json_of(
      {"linearize", "uquad", "--at", "hover", "--convention", "uquad", "--inputs", "rotor-speed"});
  const ContinuousLti reference = testing::uquad_hover();
  EXPECT_THAT(matrix(json, "A"), MatrixNear(reference.A, 1e-12));
  EXPECT_THAT(matrix(json, "B"), MatrixRelativelyNear(reference.B, 1e-12));
  EXPECT_NEAR(json["trim"]["u"][0].get<double>(), 316.103650939028, 1e-9);
  EXPECT_LE(json["trim"]["residual"].get<double>(), 1e-10);
  EXPECT_EQ(json["states"][3]["name"], "psi");
  EXPECT_EQ(json["inputs"][0]["unit"], "rad/s");
}

TEST(Lqr, OfMatricesGivesKeysOfTheContract) {
  const std::string examples = kSource + "/docs/examples/";
  const nlohmann::ordered_json json =
      json_of({"lqr", "--A", examples + "A.txt", "--B", examples + "B.txt", "--Q",
               examples + "Q.txt", "--R", examples + "R.txt"});
  for (const char* key :
       {"status", "K", "S", "poles", "residual", "rcond", "iterations", "culprit"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_THAT(matrix(json, "S"), MatrixNear((Eigen::Matrix2d() << 2, 1, 1, 2).finished(), 1e-13));
}

TEST(Lqr, ReadsStandardInput) {
  const std::string examples = kSource + "/docs/examples/";
  const ProgramResult result =
      run_program({"lqr", "--A", examples + "A.txt", "--B", examples + "B.txt", "--Q",
                   examples + "Q.txt", "--R", "-", "--json"},
                  "1\n");
  EXPECT_EQ(result.status, 0) << result.err;
}

// Editors of some systems begin a UTF-8 file with this mark and do not show it.
TEST(ByteOrderMark, IsRefusedByNameInMatricesAndPassedOverInVehicles) {
  const std::string mark = "\xef\xbb\xbf";
  const TemporaryDirectory folder;
  const std::string one = folder.write("one", mark + "1\n").string();
  const ProgramResult result = run_program({"discretize", "--A", one, "--B", one, "--dt", "1"});
  EXPECT_EQ(result.status, 3);
  EXPECT_THAT(result.err, HasSubstr("one:1: '???1' is not a number but begins with a UTF-8 byte "
                                    "order mark, expected a file without one"));
  const std::string vehicle =
      folder.write("v.toml", mark + "name = \"v\"\n[body]\nmass_kg = 0\n").string();
  EXPECT_THAT(run_program({"vehicle", "check", vehicle}).err, HasSubstr("v.toml:3: mass_kg"));
}

TEST(Output, GoesIntoAFileWholeOrNotAtAll) {
  const TemporaryDirectory folder;
  const std::string file = (folder.path() / "model.json").string();
  const std::vector<std::string> linearize = {"linearize", "mambo", "--json"};
  std::vector<std::string> args = linearize;
  args.insert(args.end(), {"-o", file, "--threads", "2", "--seed", "1"});
  const ProgramResult result = run_program(args);
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(folder.read("model.json"), run_program(linearize).out);
  args[4] = folder.path().string();
  EXPECT_EQ(run_program(args).status, 5);
}

// The converged row of docs/uquad-gains.md, through the program.
TEST(Output, GoesIntoAFileAlsoWhereTheAnswerIsNo) {
  const TemporaryDirectory folder;
  const std::string file = (folder.path() / "f.txt").string();
  EXPECT_EQ(run_program({"fly", "uquad", "--duration", "3", "-o", file}).status, 1);
  EXPECT_THAT(folder.read("f.txt"), HasSubstr("verdict: fail"));
}

TEST(Output, LeavesDevicesAndLinksWhatTheyAre) {
  const TemporaryDirectory folder;
  const std::vector<std::string> command = {"discretize", "--num",  "1",    "--den", "1,1",
                                            "--method",   "tustin", "--dt", "0.1",   "-o"};
  const auto into = [&](const std::string& file) {
    std::vector<std::string> args = command;
    args.push_back(file);
    return run_program(args).status;
  };
  // A pipe represents devices, so that a test run as root does not damage one.
  const std::string pipe = (folder.path() / "pipe").string();
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const int reader = ::open(pipe.c_str(), O_RDWR | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  EXPECT_EQ(into(pipe), 0);
  std::array<char, 1000> text{};
  EXPECT_GT(::read(reader, text.data(), text.size() - 1), 0);
  EXPECT_THAT(text.data(), HasSubstr("num"));
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  ::close(reader);
  const std::filesystem::path target = folder.write("target.txt", "old");
  std::filesystem::create_symlink(target, folder.path() / "link.txt");
  EXPECT_EQ(into((folder.path() / "link.txt").string()), 0);
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path() / "link.txt"));
  EXPECT_THAT(folder.read("target.txt"), HasSubstr("num"));
}

TEST(Lqr, OfTheUquadMatchesTheConvergedRow) {
  const nlohmann::ordered_json json =
      json_of({"lqr", "uquad", "--convention", "uquad", "--Q", "1,1,1,1e3,1e3,1e3,1,1,1,1,1,1",
               "--R", "0.01", "--method", "discrete", "--dt", "0.01"});
  Eigen::RowVectorXd row(12);
  row << -6.4229039009, 0, 4.9784193008, 0, -224.5832238898, -152.0766955622, -18.3121970818, 0,
      13.3890015616, 0, -26.0617723279, -40.4123480715;
  EXPECT_THAT(matrix(json, "K").row(0), MatrixNear(row, 1e-9));
}

TEST(Kalman, SampledKeepsTheMeaningOfDensities) {
  const std::string examples = kSource + "/docs/examples/";
  const auto gain = [&](const char* dt) -> Eigen::MatrixXd {
    return matrix(json_of({"kalman", "--A", examples + "A.txt", "--C", examples + "C.txt", "--Q",
                           examples + "Q.txt", "--R", examples + "R.txt", "--sampled", dt}),
                  "L") /
           std::stod(dt);
  };
  EXPECT_THAT(gain("0.001"), MatrixRelativelyNear(gain("0.0005"), 2e-3));
}

TEST(Discretize, TustinOfTheDoubleIntegrator) {
  const std::string examples = kSource + "/docs/examples/";
  const nlohmann::ordered_json json =
      json_of({"discretize", "--A", examples + "A.txt", "--B", examples + "B.txt", "--dt", "0.1",
               "--method", "tustin"});
  EXPECT_THAT(matrix(json, "A"), MatrixNear((Eigen::Matrix2d() << 1, 0.1, 0, 1).finished(), 1e-15));
  EXPECT_EQ(json["method"], "tustin");
}

TEST(Vehicle, ShowsDerivedHoverSpeed) {
  const nlohmann::ordered_json json = json_of({"vehicle", "show", "uquad"});
  EXPECT_NEAR(json["derived"]["hover_speed_rad_s"].get<double>(), 316.103650939028, 1e-9);
  EXPECT_EQ(json_of({"vehicle", "list"})["vehicles"].size(), 4u);
}

/// The lines of a JSON object as TOML; tables within it are omitted.
std::string toml_lines(const nlohmann::ordered_json& table) {
  std::string text;
  for (const auto& [key, value] : table.items())
    if (!value.is_object() && !(value.is_array() && (value.empty() || value.front().is_object())))
      text += key + " = " + value.dump() + "\n";
  return text;
}

/// A vehicle file with the output of `vehicle show --json`.
std::string toml_of(const nlohmann::ordered_json& vehicle) {
  std::string text = toml_lines(vehicle);
  for (const char* table : {"environment", "body", "motor", "flight"})
    if (vehicle.contains(table))
      text += std::string("[") + table + "]\n" + toml_lines(vehicle[table]);
  if (vehicle.contains("published_cascade")) {
    const nlohmann::ordered_json& cascade = vehicle["published_cascade"];
    text += "[published_cascade]\n" + toml_lines(cascade);
    for (const auto& [name, loop] : cascade.items())
      if (loop.is_object()) text += "[published_cascade." + name + "]\n" + toml_lines(loop);
  }
  if (vehicle.contains("sensors"))
    for (const auto& [name, sensor] : vehicle["sensors"].items())
      text += "[sensors." + name + "]\n" + toml_lines(sensor);
  if (vehicle.contains("battery")) text += "[battery]\n" + toml_lines(vehicle["battery"]);
  for (nlohmann::ordered_json rotor : vehicle["rotors"]) {
    if (rotor.contains("Ct"))
      rotor.erase("thrust_a2_N_s2_per_rad2");  // a file contains one of the two
    if (rotor.contains("Cq")) rotor.erase("torque_d2_N_m_s2_per_rad2");
    text += "[[rotors]]\n" + toml_lines(rotor);
  }
  return text;
}

TEST(Vehicle, ShowsTheKeysOfAVehicleFile) {
  const TemporaryDirectory folder;
  const nlohmann::ordered_json list = json_of({"vehicle", "list"});
  const auto compare = [&](const std::string& name) {
    nlohmann::ordered_json shown = json_of({"vehicle", "show", name});
    const std::string text = toml_of(shown);
    nlohmann::ordered_json again =
        json_of({"vehicle", "show", folder.write("again.toml", text).string()});
    // A file may contain what another one omits.
    shown.erase("assumed");
    again.erase("assumed");
    EXPECT_EQ(again, shown) << text;
  };
  for (const auto& name : list["vehicles"]) compare(name);
  // With every sensor and a battery.
  compare(folder
              .write("full.toml", load_vehicle("mambo").text + R"(
[sensors.magnetometer]
rate_Hz = 100
bias_uT = [1, 2, 3]
dropout = 0.1
[sensors.gps]
rate_Hz = 1
noise_m = 0.5
velocity_noise_m_per_s = [0.1, 0.1, 0.3]
[sensors.vision]
rate_Hz = 5
delay_s = 0.3
quantum_m = 0.01
[battery]
capacity_A_h = 0.55
full_voltage_V = 4.2
empty_voltage_V = 3.2
cutoff_voltage_V = 3
resistance_ohm = 0.1
idle_power_W = 1
regulated = false
)")
              .string());
}

TEST(Vehicle, LeavesOutWhatTheFileLeavesOut) {
  const TemporaryDirectory folder;
  const std::string text =
      "name = \"least\"\n[body]\nmass_kg = 1\ninertia_kg_m2 = [1, 1, 2.02]\n"
      "inertia_tolerance = 0.02\n[rotor]\nthrust_a2_N_s2_per_rad2 = 1\n"
      "torque_d2_N_m_s2_per_rad2 = 1\n[motor]\ncommand = \"speed\"\nmin_rad_s = 1\n"
      "max_rad_s = 9\n[[rotors]]\nposition_m = [1, 0, 0]\nspin = \"cw\"\n"
      "[[rotors]]\nposition_m = [-1, 0, 0]\nspin = \"ccw\"\n";
  const nlohmann::ordered_json shown =
      json_of({"vehicle", "show", folder.write("v.toml", text).string()});
  const auto keys = [](const nlohmann::ordered_json& table) {
    std::vector<std::string> names;
    for (const auto& [key, value] : table.items()) names.push_back(key);
    return names;
  };
  using ::testing::ElementsAre;
  EXPECT_THAT(keys(shown), ElementsAre("name", "environment", "body", "motor", "rotors", "assumed",
                                       "warnings", "derived"));
  EXPECT_THAT(keys(shown["environment"]), ElementsAre("gravity_m_per_s2", "air_density_kg_per_m3"));
  EXPECT_THAT(keys(shown["body"]), ElementsAre("mass_kg", "inertia_kg_m2", "inertia_tolerance"));
  EXPECT_THAT(keys(shown["motor"]), ElementsAre("command", "min_rad_s", "max_rad_s"));
  EXPECT_THAT(keys(shown["rotors"][0]), ElementsAre("position_m", "spin", "thrust_a2_N_s2_per_rad2",
                                                    "torque_d2_N_m_s2_per_rad2"));
}

class DesignTest : public ::testing::Test {
 protected:
  ProgramResult design(const std::string& name, const std::string& to) {
    return run_program(
        {"design", kSource + "/designs/" + name, "-o", (folder_.path() / to).string()});
  }
  TemporaryDirectory folder_;
};

TEST_F(DesignTest, GivesTheSameBytesTwice) {
  if (testing::kSanitized) GTEST_SKIP() << "a sanitizer learns no more from the second run";
  for (const std::string name : {"uquad-hover.toml", "mambo-hover.toml"}) {
    ASSERT_EQ(design(name, "a").status, 0);
    ASSERT_EQ(design(name, "b").status, 0);
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path() / "a")) {
      const std::string file = entry.path().filename().string();
      // A page contains its command line, which contains the directory.
      std::string b = folder_.read("b/" + file);
      const std::string named = (folder_.path() / "b").string();
      for (std::size_t at = b.find(named); at != std::string::npos; at = b.find(named, at))
        b.replace(at + named.size() - 1, 1, "a");
      EXPECT_TRUE(folder_.read("a/" + file) == b) << file;
      ++files;
    }
    EXPECT_GE(files, 4);
  }
}

TEST_F(DesignTest, WritesWhatVerifies) {
  for (const auto& [name, file] : {std::pair{"uquad-hover.toml", "K_prop_full.txt"},
                                   std::pair{"mambo-hover.toml", "controllerVars.m"}}) {
    const ProgramResult result = design(name, "out");
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_TRUE(std::filesystem::exists(folder_.path() / "out" / file));
    EXPECT_EQ(run_program({"verify", (folder_.path() / "out").string()}).status, 0);
  }
}

// A wrong sign makes the loop unstable: both the hash of the file and the closed loop show it.
TEST_F(DesignTest, VerifyAnswersNoToATamperedFile) {
  ASSERT_EQ(design("uquad-hover.toml", "out").status, 0);
  std::string text = folder_.read("out/K_prop_full.txt");
  for (char& c : text) c = c == '-' ? ' ' : c;
  folder_.write("out/K_prop_full.txt", text);
  const ProgramResult result = run_program({"verify", (folder_.path() / "out").string(), "--json"});
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(nlohmann::json::parse(result.out)["verdict"], "fail");
}

// The manifest has no hash, so its trim is recomputed.
TEST_F(DesignTest, VerifyAnswersNoToATrimThatTheVehicleDoesNotHave) {
  ASSERT_EQ(design("uquad-hover.toml", "out").status, 0);
  const std::string text = folder_.read("out/manifest.json");
  const auto verify_with = [&](const std::vector<std::pair<const char*, double>>& changes) {
    nlohmann::ordered_json manifest = nlohmann::ordered_json::parse(text);
    for (const auto& [entry, value] : changes)
      manifest["gains"][nlohmann::ordered_json::json_pointer(entry)] = value;
    folder_.write("out/manifest.json", manifest.dump());
    const ProgramResult result = run_program({"verify", (folder_.path() / "out").string()});
    EXPECT_EQ(result.status, 1) << result.err;
    return result.out;
  };
  EXPECT_THAT(verify_with({{"/u0/0", 300}}),
              HasSubstr("FAIL trim is the vehicle's: u0(w1) is 300"));
  EXPECT_THAT(verify_with({{"/x0/3", 0.1}}), HasSubstr("FAIL trim is the vehicle's: x0("));
  EXPECT_THAT(verify_with({{"/x0/6", 10}}), HasSubstr("flies these files in hover"));
  EXPECT_THAT(verify_with({{"/x0/6", 50}, {"/x0/11", 50}}),
              HasSubstr("FAIL the vehicle can fly the trim: uquad: no circle trim"));
}

// The report reads the export back, so the export exists before writing the report to a full disk
// fails.
TEST_F(DesignTest, SaysThatTheExportIsThereWhenTheReportCannotBePrinted) {
  const std::string source = kSource + "/designs/uquad-hover.toml";
  const std::string to = (folder_.path() / "out").string();
  const std::vector<std::vector<std::string>> commands = {
      {"design", source, "-o", to}, {"export", source, "--to", "json", "-o", to}};
  for (const std::vector<std::string>& command : commands) {
    std::istringstream in;
    std::ostream full(nullptr);  // accepts no output
    std::ostringstream err;
    EXPECT_EQ(cli::run(command, in, full, err), 5);
    EXPECT_EQ(err.str(),
              "standard output: could not be written; " + to + " is written and complete\n");
    EXPECT_EQ(run_program({"verify", to}).status, 0);
  }
}

TEST_F(DesignTest, SaysThatNothingIsThereWhenNothingWasWritten) {
  std::istringstream in;
  std::ostream full(nullptr);
  std::ostringstream err;
  EXPECT_EQ(cli::run({"design", kSource + "/designs/uquad-hover.toml"}, in, full, err), 5);
  EXPECT_EQ(err.str(), "standard output: could not be written\n");
}

// The folder of the second export exists as a file; the first export has been written.
TEST_F(DesignTest, NamesTheExportThatWasWrittenBeforeAnotherFailed) {
  std::ifstream file(kSource + "/designs/uquad-hover.toml");
  std::ostringstream text;
  text << file.rdbuf() << "\n[[export]]\nto = \"json\"\n";
  const std::string two = folder_.write("two.toml", text.str()).string();
  folder_.write("out/json", "a file\n");
  const std::string out = (folder_.path() / "out").string();
  const ProgramResult result = run_program({"design", two, "-o", out});
  EXPECT_EQ(result.status, 5);
  EXPECT_THAT(result.err, HasSubstr("/json: is a file"));
  EXPECT_THAT(result.err, HasSubstr("; " + out + "/uquad is written and complete\n"));
}

TEST_F(DesignTest, VerifyNamesTheExportsOfADirectoryThatIsNone) {
  ASSERT_EQ(design("uquad-hover.toml", "out/b").status, 0);
  ASSERT_EQ(design("mambo-hover.toml", "out/a").status, 0);
  const std::string out = (folder_.path() / "out").string();
  const ProgramResult result = run_program({"verify", out});
  EXPECT_EQ(result.status, 5);
  EXPECT_EQ(result.err, out + ": has no manifest.json; expected one of the exports in it: " + out +
                            "/a, " + out + "/b\n");
}

TEST_F(DesignTest, ExportsToJsonAndDiffsAsEqual) {
  ASSERT_EQ(design("uquad-hover.toml", "a").status, 0);
  const std::string a = (folder_.path() / "a").string();
  const std::string b = (folder_.path() / "b").string();
  ASSERT_EQ(run_program({"export", a, "--to", "json", "-o", b}).status, 0);
  EXPECT_EQ(json_of({"diff", a, b})["max_relative"], 0);
}

}  // namespace
}  // namespace quadtune
