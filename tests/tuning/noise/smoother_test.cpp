// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/smoother.hpp"

#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "log_files/nile.hpp"
#include "matrix_near.hpp"
#include "plants/filter_models.hpp"
#include "quadtune/tuning/innovation_likelihood.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing::MatrixNear;
using ::testing::StrEq;

/// Rauch, Tung and Striebel 1965, of a discrete model whose samples are one period apart.
struct Rts {
  MatrixXd x, P;
};
Rts rts(const FilterModel& model, const VectorXd& theta, const FilterRecord& record) {
  const Index nx = model.A.rows(), N = record.samples();
  const MatrixXd Q = model.G * covariance(model.Q, theta) * model.G.transpose();
  std::vector<MatrixXd> before, after;
  std::vector<VectorXd> x_before, x_after;
  VectorXd x = model.x0;
  MatrixXd P = model.P0;
  for (Index k = 0; k < N; ++k) {
    before.push_back(P);
    x_before.push_back(x);
    Index first = 0;
    for (const FilterSensor& s : model.sensors) {
      const Index m = s.C.rows();
      if (!std::isnan(record.y(first, k))) {
        VectorXd y = record.y.col(k).segment(first, m);
        if (s.D.size() > 0) y -= s.D * record.u.col(k);
        const MatrixXd S = s.C * P * s.C.transpose() + covariance(s.R, theta);
        const MatrixXd K = P * s.C.transpose() * S.inverse();
        x += K * (y - s.C * x);
        const MatrixXd I_KC = MatrixXd::Identity(nx, nx) - K * s.C;
        P = (I_KC * P * I_KC.transpose() + K * covariance(s.R, theta) * K.transpose()).eval();
      }
      first += m;
    }
    after.push_back(P);
    x_after.push_back(x);
    x = (model.A * x + model.B * record.u.col(k)).eval();
    P = (model.A * P * model.A.transpose() + Q).eval();
  }
  Rts result{MatrixXd(nx, N), MatrixXd(nx, nx * N)};
  VectorXd xs = x_after.back();
  MatrixXd Ps = after.back();
  for (Index k = N - 1; k >= 0; --k) {
    if (k < N - 1) {
      const auto i = static_cast<std::size_t>(k);
      const MatrixXd G = after[i] * model.A.transpose() * before[i + 1].inverse();
      xs = (x_after[i] + G * (xs - x_before[i + 1])).eval();
      Ps = (after[i] + G * (Ps - before[i + 1]) * G.transpose()).eval();
    }
    result.x.col(k) = xs;
    result.P.middleCols(nx * k, nx) = Ps;
  }
  return result;
}

TEST(Smoother, IsRauchTungStriebels) {
  std::mt19937_64 random(21);
  for (int nx = 1; nx <= 6; ++nx)
    for (const bool full : {false, true}) {
      FilterModel model = testing::random_model(random, nx, 1, false, full);
      model.Q.fixed.setZero();  // fewer noises than states: Q of the states is singular
      model.P0 += MatrixXd::Identity(nx, nx);
      const VectorXd theta = start_of(model);
      const FilterRecord record = testing::simulated(model, theta, 80, 0.1, random, 0.2);
      const SmoothedStates smoothed = smooth(model, theta, record);
      ASSERT_TRUE(smoothed.solved()) << smoothed.culprit;
      const Rts expected = rts(model, theta, record);
      EXPECT_THAT(smoothed.x, MatrixNear(expected.x, 1e-10 * expected.x.norm())) << nx;
      EXPECT_THAT(smoothed.P, MatrixNear(expected.P, 1e-10 * expected.P.norm())) << nx;
    }
}

TEST(Smoother, ItsDeterminantGivesTheFiltersLikelihood) {
  std::mt19937_64 random(22);
  for (int nx = 1; nx <= 6; ++nx)
    for (const bool diffuse : {false, true})
      for (const bool continuous : {false, true}) {
        FilterModel model = testing::random_model(random, nx, 2, continuous, true);
        model.P0 += MatrixXd::Identity(nx, nx);
        if (diffuse) {
          model.P0.setZero();
          model.diffuse.assign(static_cast<std::size_t>(nx), true);
        }
        const VectorXd theta = start_of(model);
        const FilterRecord record = testing::simulated(model, theta, 300, 0.1, random, 0.2);
        const SmoothedStates smoothed = smooth(model, theta, record);
        ASSERT_TRUE(smoothed.solved()) << smoothed.culprit;
        const double filter = InnovationLikelihood(model, {record}).evaluate(theta).value;
        EXPECT_NEAR(smoothed.log_likelihood, filter, 1e-10 * std::abs(filter)) << nx << diffuse;
      }
}

// Durbin and Koopman 2012, figure 2.2: by their formulas for the local level, diffuse.
TEST(Smoother, OfDiffuseStatesIsALimit) {
  FilterModel model = testing::local_level();
  const VectorXd theta = Eigen::Vector2d(std::log(1469.1767), std::log(15098.5185));
  const SmoothedStates smoothed = smooth(model, theta, testing::nile());
  ASSERT_TRUE(smoothed.solved()) << smoothed.culprit;
  model.diffuse = {false};
  model.P0(0, 0) = 1e10;
  const Rts vague = rts(model, theta, testing::nile());
  EXPECT_THAT(smoothed.x, MatrixNear(vague.x, 1e-3));  // first order in 4000/1e10
  EXPECT_THAT(smoothed.P, MatrixNear(vague.P, 3e-2));
  // In the middle the variance is the steady-state one: P Z/(P + Z) of both directions.
  const double q = 1469.1767, r = 15098.5185;
  const double steady = r / std::sqrt(1 + 4 * r / q);
  EXPECT_NEAR(smoothed.P(0, 50), steady, 1e-6 * steady);
}

// The likelihood of a record with a known initial state is a parabola in that state: its maximum
// and its width are the smoothed state of a diffuse start and its covariance.
TEST(Smoother, EstimatesTheStateAtTheStart) {
  std::mt19937_64 random(25);
  for (int nx = 1; nx <= 4; ++nx) {
    FilterModel model = testing::random_model(random, nx, 2, true, true);
    model.P0.setZero();
    model.diffuse.assign(static_cast<std::size_t>(nx), true);
    const VectorXd theta = start_of(model);
    FilterRecord record = testing::simulated(model, theta, 200, 0.1, random, 0.2);
    const SmoothedStates smoothed = smooth(model, theta, record);
    ASSERT_TRUE(smoothed.solved()) << smoothed.culprit;
    const VectorXd x0 = smoothed.x.col(0);
    const MatrixXd P = smoothed.P.leftCols(nx);
    const auto from = [&](const VectorXd& x) {
      record.start = {x, MatrixXd::Zero(nx, nx)};
      return InnovationLikelihood(model, {record}).evaluate(theta).value;
    };
    const double max = from(x0);
    const MatrixXd deviations = P.llt().matrixL();
    for (Index d = 0; d < nx; ++d) {  // one standard deviation in each direction
      EXPECT_NEAR(from(x0 + deviations.col(d)), max - 0.5, 1e-8) << nx;
      EXPECT_NEAR(from(x0 - deviations.col(d)), max - 0.5, 1e-8) << nx;
    }
  }
}

TEST(Smoother, NamesAStateThatIsNotObservable) {
  FilterModel model = testing::discrete_altitude();
  model.A(0, 1) = 0;  // the speed does not affect the height
  std::mt19937_64 random(1);
  const VectorXd theta = start_of(model);
  const FilterRecord record = testing::simulated(model, theta, 20, 0.005, random);
  const SmoothedStates smoothed = smooth(model, theta, record);
  EXPECT_EQ(smoothed.status, SmootherStatus::singular);
  EXPECT_THAT(smoothed.culprit,
              StrEq("simulated: state 'vz' at 0 s is known exactly or not observable"));
}

TEST(Smoother, SupportsAModelLinearizedAtEachInstant) {
  std::mt19937_64 random(21);
  FilterModel model = testing::random_model(random, 3, 2, false, false);
  model.Q.fixed.setZero();
  const VectorXd theta = start_of(model);
  FilterRecord record = testing::simulated(model, theta, 40, model.dt, random);
  record.start = FilterStart{VectorXd::Constant(3, 0.2), MatrixXd(2 * MatrixXd::Identity(3, 3))};
  const SmoothedStates expected = smooth(model, theta, record);
  const FilterRecord same = testing::linearized(model, record);
  const SmoothedStates got = smooth(model, theta, same);
  ASSERT_TRUE(expected.solved() && got.solved());
  EXPECT_THAT(got.x, MatrixNear(expected.x, 1e-9));
  EXPECT_THAT(got.P, MatrixNear(expected.P, 1e-9));
  EXPECT_NEAR(got.log_likelihood, InnovationLikelihood(model, {same}).evaluate(theta).value, 1e-8);
}

}  // namespace
}  // namespace quadtune
