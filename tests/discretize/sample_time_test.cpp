// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/sample_time.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <complex>

#include "matrix_near.hpp"
#include "plants/hover_model.hpp"
#include "quadtune/discretize/euler.hpp"
#include "quadtune/discretize/tustin.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;
using Complex = std::complex<double>;

TEST(SampleTime, WarnsOfEveryFastPoleOnce) {
  const Eigen::VectorXcd poles =
      (Eigen::VectorXcd(6) << -1, Complex(-30, 40), Complex(-30, -40), -120, -120, -50).finished();
  EXPECT_THAT(
      sample_time_warnings(poles, 0.01),
      ElementsAre("the pole at -120 1/s is fast for dt = 0.01 s: |pole| dt is 1.2, expected at "
                  "most 0.5; use dt <= 0.00417 s"));
  EXPECT_THAT(sample_time_warnings(poles, 0.0101),
              ElementsAre(HasSubstr("the pole at -120 1/s is"),
                          HasSubstr("the poles at -30 +- 40i 1/s are"),
                          HasSubstr("the pole at -50 1/s is")));
}

TEST(SampleTime, CountsWhatIsLessFast) {
  const Eigen::VectorXcd poles = Eigen::VectorXd::LinSpaced(600, -1000, -401);
  const std::vector<std::string> warnings = sample_time_warnings(poles, 0.01);
  ASSERT_EQ(warnings.size(), 5U);
  EXPECT_THAT(warnings.front(), HasSubstr("the pole at -1000 1/s is"));
  EXPECT_EQ(warnings.back(), "596 more poles or pairs are fast for dt = 0.01 s, but less so");
  EXPECT_EQ(sample_time_warnings(poles.head(5), 0.01).back(),
            "1 more pole or pair of poles is fast for dt = 0.01 s, but less so");
}

TEST(SampleTime, TakesPlantsAndTransferFunctions) {
  ContinuousLti plant;
  plant.A = MatrixXd{{-1, 7}, {0, -200}};
  plant.B = MatrixXd{{0}, {1}};
  EXPECT_THAT(sample_time_warnings(plant, 0.01), ElementsAre(HasSubstr("-200 1/s")));
  EXPECT_THAT(sample_time_warnings(plant, 0.002), IsEmpty());
  EXPECT_THAT(sample_time_warnings(testing::uquad_hover(), 10.0), IsEmpty());
  const ContinuousTransferFunction fraction{Eigen::VectorXd::Ones(1), Eigen::Vector2d(1, 200)};
  EXPECT_THAT(sample_time_warnings(fraction, 0.01), ElementsAre(HasSubstr("-200 1/s")));
  EXPECT_THAT([&] { (void)sample_time_warnings(plant, 0); },
              ThrowsMessage<InvalidInput>(HasSubstr("dt is 0 s, expected a positive")));
}

/// Hover of the uquad with a cascade around it: attitude at 10 rad/s, position at 2 rad/s, height
/// and yaw between; poles from 1.4 to 10 rad/s.
ContinuousLti closed_loop() {
  ContinuousLti plant = testing::uquad_hover();
  const double g = 9.81;
  // Accelerations vz, wqx, wqy, wqz that the cascade asks for, from x y z psi phi theta and rates.
  MatrixXd wanted = MatrixXd::Zero(4, 12);
  wanted(0, 2) = -9;
  wanted(0, 8) = -4;
  wanted.row(1) << 0, 100 * 4 / g, 0, -100, 0, 0, 0, 100 * 2.5 / g, 0, -14, 0, 0;
  wanted.row(2) << -100 * 3 / g, 0, 0, 0, -100, 0, -100 * 2 / g, 0, 0, 0, -13, 0;
  wanted(3, 5) = -5;
  wanted(3, 11) = -6;
  plant.A += plant.B * plant.B.bottomRows(4).partialPivLu().solve(wanted);
  return plant;
}

/// Largest distance of log(z)/dt, z a pole of the discrete loop, from the continuous pole nearest
/// to it [1/s].
double pole_error(const Eigen::VectorXcd& poles, const MatrixXd& discrete, double dt) {
  double worst = 0;
  for (const Complex& z : Eigen::VectorXcd(discrete.eigenvalues()))
    worst = std::max(worst, (poles.array() - std::log(z) / dt).abs().minCoeff());
  return worst;
}

/// Slope of the least-squares line through log error over log dt, for dt from 0.1 ms to 2 ms.
template <class Discretize>
double error_slope(const Discretize& method) {
  const ContinuousLti loop = closed_loop();
  const Eigen::VectorXcd poles = loop.A.eigenvalues();
  EXPECT_LT(poles.real().maxCoeff(), -0.5);
  constexpr int kPoints = 12;
  Eigen::VectorXd x(kPoints);
  Eigen::VectorXd y(kPoints);
  for (int i = 0; i < kPoints; ++i) {
    const double dt = 1e-4 * std::pow(20.0, i / (kPoints - 1.0));
    x[i] = std::log(dt);
    y[i] = std::log(pole_error(poles, method(loop, dt).A, dt));
  }
  x.array() -= x.mean();
  return x.dot(y) / x.squaredNorm();
}

TEST(SampleTime, ErrorOfTheLoopsPolesIsOfFirstOrderByEulerAndOfSecondByTustin) {
  EXPECT_NEAR(error_slope([](const auto& p, double dt) { return discretize_euler(p, dt); }), 1,
              0.05);
  EXPECT_NEAR(error_slope([](const auto& p, double dt) { return discretize_tustin(p, dt); }), 2,
              0.05);
}

}  // namespace
}  // namespace quadtune
