// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/tustin.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "matrix_near.hpp"
#include "plants/slicot_example.hpp"
#include "quadtune/errors.hpp"
#include "shared_data.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::ThrowsMessage;
using Complex = std::complex<double>;

/// C (zI - A)⁻¹ B + D
template <class Lti>
MatrixXcd response_at(const Lti& lti, Complex z) {
  const MatrixXcd zI = z * MatrixXcd::Identity(lti.A.rows(), lti.A.rows());
  return lti.C.template cast<Complex>() *
             (zI - lti.A).partialPivLu().solve(lti.B.template cast<Complex>()) +
         lti.D;
}

ContinuousLti random_plant(Eigen::Index nx, Eigen::Index nu, Eigen::Index ny,
                           std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  const auto draw = [&] { return normal(generator); };
  ContinuousLti p;
  p.A = MatrixXd::NullaryExpr(nx, nx, draw);
  p.B = MatrixXd::NullaryExpr(nx, nu, draw);
  p.C = MatrixXd::NullaryExpr(ny, nx, draw);
  p.D = MatrixXd::NullaryExpr(ny, nu, draw);
  return p;
}

TEST(DiscretizeTustin, HasThePlantsResponseAtTheWarpedFrequency) {
  std::mt19937_64 generator(4);
  const double dt = 0.1;
  for (const Eigen::Index nx : {1, 3, 8}) {
    const ContinuousLti p = random_plant(nx, 2, 3, generator);
    const DiscreteLti d = discretize_tustin(p, dt);
    for (const double w : {0.1, 1.0, 10.0, 25.0}) {
      const Complex z = std::exp(Complex(0, w * dt));
      const MatrixXcd difference =
          response_at(d, z) - response_at(p, Complex(0, 2 / dt * std::tan(w * dt / 2)));
      EXPECT_LT(difference.norm(), 1e-12 * response_at(d, z).norm());
    }
  }
}

TEST(DiscretizeTustin, IntegratorBecomesTheTrapezoidalRule) {
  ContinuousLti p;
  p.A = MatrixXd{{0}};
  p.B = MatrixXd{{1}};
  p.C = MatrixXd{{1}};
  const DiscreteLti d = discretize_tustin(p, 0.2);
  EXPECT_THAT(d.A, MatrixNear(MatrixXd{{1}}, 0));
  EXPECT_THAT(d.B, MatrixNear(MatrixXd{{0.2}}, 1e-17));
  EXPECT_THAT(d.D, MatrixNear(MatrixXd{{0.1}}, 1e-17));
}

TEST(DiscretizeTustin, KeepsStabilityAtAnyPeriod) {
  ContinuousLti p;
  p.A = MatrixXd{{-1000, 5}, {0, -0.01}};
  p.B = MatrixXd{{1}, {1}};
  for (const double dt : {1e-4, 1.0, 1e4})
    EXPECT_LT(discretize_tustin(p, dt).A.eigenvalues().cwiseAbs().maxCoeff(), 1) << dt;
}

TEST(DiscretizeTustin, WritesOutWhatWasLeftOutAndKeepsNames) {
  ContinuousLti p;
  p.A = MatrixXd{{0, 1}, {0, 0}};
  p.B = MatrixXd{{0}, {1}};
  p.states = {{"z", "m"}, {"vz", "m/s"}};
  p.inputs = {{"az", "m/s^2"}};
  const DiscreteLti d = discretize_tustin(p, 0.1);
  EXPECT_THAT(d.C, MatrixNear(MatrixXd{{1, 0.05}, {0, 1}}, 1e-17));
  EXPECT_THAT(d.D, MatrixNear(MatrixXd{{0.0025}, {0.05}}, 1e-17));
  EXPECT_EQ(d.states, p.states);
  EXPECT_EQ(d.inputs, p.inputs);
  EXPECT_EQ(d.outputs, p.states);
}

// AB04MD halves the factor of B and C between them: B there is B_d / √2, C is √2 C_d at dt = 2.
TEST(DiscretizeTustin, ReproducesSlicotAB04MD) {
  QUADTUNE_REQUIRE_DATA(data);
  const std::filesystem::path folder = data / "known" / "slicot";
  const MatrixXd all = testing::matrix_after(folder / "AB04MD.dat", "1.0D0", 8, 2);
  ContinuousLti p;
  p.A = all.topRows(2);
  p.B = all.middleRows(2, 2).transpose();  // the program reads B, C and D column by column
  p.C = all.middleRows(4, 2).transpose();
  p.D = all.bottomRows(2).transpose();
  const DiscreteLti d = discretize_tustin(p, 2);
  const auto printed = [&](const char* title) {
    return testing::matrix_after(folder / "AB04MD.res", title, 2, 2);
  };
  EXPECT_THAT(d.A, MatrixNear(printed("state matrix is"), 0.51e-4));
  EXPECT_THAT(d.B / std::sqrt(2.0), MatrixNear(printed("input matrix is"), 0.51e-4));
  EXPECT_THAT(d.C * std::sqrt(2.0), MatrixNear(printed("output matrix is"), 0.51e-4));
  EXPECT_THAT(d.D, MatrixNear(printed("input/output matrix is"), 0.51e-4));
}

TEST(DiscretizeTustin, RefusesAPoleThatWouldGoToInfinity) {
  ContinuousLti p;
  p.A = MatrixXd{{200, 1}, {0, -3}};
  p.B = MatrixXd{{1}, {1}};
  EXPECT_THAT([&] { (void)discretize_tustin(p, 0.01); },
              ThrowsMessage<InvalidInput>(
                  HasSubstr("tustin: A has a pole at 200 1/s, expected none at 2/dt because the "
                            "transformation sends it to infinity (dt is 0.01 s)")));
  EXPECT_NO_THROW((void)discretize_tustin(p, 0.011));
}

TEST(DiscretizeTustin, PrewarpedHasThePlantsOwnResponseThere) {
  std::mt19937_64 generator(6);
  const double dt = 0.1;
  const ContinuousLti p = random_plant(6, 2, 3, generator);
  for (const double w : {0.1, 5.0, 25.0, 31.0}) {
    const DiscreteLti d = discretize_tustin(p, dt, w);
    const MatrixXcd theirs = response_at(p, Complex(0, w));
    EXPECT_LT((response_at(d, std::exp(Complex(0, w * dt))) - theirs).norm(),
              1e-12 * theirs.norm());
  }
}

TEST(DiscretizeTustin, RefusesToPrewarpWhereSamplesDoNotReach) {
  ContinuousLti p;
  p.A = MatrixXd{{1}};
  p.B = MatrixXd{{1}};
  for (const double w : {0.0, -1.0, std::numbers::pi / 0.1, 100.0, std::nan("")})
    EXPECT_THAT([&] { (void)discretize_tustin(p, 0.1, w); },
                ThrowsMessage<InvalidInput>(HasSubstr(
                    "rad/s, expected more than 0 and less than 31.4159 rad/s (pi/dt) because")));
}

TEST(DiscretizeTustin, RefusesThePoleThatPrewarpingSendsToInfinity) {
  const double dt = 0.1;
  const double w = 10;
  ContinuousLti p;
  p.A = MatrixXd{{w / std::tan(w * dt / 2)}};
  p.B = MatrixXd{{1}};
  EXPECT_THAT([&] { (void)discretize_tustin(p, dt, w); },
              ThrowsMessage<InvalidInput>(HasSubstr(
                  "tustin: A has a pole at 18.3049 1/s, expected none at w/tan(w dt/2) with w = 10 "
                  "rad/s because")));
  EXPECT_NO_THROW((void)discretize_tustin(p, dt));
}

TEST(DiscretizeTustin, RefusesBadPeriodsAndPlants) {
  ContinuousLti p;
  p.A = MatrixXd{{1}};
  p.B = MatrixXd{{1}};
  EXPECT_THAT([&] { (void)discretize_tustin(p, 0); },
              ThrowsMessage<InvalidInput>(HasSubstr("tustin: dt is 0 s, expected a positive")));
  p.B = MatrixXd(2, 1);
  EXPECT_THAT([&] { (void)discretize_tustin(p, 1); },
              ThrowsMessage<InvalidInput>(HasSubstr("tustin: B is 2x1")));
}

}  // namespace
}  // namespace quadtune
