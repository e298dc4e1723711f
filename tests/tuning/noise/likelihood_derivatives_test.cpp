// SPDX-License-Identifier: Apache-2.0
// The gradient by the adjoint pass, compared with that of the sensitivities, which comes with the
// information.
#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <cmath>

#include "matrix_near.hpp"
#include "plants/filter_models.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/tuning/innovation_likelihood.hpp"
#include "uniform_matrix.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing::MatrixNear;

/// The first two noises of its covariance as an additional full block.
FilterModel with_full_block(FilterModel model) {
  model.Q.full.push_back({{0, 1}, static_cast<int>(model.parameters.size())});
  model.parameters.push_back({"Q.a", "", true, 0.3});
  model.parameters.push_back({"Q.ab", "", false, 0.4});
  model.parameters.push_back({"Q.b", "", true, 0.5});
  return model;
}

void expect_same_gradient(const FilterModel& model, const std::vector<FilterRecord>& records,
                          const VectorXd& theta, const std::string& what) {
  InnovationLikelihood likelihood(model, records);
  for (const bool hold : {true, false}) {
    likelihood.hold_steady_gains(hold);
    const Likelihood adjoint = likelihood.evaluate(theta, LikelihoodOrder::gradient);
    const Likelihood forward = likelihood.evaluate(theta, LikelihoodOrder::information);
    ASSERT_TRUE(adjoint.computed() && forward.computed()) << what << adjoint.culprit;
    EXPECT_NEAR(adjoint.value, forward.value, 1e-11 * std::abs(forward.value)) << what;
    EXPECT_EQ(adjoint.innovations, forward.innovations) << what;
    EXPECT_EQ(adjoint.diffuse, forward.diffuse) << what;
    EXPECT_THAT(adjoint.gradient,
                MatrixNear(forward.gradient, 1e-9 * (1 + forward.information.norm())))
        << what;
  }
}

TEST(LikelihoodDerivatives, AdjointAgreesWithSensitivities) {
  std::mt19937_64 random(21);
  for (const int nx : {2, 4, 5, 8, 9, 12, 13, 17, 24})
    for (const bool continuous : {false, true})
      for (const bool diffuse : {false, true}) {
        FilterModel model = testing::random_model(random, nx, nx % 3, continuous, false);
        model = with_full_block(model);
        if (diffuse) {  // one diffuse state
          model.P0.row(0).setZero();
          model.P0.col(0).setZero();
          model.diffuse[0] = true;
        }
        const VectorXd truth = start_of(model),
                       theta = truth + 0.2 * testing::uniform_vector(truth.size(), random);
        expect_same_gradient(
            model,
            {testing::simulated(model, truth, 70, 0.1, random, 0.3, continuous ? 0.3 : 0),
             testing::simulated(model, truth, 40, 0.1, random)},
            theta, std::to_string(nx) + (continuous ? " continuous " : " discrete "));
      }
}

// Pieces of 1024 samples, gains that converge within them, gaps, and N that converges backwards;
// one or several samples a block, and noise of single states, whose derivatives have separate code.
TEST(LikelihoodDerivatives, AdjointAgreesWithSensitivitiesOverSteadyStretches) {
  std::mt19937_64 random(22);
  for (const int nx : {3, 6, 12})
    for (const bool one_output : {false, true})
      for (const bool diagonal : {false, true}) {
        FilterModel model = testing::random_model(random, nx, 2, false, false);
        if (diagonal) model.G.setIdentity();
        if (one_output) {
          model.sensors.resize(1);
          model.parameters.resize(model.parameters.size() - 2);
        }
        const VectorXd truth = start_of(model);
        FilterRecord record = testing::simulated(model, truth, 6000, 0.1, random);
        for (int k = 2500; k < 2510; ++k)
          record.y.col(k).tail(one_output ? 1 : 2).setConstant(std::nan(""));
        // After a gap in time the noise of a state has spread to the others.
        for (std::size_t k = 4000; k < 6000; ++k) record.time[k] += diagonal ? 0 : 0.3;
        expect_same_gradient(model, {record},
                             truth + 0.2 * testing::uniform_vector(truth.size(), random),
                             std::to_string(nx) + (one_output ? " one output" : " three outputs") +
                                 (diagonal ? " diagonal" : ""));
      }
}

// They have separate code, which sensitivities do not use. With the small R, some steps require the
// Joseph form.
TEST(LikelihoodDerivatives, AdjointAgreesWithSensitivitiesForTwoStatesAndOneOutput) {
  std::mt19937_64 random(26);
  for (const int nu : {0, 1, 2})
    for (const double R : {0.5, 1e-5}) {
      FilterModel model = testing::random_model(random, 2, nu, false, false);
      model.sensors.resize(1);
      model.parameters.resize(3);
      model.parameters[2].start = R;
      if (nu > 0) model.sensors[0].D = Eigen::MatrixXd::Constant(1, nu, 0.3);
      const VectorXd truth = start_of(model);
      FilterRecord record = testing::simulated(model, truth, 6000, 0.1, random);
      for (int k = 2500; k < 2510; k += 3) record.y(0, k) = std::nan("");
      for (std::size_t k = 4000; k < 6000; ++k) record.time[k] += 0.3;
      expect_same_gradient(model, {record},
                           truth + 0.2 * testing::uniform_vector(truth.size(), random),
                           std::to_string(nu) + " inputs, R " + std::to_string(R));
    }
}

// More than fits on the tapes, with varying and with steady gains: a part is processed twice.
TEST(LikelihoodDerivatives, AdjointThroughALongLog) {
  std::mt19937_64 random(23);
  struct Log {
    int nx;
    double missing;
    int times;
  };
  for (const auto& [nx, missing, times] : {Log{5, 0.1, 260}, Log{2, 0, 160}}) {
    const FilterModel model = testing::random_model(random, nx, 0, false, false);
    const VectorXd theta = start_of(model);
    const FilterRecord piece = testing::simulated(model, theta, 1000, 0.1, random, missing);
    FilterRecord record = piece;
    record.y = piece.y.replicate(1, times);
    record.u.resize(0, record.y.cols());
    record.time.resize(static_cast<std::size_t>(record.y.cols()));
    for (std::size_t k = 0; k < record.time.size(); ++k)
      record.time[k] = 0.1 * static_cast<double>(k);
    const InnovationLikelihood likelihood(model, {record});
    const Likelihood at = likelihood.evaluate(theta, LikelihoodOrder::gradient);
    ASSERT_TRUE(at.computed());
    const VectorXd direction = testing::uniform_vector(theta.size(), random);
    const auto moved = [&](double by) { return likelihood.evaluate(theta + by * direction).value; };
    constexpr double h = 1e-3;  // of fourth order
    const double numeric = (8 * (moved(h) - moved(-h)) - (moved(2 * h) - moved(-2 * h))) / (12 * h);
    EXPECT_NEAR(at.gradient.dot(direction), numeric, 1e-8 * std::abs(at.value));
    EXPECT_GT(std::abs(numeric), 1e-4 * std::abs(at.value));
  }
}

// A linear model given instant by instant is the same model.
TEST(LikelihoodDerivatives, OfLinearizedInstantsIsThatOfTheModel) {
  std::mt19937_64 random(24);
  for (const int nx : {5, 15}) {
    FilterModel model = testing::random_model(random, nx, 2, false, false);
    model.Q.fixed.setZero();
    for (FilterSensor& sensor : model.sensors) sensor.D.resize(0, 0);
    const VectorXd truth = start_of(model),
                   theta = truth + 0.2 * testing::uniform_vector(truth.size(), random);
    const FilterRecord record = testing::simulated(model, truth, 90, 0.1, random, 0.2);
    FilterRecord told = record;
    told.start = FilterStart{model.x0, model.P0};
    MatrixXd C(3, nx);
    C << model.sensors[0].C, model.sensors[1].C;
    for (Index k = 0; k < record.samples(); ++k) {
      LinearizedInstant& at = told.linearized.emplace_back();
      at.C = C;
      at.F = model.A;
      at.offset = model.B * record.u.col(k);
      for (const ScaledCovariance& term : model.Q.scaled)
        at.noise.push_back(model.G * term.shape * model.G.transpose());
    }
    for (const LikelihoodOrder order : {LikelihoodOrder::gradient, LikelihoodOrder::information}) {
      const Likelihood one = InnovationLikelihood(model, {record}).evaluate(theta, order);
      const Likelihood other = InnovationLikelihood(model, {told}).evaluate(theta, order);
      ASSERT_TRUE(one.computed() && other.computed());
      EXPECT_NEAR(one.value, other.value, 1e-12 * std::abs(one.value));
      EXPECT_THAT(other.gradient, MatrixNear(one.gradient, 1e-10 * (1 + one.gradient.norm())));
      if (order == LikelihoodOrder::gradient) continue;
      EXPECT_THAT(other.information, MatrixNear(one.information, 1e-10 * one.information.norm()));
    }
    expect_same_gradient(model, {told}, theta, std::to_string(nx) + " linearized ");
  }
}

// Every kind of evaluation calls the stop function repeatedly.
TEST(LikelihoodDerivatives, StopsWithinAThousandSamples) {
  std::mt19937_64 random(25);
  for (const int nx : {2, 6}) {
    FilterModel model = testing::random_model(random, nx, 0, false, false);
    model.Q.fixed.setZero();
    const FilterRecord record = testing::simulated(model, start_of(model), 5000, 0.1, random, 0.2);
    for (const FilterRecord& of : {record, testing::linearized(model, record)}) {
      InnovationLikelihood likelihood(model, {of});
      for (const LikelihoodOrder order :
           {LikelihoodOrder::value, LikelihoodOrder::gradient, LikelihoodOrder::information}) {
        int asked = 0;
        likelihood.stop_when([&] { return ++asked == 3; });
        EXPECT_THROW((void)likelihood.evaluate(start_of(model), order), Interrupted) << nx;
        EXPECT_EQ(asked, 3);
        asked = 3;
        EXPECT_TRUE(likelihood.evaluate(start_of(model), order).computed());
      }
      int asked = 0;
      likelihood.stop_when([&] { return ++asked == 3; });
      EXPECT_THROW((void)likelihood.run(0, start_of(model)), Interrupted) << nx;
    }
  }
}

}  // namespace
}  // namespace quadtune
