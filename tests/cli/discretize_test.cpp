// SPDX-License-Identifier: Apache-2.0
/// The discretize command: all kinds of input, all keys of the output.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "matrix_near.hpp"
#include "quadtune/internal/json.hpp"
#include "run_program.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using ::testing::HasSubstr;
using testing::MatrixNear;
using testing::ProgramResult;
using testing::run_program;
using testing::TemporaryDirectory;

nlohmann::ordered_json discretize_json(std::vector<std::string> args) {
  args.insert(args.begin(), "discretize");
  args.insert(args.end(), {"--json", "--quiet"});
  const ProgramResult result = run_program(args);
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  return nlohmann::ordered_json::parse(result.out);
}

MatrixXd entry_matrix(const nlohmann::ordered_json& json, const char* key) {
  return internal::matrix_from_json(internal::Json::parse(json.at(key).dump()), key);
}

MatrixXd vector(const nlohmann::ordered_json& json, const char* key) {
  return internal::vector_from_json(internal::Json::parse(json.at(key).dump()), key).transpose();
}

TEST(DiscretizeCommand, SamplesTransferFunctionsByEveryMethod) {
  const auto num = [](const std::string& method) {
    const nlohmann::ordered_json json =
        discretize_json({"--num", "2", "--den", "1,0,0", "--dt", "0.5", "--method", method});
    EXPECT_EQ(json["method"], method);
    EXPECT_EQ(json["dt"], 0.5);
    EXPECT_EQ(json["delay_samples"], 0);
    EXPECT_TRUE(json["warnings"].empty());
    EXPECT_THAT(vector(json, "den"), MatrixNear(MatrixXd{{1, -2, 1}}, 1e-14)) << method;
    return vector(json, "num");
  };
  EXPECT_THAT(num("zoh"), MatrixNear(MatrixXd{{0, 0.25, 0.25}}, 1e-15));
  EXPECT_THAT(num("foh"), MatrixNear(MatrixXd{{0.5 / 6, 2.0 / 6, 0.5 / 6}}, 1e-15));
  EXPECT_THAT(num("impulse"), MatrixNear(MatrixXd{{0, 0.5, 0}}, 1e-15));
  EXPECT_THAT(num("euler"), MatrixNear(MatrixXd{{0, 0, 0.5}}, 1e-15));
  EXPECT_THAT(num("backward-euler"), MatrixNear(MatrixXd{{0.5, 0, 0}}, 1e-15));
  EXPECT_THAT(num("tustin"), MatrixNear(MatrixXd{{0.125, 0.25, 0.125}}, 1e-15));
  EXPECT_EQ(num("matched").cols(), 2);
}

TEST(DiscretizeCommand, PrewarpsTustin) {
  const nlohmann::ordered_json json = discretize_json(
      {"--num", "1", "--den", "1,0", "--dt", "0.1", "--method", "tustin", "--prewarp", "10"});
  const double half = std::tan(0.5) / 10;  // h/2
  EXPECT_THAT(vector(json, "num"), MatrixNear(MatrixXd{{half, half}}, 1e-16));
}

TEST(DiscretizeCommand, GoesThereAndBack) {
  const TemporaryDirectory folder;
  const std::string A = folder.write("A", "0 1\n-4 -1\n").string();
  const std::string B = folder.write("B", "0\n2\n").string();
  for (const std::string method : {"zoh", "tustin"}) {
    const nlohmann::ordered_json there =
        discretize_json({"--A", A, "--B", B, "--dt", "0.1", "--method", method});
    std::vector<std::string> args = {"--dt", "0.1", "--method", method, "--inverse"};
    for (const char* key : {"A", "B", "C", "D"}) {
      std::string rows;
      for (const auto& row : there[key]) {
        for (const auto& entry : row) rows += entry.dump() + " ";
        rows += "\n";
      }
      args.insert(args.end(),
                  {std::string("--") + key, folder.write(std::string("d") + key, rows).string()});
    }
    const nlohmann::ordered_json back = discretize_json(args);
    EXPECT_TRUE(back["inverse"].get<bool>());
    EXPECT_THAT(entry_matrix(back, "A"), MatrixNear(MatrixXd{{0, 1}, {-4, -1}}, 1e-13)) << method;
    EXPECT_THAT(entry_matrix(back, "B"), MatrixNear(MatrixXd{{0}, {2}}, 1e-13)) << method;
    EXPECT_THAT(entry_matrix(back, "C"), MatrixNear(MatrixXd::Identity(2, 2), 1e-13)) << method;
    EXPECT_THAT(entry_matrix(back, "D"), MatrixNear(MatrixXd::Zero(2, 1), 1e-13)) << method;
  }
  const nlohmann::ordered_json fraction = discretize_json(
      {"--num", "1", "--den", "1,-0.5", "--delay", "0.2", "--dt", "0.1", "--inverse"});
  EXPECT_THAT(vector(fraction, "den"), MatrixNear(MatrixXd{{1, std::log(2) / 0.1}}, 1e-13));
  EXPECT_EQ(fraction["delay_s"], 0.2);
}

TEST(DiscretizeCommand, DelaysBecomeStatesWithNames) {
  const TemporaryDirectory folder;
  const std::string A = folder.write("A", "-1 0\n0 -2\n").string();
  const std::string B = folder.write("B", "1 0\n0 2\n").string();
  const nlohmann::ordered_json json = discretize_json(
      {"--A", A, "--B", B, "--dt", "0.1", "--input-delay", "0.1", "--output-delay", "0,0.03"});
  EXPECT_EQ(json["states"],
            (std::vector<std::string>{"x1", "x2", "y2[k-0.3]", "u1[k-1]", "u2[k-1]"}));
  EXPECT_EQ(entry_matrix(json, "A").rows(), 5);
  const ProgramResult text =
      run_program({"discretize", "--A", A, "--B", B, "--dt", "0.1", "--input-delay", "0.1,0"});
  EXPECT_THAT(text.out, HasSubstr("x1 x2 u1[k-1]"));
  const nlohmann::ordered_json late =
      discretize_json({"--num", "1", "--den", "1,1", "--dt", "0.1", "--delay", "0.25"});
  EXPECT_EQ(late["delay_samples"], 2);
  EXPECT_EQ(vector(late, "den").cols(), 3);
}

TEST(DiscretizeCommand, WarnsOfFastPolesUnlessQuiet) {
  std::vector<std::string> args = {"discretize", "--num", "1", "--den", "1,120", "--dt", "0.01"};
  const std::string warning =
      "the pole at -120 1/s is fast for dt = 0.01 s: |pole| dt is 1.2, expected at most 0.5; use "
      "dt <= 0.00417 s";
  EXPECT_EQ(run_program(args).err, "discretize: warning: " + warning + "\n");
  EXPECT_EQ(run_program(args).status, 0);
  args.insert(args.end(), {"--json", "--quiet"});
  const ProgramResult quiet = run_program(args);
  EXPECT_EQ(quiet.err, "");
  EXPECT_EQ(nlohmann::ordered_json::parse(quiet.out)["warnings"],
            std::vector<std::string>{warning});
}

}  // namespace
}  // namespace quadtune
