// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/innovation_likelihood.hpp"

#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "log_files/nile.hpp"
#include "matrix_near.hpp"
#include "plants/filter_models.hpp"
#include "quadtune/errors.hpp"
#include "uniform_matrix.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::StrEq;
using ::testing::ThrowsMessage;

VectorXd logs(double a, double b) { return Eigen::Vector2d(std::log(a), std::log(b)); }

TEST(InnovationLikelihood, MatchesTheTextbookForTheNile) {
  const InnovationLikelihood likelihood(testing::local_level(), {testing::nile()});
  const Likelihood at =
      likelihood.evaluate(logs(1469.1767190775608, 15098.518459155015), LikelihoodOrder::gradient);
  ASSERT_TRUE(at.computed());
  EXPECT_NEAR(at.value, -632.5456251030405, 1e-9);
  EXPECT_NEAR(at.gradient.norm(), 0, 1e-5);  // it is the maximum
  EXPECT_EQ(at.innovations, 99);
  EXPECT_EQ(at.diffuse, 1);
}

/// log N(y; mean, covariance) of all measurements at once, as a dense Gaussian.
double dense_likelihood(const FilterModel& model, const VectorXd& theta,
                        const FilterRecord& record) {
  const Index nx = model.A.rows(), ny = model.outputs(), N = record.samples();
  MatrixXd C(ny, nx), D = MatrixXd::Zero(ny, model.B.cols()), R = MatrixXd::Zero(ny, ny);
  Index first = 0;
  for (const FilterSensor& s : model.sensors) {
    const Index m = s.C.rows();
    C.middleRows(first, m) = s.C;
    if (s.D.size() > 0) D.middleRows(first, m) = s.D;
    R.block(first, first, m, m) = covariance(s.R, theta);
    first += m;
  }
  const MatrixXd noise = model.G * covariance(model.Q, theta) * model.G.transpose();
  // States are linear in x0 and the steps' noises: mean and covariance of each pair.
  VectorXd mean(nx * N);
  MatrixXd P = MatrixXd::Zero(nx * N, nx * N);
  mean.head(nx) = model.x0;
  P.topLeftCorner(nx, nx) = model.P0;
  for (Index k = 0; k + 1 < N; ++k) {
    MatrixXd F = MatrixXd::Identity(nx, nx), B = MatrixXd::Zero(nx, model.B.cols()),
             Q = MatrixXd::Zero(nx, nx);
    const double dt =
        record.time[static_cast<std::size_t>(k) + 1] - record.time[static_cast<std::size_t>(k)];
    if (model.dt > 0) {
      for (int i = 0; i < std::lround(dt / model.dt); ++i) {
        Q = (model.A * Q * model.A.transpose() + noise).eval();
        B = (model.A * B + model.B).eval();
        F = (model.A * F).eval();
      }
    } else {
      // Many small steps of the midpoint, each exact to third order, extrapolated.
      const auto integrate = [&](int steps) {
        const double h = dt / steps;
        MatrixXd f = MatrixXd::Identity(nx, nx), b = MatrixXd::Zero(nx, model.B.cols()),
                 q = MatrixXd::Zero(nx, nx);
        const auto slope = [&](const MatrixXd& S) {
          return (model.A * S + S * model.A.transpose() + noise).eval();
        };
        for (int i = 0; i < steps; ++i) {
          const MatrixXd k1 = slope(q), k2 = slope(q + h / 2 * k1), k3 = slope(q + h / 2 * k2),
                         k4 = slope(q + h * k3);
          q += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
          const auto flow = [&](const MatrixXd& X) { return (model.A * X).eval(); };
          const MatrixXd f1 = flow(f), f2 = flow(f + h / 2 * f1), f3 = flow(f + h / 2 * f2),
                         f4 = flow(f + h * f3);
          f += h / 6 * (f1 + 2 * f2 + 2 * f3 + f4);
          const auto drive = [&](const MatrixXd& X) { return (model.A * X + model.B).eval(); };
          const MatrixXd b1 = drive(b), b2 = drive(b + h / 2 * b1), b3 = drive(b + h / 2 * b2),
                         b4 = drive(b + h * b3);
          b += h / 6 * (b1 + 2 * b2 + 2 * b3 + b4);
        }
        return std::tuple(f, b, q);
      };
      std::tie(F, B, Q) = integrate(100);
    }
    mean.segment(nx * (k + 1), nx) = F * mean.segment(nx * k, nx) + B * record.u.col(k);
    for (Index j = 0; j <= k; ++j) {
      P.block(nx * (k + 1), nx * j, nx, nx) = F * P.block(nx * k, nx * j, nx, nx);
      P.block(nx * j, nx * (k + 1), nx, nx) = P.block(nx * (k + 1), nx * j, nx, nx).transpose();
    }
    P.block(nx * (k + 1), nx * (k + 1), nx, nx) =
        F * P.block(nx * k, nx * k, nx, nx) * F.transpose() + Q;
  }
  std::vector<std::pair<Index, Index>> measured;
  for (Index k = 0; k < N; ++k)
    for (Index i = 0; i < ny; ++i)
      if (!std::isnan(record.y(i, k))) measured.push_back({k, i});
  const auto m = static_cast<Index>(measured.size());
  VectorXd e(m);
  MatrixXd S(m, m);
  for (Index a = 0; a < m; ++a) {
    const auto [k, i] = measured[static_cast<std::size_t>(a)];
    e(a) = record.y(i, k) - C.row(i).dot(mean.segment(nx * k, nx)) -
           (D.cols() > 0 ? D.row(i).dot(record.u.col(k)) : 0);
    for (Index b = 0; b < m; ++b) {
      const auto [l, j] = measured[static_cast<std::size_t>(b)];
      S(a, b) = C.row(i) * P.block(nx * k, nx * l, nx, nx) * C.row(j).transpose();
      if (k == l) S(a, b) += R(i, j);
    }
  }
  const Eigen::LLT<MatrixXd> llt(S);
  const MatrixXd L = llt.matrixL();
  return -0.5 * (static_cast<double>(m) * std::log(2 * std::numbers::pi) +
                 2 * L.diagonal().array().log().sum() + e.dot(llt.solve(e)));
}

TEST(InnovationLikelihood, MatchesTheJointDensityOfAllMeasurements) {
  std::mt19937_64 random(11);
  for (int nx = 1; nx <= 6; ++nx)
    for (const bool continuous : {false, true})
      for (const bool full : {false, true}) {
        const FilterModel model = testing::random_model(random, nx, nx % 3, continuous, full);
        const VectorXd theta = start_of(model);
        std::vector<FilterRecord> records;
        double expected = 0;
        for (int r = 0; r < 2; ++r) {
          records.push_back(testing::simulated(model, theta, 20 + r, 0.1, random, 0.3 * r,
                                               continuous ? 0.3 * r : 0));
          expected += dense_likelihood(model, theta, records.back());
        }
        if (!continuous) {  // a sample that is missing altogether
          records[1].time.erase(records[1].time.begin() + 5);
          MatrixXd y(3, 20), u(records[1].u.rows(), 20);
          y << records[1].y.leftCols(5), records[1].y.rightCols(15);
          u << records[1].u.leftCols(5), records[1].u.rightCols(15);
          records[1].y = y;
          records[1].u = u;
          expected = dense_likelihood(model, theta, records[0]) +
                     dense_likelihood(model, theta, records[1]);
        }
        const Likelihood got = InnovationLikelihood(model, records).evaluate(theta);
        ASSERT_TRUE(got.computed()) << got.culprit;
        EXPECT_NEAR(got.value, expected, 1e-8 * std::abs(expected))
            << nx << (continuous ? " continuous" : " discrete") << (full ? " full" : "");
      }
}

// The variance of a state with no memory underflows to 0, an infinite relative change. This does
// not affect the level, which converges slowly.
TEST(InnovationLikelihood, AnUnderflowingVarianceIsNotConvergence) {
  FilterModel model = testing::local_level();
  model.states = {{"level", ""}, {"fast", ""}};
  model.A = Eigen::Vector2d(1, 1e-6).asDiagonal();
  model.B.resize(2, 0);
  model.G = Eigen::Vector2d(1, 0);
  model.sensors[0].C = MatrixXd{{1, 1}};
  model.x0 = VectorXd::Zero(2);
  model.P0 = MatrixXd::Identity(2, 2);
  model.diffuse = {false, false};
  std::mt19937_64 random(5);
  const VectorXd theta = logs(1e-6, 1);
  const FilterRecord record = testing::simulated(model, theta, 400, 1, random);
  const double expected = dense_likelihood(model, theta, record);
  const Likelihood got = InnovationLikelihood(model, {record}).evaluate(theta);
  ASSERT_TRUE(got.computed()) << got.culprit;
  EXPECT_NEAR(got.value, expected, 1e-9 * std::abs(expected));
}

// The level at the second measurement differs by n steps of Q, and both measurements by R: a gap of
// years takes no longer than one of seconds.
TEST(InnovationLikelihood, StepsOverAGapOfADiscreteModel) {
  for (const double n : {1.0, 2.0, 3.0, 10.0, 1e3, 1e6 + 1, 1e9, 1e14}) {
    const FilterRecord record{"gap", {0, n}, MatrixXd{{1, 4}}, MatrixXd(0, 2)};
    const double Q = 0.3, R = 2, S = 2 * R + n * Q;
    const Likelihood got =
        InnovationLikelihood(testing::local_level(), {record}).evaluate(logs(Q, R));
    ASSERT_TRUE(got.computed()) << got.culprit;
    EXPECT_NEAR(got.value, -0.5 * (std::log(2 * std::numbers::pi * S) + 9 / S), 1e-12 * n) << n;
  }
}

// x = 0.5 x + 3 u with u = 2 goes to 12, and the variance of its noise to Q/(1 - 0.25).
TEST(InnovationLikelihood, HoldsTheInputOverAGapOfADiscreteModel) {
  FilterModel model = testing::local_level();
  model.A(0, 0) = 0.5;
  model.B = MatrixXd{{3}};
  model.inputs = {{"u", ""}};
  for (const double n : {1.0, 2.0, 3.0, 7.0, 40.0, 1e12}) {
    const FilterRecord record{"gap", {0, n}, MatrixXd{{1, 4}}, MatrixXd{{2, 2}}};
    const double Q = 0.3, R = 2, fade = std::pow(0.5, n);
    const double S = fade * fade * R + Q * (1 - fade * fade) / 0.75 + R;
    const double e = 4 - (fade * 1 + 12 * (1 - fade));
    const Likelihood got = InnovationLikelihood(model, {record}).evaluate(logs(Q, R));
    ASSERT_TRUE(got.computed()) << got.culprit;
    EXPECT_NEAR(got.value, -0.5 * (std::log(2 * std::numbers::pi * S) + e * e / S), 1e-12) << n;
  }
}

// Why the initial state is not a parameter like the variances: if the level starts at the first
// volume of the Nile, the likelihood increases without bound as the measurement noise decreases.
TEST(InnovationLikelihood, HasNoMaximumOverTheStateAtTheStart) {
  FilterRecord record = testing::nile();
  const VectorXd first = record.y.col(0);
  record.start = {first, MatrixXd::Zero(1, 1)};
  const InnovationLikelihood likelihood(testing::local_level(), {record});
  const auto at = [&](double R) { return likelihood.evaluate(logs(30000, R)).value; };
  EXPECT_NEAR(at(1e-40) - at(1e-20), 10 * std::log(10.0), 1e-9);
  EXPECT_GT(at(1e-80), likelihood.evaluate(logs(1469.18, 15098.52)).value);
}

// Durbin and Koopman 2012, section 5.2: the limit of a large initial variance, minus its
// contribution.
TEST(InnovationLikelihood, OfDiffuseStatesIsALimit) {
  std::mt19937_64 random(12);
  for (int nx = 1; nx <= 5; ++nx)
    for (const bool full : {false, true}) {
      FilterModel model = testing::random_model(random, nx, 1, false, full);
      model.P0.setZero();
      const VectorXd theta = start_of(model);
      const FilterRecord record = testing::simulated(model, theta, 30, 0.1, random);
      FilterModel diffuse = model;
      diffuse.diffuse.assign(static_cast<std::size_t>(nx), true);
      const Likelihood got = InnovationLikelihood(diffuse, {record}).evaluate(theta);
      ASSERT_TRUE(got.computed()) << got.culprit;
      EXPECT_EQ(got.diffuse, nx);
      EXPECT_EQ(got.innovations, 90 - nx);
      const auto vague = [&](double variance) {
        model.P0 = variance * MatrixXd::Identity(nx, nx);
        return InnovationLikelihood(model, {record}).evaluate(theta).value +
               0.5 * nx * std::log(2 * std::numbers::pi * variance);
      };
      // The error is of first order in 1/variance: extrapolate.
      const double limit = (10 * vague(1e7) - vague(1e6)) / 9;
      EXPECT_NEAR(got.value, limit, 2e-7 * std::abs(limit)) << nx;
    }
}

TEST(InnovationLikelihood, GradientMatchesFiniteDifferences) {
  std::mt19937_64 random(13), aside(15);
  for (int nx = 1; nx <= 6; ++nx)
    for (const bool full : {false, true})
      for (const bool diffuse : {false, true}) {
        FilterModel model = testing::random_model(random, nx, 1, nx % 2 == 0, full);
        if (diffuse) {
          model.P0.setZero();
          model.diffuse.assign(static_cast<std::size_t>(nx), true);
        }
        const VectorXd truth = start_of(model);
        const InnovationLikelihood likelihood(
            model, {testing::simulated(model, truth, 60, 0.1, random, 0.2),
                    testing::simulated(model, truth, 60, 0.1, random)});
        const VectorXd theta = truth + 0.3 * testing::uniform_vector(truth.size(), aside);
        const Likelihood at = likelihood.evaluate(theta, LikelihoodOrder::information);
        ASSERT_TRUE(at.computed()) << at.culprit;
        EXPECT_NEAR(at.value, likelihood.evaluate(theta).value, 1e-11 * std::abs(at.value));
        VectorXd numeric(theta.size());
        for (Index i = 0; i < theta.size(); ++i) {
          const auto moved = [&](double by) {
            VectorXd there = theta;
            there(i) += by;
            return likelihood.evaluate(there).value;
          };
          constexpr double h = 1e-3;  // of fourth order
          numeric(i) = (8 * (moved(h) - moved(-h)) - (moved(2 * h) - moved(-2 * h))) / (12 * h);
        }
        EXPECT_THAT(at.gradient, MatrixNear(numeric, 1e-7 * (1 + numeric.norm()))) << nx;
        EXPECT_GT(at.information.diagonal().minCoeff(), 0);
      }
}

// The expectation of the outer product of scores is the Fisher information, that is, the
// expectation of the sum.
TEST(InnovationLikelihood, InformationIsTheVarianceOfTheScore) {
  std::mt19937_64 random(14);
  const FilterModel model = testing::random_model(random, 2, 0, false, false);
  const VectorXd theta = start_of(model);
  const Index p = theta.size();
  MatrixXd scores = MatrixXd::Zero(p, p), information = MatrixXd::Zero(p, p);
  constexpr int runs = 2000;
  for (int run = 0; run < runs; ++run) {
    const InnovationLikelihood likelihood(model,
                                          {testing::simulated(model, theta, 50, 0.1, random)});
    // Five parameters do not fit into one vector of four; the result is the same.
    const Likelihood at = likelihood.evaluate(theta, LikelihoodOrder::information);
    scores += at.gradient * at.gradient.transpose() / runs;
    information += at.information / runs;
  }
  for (Index i = 0; i < p; ++i)
    for (Index j = 0; j < p; ++j)
      EXPECT_NEAR(scores(i, j), information(i, j),
                  4 * std::sqrt(3.0 / runs * information(i, i) * information(j, j)))
          << i << " " << j;
}

TEST(InnovationLikelihood, HoldsConvergedGains) {
  std::mt19937_64 random(15);
  for (int nx = 1; nx <= 6; ++nx)
    for (const bool full : {false, true}) {
      const FilterModel model = testing::random_model(random, nx, 2, false, full);
      const VectorXd theta = start_of(model);
      // Whole stretches, and gaps in between.
      FilterRecord record = testing::simulated(model, theta, 3000, 0.1, random);
      for (int k = 1000; k < 1010; ++k) record.y.col(k).tail(2).setConstant(std::nan(""));
      for (std::size_t k = 2000; k < 3000; ++k) record.time[k] += 0.3;
      InnovationLikelihood likelihood(model, {record});
      const Likelihood held = likelihood.evaluate(theta, LikelihoodOrder::information);
      likelihood.hold_steady_gains(false);
      const Likelihood whole = likelihood.evaluate(theta, LikelihoodOrder::information);
      ASSERT_TRUE(held.computed() && whole.computed());
      EXPECT_NEAR(held.value, whole.value, 1e-12 * std::abs(whole.value));
      EXPECT_EQ(held.innovations, whole.innovations);
      EXPECT_THAT(held.gradient, MatrixNear(whole.gradient, 1e-8 * whole.information.norm()));
      EXPECT_THAT(held.information,
                  MatrixNear(whole.information, 1e-10 * whole.information.norm()));
    }
}

TEST(InnovationLikelihood, ItsRunIsWhiteAndSumsToTheLikelihood) {
  std::mt19937_64 random(16);
  FilterModel model = testing::random_model(random, 3, 1, true, true);
  model.diffuse = {false, true, false};
  model.P0.row(1).setZero();
  model.P0.col(1).setZero();
  const VectorXd theta = start_of(model);
  const FilterRecord record = testing::simulated(model, theta, 5000, 0.1, random, 0.1);
  const InnovationLikelihood likelihood(model, {record});
  const FilterRun run = likelihood.run(0, theta);
  ASSERT_EQ(run.status, LikelihoodStatus::computed);
  double twice = 0, squares = 0;
  Index count = 0;
  for (Index k = 0; k < record.samples(); ++k)
    for (Index i = 0; i < 3; ++i) {
      if (std::isnan(run.innovation(i, k))) continue;
      const double S = run.variance(i, k), e = run.innovation(i, k);
      twice += std::log(2 * std::numbers::pi * S) + e * e / S;
      squares += e * e / S;
      ++count;
    }
  const Likelihood at = likelihood.evaluate(theta);
  EXPECT_EQ(count, at.innovations);
  EXPECT_EQ(at.diffuse, 1);
  EXPECT_NEAR(squares / static_cast<double>(count), 1,
              4 * std::sqrt(2.0 / static_cast<double>(count)));
  EXPECT_TRUE(run.x.rightCols(4000).allFinite());
  EXPECT_GT(run.x_variance.rightCols(4000).minCoeff(), 0);
}

TEST(InnovationLikelihood, NamesErrorsOfAModelOrALog) {
  const FilterModel model = testing::local_level();
  const auto refused = [&](auto change, const std::string& message) {
    FilterModel m = model;
    FilterRecord r = testing::nile();
    change(m, r);
    EXPECT_THAT([&] { InnovationLikelihood(m, {r}); }, ThrowsMessage<InvalidInput>(StrEq(message)));
  };
  refused([](FilterModel& m, FilterRecord&) { m.A(0, 0) = std::nan(""); },
          "filter model: A has nan at (1,1), expected finite numbers");
  refused([](FilterModel& m, FilterRecord&) { m.parameters[0].start = -1; },
          "filter model: the start of 'Q.level' is -1, expected a positive number");
  refused(
      [](FilterModel& m, FilterRecord&) {
        m.parameters.push_back({"Q.other", ""});
      },
      "filter model: parameter 'Q.other' is not used, expected a covariance that depends on it");
  refused([](FilterModel& m, FilterRecord&) { m.sensors[0].C.setZero(); },
          "filter model: C of sensor 'y' has only zeros in row 1, expected a measurement that "
          "depends on a state");
  refused([](FilterModel& m, FilterRecord&) { m.sensors[0].R.scaled.clear(); },
          "filter model: R of sensor 'y' is not positive definite at the initial values of its "
          "parameters, expected every "
          "measurement to have some noise");
  refused(
      [](FilterModel& m, FilterRecord&) { m.P0(0, 0) = 1; },
      "filter model: state 'level' is diffuse and has an initial covariance, expected one or the "
      "other");
  refused([](FilterModel&, FilterRecord& r) { r.time[3] = r.time[2]; },
          "nile: the time changes from 1873 s to 1873 s at sample 4, expected increasing times");
  refused([](FilterModel&, FilterRecord& r) { r.time[3] += 0.4; },
          "nile: the time from sample 3 to 4 is 1.4 s, expected a multiple of the model's period 1 "
          "s because it is discrete");
  refused([](FilterModel&, FilterRecord& r) { r.y.resize(2, 100); },
          "nile: the matrix of measurements is 2x100, expected 1x100 (one row per output, one "
          "column per "
          "sample)");
  EXPECT_THAT([&] { (void)parameter_index(model, "Q.levl", "--fix"); },
              ThrowsMessage<InvalidInput>(
                  StrEq("--fix: no parameter 'Q.levl', expected one of Q.level, R.y; did you mean "
                        "'Q.level'?")));
}

TEST(InnovationLikelihood, NamesWhereItFails) {
  FilterModel model = testing::local_level();
  model.A(0, 0) = 1e200;  // its variance leaves the range of a double
  const Likelihood at = InnovationLikelihood(model, {testing::nile()}).evaluate(start_of(model));
  EXPECT_NE(at.status, LikelihoodStatus::computed);
  model = testing::local_level();
  const Likelihood tiny =
      InnovationLikelihood(model, {testing::nile()}).evaluate(logs(1e-320, 1e-320));
  EXPECT_FALSE(tiny.computed());
}

TEST(InnovationLikelihood, ConvergesToThePublishedCovariancesOfTheMambo) {
  // Oliveira 2020, tables 3.1 and 3.2, to the digits of an evaluation in 50.
  std::mt19937_64 random(3);
  const FilterModel altitude = testing::discrete_altitude();
  const VectorXd theta = start_of(altitude);
  const FilterRecord record = testing::simulated(altitude, theta, 3000, altitude.dt, random);
  const FilterRun run = InnovationLikelihood(altitude, {record}).run(0, theta);
  EXPECT_NEAR(run.x_variance(0, 2999), 0.0026241420641870283, 1e-15);
  EXPECT_NEAR(run.x_variance(1, 2999), 0.037607692935054747, 1e-14);
  EXPECT_NEAR(run.variance(0, 2999), 0.1 + 0.0026948589925818966, 1e-14);
  const FilterModel level = testing::local_level();
  const FilterRecord levels = testing::simulated(level, logs(0.09, 5), 500, 1, random);
  const FilterRun settled = InnovationLikelihood(level, {levels}).run(0, logs(0.09, 5));
  // P² - q P - q r = 0 before a measurement.
  const double P = 0.5 * (0.09 + std::sqrt(0.09 * 0.09 + 4 * 0.09 * 5));
  EXPECT_NEAR(settled.variance(0, 499), P + 5, 1e-12);
  EXPECT_NEAR(settled.x_variance(0, 499), 0.627328044930449, 1e-12);
}

}  // namespace
}  // namespace quadtune
