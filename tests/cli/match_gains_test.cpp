// SPDX-License-Identifier: Apache-2.0
/// quadtune tune lqr V --match-gains FILE.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "matrix_near.hpp"
#include "quadtune/design.hpp"
#include "quadtune/internal/json.hpp"
#include "run_program.hpp"
#include "sanitized.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::Not;
using testing::ProgramResult;
using testing::run_program;
using testing::TemporaryDirectory;

const std::string kDesign = testing::source_folder() + "/designs/uquad-hover.toml";

double number(const Json& json) { return json.get<double>(); }

/// The weight with this name.
const Json& weight(const Json& json, const std::string& name) {
  for (const Json& row : json["weights"])
    if (row["name"] == name) return row;
  ADD_FAILURE() << "no weight " << name;
  return json["weights"][0];
}

ProgramResult match(const std::string& file, std::vector<std::string> more = {}) {
  more.insert(more.begin(), {"tune", "lqr", "uquad", "--match-gains", file});
  return run_program(more);
}

class MatchGainsVerb : public ::testing::Test {
 protected:
  /// gains.json of the uquad's hover with all digits, computed with these options of `lqr`.
  std::string export_of(const std::string& design) {
    std::string directory = (folder_.path() / "export").string();
    const ProgramResult result = run_program({"design", design, "-o", directory, "--quiet"});
    EXPECT_EQ(result.status, 0) << result.err;
    return directory;
  }
  /// The uquad's hover design without its mission, exported as JSON.
  std::string exact_gains() {
    return export_of(
        folder_
            .write("hover.toml",
                   "name = \"hover\"\nvehicle = \"uquad\"\n[lqr]\nconvention = \"uquad\"\n"
                   "inputs = \"rotor-speed\"\nQ = [1, 1, 1, 1e3, 1e3, 1e3, 1, 1, 1, 1, 1, 1]\n"
                   "R = [0.01, 0.01, 0.01, 0.01]\nintegral = [\"x\", \"y\", \"z\", \"theta\"]\n"
                   "Q_integral = [1, 1, 1, 1]\nmethod = \"discrete\"\ndt_s = 0.01\n"
                   "[[export]]\nto = \"json\"\n")
            .string());
  }

  TemporaryDirectory folder_;
};

TEST_F(MatchGainsVerb, RecoversTheWeightsOfAnExport) {
  const ProgramResult result =
      match(exact_gains(), {"--method", "discrete", "--R", "0.01", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json["status"], "matched");
  EXPECT_EQ(json["convention"], "uquad");
  EXPECT_EQ(number(json["dt"]), 0.01);
  EXPECT_EQ(json["integrals"], Json::parse("[\"x\", \"y\", \"z\", \"theta\"]"));
  Eigen::VectorXd Q = Eigen::VectorXd::Ones(12);
  Q.segment(3, 3).setConstant(1e3);
  const Eigen::MatrixXd found =
      internal::matrix_from_json(internal::Json::parse(json["Q"].dump()), "Q");
  EXPECT_THAT((found.diagonal().cwiseQuotient(Q)).eval(),
              MatrixNear(Eigen::VectorXd::Ones(12).eval(), 1e-7));
  EXPECT_NEAR(number(weight(json, "Q_integral(theta)")["value"]), 1, 1e-8);
  EXPECT_NEAR(number(weight(json, "R(w3)")["value"]), 0.01, 1e-10);
  EXPECT_LT(number(json["difference"]["after"]), 1e-10);
  EXPECT_GT(number(json["difference"]["before"]), 0.1);
  EXPECT_TRUE(json["weighted_sensitivity"]["can_be_lqr"]);
  EXPECT_EQ(json["unseen"].size(), 0u);
}

// The same gain, requested in another convention, has the same weights under other names.
TEST_F(MatchGainsVerb, SpeaksTheConventionThatIsAskedFor) {
  const ProgramResult result = match(
      exact_gains(), {"--method", "discrete", "--R", "0.01", "--convention", "ned", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const Json json = Json::parse(result.out);
  EXPECT_NEAR(number(weight(json, "Q(roll)")["value"]), 1e3, 1e-3);
  EXPECT_NEAR(number(weight(json, "Q(pz)")["value"]), 1, 1e-6);
  EXPECT_NEAR(number(weight(json, "Q_integral(yaw)")["value"]), 1, 1e-6);
}

// docs/cli/tune-lqr.md: every weight that the published gains come from, but for the integral of
// the yaw, whose mode is the slowest and was far from its end where the recursion stopped.
TEST_F(MatchGainsVerb, FindsTheWeightsOfThePublishedGains) {
  const std::string file = (folder_.path() / "matched.toml").string();
  const ProgramResult result = match(kDesign, {"--R", "0.01", "--json", "-o", file});
  ASSERT_EQ(result.status, 0) << result.err;
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json["method"], "discrete");
  for (const char* name : {"Q(x)", "Q(z)", "Q(vqx)", "Q(wqy)", "Q(wqz)", "Q_integral(x)"})
    EXPECT_NEAR(number(weight(json, name)["value"]), 1, 1e-4) << name;
  EXPECT_NEAR(number(weight(json, "Q(theta)")["value"]), 1e3, 1e-2);
  EXPECT_NEAR(number(weight(json, "Q_integral(theta)")["value"]), 0.9682, 1e-4);
  EXPECT_LT(number(json["difference"]["after"]), 1e-7);
  // The file is a design whose gain is the published one.
  const Design design = load_design(file);
  EXPECT_EQ(design.name, "uquad-matched");
  EXPECT_EQ(design.lqr->method, LqrMethod::discrete);
  const ProgramResult designed = run_program({"design", file, "--json"});
  ASSERT_EQ(designed.status, 0) << designed.err;
  EXPECT_LT(number(Json::parse(designed.out)["published"]["max_relative"]), 1e-7);
}

TEST_F(MatchGainsVerb, TiesMakeWeightsEqual) {
  const ProgramResult result =
      match(kDesign, {"--tie", "x,y", "--tie", "psi,phi,theta", "--tie", "w1,w2,w3,w4", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const Json json = Json::parse(result.out);
  EXPECT_EQ(number(weight(json, "Q(x)")["value"]), number(weight(json, "Q(y)")["value"]));
  EXPECT_EQ(number(weight(json, "Q(psi)")["value"]), number(weight(json, "Q(theta)")["value"]));
  EXPECT_EQ(number(weight(json, "R(w1)")["value"]), number(weight(json, "R(w4)")["value"]));
  EXPECT_NEAR(number(weight(json, "R(w1)")["value"]), 1, 1e-12);  // the geometric mean of R is that
                                                                  // of the start
  EXPECT_NEAR(number(weight(json, "Q(psi)")["value"]), 1e5, 10);
}

// A common weight of position and roll cannot give the published gain.
TEST_F(MatchGainsVerb, SaysNoWhereNoWeightsGiveTheGain) {
  const std::string file = (folder_.path() / "matched.toml").string();
  const std::vector<std::string> tied = {"--tie", "x,psi", "-o", file};
  const ProgramResult result = match(kDesign, tied);
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.out, HasSubstr("verdict     not matched"));
  EXPECT_THAT(result.err,
              HasSubstr("no diagonal weights with these ties give this gain: the best ones leave"));
  EXPECT_FALSE(std::filesystem::exists(file));
  std::vector<std::string> forced = tied;
  forced.emplace_back("--force");
  EXPECT_EQ(match(kDesign, forced).status, 1);
  EXPECT_TRUE(std::filesystem::exists(file));
  // A remaining difference is accepted with a larger tolerance.
  EXPECT_EQ(match(kDesign, {"--tie", "x,psi", "--tolerance", "0.99"}).status, 0);
}

TEST_F(MatchGainsVerb, TellsPeopleTheSame) {
  const ProgramResult result = match(kDesign, {"--R", "0.01"});
  ASSERT_EQ(result.status, 0) << result.err;
  for (const char* line :
       {"problem     LQR, discrete weights, 10 ms, convention uquad", "Q_integral(theta)",
        "optimality  weighted sensitivity", "verdict     matched"})
    EXPECT_THAT(result.out, HasSubstr(line));
  EXPECT_THAT(result.out, Not(HasSubstr("not determined")));
}

// The axes of a wrench are decoupled, so the factor of each is not observable.
TEST_F(MatchGainsVerb, NamesWhatTheGainOfAWrenchDoesNotTell) {
  const std::string gains =
      export_of(folder_
                    .write("wrench.toml",
                           "name = \"wrench\"\nvehicle = \"mambo\"\n[lqr]\n"
                           "inputs = \"wrench\"\n"
                           "Q = [4, 4, 9, 25, 25, 10, 1, 1, 1, 0.2, 0.2, 0.1]\n"
                           "R = [1, 1e5, 1e5, 2e5]\nmethod = \"sampled\"\ndt_s = 0.005\n"
                           "[[export]]\nto = \"json\"\n")
                    .string());
  const ProgramResult result = run_program(
      {"tune", "lqr", "mambo", "--match-gains", gains, "--method", "sampled", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json["unseen"].size(), 3u);
  EXPECT_EQ(weight(json, "Q(yaw)")["verdict"], "in combination");
  EXPECT_NEAR(number(weight(json, "Q(yaw)")["value"]) / number(weight(json, "R(tau_z)")["value"]),
              10 / 2e5, 1e-10);
}

TEST_F(MatchGainsVerb, SameSeedSameBytes) {
  if (testing::kSanitized) GTEST_SKIP() << "a sanitizer learns no more from the second run";
  const std::vector<std::string> args = {"--tie", "x,psi", "--json", "--seed", "5"};
  EXPECT_EQ(match(kDesign, args).out, match(kDesign, args).out);
}

TEST_F(MatchGainsVerb, RefusesInOneLine) {
  const auto refused = [&](const std::vector<std::string>& args, int status,
                           const std::string& message) {
    const ProgramResult result = run_program(args);
    EXPECT_EQ(result.status, status) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  };
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"tune", "lqr", "uquad", "--match-gains", kDesign});
    return more;
  };
  refused({"tune", "lqr", "uquad"}, 2,
          "quadtune tune lqr: expected --mission NAME or --requirements FILE");
  refused({"tune", "lqr", "--match-gains", kDesign}, 2, "quadtune tune lqr: expected a vehicle");
  refused({"tune", "lqr", "uquad", "--match-gains", "no.json"}, 5, "no.json: No such file");
  refused({"tune", "lqr", "mambo", "--match-gains", kDesign}, 3,
          "the gains are for the vehicle 'uquad', expected 'mambo'");
  const TemporaryDirectory folder;
  const std::string remembering = (folder.path() / "g.json").string();
  ASSERT_EQ(run_program({"lqr", "crazyflie", "-o", remembering}).status, 0);
  refused({"tune", "lqr", "crazyflie", "--match-gains", remembering}, 3,
          "g.json: the law feeds back its past commands, expected a matrix on the states");
  refused(with({"--inputs", "wrench"}), 3, "the gains command rotor-speed, expected wrench");
  refused(with({"--states", "x,y,z"}), 3, "the gains have the states 'x y z psi");
  refused(with({"--integral", "x"}), 3, "the gains have the integrals 'x y z theta', expected 'x'");
  refused(with({"--tie", "x,thet"}), 2,
          "--tie: cannot tie the weight of 'thet': unknown name; expected some of: x y z psi");
  refused(with({"--tie", "x,int_thetta"}), 2, "did you mean 'int_theta'?");
  refused(with({"--tie", "x"}), 2, "--tie: a tie has 1 weight; expected 2 or more");
  refused(with({"--tie", "x,y", "--tie", "y,z"}), 2, "--tie: 'y' is in more than one tie");
  refused(with({"--tie", "x,w1"}), 2, "--tie: 'x' and 'w1' are tied; expected only states");
  refused(with({"--tolerance", "0"}), 2, "--tolerance is 0, expected more than 0 and less than 1");
  refused(with({"--R", "0"}), 2, "--R has a 0; expected positive entries");
  refused(with({"--Q", "1,2"}), 2, "quadtune tune lqr: --Q has 2 entries, expected 16");
  refused(with({"--method", "discreet"}), 2, "did you mean 'discrete'?");
  // A design whose published gain has lost its minus signs.
  std::ifstream stream(kDesign);
  std::string turned(std::istreambuf_iterator<char>(stream), {});
  for (std::size_t at = turned.find("[published]");
       (at = turned.find('-', at + 1)) != std::string::npos;)
    turned[at] = ' ';
  const std::string file = folder_.write("turned.toml", turned).string();
  refused({"tune", "lqr", "uquad", "--match-gains", file}, 4,
          "turned.toml: the loop of the given gain has a pole of modulus");
  // Without [published], the gains of a design are those of its weights.
  const std::string bare = turned.substr(0, turned.find("[published]"));
  const ProgramResult own = run_program(
      {"tune", "lqr", "uquad", "--match-gains", folder_.write("bare.toml", bare).string()});
  EXPECT_EQ(own.status, 0) << own.err;
  EXPECT_THAT(own.out, HasSubstr("verdict     matched"));
}

}  // namespace
}  // namespace quadtune
