// SPDX-License-Identifier: Apache-2.0
// quadtune certify on exports of the two designs.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "run_program.hpp"
#include "sanitized.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::string kSource = testing::source_folder();

class CertifyTest : public ::testing::Test {
 protected:
  /// The export of a design, written once for all tests.
  static const std::string& exported(const std::string& design) {
    static const TemporaryDirectory folder;
    static std::map<std::string, std::string> made;
    std::string& directory = made[design];
    if (directory.empty()) {
      directory = (folder.path() / design).string();
      const ProgramResult result =
          run_program({"design", kSource + "/designs/" + design + ".toml", "-o", directory});
      EXPECT_EQ(result.status, 0) << result.err;
    }
    return directory;
  }

  static nlohmann::json certified(std::vector<std::string> args, int status) {
    args.insert(args.begin(), "certify");
    args.emplace_back("--json");
    const ProgramResult result = run_program(args);
    EXPECT_EQ(result.status, status) << result.err;
    return nlohmann::json::parse(result.out);
  }

  static std::string refused(std::vector<std::string> args, int status) {
    args.insert(args.begin(), "certify");
    const ProgramResult result = run_program(args);
    EXPECT_EQ(result.status, status) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    return result.err;
  }
};

TEST_F(CertifyTest, ProvesTheUquadInItsDefaultBox) {
  const nlohmann::json report = certified({exported("uquad-hover")}, 0);
  EXPECT_EQ(report["verdict"], "proved");
  ASSERT_EQ(report["laws"].size(), 1);
  const nlohmann::json& law = report["laws"][0];
  EXPECT_EQ(law["name"], "state feedback");
  EXPECT_EQ(law["parts"].size(), 4);  // x, y, z and yaw are decoupled up to rounding
  EXPECT_GT(law["proof"]["gap"], 0);
  EXPECT_LT(law["proof"]["coupling"], law["proof"]["gap"]);
  EXPECT_TRUE(law["proof"]["where"].is_null());
  EXPECT_LT(law["worst"]["radius"], 1);
  EXPECT_GE(law["worst"]["radius"], 0.999683);  // of the nominal loop
  EXPECT_GE(law["scale"]["proved"], 1);
  EXPECT_EQ(law["box"]["delay"]["high"], 0.01);
  EXPECT_EQ(law["box"]["lag"]["high"], 0);
  // The nominal vehicle, the corners of mass, inertia, thrust and delay, and the worst one that the
  // search found.
  EXPECT_GE(law["flown"]["vehicles"], 17);
  EXPECT_EQ(law["flown"]["estimator"], "uquad");
  EXPECT_TRUE(law["flown"]["stable"]);
  EXPECT_LT(law["flown"]["radius"], 1);
}

// 45 ms of delay are too much for this box, 40 ms are not: search and proof agree to 2 %.
TEST_F(CertifyTest, BracketsTheScaleAtWhichStabilityIsLost) {
  const nlohmann::json report =
      certified({exported("uquad-hover"), "--delay", "0:0.06", "--mass", "0.9:1.1"}, 1);
  EXPECT_EQ(report["verdict"], "unstable");
  const nlohmann::json& law = report["laws"][0];
  EXPECT_FALSE(law["proved"].get<bool>());
  EXPECT_GT(law["worst"]["radius"], 1);
  EXPECT_TRUE(law["worst"]["unstable"].get<bool>());
  EXPECT_LT(law["scale"]["proved"], law["scale"]["found"]);
  EXPECT_GT(law["scale"]["proved"], 0.95 * law["scale"]["found"].get<double>());
  EXPECT_LT(law["scale"]["found"], 1);
  EXPECT_GT(law["scale"]["found_at"]["delay"], 0.03);
}

TEST_F(CertifyTest, SaysWhatItCannotProveAndWhere) {
  const ProgramResult result =
      run_program({"certify", exported("uquad-hover"), "--budget", "2", "--delay", "0:0.01"});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.out, HasSubstr("not proved"));
  EXPECT_THAT(result.out, HasSubstr("verdict     not proved"));
  EXPECT_THAT(result.err,
              HasSubstr("2 parts of the box were examined. The worst loop found has |z| 0.99968"));
}

TEST_F(CertifyTest, TakesBothLawsOfAMamboExport) {
  if (kSanitized) GTEST_SKIP() << "takes minutes under sanitizers";
  const nlohmann::json report = certified({exported("mambo-hover")}, 0);
  ASSERT_EQ(report["laws"].size(), 2);
  for (const nlohmann::json& law : report["laws"]) {
    EXPECT_GT(law["scale"]["proved"], 2.4) << law["name"];
    EXPECT_LT(law["scale"]["proved"], law["scale"]["found"]) << law["name"];
    EXPECT_LT(law["proof"]["boxes"], 40) << law["name"];
  }
}

// The poles of past commands and of the rotor reaction nearly coincide. A search that stops at its
// first choice of coordinates examines 20,000 boxes in vain.
TEST_F(CertifyTest, ProvesALawWithMemory) {
  if (kSanitized) GTEST_SKIP() << "takes minutes under sanitizers";
  const TemporaryDirectory folder;
  const std::string design = folder
                                 .write("d.toml",
                                        "name = \"d\"\nvehicle = \"crazyflie\"\n[trim]\nat = "
                                        "\"hover\"\n[lqr]\nplant = \"flown\"\n[[export]]\nto = "
                                        "\"json\"\n")
                                 .string();
  const std::string out = (folder.path() / "out").string();
  const ProgramResult designed = run_program({"design", design, "-o", out});
  ASSERT_EQ(designed.status, 0) << designed.err;
  const nlohmann::json report = certified({out}, 0);
  EXPECT_LT(report["laws"][0]["proof"]["boxes"], 400);
  EXPECT_GT(report["laws"][0]["scale"]["proved"], 1);
}

// Only the cascade can be requested.
TEST_F(CertifyTest, TakesTheCascadeOfAMamboExport) {
  const nlohmann::json one =
      certified({exported("mambo-hover"), "--controller", "cascaded-pid", "--mass", "1:1",
                 "--thrust", "1:1", "--inertia", "1:1", "--delay", "0"},
                0);
  ASSERT_EQ(one["laws"].size(), 1);
  EXPECT_EQ(one["laws"][0]["name"], "cascade");
  // A box of a single loop: the bracket consists of the limits of the search.
  EXPECT_EQ(one["laws"][0]["proof"]["proved_boxes"], one["laws"][0]["proof"]["boxes"]);
}

// The motor lag of the vehicle applies although it was not requested, so the box contains it. The
// export is made from the JSON output of `pid`.
TEST_F(CertifyTest, ListsTheLagThatItUsed) {
  const TemporaryDirectory folder;
  const std::string gains = (folder.path() / "pid.json").string();
  const std::string out = (folder.path() / "out").string();
  ASSERT_EQ(run_program({"pid", "crazyflie", "--quiet", "-o", gains}).status, 0);
  ASSERT_EQ(run_program({"export", gains, "--to", "json", "-o", out, "--quiet"}).status, 0);
  const std::vector<std::string> one = {out,        "--mass", "1:1",     "--inertia", "1:1",
                                        "--thrust", "1:1",    "--delay", "0"};
  const nlohmann::json box = certified(one, 0)["laws"][0]["box"];
  EXPECT_EQ(box["lag"],
            (nlohmann::json{{"low", 0.072}, {"nominal", 0.072}, {"high", 0.072}, {"unit", "s"}}));
  std::vector<std::string> text = one;
  text.insert(text.begin(), "certify");
  EXPECT_THAT(run_program(text).out, HasSubstr("lag         0.072 s"));
}

// The loop with true states is proved with a delay of 30 ms. With the delays of the sensors and the
// estimator it has 21 ms of margin at nominal.
TEST_F(CertifyTest, FindsTheFlownLoopThatIsUnstable) {
  const TemporaryDirectory folder;
  const std::string gains = (folder.path() / "pid.json").string();
  const std::string out = (folder.path() / "out").string();
  ASSERT_EQ(run_program({"pid", "mambo", "--quiet", "-o", gains}).status, 0);
  ASSERT_EQ(run_program({"export", gains, "--to", "json", "-o", out, "--quiet"}).status, 0);
  std::vector<std::string> args = {out,        "--mass", "1:1",     "--inertia", "1:1",
                                   "--thrust", "1:1",    "--delay", "0.03"};
  const nlohmann::json report = certified(args, 1);
  EXPECT_EQ(report["verdict"], "unstable");
  const nlohmann::json& law = report["laws"][0];
  EXPECT_EQ(law["proof"]["status"], "proved");
  EXPECT_FALSE(law["proved"].get<bool>());
  EXPECT_FALSE(law["flown"]["stable"].get<bool>());
  EXPECT_GT(law["flown"]["radius"], 1);
  EXPECT_EQ(law["flown"]["parameters"]["delay"], 0.03);
  EXPECT_THAT(refused(args, 1),
              HasSubstr("the flown loop, with sensors and the estimator general, is unstable at "));
  args.insert(args.end(), {"--plant", "ideal"});
  EXPECT_TRUE(certified(args, 0)["laws"][0]["flown"].is_null());
}

TEST_F(CertifyTest, SaysWhereTheVehicleCannotHover) {
  EXPECT_THAT(refused({exported("uquad-hover"), "--mass", "0.9:1.7"}, 1),
              HasSubstr("cannot hover everywhere in the box: "));
}

TEST_F(CertifyTest, GivesTheSameBytesTwice) {
  if (kSanitized) GTEST_SKIP() << "two certificates are as good as one for a sanitizer";
  const std::vector<std::string> args = {"certify", exported("uquad-hover"), "--delay", "0:0.02"};
  EXPECT_EQ(run_program(args).out, run_program(args).out);
}

TEST_F(CertifyTest, RefusesBadBoxes) {
  const std::string& out = exported("uquad-hover");
  EXPECT_EQ(refused({out, "--mass", "1.1:0.9"}, 2),
            "quadtune certify: --mass is '1.1:0.9', expected LOW:HIGH, ratios to the file's value "
            "with 0 < LOW <= 1 <= HIGH\n");
  EXPECT_THAT(refused({out, "--inertia", "1.1:1.2"}, 2), HasSubstr("--inertia is '1.1:1.2'"));
  EXPECT_THAT(refused({out, "--thrust", "0:1"}, 2), HasSubstr("--thrust is '0:1'"));
  EXPECT_THAT(refused({out, "--thrust", "nan:1"}, 2), HasSubstr("--thrust is 'nan:1'"));
  EXPECT_THAT(refused({out, "--delay", "-0.1:0"}, 2), HasSubstr("--delay is '-0.1:0'"));
  EXPECT_THAT(refused({out, "--delay", "0:1"}, 2), HasSubstr("at most 40 periods of 0.01 s"));
  EXPECT_THAT(refused({out, "--lag", "0:0.1"}, 2), HasSubstr("--lag is '0:0.1'"));
  EXPECT_THAT(refused({out, "--lag", "0.1:1.5"}, 2),
              HasSubstr("--lag is up to 1.5 s, expected at most 1 s"));
  EXPECT_THAT(refused({out, "--controller", "pdi"}, 2), HasSubstr("--controller is 'pdi'"));
  // The loops of an autopilot are certified as the cascade that `import` derives.
  EXPECT_THAT(refused({out, "--controller", "firmware"}, 2),
              HasSubstr("expected cascaded-pid (or pid) or state-feedback (or lqr)"));
  EXPECT_THAT(refused({out, "--budget", "0"}, 2), HasSubstr("--budget"));
  EXPECT_THAT(refused({out, "--plant", "real"}, 2), HasSubstr("--plant is 'real'"));
  EXPECT_THAT(refused({out, "--weight", "1"}, 2), StartsWith("quadtune certify: no option"));
  EXPECT_THAT(refused({}, 2), HasSubstr("expected an export's directory"));
}

TEST_F(CertifyTest, RefusesWhatDoesNotVerify) {
  const TemporaryDirectory folder;
  EXPECT_THAT(refused({folder.path().string()}, 5), HasSubstr("manifest.json"));
  std::filesystem::copy(exported("uquad-hover"), folder.path() / "out");
  folder.write("out/K_prop_full.txt", folder.read("out/K_prop_full.txt") + "\n");
  EXPECT_THAT(
      refused({(folder.path() / "out").string()}, 1),
      HasSubstr("does not verify: the check 'K_prop_full.txt matches the manifest' failed"));
  EXPECT_THAT(refused({exported("uquad-hover"), "--controller", "cascaded-pid"}, 3),
              HasSubstr("the export has no cascaded-pid, expected state-feedback"));
}

}  // namespace
}  // namespace quadtune::testing
