// SPDX-License-Identifier: Apache-2.0
/// Errors that the mutated inputs of tests/mutations revealed.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "log_files/hostile_samples.hpp"
#include "run_program.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::ProgramResult;
using testing::run_program;
using testing::TemporaryDirectory;

constexpr char kFilter[] = R"(name = "filter"
vehicle = "mambo"
[[kalman]]
name = "level"
dt_s = 0.005
states = [{ name = "level" }]
measurements = [{ name = "y" }]
A = [[1]]
C = [[1]]
G = [[1]]
tuned = "tuned.toml"
[[export]]
to = "json"
)";
constexpr char kTuned[] = R"(name = "local-level"
verdict = "fail"
states = ["level"]
noises = ["level"]
A = [[0]]
G = [[1]]
[[Q]]
variance = 1
[[sensors]]
name = "y"
outputs = ["y"]
C = [[1]]
[[sensors.R]]
variance = 1
)";

/// A negative answer before there is a result: one line, one object, no file.
void expect_refusal(const TemporaryDirectory& folder, std::vector<std::string> args,
                    const std::string& why) {
  const std::string file = (folder.path() / "answer").string();
  args.insert(args.end(), {"--json", "--quiet", "-o", file});
  const ProgramResult result = run_program(args);
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, HasSubstr(why));
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["error"]["code"], 1);
  EXPECT_THAT(json["error"]["message"].get<std::string>(), HasSubstr(why));
  EXPECT_FALSE(json["error"]["where"].get<std::string>().empty());
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(Refusal, OfAnExportThatDoesNotVerify) {
  const TemporaryDirectory folder;
  const std::string design = folder
                                 .write("d.toml", R"(name = "small"
vehicle = "uquad"
[lqr]
inputs = "rotor-speed"
states = ["roll", "pitch", "yaw", "p", "q", "r"]
Q = [1, 1, 1, 1, 1, 1]
R = [1, 1, 1, 1]
method = "discrete"
dt_s = 0.01
[[export]]
to = "json"
)")
                                 .string();
  const std::string made = (folder.path() / "out").string();
  ASSERT_EQ(run_program({"design", design, "-o", made}).status, 0);
  folder.write("out/gains.json", folder.read("out/gains.json") + " ");
  expect_refusal(folder, {"certify", made},
                 "does not verify: the check 'gains.json matches the manifest' failed");
}

TEST(Refusal, OfAFilterWhoseTuningDidNotPass) {
  const TemporaryDirectory folder;
  const std::string design = folder.write("d.toml", kFilter).string();
  folder.write("tuned.toml", kTuned);
  const std::string why = "the verdict on tuned.toml of filter level is 'fail'";
  const ProgramResult result = run_program({"design", design, "--json"});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(nlohmann::json::parse(result.out)["error"]["message"].get<std::string>(),
              HasSubstr(why));
  expect_refusal(folder, {"export", design, "--to", "json"}, why);
}

// Ceres wrote messages about its line search to the error stream, even with --quiet.
TEST(Libraries, PrintNothing) {
  const TemporaryDirectory folder;
  for (const testing::LogSample& sample : testing::log_samples()) {
    if (sample.format != "uquad-log") continue;
    const std::string file = folder.write("log", sample.bytes).string();
    ::testing::internal::CaptureStderr();
    const ProgramResult result =
        run_program({"tune", "kalman", "--model", "local-level", "--log", file, "--format",
                     "uquad-log", "--map", "y=4", "--starts", "1", "--quiet"});
    EXPECT_THAT(::testing::internal::GetCapturedStderr(), IsEmpty());
    EXPECT_LE(result.status, 4);
  }
}

}  // namespace
}  // namespace quadtune
