// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/delay.hpp"

#include <cmath>
#include <random>

#include "matrix_near.hpp"
#include "plants/hover_model.hpp"
#include "plants/random_plant.hpp"
#include "quadtune/discretize/discretize.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"
#include "uniform_matrix.hpp"

namespace quadtune {
namespace {

using Method = DiscretizationMethod;

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::ThrowsMessage;

constexpr int kFine = 10;  // short holds in a sample

/// Outputs at the samples, one column each, for the inputs in the columns of u.
MatrixXd response(const DiscreteLti& plant, const MatrixXd& u) {
  MatrixXd y(plant.C.rows(), u.cols());
  VectorXd x = VectorXd::Zero(plant.A.rows());
  for (Index k = 0; k < u.cols(); ++k) {
    y.col(k) = plant.C * x + plant.D * u.col(k);
    x = (plant.A * x + plant.B * u.col(k)).eval();
  }
  return y;
}

/// The same by ten holds in a sample, with delays counted in them.
MatrixXd fine_response(const ContinuousLti& plant, double dt, const Eigen::VectorXi& input_delay,
                       const Eigen::VectorXi& output_delay, const MatrixXd& u) {
  const DiscreteLti fine = discretize_zoh(plant, dt / kFine);
  const Index steps = u.cols() * kFine;
  MatrixXd all(plant.C.rows(), steps);
  VectorXd x = VectorXd::Zero(plant.A.rows());
  for (Index m = 0; m < steps; ++m) {
    VectorXd late(u.rows());
    for (Index j = 0; j < u.rows(); ++j)
      late[j] = m >= input_delay[j] ? u(j, (m - input_delay[j]) / kFine) : 0;
    all.col(m) = plant.C * x + plant.D * late;
    x = (fine.A * x + fine.B * late).eval();
  }
  MatrixXd y = MatrixXd::Zero(plant.C.rows(), u.cols());
  for (Index k = 0; k < u.cols(); ++k)
    for (Index i = 0; i < y.rows(); ++i)
      if (k * kFine >= output_delay[i]) y(i, k) = all(i, k * kFine - output_delay[i]);
  return y;
}

VectorXd seconds(const Eigen::VectorXi& fine_steps, double dt) {
  return fine_steps.cast<double>() * (dt / kFine);
}

TEST(Delays, AgreeWithFinerHoldsForAnyFractions) {
  std::mt19937_64 generator(8);
  std::uniform_int_distribution<int> delay(0, 35);
  const double dt = 0.3;
  for (int trial = 0; trial < 200; ++trial) {
    ContinuousLti p = testing::random_plant(4, 3, 2, trial % 2 == 0, generator);
    p.A.diagonal().array() -= 1.5;  // stable, so that an error at the start is not outgrown
    Eigen::VectorXi input(3);
    Eigen::VectorXi output(2);
    for (int& d : input) d = delay(generator);
    for (int& d : output) d = delay(generator);
    const MatrixXd u = testing::uniform_matrix(3, 30, generator);
    const DiscreteLti d = discretize_zoh(p, dt, {seconds(input, dt), seconds(output, dt)});
    EXPECT_THAT(response(d, u), MatrixNear(fine_response(p, dt, input, output, u), 1e-12))
        << "delays " << input.transpose() << " and " << output.transpose() << " tenths of a sample";
    EXPECT_NO_THROW(validate(d, ""));
    EXPECT_EQ(std::ssize(d.states), d.A.rows());
  }
}

TEST(Delays, FractionalDelayOfALagHasItsClosedForm) {
  const double a = 2, dt = 0.1, late = 0.03;
  ContinuousLti p;
  p.A = MatrixXd{{-a}};
  p.B = MatrixXd{{a}};
  const DiscreteLti d = discretize_zoh(p, dt, {VectorXd::Constant(1, dt + late), {}});
  // x, then u[k-2], then u[k-1]
  const double before = std::exp(-a * (dt - late)) - std::exp(-a * dt);
  const double now = 1 - std::exp(-a * (dt - late));
  EXPECT_THAT(d.A,
              MatrixNear(MatrixXd{{std::exp(-a * dt), before, now}, {0, 0, 1}, {0, 0, 0}}, 1e-15));
  EXPECT_THAT(d.B, MatrixNear(MatrixXd{{0}, {0}, {1}}, 0));
  EXPECT_THAT(d.C, MatrixNear(MatrixXd{{1, 0, 0}}, 0));
}

TEST(Delays, StateNamesDescribeTheirDelay) {
  ContinuousLti p = testing::uquad_hover();
  p.C = MatrixXd::Identity(2, 12);
  p.outputs = {{"x", "m"}, {"y", "m"}};
  const DiscreteLti d =
      discretize_zoh(p, 0.01, {Eigen::Vector4d(0.02, 0, 0.013, 0), Eigen::Vector2d(0.003, 0.01)});
  std::vector<std::string> added;
  for (std::size_t i = 12; i < d.states.size(); ++i) added.push_back(d.states[i].name);
  EXPECT_THAT(added, ElementsAre("w3[k-2]", "x[k-0.3]", "w1[k-1]", "w1[k-2]", "w3[k-1]", "y[k-1]"));
  EXPECT_EQ(d.states[12].unit, "rad/s");
  EXPECT_EQ(d.states[13].unit, "m");
  EXPECT_EQ(d.outputs, p.outputs);
}

TEST(Delays, StatesWithoutNamesGetSome) {
  ContinuousLti p;
  p.A = MatrixXd{{-1}};
  p.B = MatrixXd{{1}};
  const DiscreteLti d =
      discretize_zoh(p, 0.1, {VectorXd::Constant(1, 0.1), VectorXd::Constant(1, 0.1)});
  EXPECT_EQ(names(d.states), "x1 u1[k-1] y1[k-1]");
}

// 0.03 / 0.01 is 3 but for a rounding, and so is 3 * 0.01 for 0.03.
TEST(Delays, RoundingMakesNoFraction) {
  ContinuousLti p;
  p.A = MatrixXd{{-1}};
  p.B = MatrixXd{{1}};
  for (int samples = 0; samples < 200; ++samples) {
    const DiscreteLti d = discretize_zoh(
        p, 0.01, {VectorXd::Constant(1, std::stod(std::to_string(samples * 0.01))), {}});
    EXPECT_EQ(d.A.rows(), 1 + samples);
  }
}

TEST(Delays, WholeSamplesGoWithEveryMethod) {
  std::mt19937_64 generator(9);
  const double dt = 0.1;
  const ContinuousLti p = testing::random_plant(3, 2, 2, false, generator);
  const MatrixXd u = testing::uniform_matrix(2, 20, generator);
  for (const Method method : {Method::zoh, Method::foh, Method::impulse, Method::euler,
                              Method::backward_euler, Method::tustin}) {
    const DiscreteLti prompt = discretize(p, dt, method);
    const DiscreteLti late =
        discretize(p, dt, method,
                   {.prewarp = {}, .delays = {Eigen::Vector2d(0.2, 0.2), Eigen::Vector2d(0, 0.1)}});
    const MatrixXd y = response(prompt, u);
    const MatrixXd y_late = response(late, u);
    EXPECT_THAT(y_late.row(0).tail(18), MatrixNear(y.row(0).head(18), 1e-13)) << to_string(method);
    EXPECT_THAT(y_late.row(1).tail(17), MatrixNear(y.row(1).head(17), 1e-13)) << to_string(method);
    EXPECT_THAT(y_late.leftCols(2), MatrixNear(MatrixXd::Zero(2, 2), 0)) << to_string(method);
  }
}

TEST(Delays, RefusesFractionsWhereTheyAreNotExact) {
  const ContinuousLti p = testing::uquad_hover();
  DiscretizationOptions options;
  options.delays.input = Eigen::Vector4d(0, 0.015, 0, 0);
  EXPECT_THAT([&] { (void)discretize(p, 0.01, DiscretizationMethod::tustin, options); },
              ThrowsMessage<InvalidInput>(HasSubstr(
                  "delays: the delay of input 2 is 0.015 s, expected a whole number of samples of "
                  "0.01 s because only zoh is exact for fractions of a sample")));
  EXPECT_NO_THROW((void)discretize(p, 0.01, DiscretizationMethod::zoh, options));
  EXPECT_NO_THROW((void)discretize(p, 0.015, DiscretizationMethod::tustin, options));
}

TEST(Delays, RefusesBadDelays) {
  ContinuousLti p;
  p.A = MatrixXd{{-1}};
  p.B = MatrixXd{{1}};
  const auto message = [&](const ChannelDelays& delays, const std::string& expected) {
    EXPECT_THAT([&] { (void)discretize_zoh(p, 0.01, delays); },
                ThrowsMessage<InvalidInput>(HasSubstr(expected)));
    EXPECT_THAT([&] { (void)with_delays(discretize_zoh(p, 0.01), delays); },
                ThrowsMessage<InvalidInput>(HasSubstr(expected)));
  };
  message({Eigen::Vector2d(0, 0), {}}, "delays: 2 input delays, expected 1, one for each input");
  message({{}, Eigen::Vector2d(0, 0)}, "delays: 2 output delays, expected 1, one for each output");
  message({VectorXd::Constant(1, -0.01), {}}, "the delay of input 1 is -0.01 s, expected a finite");
  message({{}, VectorXd::Constant(1, std::nan(""))}, "the delay of output 1 is nan s");
  message({VectorXd::Constant(1, 1e9), {}},
          "delays: the delays, including that of input 1, add up to 1e+11 samples, expected at "
          "most 2000");
}

}  // namespace
}  // namespace quadtune
