// SPDX-License-Identifier: Apache-2.0
// Command lines with habits of other programs or typing mistakes: they are accepted, or rejected
// with the right suggestion before any work is done.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "run_program.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using testing::ProgramResult;
using testing::run_program;
using ::testing::StartsWith;
using testing::TemporaryDirectory;

void refuses(const std::vector<std::string>& args, int status, const std::string& message) {
  const ProgramResult result = run_program(args);
  EXPECT_EQ(result.status, status) << result.err;
  EXPECT_THAT(result.err, HasSubstr(message));
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_EQ(result.out, "");
}

// K = [1 √3] for the double integrator with unit weights.
TEST(InlineMatrices, AreThoseOfFiles) {
  const TemporaryDirectory folder;
  const auto solved = [](const std::string& A, const std::string& B, const std::string& Q) {
    const ProgramResult result =
        run_program({"lqr", "--A", A, "--B", B, "--Q", Q, "--R", "1", "--json"});
    EXPECT_EQ(result.status, 0) << result.err;
    return result.out;
  };
  const std::string of_files =
      solved(folder.write("A", "0 1\n0 0\n").string(), folder.write("B", "0\n1\n").string(),
             folder.write("Q", "1 0\n0 1\n").string());
  const auto K = nlohmann::json::parse(of_files)["K"][0];
  EXPECT_NEAR(K[0].get<double>(), 1, 1e-15);
  EXPECT_NEAR(K[1].get<double>(), std::sqrt(3), 1e-15);
  EXPECT_EQ(solved("0 1; 0 0", "0; 1", "1 0; 0 1"), of_files);
  EXPECT_EQ(solved("[0 1; 0 0]", "[0; 1]", "[1 0; 0 1]"), of_files);
  EXPECT_EQ(solved("[[0, 1], [0, 0]]", "[[0], [1]]", "[[1,0],[0,1]]"), of_files);
  EXPECT_EQ(solved("0, 1; 0, 0;", " 0\n1 ", "1e0 0; 0 1.0"), of_files);
}

TEST(InlineMatrices, MayBeginWithAMinus) {
  const auto K = [](const std::vector<std::string>& A) {
    std::vector<std::string> args = {"lqr", "--B", "1", "--Q", "3", "--R", "1", "--json"};
    args.insert(args.end(), A.begin(), A.end());
    const ProgramResult result = run_program(args);
    EXPECT_EQ(result.status, 0) << result.err;
    return nlohmann::json::parse(result.out)["K"][0][0].get<double>();
  };
  EXPECT_NEAR(K({"--A", "-1"}), 1, 1e-15);
  EXPECT_NEAR(K({"--A=-1"}), 1, 1e-15);
}

TEST(InlineMatrices, SayWhichRowIsWrong) {
  const auto wrong = [](const std::string& A, const std::string& message) {
    refuses({"lqr", "--A", A, "--B", "0; 1", "--Q", "1 0; 0 1", "--R", "1"}, 2, message);
  };
  wrong("0 1; 0", "quadtune lqr: --A '0 1; 0':2: row has 1 number, expected 2");
  wrong("0 1; 0 x", "'0 1; 0 x':2: ");
  wrong("[0 one; 0 0]", "'[0 one; 0 0]':1: ");
}

TEST(InlineMatrices, AreNotTakenForFiles) {
  const TemporaryDirectory folder;
  const std::string file = folder.write("1;2", "0 1\n0 0\n").string();
  const ProgramResult result =
      run_program({"lqr", "--A", file, "--B", "0; 1", "--Q", "1 0; 0 1", "--R", "1", "--json"});
  EXPECT_EQ(result.status, 0) << result.err;
}

TEST(Synonyms, OfControllers) {
  const auto flown = [](const std::string& controller) {
    const ProgramResult result =
        run_program({"fly", "mambo", "--gains", "published", "--duration", "0.2", "--json",
                     "--quiet", "--controller", controller});
    EXPECT_LE(result.status, 1) << result.err;
    return nlohmann::json::parse(result.out)["law"];
  };
  EXPECT_EQ(flown("pid"), flown("cascaded-pid"));
  for (const char* word : {"lqr", "state-feedback"}) {
    const ProgramResult result = run_program(
        {"fly", "mambo", "--duration", "0.2", "--sensors", "ideal", "--controller", word});
    EXPECT_LE(result.status, 1) << result.err;
    EXPECT_THAT(result.out, HasSubstr("state feedback, LQI"));
  }
}

// "-" is standard output, never a file of that name.
TEST(StandardOutput, IsNoFile) {
  const ProgramResult printed = run_program({"vehicle", "show", "mambo"});
  EXPECT_EQ(run_program({"vehicle", "show", "mambo", "-o", "-"}).out, printed.out);
  for (const std::vector<std::string>& args : std::vector<std::vector<std::string>>{
           {"design", "designs/mambo-hover.toml", "-o", "-"},
           {"fly", "mambo", "--log", "-"},
           {"fly", "mambo", "--report", "-"},
           {"margins", "--num", "1", "--den", "1,1", "--plot", "-"}})
    refuses(args, 2,
            " is -, expected a file name, because standard output is used for the printed text");
  EXPECT_FALSE(std::filesystem::exists("-"));
}

TEST(WrongWords, AreAnsweredWithTheRightOnes) {
  refuses({"help", "a", "b", "c"}, 2, "too many arguments; expected: quadtune help");
  refuses({"vehicle"}, 2, "no action is given; expected list, show V, check FILE or new NAME");
  refuses({"fly", "mambo", "--mission", "figure8"}, 3, "did you mean 'lemniscate'?");
  refuses({"fly", "mambo", "--mission", "figure-eight"}, 3, "did you mean 'lemniscate'?");
  refuses({"fly", "mambo", "--wind", "5"}, 2,
          "'5' has no direction, expected the direction the wind blows to, such as north=3 [m/s]");
  refuses({"fly", "mambo", "--controller", "pdi"}, 2, "cascaded-pid (or pid)");
}

// None of them first computes a design or reads a missing file.
TEST(WrongWords, AreToldBeforeAnyWork) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> wrong = {
      {{"--sensors", "idel"}, "--sensors is 'idel', expected ideal or real"},
      {{"--wind", "gale"}, "--wind: no wind 'gale'"},
      {{"--estimator", "manbo"}, "--estimator"},
      {{"--controller", "pif"}, "--controller"}};
  for (const auto& [words, message] : wrong) {
    std::vector<std::string> args = {"fly", "mambo", "--gains", "not-there.json"};
    args.insert(args.end(), words.begin(), words.end());
    refuses(args, 2, message);
  }
  refuses({"tune", "pid", "mambo", "--mission", "hover", "--sensors", "idel"}, 2, "'idel'");
  refuses({"compare", "gains", "mambo", "not-there", "nor-this", "--wind", "gale"}, 2, "'gale'");
}

TEST(Help, OfCommandsOfTwoWords) {
  for (const auto& [words, begin] : {std::pair(std::vector<std::string>{"help", "calibrate", "imu"},
                                               "usage: quadtune calibrate imu"),
                                     std::pair(std::vector<std::string>{"help", "tune", "kalman"},
                                               "usage: quadtune tune kalman"),
                                     std::pair(std::vector<std::string>{"help", "vehicle", "show"},
                                               "usage: quadtune vehicle")}) {
    const ProgramResult result = run_program(words);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.out, StartsWith(begin));
  }
  refuses({"help", "calibrate", "imi"}, 2, "did you mean 'calibrate");
}

TEST(MissingFiles, SayWhatWasLookedForAndWhatIsThere) {
  const TemporaryDirectory folder;
  folder.write("hover.csv", "t,x\n0,1\n");
  const std::string missing = (folder.path() / "hovr.csv").string();
  refuses({"log", missing}, 5, missing + ": No such file or directory, expected a log");
  refuses({"log", missing}, 5, "hover.csv");
  refuses({"lqr", (folder.path() / "none" / "v.toml").string()}, 5, "there is no folder");
}

// The help text of the option and the files that exist say nothing about a file to write.
TEST(MissingFiles, AFileToWriteIsNotLookedFor) {
  const ProgramResult result = run_program({"pid", "mambo", "--plot", "/proc/none/loops.csv"});
  EXPECT_EQ(result.status, 5) << result.err;
  EXPECT_THAT(result.err,
              ::testing::AnyOf("/proc/none: No such file or directory\n",  // for root
                               "/proc/none: Permission denied\n"));
}

// For example a note about a vehicle that is read several times.
TEST(Notes, ComeOnce) {
  const TemporaryDirectory folder;
  const ProgramResult result =
      run_program({"export", "designs-of-nobody", "--to", "json", "-o", "x"});
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  const ProgramResult flown = run_program({"compare", "gains", "mambo", "published", "published",
                                           "--duration", "0.5", "--sensors", "ideal"});
  std::vector<std::string> lines;
  std::istringstream stream(flown.err);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  std::sort(lines.begin(), lines.end());
  EXPECT_EQ(std::adjacent_find(lines.begin(), lines.end()), lines.end()) << flown.err;
}

}  // namespace
}  // namespace quadtune
