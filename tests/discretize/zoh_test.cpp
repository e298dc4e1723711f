// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/zoh.hpp"

#include <cmath>
#include <limits>
#include <random>

#include "matrix_near.hpp"
#include "plants/extended_hold.hpp"
#include "plants/hover_model.hpp"
#include "plants/slicot_example.hpp"
#include "quadtune/errors.hpp"
#include "shared_data.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using ::testing::HasSubstr;
using testing::MatrixNear;
using testing::MatrixRelativelyNear;
using ::testing::ThrowsMessage;

ContinuousLti plant(const MatrixXd& A, const MatrixXd& B) {
  ContinuousLti result;
  result.A = A;
  result.B = B;
  return result;
}

ContinuousLti random_zoh_plant(Eigen::Index nx, Eigen::Index nu, std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  const auto draw = [&] { return normal(generator); };
  return plant(MatrixXd::NullaryExpr(nx, nx, draw), MatrixXd::NullaryExpr(nx, nu, draw));
}

TEST(DiscretizeZoh, DoubleIntegratorIsExact) {
  const double dt = 0.01;
  const DiscreteLti d = discretize_zoh(plant(MatrixXd{{0, 1}, {0, 0}}, MatrixXd{{0}, {1}}), dt);
  EXPECT_THAT(d.A, MatrixNear(MatrixXd{{1, dt}, {0, 1}}, 0));
  EXPECT_THAT(d.B, MatrixNear(MatrixXd{{dt * dt / 2}, {dt}}, 1e-20));
  EXPECT_EQ(d.dt, dt);
}

TEST(DiscretizeZoh, FirstOrderLagsHaveTheirClosedForm) {
  for (const double a : {-1e8, -500.0, -1.0, -1e-9, 1e-9, 1.0, 50.0}) {
    const double dt = 0.02;
    const DiscreteLti d = discretize_zoh(plant(MatrixXd{{a}}, MatrixXd{{3}}), dt);
    EXPECT_NEAR(d.A(0, 0), std::exp(a * dt), 4e-15 * std::exp(a * dt)) << a;
    EXPECT_NEAR(d.B(0, 0), 3 * std::expm1(a * dt) / a, 4e-15 * d.B(0, 0)) << a;
  }
}

TEST(DiscretizeZoh, HarmonicOscillatorTurns) {
  const double w = 20;
  const double dt = 0.05;
  const DiscreteLti d = discretize_zoh(plant(MatrixXd{{0, w}, {-w, 0}}, MatrixXd{{0}, {w}}), dt);
  const double c = std::cos(w * dt);
  const double s = std::sin(w * dt);
  EXPECT_THAT(d.A, MatrixNear(MatrixXd{{c, s}, {-s, c}}, 5e-16));
  EXPECT_THAT(d.B, MatrixNear(MatrixXd{{1 - c}, {s}}, 5e-16));
}

TEST(DiscretizeZoh, TwoHalfPeriodsMakeOne) {
  std::mt19937_64 generator(1);
  for (const Eigen::Index nx : {2, 7, 12, 16}) {
    const ContinuousLti p = random_zoh_plant(nx, 3, generator);
    const DiscreteLti half = discretize_zoh(p, 0.05);
    const DiscreteLti whole = discretize_zoh(p, 0.1);
    EXPECT_THAT(half.A * half.A, MatrixRelativelyNear(whole.A, 2e-15));
    EXPECT_THAT(half.A * half.B + half.B, MatrixRelativelyNear(whole.B, 2e-15));
  }
}

TEST(DiscretizeZoh, TendsToThePlantForShortPeriods) {
  const ContinuousLti p = testing::uquad_hover();
  const double dt = 1e-9;
  const DiscreteLti d = discretize_zoh(p, dt);
  EXPECT_THAT((d.A - MatrixXd::Identity(12, 12)) / dt, MatrixNear(p.A, 1e-6));
  EXPECT_THAT(d.B / dt, MatrixNear(p.B, 1e-8));
}

TEST(DiscretizeZoh, AgreesWithExtendedPrecisionForAllSizes) {
  std::mt19937_64 generator(2);
  for (Eigen::Index nx = 1; nx <= 30; ++nx)
    for (const double dt : {1e-4, 0.005, 0.01, 0.1, 1.0}) {
      const ContinuousLti p = random_zoh_plant(nx, 1 + nx % 5, generator);
      const DiscreteLti d = discretize_zoh(p, dt);
      const testing::ExtendedHold reference = testing::extended_hold(p.A, p.B, dt);
      const double tolerance = 3e-16 * std::max(2.0, p.A.norm() * dt);
      EXPECT_THAT(d.A, MatrixRelativelyNear(reference.E, tolerance)) << nx << " at " << dt;
      EXPECT_THAT(d.B, MatrixRelativelyNear(reference.integral, tolerance)) << nx << " at " << dt;
    }
}

// Where A⁻¹ (e^(A dt) - I) B would be tempting: hover has twelve poles at 0.
TEST(DiscretizeZoh, HoverIsExactEntryByEntry) {
  const ContinuousLti p = testing::uquad_hover();
  const double dt = 0.01;
  const DiscreteLti d = discretize_zoh(p, dt);
  const testing::ExtendedHold reference = testing::extended_hold(p.A, p.B, dt);
  for (Eigen::Index i = 0; i < 12; ++i) {
    EXPECT_THAT(d.A.row(i), MatrixRelativelyNear(reference.E.row(i), 3e-16));
    EXPECT_THAT(d.B.row(i), MatrixRelativelyNear(reference.integral.row(i), 3e-16));
  }
}

TEST(DiscretizeZoh, KeepsOutputsAndNames) {
  ContinuousLti p = testing::uquad_hover();
  p.C = MatrixXd::Identity(2, 12);
  p.D = MatrixXd::Constant(2, 4, 0.5);
  p.outputs = {{"x", "m"}, {"y", "m"}};
  const DiscreteLti d = discretize_zoh(p, 0.01);
  EXPECT_THAT(d.C, MatrixNear(p.C, 0));
  EXPECT_THAT(d.D, MatrixNear(p.D, 0));
  EXPECT_EQ(d.states, p.states);
  EXPECT_EQ(d.inputs, p.inputs);
  EXPECT_EQ(d.outputs, p.outputs);
}

TEST(DiscretizeZoh, ReproducesSlicotMB05ND) {
  QUADTUNE_REQUIRE_DATA(data);
  const std::filesystem::path folder = data / "known" / "slicot";
  const MatrixXd A = testing::matrix_after(folder / "MB05ND.dat", "   5     0.1", 5, 5);
  const DiscreteLti d = discretize_zoh(plant(A, MatrixXd::Identity(5, 5)), 0.1);
  EXPECT_THAT(d.A, MatrixNear(testing::matrix_after(folder / "MB05ND.res", "exp(A*DELTA) is", 5, 5),
                              0.51e-4));
  EXPECT_THAT(d.B, MatrixNear(testing::matrix_after(folder / "MB05ND.res", "its integral is", 5, 5),
                              0.51e-4));
}

// A dt itself is beyond the range of a double here, the answer is not.
TEST(DiscretizeZoh, SurvivesAbsurdlyFastDecay) {
  const DiscreteLti d = discretize_zoh(plant(MatrixXd{{-1e300}}, MatrixXd{{1}}), 1e10);
  EXPECT_EQ(d.A(0, 0), 0);
  EXPECT_NEAR(d.B(0, 0), 1e-300, 1e-313);
}

TEST(DiscretizeZoh, WorkspaceGivesTheSameBits) {
  std::mt19937_64 generator(5);
  ZohWorkspace workspace(9, 2);
  for (const double dt : {0.001, 3.0, 0.01}) {
    const ContinuousLti p = random_zoh_plant(9, 2, generator);
    const DiscreteLti d = discretize_zoh(p, dt);
    MatrixXd Ad(9, 9);
    MatrixXd Bd(9, 2);
    workspace.solve(p.A, p.B, dt, Ad, Bd);
    EXPECT_THAT(Ad, MatrixNear(d.A, 0));
    EXPECT_THAT(Bd, MatrixNear(d.B, 0));
  }
}

TEST(DiscretizeZoh, RefusesBadPeriods) {
  const ContinuousLti p = plant(MatrixXd{{-1}}, MatrixXd{{1}});
  for (const double dt : {0.0, -0.01, std::numeric_limits<double>::infinity(),
                          std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THAT(
        [&] { (void)discretize_zoh(p, dt); },
        ThrowsMessage<InvalidInput>(HasSubstr("s, expected a positive, finite number of seconds")));
  EXPECT_THAT([&] { (void)discretize_zoh(p, -0.01); },
              ThrowsMessage<InvalidInput>(HasSubstr("zoh: dt is -0.01 s")));
  EXPECT_THAT(
      [] { (void)discretize_zoh(plant(MatrixXd{{1}}, MatrixXd{{1}}), 1e4); },
      ThrowsMessage<InvalidInput>(HasSubstr(
          "zoh: dt is 10000 s, expected a shorter period because within it the plant grows")));
}

TEST(DiscretizeZoh, RefusesBadPlants) {
  EXPECT_THAT([] { (void)discretize_zoh(plant(MatrixXd::Zero(2, 3), MatrixXd::Zero(2, 1)), 1); },
              ThrowsMessage<InvalidInput>(HasSubstr("zoh: A is 2x3, expected a square matrix")));
  EXPECT_THAT([] { (void)discretize_zoh(plant(MatrixXd::Zero(2, 2), MatrixXd::Zero(3, 1)), 1); },
              ThrowsMessage<InvalidInput>(HasSubstr("zoh: B is 3x1, expected 2 rows")));
  MatrixXd A = MatrixXd::Zero(2, 2);
  A(0, 1) = std::numeric_limits<double>::infinity();
  EXPECT_THAT([&] { (void)discretize_zoh(plant(A, MatrixXd::Zero(2, 1)), 1); },
              ThrowsMessage<InvalidInput>(HasSubstr("zoh: A has inf at (1,2)")));
}

TEST(DiscretizeZoh, WorkspaceRefusesTheSame) {
  ZohWorkspace workspace(2, 1);
  MatrixXd A = MatrixXd::Zero(2, 2);
  MatrixXd B = MatrixXd::Zero(2, 1);
  MatrixXd Ad = A;
  MatrixXd Bd = B;
  const auto message = [&](double dt, const std::string& expected) {
    EXPECT_THAT([&] { workspace.solve(A, B, dt, Ad, Bd); },
                ThrowsMessage<InvalidInput>(HasSubstr(expected)));
  };
  message(0, "zoh: dt is 0 s");
  B(1, 0) = std::numeric_limits<double>::quiet_NaN();
  message(0.1, "zoh: B has nan at (2,1)");
  EXPECT_TRUE(Ad.array().isNaN().all());
  A(0, 0) = -std::numeric_limits<double>::infinity();
  message(0.1, "zoh: A has -inf at (1,1)");
  A = MatrixXd::Zero(3, 3);
  message(0.1, "zoh: A is 3x3, expected 2x2 (the size of the workspace)");
  EXPECT_THAT([] { ZohWorkspace(0, 1); },
              ThrowsMessage<InvalidInput>(HasSubstr("0 states and 1 inputs")));
}

}  // namespace
}  // namespace quadtune
