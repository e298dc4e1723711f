// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/match_gains.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "gains/gain_search.hpp"
#include "matrix_near.hpp"
#include "plants/hover_model.hpp"
#include "plants/random_plant.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/synthesis/diagonal_lqr.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::ThrowsMessage;

/// Diagonal weights of 1 with these sizes.
LqrDesign ones(Index nx, Index nu, const std::vector<std::string>& integrals) {
  LqrDesign design;
  design.integrals = integrals;
  design.Q.setIdentity(nx, nx);
  design.Q_integral.setIdentity(std::ssize(integrals), std::ssize(integrals));
  design.R.setIdentity(nu, nu);
  return design;
}

/// The problem of the uquad's published gains, weights of 1.
LqrDesign uquad_problem() {
  LqrDesign design = ones(12, 4, {"x", "y", "z", "theta"});
  design.method = LqrMethod::discrete;
  design.dt = 0.01;
  return design;
}

VectorXd uquad_weights() {
  VectorXd w = VectorXd::Ones(20);
  w.segment(3, 3).setConstant(1e3);
  w.tail(4).setConstant(0.01);
  return w;
}

/// As in designs/uquad-hover.toml.
struct Published {
  MatrixXd K, K_int;
};
Published published() {
  Published p;
  p.K.resize(4, 12);
  p.K << -21.352434, 0, 15.803452, 0, -239.72813, -153.31028, -32.396814, 0, 22.677079, 0,
      -26.837592, -40.570464, 0, -21.352434, 15.803452, 239.72813, 0, 153.31028, 0, -32.396814,
      22.677079, 26.837592, 0, 40.570464, 21.352434, 0, 15.803452, 0, 239.72813, -153.31028,
      32.396814, 0, 22.677079, 0, 26.837592, -40.570464, 0, 21.352434, 15.803452, -239.72813, 0,
      153.31028, 0, 32.396814, 22.677079, -26.837592, 0, 40.570464;
  p.K_int.resize(4, 4);
  p.K_int << -6.4037014, 0, 4.9634531, -4.7312816, 0, -6.4037014, 4.9634531, 4.7312816, 6.4037014,
      0, 4.9634531, -4.7312816, 0, 6.4037014, 4.9634531, 4.7312816;
  return p;
}

VectorXd values(const GainMatch& match) {
  VectorXd w(std::ssize(match.weights));
  for (std::size_t i = 0; i < match.weights.size(); ++i)
    w(static_cast<Index>(i)) = match.weights[i].value;
  return w;
}

// ẋ = a x + b u with gain k: k b > a, and q/r = k (k - 2 a/b).
TEST(MatchGains, ScalarInClosedForm) {
  ContinuousLti plant;
  plant.A = MatrixXd::Constant(1, 1, 0.5);
  plant.B = MatrixXd::Constant(1, 1, 2);
  plant.states = {{"v", "m/s"}};
  plant.inputs = {{"f", "N"}};
  LqrDesign start = ones(1, 1, {});
  start.R(0, 0) = 0.3;
  const double k = 1.7;
  const GainMatch match = match_gains(plant, start, MatrixXd::Constant(1, 1, k), MatrixXd(1, 0));
  ASSERT_EQ(match.status, GainMatchStatus::matched) << match.culprit;
  EXPECT_NEAR(match.weights[0].value, 0.3 * k * (k - 2 * 0.5 / 2), 1e-9);
  EXPECT_NEAR(match.weights[1].value, 0.3, 1e-15);
  EXPECT_EQ(match.weights[0].name, "Q(v)");
  EXPECT_EQ(match.weights[1].name, "R(f)");
  EXPECT_LT(match.after, 1e-9);
  EXPECT_LE(match.weighted_sensitivity, 1 + 1e-9);
  EXPECT_LT(match.excess_cost, 1e-9);
  EXPECT_TRUE(match.unseen.empty());
}

// A gain between a/b and 2 a/b stabilizes but is not an LQR gain: |1 + L(0)| < 1 violates Kalman's
// inequality.
TEST(MatchGains, ReportsAStabilizingGainThatIsNotAnLqrGain) {
  ContinuousLti plant;
  plant.A = MatrixXd::Constant(1, 1, 0.5);
  plant.B = MatrixXd::Constant(1, 1, 2);
  plant.states = {{"v", "m/s"}};
  plant.inputs = {{"f", "N"}};
  const double k = 0.3;
  const GainMatch match =
      match_gains(plant, ones(1, 1, {}), MatrixXd::Constant(1, 1, k), MatrixXd(1, 0));
  EXPECT_EQ(match.status, GainMatchStatus::not_matched);
  // The closest LQR gain is that of Q = 0: 2 a/b = 0.5, the mirrored pole.
  EXPECT_NEAR(match.feedback.K(0, 0), 0.5, 1e-6);
  EXPECT_EQ(match.weights[0].verdict, WeightVerdict::at_zero);
  EXPECT_NEAR(match.after, 0.2 / 0.3, 1e-6);
  EXPECT_EQ(match.worst, "K(f, v)");
  // 1/|1 + L(0)| = 1/|1 - k b/a| = 5.
  EXPECT_NEAR(match.weighted_sensitivity, 5, 1e-3);
  EXPECT_GT(match.excess_cost, 0.1);
}

class MatchEveryMethod : public ::testing::TestWithParam<LqrMethod> {};
INSTANTIATE_TEST_SUITE_P(Method, MatchEveryMethod,
                         ::testing::Values(LqrMethod::continuous, LqrMethod::discrete,
                                           LqrMethod::sampled),
                         [](const auto& p) { return to_string(p.param); });

TEST_P(MatchEveryMethod, FindsTheWeightsOfRandomPlants) {
  std::mt19937_64 random(31);
  std::uniform_real_distribution<double> decade(-1.5, 1.5);
  for (int round = 0; round < 4; ++round) {
    ContinuousLti plant = testing::random_plant(5, 2, 5, false, random);
    for (Index i = 1; i <= 5; ++i) plant.states.push_back({"s" + std::to_string(i), ""});
    for (Index i = 1; i <= 2; ++i) plant.inputs.push_back({"u" + std::to_string(i), ""});
    LqrDesign start = ones(5, 2, {"s3"});
    start.method = GetParam();
    start.dt = 0.05;
    VectorXd w = VectorXd::NullaryExpr(8, [&] { return std::pow(10, decade(random)); });
    w /= std::sqrt(w(6) * w(7));  // the geometric mean of R is that of the start
    const MatrixXd K = DiagonalLqr(plant, start).solve(w).K;
    const GainMatch match = match_gains(plant, start, K.leftCols(5), K.rightCols(1));
    ASSERT_EQ(match.status, GainMatchStatus::matched) << round << match.culprit;
    EXPECT_LT(match.after, 1e-8) << round;
    EXPECT_THAT(values(match).cwiseQuotient(w).eval(), MatrixNear(VectorXd::Ones(8).eval(), 1e-5))
        << round;
    EXPECT_LE(match.weighted_sensitivity, 1 + 1e-6);
    for (const MatchedWeight& weight : match.weights) {
      EXPECT_LE(weight.low, weight.value);
      EXPECT_GE(weight.high, weight.value);
    }
  }
}

// The stationarity residual of the cost of a gain is linear in the weights: for an LQR gain one
// singular vector is the solution.
TEST_P(MatchEveryMethod, StationaryWeightsNeedNoSearch) {
  std::mt19937_64 random(41);
  std::uniform_real_distribution<double> decade(-1.5, 1.5);
  ContinuousLti plant = testing::random_plant(5, 2, 5, false, random);
  for (Index i = 1; i <= 5; ++i) plant.states.push_back({"s" + std::to_string(i), ""});
  LqrDesign start = ones(5, 2, {"s3"});
  start.method = GetParam();
  start.dt = 0.05;
  const DiagonalLqr problem(plant, start);
  const VectorXd w = VectorXd::NullaryExpr(8, [&] { return std::pow(10, decade(random)); });
  const MatrixXd K = problem.solve(w).K;
  const internal::GainTarget target{
      problem, K, K.cwiseAbs(), {{0}, {1}, {2}, {3}, {4}, {5}, {6}, {7}}, {}};
  const VectorXd found = internal::stationary_weights(target, VectorXd::Ones(8));
  EXPECT_THAT((found / found(7)).cwiseQuotient(w / w(7)).eval(),
              MatrixNear(VectorXd::Ones(8).eval(), 1e-7));
}

// The intervals are correct: at their ends, with the other weights compensating, the difference of
// the gain is the tolerance.
TEST(MatchGains, IntervalsEndWhereTheGainMovesByTheTolerance) {
  std::mt19937_64 random(37);
  ContinuousLti plant = testing::random_plant(4, 2, 4, false, random);
  for (Index i = 1; i <= 4; ++i) plant.states.push_back({"s" + std::to_string(i), ""});
  for (Index i = 1; i <= 2; ++i) plant.inputs.push_back({"u" + std::to_string(i), ""});
  const LqrDesign start = ones(4, 2, {});
  const MatrixXd K = DiagonalLqr(plant, start).solve(VectorXd::Ones(6)).K;
  GainMatchOptions options;
  options.tolerance = 1e-5;
  const GainMatch match = match_gains(plant, start, K, MatrixXd(2, 0), options);
  ASSERT_EQ(match.status, GainMatchStatus::matched);
  // Compared with the best fit over the logarithms of the others, by finite differences.
  const DiagonalLqr problem(plant, start);
  const MatrixXd size = K.cwiseAbs();
  MatrixXd scale(2, 4);
  for (Index i = 0; i < 2; ++i)
    for (Index j = 0; j < 4; ++j)
      scale(i, j) = std::min(size.row(i).maxCoeff(), size.col(j).maxCoeff());
  MatrixXd J(8, 6);
  for (Index i = 0; i < 6; ++i) {
    VectorXd up = VectorXd::Ones(6), down = up;
    up(i) = std::exp(1e-4);
    down(i) = std::exp(-1e-4);
    J.col(i) =
        ((problem.solve(up).K - problem.solve(down).K) / 2e-4).cwiseQuotient(scale).reshaped();
  }
  for (Index i = 0; i < 4; ++i) {
    // Others: the other states and the two inputs, whose logarithms add to 0.
    MatrixXd others(8, 4);
    Index k = 0;
    for (Index j = 0; j < 4; ++j)
      if (j != i) others.col(k++) = J.col(j);
    others.col(3) = J.col(4) - J.col(5);
    const VectorXd left = J.col(i) - others * others.colPivHouseholderQr().solve(J.col(i)).eval();
    const MatchedWeight& weight = match.weights[static_cast<std::size_t>(i)];
    EXPECT_NEAR(std::log(weight.high / weight.value) * left.norm(), 1e-5, 1e-9) << weight.name;
    EXPECT_NEAR(std::log(weight.value / weight.low) * left.norm(), 1e-5, 1e-9) << weight.name;
  }
}

TEST(MatchGains, RecoversTheUquadsWeightsFromItsExactGain) {
  const ContinuousLti plant = testing::uquad_hover();
  LqrDesign start = uquad_problem();
  start.R *= 0.01;
  const MatrixXd K = DiagonalLqr(plant, start).solve(uquad_weights()).K;
  const GainMatch match = match_gains(plant, start, K.leftCols(12), K.rightCols(4));
  ASSERT_EQ(match.status, GainMatchStatus::matched) << match.culprit;
  EXPECT_THAT(values(match).cwiseQuotient(uquad_weights()).eval(),
              MatrixNear(VectorXd::Ones(20).eval(), 1e-9));
  EXPECT_LT(match.after, 1e-12);
  EXPECT_GT(match.before, 0.5);
  EXPECT_EQ(match.starts, 1);
  EXPECT_LE(match.weighted_sensitivity, 1);
  EXPECT_TRUE(match.unseen.empty());
  for (const MatchedWeight& weight : match.weights)
    EXPECT_EQ(weight.verdict, WeightVerdict::seen) << weight.name;
}

// The published gain is an iterate of the Riccati recursion, which is the exact gain of other
// weights: only the weight of the yaw integral differs in more than the fourth digit.
TEST(MatchGains, FindsTheWeightsOfThePublishedUquadGains) {
  const ContinuousLti plant = testing::uquad_hover();
  LqrDesign start = uquad_problem();
  start.R *= 0.01;
  const Published p = published();
  const GainMatch match = match_gains(plant, start, p.K, p.K_int);
  ASSERT_EQ(match.status, GainMatchStatus::matched) << match.culprit;
  VectorXd ratio = values(match).cwiseQuotient(uquad_weights());
  EXPECT_NEAR(ratio(15), 0.9682, 1e-4);
  ratio(15) = 1;
  EXPECT_THAT(ratio, MatrixNear(VectorXd::Ones(20).eval(), 1e-4));
  EXPECT_LT(match.after, 1e-7);  // the files have eight digits
}

/// Two decoupled plants, like the axes of a wrench: a cart and a mass on a spring.
ContinuousLti two_plants() {
  ContinuousLti plant;
  plant.A = MatrixXd::Zero(4, 4);
  plant.A(0, 1) = plant.A(2, 3) = 1;
  plant.A(3, 2) = -2;
  plant.B = MatrixXd::Zero(4, 2);
  plant.B(1, 0) = 1;
  plant.B(3, 1) = 0.5;
  plant.states = {{"a", ""}, {"va", ""}, {"b", ""}, {"vb", ""}};
  plant.inputs = {{"fa", ""}, {"fb", ""}};
  return plant;
}

TEST(MatchGains, NamesTheUndeterminedFactorOfDecoupledPlants) {
  const ContinuousLti plant = two_plants();
  const LqrDesign start = ones(4, 2, {});
  VectorXd w(6);
  w << 3, 0.5, 20, 7, 2, 0.1;
  const MatrixXd K = DiagonalLqr(plant, start).solve(w).K;
  const GainMatch match = match_gains(plant, start, K, MatrixXd(2, 0));
  ASSERT_EQ(match.status, GainMatchStatus::matched);
  EXPECT_LT(match.after, 1e-9);
  EXPECT_THAT(match.unseen, ElementsAre("a factor common to Q(a) Q(va) R(fa), its inverse to Q(b) "
                                        "Q(vb) R(fb)"));
  // Within each part the ratios are determined.
  const VectorXd found = values(match);
  EXPECT_NEAR(found(0) / found(4), 1.5, 1e-7);
  EXPECT_NEAR(found(3) / found(5), 70, 1e-5);
  for (const MatchedWeight& weight : match.weights) {
    EXPECT_EQ(weight.verdict, WeightVerdict::combination) << weight.name;
    EXPECT_LT(weight.high / weight.low, 1.1) << weight.name;
  }
}

// A state that is not coupled to the states of the inputs: its weight does not affect the gain.
TEST(MatchGains, MarksAWeightThatTheGainDoesNotDetermine) {
  ContinuousLti plant = two_plants();
  plant.B(3, 1) = 0;
  plant.B(1, 1) = -0.3;
  plant.A(3, 3) = -0.2;
  const LqrDesign start = ones(4, 2, {});
  const MatrixXd K = DiagonalLqr(plant, start).solve(VectorXd::Constant(6, 2)).K;
  const GainMatch match = match_gains(plant, start, K, MatrixXd(2, 0));
  ASSERT_EQ(match.status, GainMatchStatus::matched);
  EXPECT_EQ(match.weights[2].verdict, WeightVerdict::not_seen);
  EXPECT_EQ(match.weights[3].verdict, WeightVerdict::not_seen);
  EXPECT_EQ(match.weights[2].value, 1);  // as in the start
  EXPECT_TRUE(std::isinf(match.weights[2].high));
  EXPECT_THAT(match.unseen,
              ::testing::UnorderedElementsAre("Q(b): the gain does not determine it",
                                              "Q(vb): the gain does not determine it"));
  EXPECT_EQ(match.weights[0].verdict, WeightVerdict::seen);
}

TEST(MatchGains, FindsAWeightOfZeroAndKeepsAGivenZero) {
  const ContinuousLti plant = two_plants();
  LqrDesign start = ones(4, 2, {});
  VectorXd w(6);
  w << 3, 0, 20, 7, 1, 1;
  const MatrixXd K = DiagonalLqr(plant, start).solve(w).K;
  const GainMatch limit = match_gains(plant, start, K, MatrixXd(2, 0));
  ASSERT_EQ(limit.status, GainMatchStatus::matched);
  EXPECT_EQ(limit.weights[1].value, 0);
  EXPECT_EQ(limit.weights[1].verdict, WeightVerdict::at_zero);
  EXPECT_GT(limit.weights[1].high, 0);
  EXPECT_LT(limit.weights[1].high, 0.1);
  EXPECT_LT(limit.after, 1e-9);
  start.Q(1, 1) = 0;
  const GainMatch kept = match_gains(plant, start, K, MatrixXd(2, 0));
  EXPECT_EQ(kept.weights[1].verdict, WeightVerdict::fixed);
  EXPECT_EQ(kept.weights[1].value, 0);
  EXPECT_LT(kept.after, 1e-9);
}

TEST(MatchGains, TiedWeightsAreEqual) {
  const ContinuousLti plant = testing::uquad_hover();
  const Published p = published();
  GainMatchOptions options;
  options.ties = {{"x", "y"}, {"vqx", "vqy"}, {"int_x", "int_y"}, {"w1", "w2", "w3", "w4"}};
  const GainMatch match = match_gains(plant, uquad_problem(), p.K, p.K_int, options);
  ASSERT_EQ(match.status, GainMatchStatus::matched);
  EXPECT_EQ(match.weights[0].value, match.weights[1].value);
  EXPECT_EQ(match.weights[12].value, match.weights[13].value);
  for (std::size_t i = 16; i < 20; ++i) EXPECT_NEAR(match.weights[i].value, 1, 1e-12);
  EXPECT_NEAR(match.weights[0].value, 100, 1e-2);
}

// A gain of the wrong sign makes the loop unstable.
TEST(MatchGains, RejectsAGainThatDoesNotStabilize) {
  const ContinuousLti plant = testing::uquad_hover();
  const Published p = published();
  const GainMatch match = match_gains(plant, uquad_problem(), -p.K, p.K_int);
  EXPECT_EQ(match.status, GainMatchStatus::not_stabilizing);
  EXPECT_FALSE(match.has_weights());
  EXPECT_THAT(match.culprit, HasSubstr("the loop of the given gain has a pole of modulus 1."));
}

// An integral that is not fed back keeps its value.
TEST(MatchGains, RejectsAGainAtTheStabilityLimit) {
  Published p = published();
  p.K_int.col(0).setZero();
  const GainMatch match = match_gains(testing::uquad_hover(), uquad_problem(), p.K, p.K_int);
  EXPECT_EQ(match.status, GainMatchStatus::not_stabilizing);
  EXPECT_THAT(match.culprit, HasSubstr("a pole of modulus 1, expected less than 1"));
}

TEST(MatchGains, TheSearchCanBeInterrupted) {
  const Published p = published();
  GainMatchOptions options;
  int asked = 0;
  options.interrupted = [&asked] { return ++asked > 3; };
  const GainMatch match =
      match_gains(testing::uquad_hover(), uquad_problem(), p.K, p.K_int, options);
  EXPECT_EQ(match.status, GainMatchStatus::interrupted);
  EXPECT_LE(asked, 10);
}

TEST(MatchGains, RejectsInvalidProblems) {
  const ContinuousLti plant = two_plants();
  const LqrDesign start = ones(4, 2, {});
  const MatrixXd K = MatrixXd::Ones(2, 4), none(2, 0);
  const auto refuses = [&](const LqrDesign& design, const MatrixXd& gain,
                           const GainMatchOptions& options, const std::string& message) {
    EXPECT_THAT([&] { (void)match_gains(plant, design, gain, none, options); },
                ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  refuses(start, MatrixXd::Ones(2, 3), {}, "match_gains: K is 2x3, expected 2x4");
  refuses(start, MatrixXd::Zero(2, 4), {}, "the gain is 0; expected a nonzero gain");
  refuses(start, K * std::nan(""), {}, "has nan at (1,1)");
  LqrDesign bad = start;
  bad.R(1, 1) = 0;
  refuses(bad, K, {}, "the weight of fb is 0, expected more than 0");
  bad = start;
  bad.Q(0, 0) = -1;
  refuses(bad, K, {}, "the weight of a is -1, expected 0 or more");
  bad = start;
  bad.Q(0, 1) = bad.Q(1, 0) = 0.1;
  refuses(bad, K, {}, "Q has entries off its diagonal");
  GainMatchOptions options;
  options.tolerance = 0;
  refuses(start, K, options, "the tolerance is 0, expected a positive number");
  options = {};
  options.ties = {{"a", "va"}, {"va", "b"}};
  refuses(start, K, options, "'va' is in more than one tie");
  options.ties = {{"a", "fa"}};
  refuses(start, K, options, "'a' and 'fa' are tied; expected only states or only inputs");
}

}  // namespace
}  // namespace quadtune
