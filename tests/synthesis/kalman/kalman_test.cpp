// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/kalman.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"
#include "shared_data.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using testing::MatrixNear;
using testing::MatrixRelativelyNear;
using ::testing::ThrowsMessage;

Eigen::MatrixXd scalar(double value) { return Eigen::MatrixXd::Constant(1, 1, value); }

DiscreteLti altitude_model() {
  DiscreteLti model;
  model.A = (Eigen::MatrixXd(2, 2) << 1, 0.005, 0, 1).finished();
  model.C = Eigen::RowVector2d(1, 0);
  model.dt = 0.005;
  model.states = {{"z", "m"}, {"vz", "m/s"}};
  return model;
}

// The filter of table 3.1. MATLAB's numbers are quoted in docs/bibliography.md; the sixteen digits
// here are their 50-digit recomputation.
TEST(Kalman, MamboAltitudeGain) {
  const KalmanResult result =
      kalman(altitude_model(), {Eigen::Vector2d(0, 1), scalar(5e-4), scalar(0.1), {}});
  ASSERT_TRUE(result.solved()) << result.culprit;
  EXPECT_THAT(result.M, MatrixNear(Eigen::Vector2d(0.0262414206418703, 0.0697767360714920), 1e-14));
  // L = A M without cross-correlation
  EXPECT_THAT(result.L, MatrixNear(altitude_model().A * result.M, 1e-15));
}

TEST(Kalman, MatchesEveryReferenceCase) {
  QUADTUNE_REQUIRE_DATA(data);
  std::ifstream file(data / "known" / "mambo_kalman.json");
  const nlohmann::json known = nlohmann::json::parse(file);
  const auto matrix = [](const nlohmann::json& rows) {
    Eigen::MatrixXd M(rows.size(), rows[0].size());
    for (std::size_t i = 0; i < rows.size(); ++i)
      for (std::size_t j = 0; j < rows[i].size(); ++j)
        M(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
            std::stod(rows[i][j].get<std::string>());
    return M;
  };
  for (const nlohmann::json& c : known["cases"]) {
    DiscreteLti model;
    model.A = matrix(c["A"]);
    model.C = matrix(c["C"]);
    const KalmanResult result = kalman(model, {matrix(c["G"]), matrix(c["Q"]), matrix(c["R"]), {}});
    ASSERT_TRUE(result.solved()) << c["name"];
    const nlohmann::json& reference = c["reference50"];
    const auto near = [&](const char* name, const Eigen::MatrixXd& got) {
      const Eigen::MatrixXd want = matrix(reference[name]);
      EXPECT_THAT(got, MatrixRelativelyNear(want, 1e-13)) << c["name"] << " " << name;
    };
    near("M", result.M);
    near("L", result.L);
    near("P", result.P);
    near("Z", result.Z);
  }
}

// A random walk that is measured with noise: P = (q + sqrt(q² + 4 q r)) / 2.
TEST(Kalman, LocalLevelInClosedForm) {
  DiscreteLti model;
  model.A = model.C = scalar(1);
  const double q = 1469.1, r = 15099;
  const KalmanResult result = kalman(model, {{}, scalar(q), scalar(r), {}});
  ASSERT_TRUE(result.solved()) << result.culprit;
  const double P = (q + std::sqrt(q * q + 4 * q * r)) / 2;
  EXPECT_NEAR(result.P(0, 0), P, 1e-12 * P);
  EXPECT_NEAR(result.M(0, 0), P / (P + r), 1e-14);
  EXPECT_NEAR(result.Z(0, 0), P * r / (P + r), 1e-12 * P);
}

// Kalman–Bucy filter of a double integrator driven by acceleration noise.
TEST(Kalman, ContinuousDoubleIntegratorInClosedForm) {
  ContinuousLti model;
  model.A = (Eigen::MatrixXd(2, 2) << 0, 1, 0, 0).finished();
  model.C = Eigen::RowVector2d(1, 0);
  const KalmanResult result = kalman(model, {Eigen::Vector2d(0, 1), scalar(4), scalar(0.25), {}});
  ASSERT_TRUE(result.solved()) << result.culprit;
  // (q/r)^(1/2) = 4: L = [sqrt(2 · 4), 4]
  EXPECT_THAT(result.L, MatrixNear(Eigen::Vector2d(2 * std::numbers::sqrt2, 4), 1e-13));
}

// Correlated noises: removing the correlation by feeding the measurement forward must give the same
// filter (Anderson and Moore 1979, section 5.5).
TEST(Kalman, CorrelatedNoiseEqualsItsDecorrelatedForm) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 20; ++trial) {
    const auto draw = [&](Eigen::Index rows, Eigen::Index cols) {
      return Eigen::MatrixXd::NullaryExpr(rows, cols, [&] { return normal(random); }).eval();
    };
    DiscreteLti model;
    model.A = 0.5 * draw(4, 4);
    model.C = draw(2, 4);
    const Eigen::MatrixXd F = draw(5, 5);
    const Eigen::MatrixXd joint = F * F.transpose();
    KalmanNoise noise = {draw(4, 3), joint.topLeftCorner(3, 3), joint.bottomRightCorner(2, 2),
                         joint.topRightCorner(3, 2)};
    const KalmanResult result = kalman(model, noise);
    ASSERT_TRUE(result.solved()) << result.culprit;
    const Eigen::MatrixXd NRi = noise.N * noise.R.inverse();
    DiscreteLti decorrelated = model;
    decorrelated.A -= noise.G * NRi * model.C;
    KalmanNoise rest = noise;
    rest.Q -= NRi * noise.N.transpose();
    rest.Q = 0.5 * (rest.Q + rest.Q.transpose()).eval();
    rest.N = {};
    const KalmanResult other = kalman(decorrelated, rest);
    ASSERT_TRUE(other.solved()) << other.culprit;
    EXPECT_THAT(result.P, MatrixRelativelyNear(other.P, 1e-11));
    EXPECT_THAT(result.L, MatrixRelativelyNear(other.L + noise.G * NRi, 1e-11));
  }
}

// The sampled filter converges to the continuous one: P and L / dt.
TEST(Kalman, SampledTendsToContinuous) {
  ContinuousLti model;
  model.A = (Eigen::MatrixXd(2, 2) << 0, 1, 0, 0).finished();
  model.C = Eigen::RowVector2d(1, 0);
  const KalmanNoise noise = {Eigen::Vector2d(0, 1), scalar(4), scalar(0.25), {}};
  const double dt = 1e-4;
  const KalmanResult sampled = kalman_sampled(model, noise, dt);
  const KalmanResult continuous = kalman(model, noise);
  ASSERT_TRUE(sampled.solved()) << sampled.culprit;
  EXPECT_THAT(sampled.L / dt, MatrixRelativelyNear(continuous.L, 1e-3));
  EXPECT_THAT(sampled.P, MatrixRelativelyNear(continuous.P, 1e-3));
}

TEST(Kalman, NamesTheUnobservableState) {
  DiscreteLti model = altitude_model();
  model.C = Eigen::RowVector2d(0, 1);  // velocity alone says nothing of height
  const KalmanResult result = kalman(model, {{}, Eigen::MatrixXd::Identity(2, 2), scalar(1), {}});
  EXPECT_EQ(result.status, RiccatiStatus::not_detectable);
  EXPECT_THAT(result.culprit, HasSubstr("z cannot be observed by the measurements"));
}

TEST(Kalman, RefusesBadCovariancesAndShapes) {
  EXPECT_THAT(
      [] {
        (void)kalman(altitude_model(), {{}, Eigen::MatrixXd::Identity(3, 3), scalar(1), {}});
      },
      ThrowsMessage<InvalidInput>(HasSubstr("Q is 3x3, expected 2x2 (A is 2x2)")));
  EXPECT_THAT(
      [] {
        (void)kalman(altitude_model(), {{}, Eigen::Vector2d(1, -1).asDiagonal(), scalar(1), {}});
      },
      ThrowsMessage<InvalidInput>(HasSubstr("Q has eigenvalue -1, expected none below 0")));
}

// A correlation that exceeds 1 is rejected, however small the noises; one of exactly 1 is accepted.
TEST(Kalman, RejectsCorrelationsAboveOne) {
  for (const double size : {1.0, 1e-9, 1e9}) {
    const auto found = [&](double correlation) {
      KalmanNoise noise = {Eigen::Vector2d(0, 1), scalar(size * size), scalar(1), {}};
      noise.N = scalar(correlation * size);
      return kalman(altitude_model(), noise);
    };
    EXPECT_TRUE(found(0.999).solved()) << found(0.999).culprit;
    EXPECT_NO_THROW((void)found(1));  // but nothing drives the states that v does not determine
    for (const double correlation : {1.001, -2.0})
      EXPECT_THAT([&] { (void)found(correlation); },
                  ThrowsMessage<InvalidInput>(HasSubstr("[Q N; N' R] is indefinite")));
  }
  EXPECT_THAT(
      [] {
        (void)kalman(altitude_model(), {Eigen::Vector2d(0, 1), scalar(0), scalar(1), scalar(1e-9)});
      },
      ThrowsMessage<InvalidInput>(HasSubstr("[Q N; N' R] is indefinite")));
}

}  // namespace
}  // namespace quadtune
