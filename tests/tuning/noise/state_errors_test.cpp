// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/state_errors.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "plants/filter_models.hpp"
#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/internal/tails.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using ::testing::HasSubstr;

/// Errors of the states of a simulated height, with a noise that is assumed `times` as large.
ConsistencyCheck error_of_speed(double times) {
  std::mt19937_64 random(31);
  FilterModel model = testing::discrete_altitude();
  const Eigen::VectorXd theta = start_of(model);
  // The states are known: those that are measured, and a second sensor with the true state in a
  // record that the filter does not use.
  FilterModel seen = model;
  FilterSensor& speed = seen.sensors.emplace_back();
  speed.name = "truth";
  speed.outputs = {{"speed", "m/s"}};
  speed.C = Eigen::MatrixXd{{0, 1}};
  speed.R.fixed = Eigen::MatrixXd::Constant(1, 1, 1e-18);
  FilterRecord record = testing::simulated(seen, theta, 20000, seen.dt, random);
  record.truth = Eigen::MatrixXd::Constant(2, record.samples(), std::nan(""));
  record.truth.row(1) = record.y.row(1);
  record.y = record.y.topRows(1).eval();
  const Eigen::VectorXd taken = theta.array() + std::log(times);
  const std::vector<FilterRun> runs = {InnovationLikelihood(model, {record}).run(0, taken)};
  const auto checks = check_errors(model, {record}, runs);
  EXPECT_EQ(checks.size(), 1u);
  return checks[0];
}

TEST(ErrorsOfStates, AgreeWithTheirCovariances) {
  const ConsistencyCheck right = error_of_speed(1);
  EXPECT_EQ(right.output, "vz");
  EXPECT_EQ(right.verdict, CheckVerdict::pass);
  EXPECT_LT(right.low, right.value);
  EXPECT_GT(right.high, right.value);
  // Errors are correlated over the time constant of the filter, so the interval is wide.
  EXPECT_GT(right.high, 1.1);
  const ConsistencyCheck small = error_of_speed(0.2);
  EXPECT_EQ(small.verdict, CheckVerdict::fail);
  EXPECT_NEAR(small.value, 5 * right.value, 0.2 * small.value);
  EXPECT_THAT(small.reason, HasSubstr("vz: the mean squared error is"));
}

// A constant error over a whole record counts as one error, however many instants there are.
TEST(ErrorsOfStates, CountAsOneIfConstant) {
  const FilterModel model = testing::discrete_altitude();
  FilterRecord record;
  record.truth = MatrixXd::Zero(2, 5000);
  FilterRun run;
  run.x = MatrixXd::Constant(2, 5000, 2);
  run.x_variance = MatrixXd::Ones(2, 5000);
  for (const ConsistencyCheck& check : check_errors(model, {record}, {run})) {
    EXPECT_EQ(check.value, 4);
    // Two standard deviations are exceeded by chance in 4.6 % of all cases.
    EXPECT_NEAR(check.p, 0.0455, 0.01);
    EXPECT_EQ(check.verdict, CheckVerdict::pass);
  }
}

// For errors e[k+1] = ρ e[k] + noise the effective number is n (1 - ρ²)/(1 + ρ²).
TEST(ErrorsOfStates, CountAccordingToTheirAutocorrelation) {
  const FilterModel model = testing::discrete_altitude();
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (const double rho : {0.5, 0.99}) {
    const Index N = 400000;
    FilterRecord record;
    record.truth = MatrixXd::Zero(2, N);
    FilterRun run;
    run.x = MatrixXd::Zero(2, N);
    run.x_variance = MatrixXd::Ones(2, N);
    for (Index k = 1; k < N; ++k)
      for (Index i = 0; i < 2; ++i)
        run.x(i, k) = rho * run.x(i, k - 1) + std::sqrt(1 - rho * rho) * normal(random);
    const ConsistencyCheck check = check_errors(model, {record}, {run})[0];
    // For χ²/f with a large f the interval is 1 ± z √(2/f): f follows from its width.
    ConsistencyOptions options;
    const double z = internal::normal_exceeded(0.5 * options.significance);
    const double counted = 8 * z * z / std::pow(check.high - check.low, 2);
    const double expected = static_cast<double>(N) * (1 - rho * rho) / (1 + rho * rho);
    EXPECT_NEAR(counted / expected, 1, 0.1) << rho;
  }
}

/// Records and runs of this many states over N instants, all zero, with known true values.
struct MadeUp {
  std::vector<FilterRecord> records{1};
  std::vector<FilterRun> runs{1};

  MadeUp(Index states, Index N) {
    records[0].truth = MatrixXd::Zero(states, N);
    runs[0].x = MatrixXd::Zero(states, N);
  }
  operator TrueRuns() const { return {records, runs}; }
};

TEST(ComparedErrors, AreRootMeanSquares) {
  const FilterModel model = testing::discrete_altitude();
  MadeUp before(2, 4), after(2, 4);
  before.runs[0].x.row(0) << 3, -4, 3, -4;
  after.runs[0].x.row(0) << 1, -1, 1, -1;
  before.records[0].truth.row(1).setConstant(std::nan(""));
  after.records[0].truth.row(1).setConstant(std::nan(""));
  const auto accuracy = compare_errors(model, before, after);
  ASSERT_EQ(accuracy.size(), 1);
  EXPECT_EQ(accuracy[0].state, "z");
  EXPECT_EQ(accuracy[0].unit, "m");
  EXPECT_EQ(accuracy[0].samples, 4);
  EXPECT_NEAR(accuracy[0].before, std::sqrt(12.5), 1e-12);
  EXPECT_NEAR(accuracy[0].after, 1, 1e-12);
}

// Equal errors differ by chance only; twice as large ones differ significantly.
TEST(ComparedErrors, DistinguishChanceFromChange) {
  const FilterModel model = testing::discrete_altitude();
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const Index N = 2000;
  for (const double factor : {1.0, 2.0}) {
    MadeUp before(2, N), after(2, N);
    for (Index k = 0; k < N; ++k) {
      before.runs[0].x(1, k) = normal(random);
      after.runs[0].x(1, k) = factor * normal(random);
    }
    const double p = compare_errors(model, before, after)[1].p;
    if (factor > 1)
      EXPECT_LT(p, 1e-6);
    else
      EXPECT_GT(p, 0.001);
  }
}

// Rotations of 0.1 rad about one axis before, of 0.3 and 0.4 about two perpendicular axes after.
TEST(ComparedErrors, OfAnAttitudeAreItsAngle) {
  const FilterModel model = load_filter_model("inertial");
  MadeUp before(15, 3), after(15, 3);
  before.runs[0].x.row(2).setConstant(0.1);
  after.runs[0].x.row(0).setConstant(0.03);
  after.records[0].truth.row(1).setConstant(0.04);
  const auto accuracy = compare_errors(model, before, after);
  ASSERT_EQ(accuracy.size(), 16);
  EXPECT_EQ(accuracy[0].state, "attitude");
  EXPECT_EQ(accuracy[0].unit, "rad");
  EXPECT_NEAR(accuracy[0].before, 0.1, 1e-12);
  EXPECT_NEAR(accuracy[0].after, 0.05, 1e-5);
  EXPECT_EQ(accuracy[1].state, "turn_x");
  EXPECT_NEAR(accuracy[1].after, 0.03, 1e-12);
}

}  // namespace
}  // namespace quadtune
