// SPDX-License-Identifier: Apache-2.0
/// File names that are not UTF-8, and unexpected exceptions: no command ends by abort().
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <istream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <streambuf>

#include "program/program.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/utf8.hpp"
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

namespace fs = std::filesystem;

/// A folder whose name is not UTF-8, with copies of the files that the commands read.
class HostileNames : public ::testing::Test {
 protected:
  HostileNames() {
    fs::create_directories(folder_);
    const fs::path source = testing::source_folder();
    fs::copy(source / "designs/uquad-hover.toml", path("design\xff.toml"));
    fs::copy(source / "vehicles/mambo.toml", path("vehicle\xff.toml"));
    std::ofstream log(path("log\xff.csv"));
    log << "t_s,position[m],c\xff[m]\n";
    for (int i = 0; i < 400; ++i) log << i * 0.01 << "," << (i * 7919 % 101) * 0.01 << ",1\n";
  }

  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_ / name).string();
  }

  /// Runs with --json: the output is JSON, and the status is a documented one.
  Json run(std::vector<std::string> args, const std::vector<int>& expected = {0}) {
    args.emplace_back("--json");
    const ProgramResult result = run_program(args);
    EXPECT_THAT(expected, ::testing::Contains(result.status)) << args[0] << ": " << result.err;
    EXPECT_EQ(internal::visible_text(result.err), result.err);
    Json json = Json::parse(result.out, nullptr, false);
    EXPECT_FALSE(json.is_discarded()) << args[0] << ": " << result.out;
    return json;
  }

  /// The written page is UTF-8 and contains the name in a recognizable form.
  void expect_page(const std::string& name) {
    std::ifstream file(path(name));
    const std::string text(std::istreambuf_iterator<char>(file), {});
    EXPECT_THAT(text, HasSubstr("</html>")) << name;
    EXPECT_EQ(internal::valid_utf8(text), text) << name;
  }

  TemporaryDirectory directory_;
  fs::path folder_ = directory_.path() / "c\xff";
};

TEST_F(HostileNames, DesignVerifyExportCertifyAndDiff) {
  const Json design = run({"design", path("design\xff.toml"), "-o", path("out\xff")}, {0, 1});
  EXPECT_THAT(design.dump(), HasSubstr("out\\\\xff"));
  EXPECT_EQ(run({"verify", path("out\xff")})["verdict"], "pass");
  (void)run({"certify", path("out\xff"), "--budget", "100"}, {0, 1});
  (void)run({"export", path("design\xff.toml"), "--to", "json", "-o", path("json\xff")});
  (void)run({"diff", path("out\xff"), path("json\xff")}, {0, 1});
  (void)run({"verify", path("nothing\xff")}, {5});
}

TEST_F(HostileNames, LogsAndWhatIsTunedOnThem) {
  const Json log = run({"log", path("log\xff.csv")});
  EXPECT_THAT(log.dump(), HasSubstr("c\\\\xff"));
  (void)run({"tune", "kalman", "--model", "constant-velocity", "--log", path("log\xff.csv"),
             "--force", "-o", path("tuned\xff.toml"), "--report", path("tuned\xff.html")},
            {0, 1});
  expect_page("tuned\xff.html");
  (void)run({"calibrate", "imu", "--simulate", "-o", path("calib\xff.txt")});
  (void)run({"allan", "--log", path("log\xff.csv"), "--column", "position"}, {0, 1, 3});
}

TEST_F(HostileNames, FlightsAndTheirPages) {
  (void)run({"fly", path("vehicle\xff.toml"), "--duration", "1", "--log", path("flight\xff.mat"),
             "--report", path("flight\xff.html")},
            {0, 1});
  expect_page("flight\xff.html");
  (void)run({"vehicle", "show", path("vehicle\xff.toml")});
  (void)run({"pid", path("vehicle\xff.toml")});
  (void)run({"lqr", path("vehicle\xff.toml")});
}

// Regression test: all flights were flown, but neither statistics nor page were written.
TEST_F(HostileNames, Campaigns) {
  std::ofstream(path("campaign\xff.toml"))
      << "name = \"names\"\nvehicle = \"vehicle\xef\xbf\xbd.toml\"\nflights = 4\n[[design]]\ngains "
         "= \"published\"\n[[mission]]\nmission = \"hover\"\nduration_s = 1\n[[vary]]\nquantity = "
         "\"mass\"\nnormal = { deviation = 0.05, least = 0.8, most = 1.2 }\n[keep]\nfailures = 1\n";
  fs::copy(path("vehicle\xff.toml"), path("vehicle\xef\xbf\xbd.toml"));
  const Json json = run({"campaign", "run", path("campaign\xff.toml"), path("flown\xff")});
  EXPECT_EQ(json["flights"], 4);
  expect_page("flown\xff/report.html");
  (void)run({"campaign", "status", path("flown\xff")});
  (void)run({"campaign", "replay", path("flown\xff"), "--flight", "0", "--report",
             path("replay\xff.html")},
            {0, 1});
  expect_page("replay\xff.html");
}

/// An input stream that fails in an unexpected way.
class FailingInput : public std::streambuf {
  int_type underflow() override { throw std::logic_error("a library's \x1b[1m surprise \xff"); }
};

TEST(LastHandler, TellsEveryException) {
  const TemporaryDirectory directory;
  const std::string B = directory.write("B", "0\n1\n").string();
  const std::string Q = directory.write("Q", "1 0\n0 1\n").string();
  const std::string R = directory.write("R", "1\n").string();
  FailingInput failing;
  std::istream in(&failing);
  std::ostringstream out, err;
  EXPECT_EQ(cli::run({"lqr", "--A", "-", "--B", B, "--Q", Q, "--R", R, "--json"}, in, out, err), 6);
  EXPECT_EQ(err.str(),
            "quadtune: an error in quadtune itself: a library's \\x1b[1m surprise \\xff; please "
            "report it together with the command and its input\n");
  EXPECT_EQ(Json::parse(out.str())["error"]["code"], 6);
}

TEST(LastHandler, TellsWhatWouldTerminate) {
  const auto terminated = [] {
    cli::install_last_handler();
    // As from a thread or a destructor: nothing catches it.
    class Terminating : public std::streambuf {
      static void surprise() { throw std::logic_error("nobody catches this"); }
      int_type underflow() noexcept override {  // NOLINT(bugprone-exception-escape): on purpose
        surprise();
        return traits_type::eof();
      }
    } terminating;
    std::istream in(&terminating);
    std::ostringstream out;
    (void)cli::run({"lqr", "--A", "-"}, in, out, std::cerr);
  };
  EXPECT_EXIT(terminated(), ::testing::ExitedWithCode(6), "an error in quadtune itself");
}

}  // namespace
}  // namespace quadtune
