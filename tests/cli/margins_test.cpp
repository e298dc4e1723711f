// SPDX-License-Identifier: Apache-2.0
/// quadtune margins, and the margins in lqr and design.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

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

Json margins_json(std::vector<std::string> args) {
  args.emplace_back("--json");
  const ProgramResult result = run_program(args);
  EXPECT_EQ(result.status, 0) << result.err;
  return Json::parse(result.out);
}

TEST(MarginsVerb, OfATransferFunction) {
  const Json json = margins_json({"margins", "--num", "25", "--den", "1,10,10,10"});
  ASSERT_EQ(json["loops"].size(), 1U);
  const Json& loop = json["loops"][0];
  EXPECT_TRUE(loop["stable"]);
  EXPECT_NEAR(loop["disk_alpha"], 0.4581, 5e-5);
  EXPECT_NEAR(loop["disk_frequency"], 1.955, 5e-4);
  EXPECT_NEAR(loop["disk_gain_margin_db"], 4.051, 5e-4);
  EXPECT_NEAR(loop["disk_phase_margin_deg"], 25.80, 5e-3);
  EXPECT_TRUE(loop["gain_reduction_db"].is_null());
  EXPECT_NEAR(json["multivariable"]["disk_alpha_destabilizing"], 0.4581, 5e-5);
  const ProgramResult text = run_program({"margins", "--num", "24", "--den", "1,6,11,6"});
  EXPECT_THAT(text.out, HasSubstr("35.4"));
  EXPECT_EQ(text.err, "");
}

TEST(MarginsVerb, WarnsByName) {
  const ProgramResult low = run_program({"margins", "--num", "25", "--den", "1,10,10,10"});
  EXPECT_EQ(low.status, 0);
  EXPECT_EQ(low.err, "margins: warning: the loop: phase margin 29.1 deg, less than 30 deg\n");
  const ProgramResult unstable = run_program({"margins", "--num", "1", "--den", "1,0,0"});
  EXPECT_THAT(unstable.out, HasSubstr("UNSTABLE"));
  EXPECT_THAT(unstable.err, HasSubstr("the loop is unstable when it is closed"));
}

// A delay of whole samples is the same given as an option and as poles at 0.
TEST(MarginsVerb, DelayOfDiscreteLoops) {
  const Json option =
      margins_json({"margins", "--num", "0.1", "--den", "1,-1", "--dt", "0.01", "--delay", "0.02"});
  const Json states =
      margins_json({"margins", "--num", "0.1", "--den", "1,-1,0,0", "--dt", "0.01"});
  EXPECT_NEAR(option["loops"][0]["gain_margin_db"], states["loops"][0]["gain_margin_db"], 1e-9);
  const TemporaryDirectory folder;
  const std::string A = folder.write("A", "1\n").string();
  const std::string B = folder.write("B", "0.1\n").string();
  const std::string K = folder.write("K", "1\n").string();
  const Json matrices =
      margins_json({"margins", "--A", A, "--B", B, "--K", K, "--dt", "0.01", "--delay", "0.02"});
  EXPECT_EQ(matrices["loops"][0]["name"], "u1");
  EXPECT_NEAR(matrices["loops"][0]["gain_margin_db"], option["loops"][0]["gain_margin_db"], 1e-9);
  const Json at_states = margins_json({"margins", "--A", A, "--B", B, "--K", K, "--cut", "states"});
  EXPECT_EQ(at_states["loops"][0]["name"], "x1");
}

// The same loop by lqr, by design, and by margins from the files of design.
TEST(MarginsVerb, OfAVehiclesGains) {
  const TemporaryDirectory folder;
  const std::string out = (folder.path() / "out").string();
  const std::string design = testing::source_folder() + "/designs/uquad-hover.toml";
  const Json designed = margins_json({"design", design, "-o", out});
  const Json& expected = designed["lqr"]["margins"];
  EXPECT_EQ(designed["verdict"], "pass");
  EXPECT_TRUE(designed["warnings"].empty());
  const Json read = margins_json({"margins", "uquad", "--gains", out, "--plant", "ideal"});
  EXPECT_EQ(read["plant"], "ideal");
  EXPECT_FALSE(read.contains("flown"));
  ASSERT_EQ(read["loops"].size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(read["loops"][i]["name"], expected["loops"][i]["name"]);
    for (const char* key : {"gain_margin_db", "phase_margin_deg", "delay_margin_s", "disk_alpha"})
      EXPECT_NEAR(read["loops"][i][key], expected["loops"][i][key], 1e-6) << key;
    EXPECT_GT(expected["loops"][i]["phase_margin_deg"], 60);
  }
  // The margin of all loops at once is never larger than that of a single one.
  EXPECT_LE(expected["multivariable"]["disk_alpha"], expected["loops"][0]["disk_alpha"]);
  // With fourteen samples of delay the loop is unstable; the delay margin is less than ten.
  const double samples = double(expected["loops"][0]["delay_margin_s"]) / 0.01;
  EXPECT_LT(samples, 10);
  const Json late =
      margins_json({"margins", "uquad", "--gains", out, "--delay", "0.14", "--plant", "ideal"});
  EXPECT_FALSE(late["loops"][0]["stable"]);
  EXPECT_TRUE(
      margins_json({"margins", "uquad", "--gains", out, "--delay", "0.01"})["loops"][0]["stable"]);
  // The flown loop in addition: more delay, smaller margins, and the same ideal loop.
  const Json flown = margins_json({"margins", "uquad", "--gains", out, "--estimator", "uquad"});
  EXPECT_EQ(flown["plant"], "flown");
  EXPECT_EQ(flown["ideal"]["loops"], read["loops"]);
  EXPECT_TRUE(flown["flown"]["stable"]);
  EXPECT_LT(flown["flown"]["largest_pole"], 1);
  EXPECT_EQ(flown["flown"]["periods"], 100);  // GPS of 1 Hz, law of 100 Hz
  EXPECT_EQ(flown["flown"]["estimator"], "uquad");
  EXPECT_TRUE(flown["flown"]["drifts"].empty());
  for (const Json& loop : flown["loops"]) EXPECT_TRUE(loop["stable"]);
}

/// Optical flow and gyroscope that are sampled at different instants destabilize the Mambo's state
/// feedback, the sooner the higher it flies; its ideal margins do not show it.
TEST(MarginsVerb, OfTheFlownLoopKnowTheEstimator) {
  const std::string design = testing::source_folder() + "/designs/mambo-hover.toml";
  const Json aligned = margins_json({"margins", "mambo", "--gains", design});
  EXPECT_TRUE(aligned["flown"]["stable"]);
  EXPECT_EQ(aligned["flown"]["drifts"], Json({"px", "py", "yaw"}));
  const Json original = margins_json(
      {"margins", "mambo", "--gains", design, "--estimator", "mambo-original", "--height", "3"});
  EXPECT_FALSE(original["flown"]["stable"]);
  EXPECT_GT(original["flown"]["largest_pole"], 1.01);
  for (const Json& loop : original["ideal"]["loops"]) EXPECT_TRUE(loop["stable"]);
  const ProgramResult text = run_program({"margins", "mambo", "--gains", design});
  EXPECT_EQ(text.status, 0);
  for (const char* part :
       {"hover at 1.1 m, estimator general, real sensors; the sample times of the "
        "sensors repeat every 10 periods",
        "stable, largest |z| 0.99", "\nmargins of the ideal plant\n"})
    EXPECT_NE(text.out.find(part), std::string::npos) << part << "\n" << text.out;
  EXPECT_NE(text.err.find("do not observe px, py and yaw"), std::string::npos) << text.err;
}

TEST(MarginsVerb, OfLqrAreTheGuaranteed) {
  const TemporaryDirectory folder;
  const std::string A = folder.write("A", "0 1\n0 0\n").string();
  const std::string B = folder.write("B", "0\n1\n").string();
  const std::string Q = folder.write("Q", "1 0\n0 1\n").string();
  const std::string R = folder.write("R", "1\n").string();
  const Json json = margins_json({"lqr", "--A", A, "--B", B, "--Q", Q, "--R", R});
  const Json& loop = json["margins"]["loops"][0];
  EXPECT_TRUE(loop["gain_margin_db"].is_null());  // infinite
  EXPECT_GE(double(loop["phase_margin_deg"]), 60);
  EXPECT_NEAR(loop["Ms"], 1, 1e-6);
}

struct Matrices {
  TemporaryDirectory folder;
  std::string A, B, K;
  Matrices(const std::string& a, const std::string& b, const std::string& k)
      : A(folder.write("A", a).string()),
        B(folder.write("B", b).string()),
        K(folder.write("K", k).string()) {}
  [[nodiscard]] std::vector<std::string> arguments(std::vector<std::string> more) const {
    std::vector<std::string> all = {"margins", "--A", A, "--B", B, "--K", K};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
};

// A double integrator with poles at -1 +- j: stable as continuous matrices, not as discrete ones.
TEST(MarginsVerb, SaysWhatMatricesAreTakenFor) {
  const Matrices m("0 1\n0 0\n", "0\n1\n", "2 2\n");
  const ProgramResult by_period = run_program(m.arguments({"--dt", "0.01"}));
  EXPECT_EQ(by_period.status, 0);
  EXPECT_THAT(by_period.out, HasSubstr("discrete, every 0.01 s"));
  EXPECT_THAT(by_period.err,
              HasSubstr("margins: warning: A and B are assumed discrete because of --dt, but A - B "
                        "K is stable only if they are continuous: --sampled DT"));
  const ProgramResult declared = run_program(m.arguments({"--discrete", "--dt", "0.01"}));
  EXPECT_THAT(declared.err, ::testing::Not(HasSubstr("taken as")));
  EXPECT_THAT(declared.err, HasSubstr("unstable"));
  const Json continuous = margins_json(m.arguments({"--continuous"}));
  EXPECT_EQ(continuous["time"], "continuous");
  EXPECT_TRUE(continuous["dt"].is_null());
  EXPECT_EQ(run_program(m.arguments({})).err, "");
  const Json sampled = margins_json(m.arguments({"--sampled", "0.01"}));
  EXPECT_EQ(sampled["time"], "discrete");
  EXPECT_EQ(sampled["dt"], 0.01);
  EXPECT_TRUE(sampled["loops"][0]["stable"]);
  // The hold is equivalent to half a sample of delay.
  const double cut = double(continuous["loops"][0]["crossover"]);
  EXPECT_NEAR(double(continuous["loops"][0]["phase_margin_deg"]) -
                  double(sampled["loops"][0]["phase_margin_deg"]),
              cut * 0.005 * 180 / M_PI, 0.01);
  // x[k+1] = x + 0.1 u, closed-loop pole 0.5; unstable if read as continuous matrices.
  const Matrices discrete("1\n", "0.1\n", "5\n");
  EXPECT_THAT(run_program(discrete.arguments({})).err,
              HasSubstr("margins: warning: A and B are assumed continuous, but A - B K is stable "
                        "only if they are discrete: declare this with --discrete --dt T"));
  const ProgramResult noted = run_program(discrete.arguments({"--dt", "0.1"}));
  EXPECT_THAT(noted.err, HasSubstr("margins: note: A and B are assumed discrete because of --dt"));
}

// Stable as either kind. But a sampled plant has an eigenvalue 0, or a single negative one, only if
// it has delays, which occur together with slow modes near 1.
TEST(MarginsVerb, WarnsOfMatricesThatNoSampledPlantHas) {
  const auto told = [](const std::string& A, const std::string& B, const std::string& K,
                       std::vector<std::string> more = {"--dt", "0.01"}) {
    const ProgramResult result = run_program(Matrices(A, B, K).arguments(more));
    EXPECT_EQ(result.status, 0) << result.err;
    return result.err;
  };
  EXPECT_THAT(told("0 1\n0 0\n", "0\n1\n", "0.3 0.2\n"),
              HasSubstr("margins: warning: A and B are assumed discrete because of --dt, but A has "
                        "the eigenvalue 0, which is impossible for a plant sampled without delays: "
                        "--sampled DT declares them continuous"));
  EXPECT_THAT(told("-0.5\n", "1\n", "0.1\n"), HasSubstr("A has the eigenvalue -0.5"));
  EXPECT_THAT(told("0 1\n0 0\n", "0\n1\n", "0.3 0.2\n", {"--discrete", "--dt", "0.01"}),
              ::testing::Not(HasSubstr("eigenvalue")));
  for (const char* A : {"1 0.1\n0 0.9\n", "1 0.1\n0 0\n", "-0.5 0\n0 -0.5\n", "0 -0.5\n0.5 0\n"})
    EXPECT_THAT(told(A, "0\n1\n", "0.1 0.1\n"), ::testing::Not(HasSubstr("eigenvalue"))) << A;
}

TEST(MarginsVerb, RefusesContradictoryKinds) {
  const Matrices m("0 1\n0 0\n", "0\n1\n", "1 1.7\n");
  const auto refused = [&](std::vector<std::string> more, const std::string& why) {
    const ProgramResult result = run_program(m.arguments(std::move(more)));
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(result.err, HasSubstr(why));
  };
  refused({"--continuous", "--discrete"},
          "more than one of --continuous, --discrete and --sampled");
  refused({"--discrete"}, "--dt is missing, expected the sample period with --discrete");
  refused({"--continuous", "--dt", "0.1"}, "--dt cannot be combined with --continuous");
  refused({"--sampled", "0.1", "--dt", "0.1"}, "--dt cannot be combined with --sampled");
  refused({"--sampled", "-1"}, "--sampled is -1");
  const ProgramResult fraction =
      run_program({"margins", "--num", "1", "--den", "1,1", "--discrete"});
  EXPECT_EQ(fraction.status, 2);
  EXPECT_THAT(fraction.err, HasSubstr("apply to matrices only"));
}

TEST(MarginsVerb, TellsItsConventions) {
  const ProgramResult rest = run_program({"margins", "--num", "1", "--den", "1,1"});
  EXPECT_THAT(rest.err, HasSubstr("margins: note: the loop: |L(0)| is 1, which counts as a "
                                  "crossover at 0 rad/s"));
  const ProgramResult late =
      run_program({"margins", "--num", "1e-4", "--den", "1,1", "--delay", "1"});
  EXPECT_THAT(late.err,
              HasSubstr("phase crossovers with |L| below 1e-6 or above 1e6 are not listed"));
  const Json far = margins_json({"margins", "--num", "1e-6", "--den", "1,3,3,1"});
  EXPECT_NEAR(double(far["loops"][0]["gain_margin_db"]), 20 * std::log10(8e6), 1e-6);  // 138 dB
}

// 1/(s² + 1) gives closed-loop poles at ±i√2, where |S| is unbounded: 3e15 in a double.
TEST(MarginsVerb, KeepsItsColumnsWhateverTheNumbers) {
  const ProgramResult result = run_program({"margins", "--num", "1", "--den", "1,0,1"});
  std::istringstream lines(result.out);
  std::string line, head, row;
  while (std::getline(lines, line)) {
    if (line.find("gain up") != std::string::npos) head = line;
    if (line.find("UNSTABLE") != std::string::npos) row = line;
  }
  ASSERT_FALSE(head.empty()) << result.out;
  EXPECT_EQ(row.find("  UNSTABLE"), head.size()) << result.out;
}

// Random plants with many inputs: the work is bounded, reported, and selectable.
TEST(LqrEvidence, IsBoundedAndChosen) {
  const TemporaryDirectory folder;
  const auto identity = [](int n) {
    std::string text;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) text += i == j ? "1 " : (j == i + 1 ? "0.3 " : "0 ");
      text += "\n";
    }
    return text;
  };
  const auto plain = [](int n) {
    std::string text;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) text += i == j ? "1 " : "0 ";
      text += "\n";
    }
    return text;
  };
  const auto arguments = [&](int n, std::vector<std::string> more) {
    const std::string A = folder.write("A", identity(n)).string();
    const std::string I = folder.write("I", plain(n)).string();
    std::vector<std::string> all = {"lqr", "--A", A, "--B", I, "--Q", I, "--R", I};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  const ProgramResult large = run_program(arguments(64, {"--json"}));
  EXPECT_EQ(large.status, 0);
  EXPECT_THAT(large.err,
              HasSubstr("lqr: note: the margins are omitted, because with 64 states and 64 "
                        "inputs it would take more than about a second; --evidence full"));
  const Json none = Json::parse(large.out);
  EXPECT_EQ(none["K"].size(), 64U);
  EXPECT_TRUE(none["margins"]["loops"].empty());
  EXPECT_TRUE(none["margins"]["multivariable"].is_null());
  const Json full = margins_json(arguments(3, {}));
  EXPECT_EQ(full["margins"]["loops"].size(), 3U);
  EXPECT_GT(double(full["margins"]["multivariable"]["disk_alpha"]), 0);
  const Json essential = margins_json(arguments(3, {"--evidence", "essential"}));
  EXPECT_EQ(essential["margins"]["loops"], full["margins"]["loops"]);
  EXPECT_TRUE(essential["margins"]["multivariable"].is_null());
  EXPECT_TRUE(margins_json(arguments(3, {"--evidence", "none"}))["margins"]["loops"].empty());
  EXPECT_THAT(run_program(arguments(3, {"--evidence", "none"})).out, HasSubstr("not computed"));
  const ProgramResult wrong = run_program(arguments(3, {"--evidence", "esential"}));
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err, HasSubstr("expected none, essential or full; did you mean 'essential'?"));
}

// x[k+1] = u[k]: the closed loop's pole is 0, which has no logarithm.
TEST(LqrVerb, PoleAtZeroIsNoNan) {
  const TemporaryDirectory folder;
  const std::string A = folder.write("A", "0 0\n0 1\n").string();
  const std::string I = folder.write("I", "1 0\n0 1\n").string();
  const std::string zero = folder.write("Z", "0 0\n0 0\n").string();
  for (const std::string& R : {I, zero}) {
    const ProgramResult result =
        run_program({"lqr", "--discrete", "--A", A, "--B", I, "--Q", I, "--R", R});
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.out, ::testing::Not(HasSubstr("nan")));
    const bool told = result.err.find(
                          "lqr: note: R is singular; there is a solution because R + "
                          "B'SB is not") != std::string::npos;
    EXPECT_EQ(told, R == zero) << result.err;
  }
}

// S = Q, and B'SB = [1/16 -3/8; -3/8 9/4]: K is one of many.
TEST(LqrVerb, TellsThatOtherGainsCostNoMore) {
  const ProgramResult result =
      run_program({"lqr", "--discrete", "--A", "1 1.5; 0.5 0", "--B", "0.5 1.5; 1.5 0", "--Q",
                   "1 -0.5; -0.5 0.25", "--R", "0 0; 0 0"});
  EXPECT_THAT(result.err,
              HasSubstr("lqr: warning: R + B'SB is singular up to rounding, so that other "
                        "gains have the same cost as K"));
}

TEST(LqrVerb, TellsAnIndefiniteCost) {
  const TemporaryDirectory folder;
  const auto file = [&](const std::string& name, const std::string& text) {
    return folder.write(name, text).string();
  };
  const ProgramResult result =
      run_program({"lqr", "--discrete", "--A", file("A", "0.5\n"), "--B", file("B", "1\n"), "--Q",
                   file("Q", "1\n"), "--R", file("R", "1\n"), "--N", file("N", "-1.1\n")});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("lqr: warning: [Q N; N' R] has eigenvalue -0.1"));
}

// Rounding R once more may halve or double its small eigenvalue, 5e-15: K is exact and may change.
TEST(LqrVerb, TellsThatAnEquationIsIllConditioned) {
  const TemporaryDirectory folder;
  const auto file = [&](const std::string& name, const std::string& text) {
    return folder.write(name, text).string();
  };
  const std::vector<std::string> arguments = {"lqr",
                                              "--A",
                                              file("A", "0 1\n0 0\n"),
                                              "--B",
                                              file("B", "0 1\n1 1\n"),
                                              "--Q",
                                              file("Q", "1 0\n0 0\n"),
                                              "--R",
                                              file("R", "1 1\n1 1.00000000000001\n")};
  const ProgramResult text = run_program(arguments);
  EXPECT_EQ(text.status, 0) << text.err;
  EXPECT_THAT(text.err, HasSubstr("lqr: warning: the equation is ill-conditioned (rcond "));
  EXPECT_THAT(text.err,
              HasSubstr("K is exact for the matrices as given, but rounding their entries"));
  const Json json = margins_json(arguments);
  EXPECT_GT(double(json["gain_error"]), 1e-5);
  EXPECT_THAT(std::string(json["warning"]), HasSubstr("ill-conditioned"));
}

}  // namespace
}  // namespace quadtune
