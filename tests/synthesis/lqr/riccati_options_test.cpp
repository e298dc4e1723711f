// SPDX-License-Identifier: Apache-2.0
/// The options of the Riccati solvers reach every design that is built on them.
#include <fmt/format.h>

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <limits>

#include "matrix_near.hpp"
#include "plants/hover_model.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/synthesis/actuator_lqi.hpp"
#include "quadtune/synthesis/kalman.hpp"
#include "quadtune/synthesis/lqg_regulator.hpp"
#include "quadtune/synthesis/lqr.hpp"
#include "quadtune/synthesis/state_feedback.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using ::testing::HasSubstr;
using testing::MatrixNear;
using testing::MatrixRelativelyNear;
using ::testing::ThrowsMessage;

/// What the options can change in a solution.
struct Outcome {
  RiccatiStatus status;
  MatrixXd gain;
  int iterations;
  Eigen::Index poles;
  std::string culprit;
};
Outcome outcome(const RiccatiResult& r) {
  return {r.status, r.K, r.iterations, r.poles.size(), r.culprit};
}
Outcome outcome(const KalmanResult& r) {
  return {r.status, r.L, r.iterations, r.poles.size(), r.culprit};
}

/// A design with given options, and the name with which it rejects them.
struct OptionsCase {
  std::string name;
  std::string where;
  Eigen::Index states;
  std::function<Outcome(const RiccatiOptions&)> solve;
  std::function<Outcome()> by_default;
};

const double kPeriod = 0.01;  // [s]

LqrDesign integral_design(LqrMethod method) {
  LqrDesign design;
  design.method = method;
  design.dt = kPeriod;
  design.Q = MatrixXd::Identity(12, 12);
  design.R = MatrixXd::Identity(4, 4);
  design.integrals = {"z"};
  design.Q_integral = MatrixXd::Identity(1, 1);
  return design;
}

ActuatorLqi actuator_design(const ActuatorLqiOptions& options) {
  static const Vehicle vehicle = load_vehicle("crazyflie");
  return actuator_lqi(vehicle, {MatrixXd::Identity(12, 12), MatrixXd::Identity(4, 4), {}, {}},
                      options);
}

std::vector<OptionsCase> every_design() {
  ContinuousLti plant = testing::uquad_hover();
  plant.C = MatrixXd::Identity(12, 12);
  plant.D.resize(0, 0);
  const DiscreteLti sampled = discretize_zoh(plant, kPeriod);
  const LqrWeights weights = {MatrixXd::Identity(12, 12), MatrixXd::Identity(4, 4), {}};
  const KalmanNoise noise = {{}, MatrixXd::Identity(12, 12), MatrixXd::Identity(12, 12), {}};
  std::vector<OptionsCase> cases = {
      {"continuous lqr", "lqr", 12,
       [=](const RiccatiOptions& o) { return outcome(lqr(plant, weights, o)); },
       [=] { return outcome(lqr(plant, weights)); }},
      {"discrete lqr", "lqr", 12,
       [=](const RiccatiOptions& o) { return outcome(lqr(sampled, weights, o)); },
       [=] { return outcome(lqr(sampled, weights)); }},
      {"continuous kalman", "kalman", 12,
       [=](const RiccatiOptions& o) { return outcome(kalman(plant, noise, o)); },
       [=] { return outcome(kalman(plant, noise)); }},
      {"discrete kalman", "kalman", 12,
       [=](const RiccatiOptions& o) { return outcome(kalman(sampled, noise, o)); },
       [=] { return outcome(kalman(sampled, noise)); }},
      {"kalman_sampled", "kalman", 12,
       [=](const RiccatiOptions& o) { return outcome(kalman_sampled(plant, noise, kPeriod, o)); },
       [=] { return outcome(kalman_sampled(plant, noise, kPeriod)); }},
      {"regulator of lqg, continuous", "lqr", 12,
       [=](const RiccatiOptions& o) {
         return outcome(lqg_regulator(plant, weights, noise, o).lqr);
       },
       [=] { return outcome(lqg_regulator(plant, weights, noise).lqr); }},
      {"filter of lqg, discrete", "lqr", 12,
       [=](const RiccatiOptions& o) {
         return outcome(lqg_regulator(sampled, weights, noise, LqgEstimate::delayed, o).filter);
       },
       [=] {
         return outcome(lqg_regulator(sampled, weights, noise, LqgEstimate::delayed).filter);
       }},
  };
  for (const LqrMethod method : {LqrMethod::continuous, LqrMethod::discrete, LqrMethod::sampled}) {
    const LqrDesign design = integral_design(method);
    cases.push_back(
        {"state_feedback", "lqr", 13,
         [=](const RiccatiOptions& o) { return outcome(state_feedback(plant, design, o).riccati); },
         [=] { return outcome(state_feedback(plant, design).riccati); }});
  }
  return cases;
}

void expect_equal(const Outcome& a, const Outcome& b) {
  EXPECT_EQ(a.status, b.status);
  EXPECT_THAT(a.gain, MatrixNear(b.gain, 0));
  EXPECT_EQ(a.iterations, b.iterations);
  EXPECT_EQ(a.poles, b.poles);
}

TEST(RiccatiOptionsReach, DefaultsGiveTheSameBits) {
  for (const OptionsCase& design : every_design()) {
    SCOPED_TRACE(design.name);
    const Outcome expected = design.by_default();
    EXPECT_EQ(expected.status, RiccatiStatus::solved);
    EXPECT_GT(expected.iterations, 1);
    EXPECT_EQ(expected.poles, design.states);
    expect_equal(design.solve({}), expected);
  }
  const DiscreteLti plant = discretize_zoh(testing::uquad_hover(), kPeriod);
  const MatrixXd I = MatrixXd::Identity(12, 12), R = MatrixXd::Identity(4, 4);
  EXPECT_THAT(lqr(plant, {I, R, {}}).K, MatrixNear(dare(plant.A, plant.B, I, R).K, 0));
  DiscreteLti measured = plant;
  measured.C = I;
  EXPECT_THAT(kalman(measured, {{}, I, I, {}}).L,
              MatrixNear(dare(plant.A.transpose(), I, I, I).K.transpose(), 0));
  // Its own default omits the poles.
  const ActuatorLqi lqi = actuator_design({});
  ASSERT_TRUE(lqi.solved());
  EXPECT_EQ(lqi.riccati.poles.size(), 0);
}

// One doubling step does not suffice: the Schur method then solves the equation, which iterations
// of 0 show.
TEST(RiccatiOptionsReach, LimitOfIterations) {
  for (const OptionsCase& design : every_design()) {
    SCOPED_TRACE(design.name);
    const Outcome limited = design.solve({.max_iterations = 1});
    EXPECT_EQ(limited.status, RiccatiStatus::solved);
    EXPECT_EQ(limited.iterations, 0);
    EXPECT_THAT(limited.gain, MatrixRelativelyNear(design.by_default().gain, 1e-9));
  }
  ActuatorLqiOptions options;
  options.riccati.max_iterations = 1;
  EXPECT_TRUE(actuator_design(options).riccati.used_schur);
}

TEST(RiccatiOptionsReach, EssentialEvidence) {
  for (const OptionsCase& design : every_design()) {
    SCOPED_TRACE(design.name);
    EXPECT_EQ(design.solve({.evidence = RiccatiEvidence::essential}).poles, 0);
  }
  ActuatorLqiOptions options;
  options.riccati.evidence = RiccatiEvidence::full;
  EXPECT_GT(actuator_design(options).riccati.poles.size(), 0);
}

TEST(RiccatiOptionsReach, RejectsOptionsOutOfRange) {
  const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
  const auto expect_rejected = [](const OptionsCase& design, const RiccatiOptions& options,
                                  const std::string& message) {
    EXPECT_THAT([&] { (void)design.solve(options); },
                ThrowsMessage<InvalidInput>(design.where + ": " + message));
  };
  for (const OptionsCase& design : every_design()) {
    SCOPED_TRACE(design.name);
    for (const auto& [value, text] : std::vector<std::pair<double, std::string>>{
             {nan, "nan"}, {infinite, "inf"}, {-1e-12, "-1e-12"}, {0, "0"}, {1, "1"}})
      expect_rejected(design, {.relative_tolerance = value},
                      "relative_tolerance is " + text + ", expected a number in (0, 1)");
    for (const int value : {0, -1})
      expect_rejected(design, {.max_iterations = value},
                      "max_iterations is " + std::to_string(value) + ", expected >= 1");
    expect_rejected(
        design, {.state_names = {"x", "y"}},
        fmt::format("state_names has 2 names, expected {0} (A is {0}x{0})", design.states));
  }
  ActuatorLqiOptions options;
  options.riccati.relative_tolerance = nan;
  EXPECT_THAT([&] { (void)actuator_design(options); },
              ThrowsMessage<InvalidInput>(HasSubstr("relative_tolerance is nan")));
}

// Poles near 400 that one input must move into the unit circle. In double precision the residual
// exceeds the default tolerance, which requires 50 digits.
TEST(RiccatiOptionsReach, Tolerance) {
  DiscreteLti plant;
  plant.A = 100 * Eigen::Matrix3d{{-2, -2, 0}, {-1, -3, -3}, {-3, 2, -1}};
  plant.B = Eigen::Vector3d(0, 1, -1);
  plant.dt = 1;
  const MatrixXd one = MatrixXd::Identity(1, 1);
  const LqrWeights weights = {Eigen::Vector3d(0, 1, 0).asDiagonal(), one, {}};
  const RiccatiOptions loose = {.relative_tolerance = 0.5, .evidence = RiccatiEvidence::essential};
  const RiccatiResult accurate = lqr(plant, weights), accepted = lqr(plant, weights, loose);
  ASSERT_TRUE(accurate.solved() && accepted.solved());
  EXPECT_TRUE(accurate.used_extended);
  EXPECT_LE(accurate.residual, 1e-12);
  EXPECT_FALSE(accepted.used_extended);
  EXPECT_GT(accepted.residual, 1e-12);
  EXPECT_LE(accepted.residual, 0.5);

  DiscreteLti dual;
  dual.A = plant.A.transpose();
  dual.C = plant.B.transpose();
  dual.dt = 1;
  const KalmanNoise noise = {{}, weights.Q, one, {}};
  EXPECT_LE(kalman(dual, noise).residual, 1e-12);
  EXPECT_GT(kalman(dual, noise, loose).residual, 1e-12);
}

// y' = 0 and an unstable drift that no input reaches.
TEST(RiccatiOptionsReach, NamesOfTheCulprit) {
  ContinuousLti plant;
  plant.A = Eigen::Matrix2d{{0, 0}, {0, 1}};
  plant.B = Eigen::Vector2d(1, 0);
  plant.C = Eigen::RowVector2d(1, 0);
  plant.states = {{"y", "m"}, {"drift", "m"}};
  const MatrixXd I = Eigen::Matrix2d::Identity(), one = MatrixXd::Identity(1, 1);
  const LqrWeights weights = {I, one, {}};
  const KalmanNoise noise = {{}, I, one, {}};
  EXPECT_EQ(lqr(plant, weights).culprit, "mode at 1: drift cannot be controlled");
  // The problem of the options is not that of the caller.
  RiccatiOptions options = {.problem = RiccatiProblem::filter, .state_names = {"a", "b"}};
  EXPECT_EQ(lqr(plant, weights, options).culprit, "mode at 1: b cannot be controlled");
  EXPECT_EQ(lqr(plant, weights, options).status, RiccatiStatus::not_stabilizable);
  options.problem = RiccatiProblem::regulator;
  EXPECT_EQ(kalman(plant, noise, options).culprit,
            "mode at 1: b cannot be observed by the measurements");
  EXPECT_EQ(kalman(plant, noise, {.max_iterations = 1}).culprit,
            "mode at 1: drift cannot be observed by the measurements");
}

TEST(RiccatiOptionsReach, RejectsAnIndefiniteQIfAsked) {
  const ContinuousLti plant = testing::uquad_hover();
  LqrWeights weights = {MatrixXd::Identity(12, 12), MatrixXd::Identity(4, 4), {}};
  weights.Q(11, 11) = -1e-3;
  EXPECT_TRUE(lqr(plant, weights).solved());
  EXPECT_THAT([&] { (void)lqr(plant, weights, {.reject_indefinite_Q = true}); },
              ThrowsMessage<InvalidInput>(HasSubstr("lqr: Q has eigenvalue -0.001")));
}

}  // namespace
}  // namespace quadtune
