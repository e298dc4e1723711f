// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/extended_kalman_filter.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/angles.hpp"
#include "quadtune/estimation/kalman_filter.hpp"
#include "quadtune/model/rotation.hpp"
#include "uniform_matrix.hpp"

namespace quadtune {
namespace {

using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;
using testing::MatrixNear;
using ::testing::ThrowsMessage;
using testing::uniform_matrix;
using testing::uniform_vector;

// A pendulum with a torque: the angle [rad] and its rate, by a step of semi-implicit Euler.
struct Pendulum {
  double stiffness = 9.81 / 0.7;  // g/l
  template <class T>
  ModelVector<T> operator()(const ModelVector<T>& x, double torque, double dt) const {
    using std::sin;
    const T rate = x(1) + dt * (torque - stiffness * sin(x(0)));
    return ModelVector<T>{{x(0) + dt * rate, rate}};
  }
  [[nodiscard]] Matrix2d jacobian(const VectorXd& x, double dt) const {
    const double slope = -dt * stiffness * std::cos(x(0));
    return Matrix2d{{1 + dt * slope, dt}, {slope, 1}};
  }
};

// Position and velocity in a plane; a beacon at the origin measures range and bearing.
struct Motion {
  template <class T, class Input>
  ModelVector<T> operator()(const ModelVector<T>& x, const Input&, double dt) const {
    return ModelVector<T>{{x(0) + dt * x(2), x(1) + dt * x(3), x(2), x(3)}};
  }
};
struct RangeAndBearing {
  template <class T, class Input>
  ModelVector<T> operator()(const ModelVector<T>& x, const Input&) const {
    using std::atan2, std::hypot;
    return ModelVector<T>{{hypot(x(0), x(1)), atan2(x(1), x(0))}};
  }
};
// A bearing may be just beyond ±π.
VectorXd wrapped_bearing(const VectorXd& y, const VectorXd& expected) {
  return Vector2d(y(0) - expected(0), wrap_angle(y(1) - expected(1)));
}

// The measurement of the angle alone, as one number.
const auto kAngle = [](const auto& x, const auto&) { return x(0); };

MatrixXd random_positive(Eigen::Index n, std::mt19937_64& random) {
  const MatrixXd root = uniform_matrix(n, n, random);
  return root * root.transpose() + 0.1 * MatrixXd::Identity(n, n);
}

// 5 states: the derivatives take two passes.
TEST(ExtendedKalmanFilter, EqualsTheLinearFilterForALinearModel) {
  std::mt19937_64 random(1);
  KalmanModel<double, 5, 2> model;
  model.F = 0.5 * uniform_matrix(5, 5, random);
  model.G = uniform_matrix(5, 2, random);
  model.Q = random_positive(5, random);
  const MatrixXd C = uniform_matrix(2, 5, random), R = random_positive(2, random);
  KalmanState<double, 5> linear;
  linear.x = uniform_vector(5, random);
  linear.P = random_positive(5, random);
  ExtendedKalmanFilter filter(linear.x, linear.P);
  const auto f = [&](const auto& x, const VectorXd& u, double) {
    return std::remove_cvref_t<decltype(x)>(model.F * x + model.G * u);
  };
  const auto h = [&](const auto& x, const VectorXd&) {
    return std::remove_cvref_t<decltype(x)>(C * x);
  };
  for (int step = 0; step < 100; ++step) {
    const Vector2d u = uniform_vector(2, random), y = uniform_vector(2, random);
    predict(model, linear, u);
    filter.predict(f, VectorXd(u), 0.01, model.Q);
    EXPECT_THAT(filter.x(), MatrixNear(linear.x, 1e-13));
    EXPECT_THAT(filter.P(), MatrixNear(linear.P, 1e-13));
    const VectorXd e = y - C * linear.x;
    const MatrixXd S = C * linear.P * C.transpose() + R;
    const KalmanUpdate<double> expected =
        update(linear, Eigen::Matrix<double, 2, 5>(C), y, Matrix2d(R), true);
    const ExtendedUpdate got = filter.update(h, {}, y, R);
    EXPECT_TRUE(got.used);
    EXPECT_THAT(filter.x(), MatrixNear(linear.x, 1e-13));
    EXPECT_THAT(filter.P(), MatrixNear(linear.P, 1e-13));
    EXPECT_THAT(got.H, MatrixNear(C, 0));
    EXPECT_THAT(got.innovation, MatrixNear(e, 1e-13));
    EXPECT_THAT(got.S, MatrixNear(S, 1e-13));
    EXPECT_NEAR(got.innovation_square, expected.innovation_square, 1e-12);
  }
}

TEST(ExtendedKalmanFilter, EqualsHandWrittenJacobians) {
  std::mt19937_64 random(2);
  const Pendulum pendulum;
  for (int trial = 0; trial < 20; ++trial) {
    const VectorXd x = 3 * uniform_vector(2, random);
    const MatrixXd P = random_positive(2, random), Q = random_positive(2, random);
    ExtendedKalmanFilter filter(x, P);
    filter.predict(pendulum, 0.3, 0.02, Q);
    const Matrix2d F = pendulum.jacobian(x, 0.02);
    EXPECT_THAT(filter.x(), MatrixNear(pendulum(ModelVector<double>(x), 0.3, 0.02), 0));
    EXPECT_THAT(filter.P(), MatrixNear(F * P * F.transpose() + Q, 1e-14));

    const VectorXd plane = uniform_vector(4, random);
    ExtendedKalmanFilter tracker(plane, MatrixXd::Identity(4, 4));
    const ExtendedUpdate update =
        tracker.update(RangeAndBearing{}, {}, Vector2d(1, 0), Matrix2d::Identity());
    const double r = plane.head<2>().norm();
    MatrixXd H = MatrixXd::Zero(2, 4);
    H.topLeftCorner<2, 2>() << plane(0) / r, plane(1) / r, -plane(1) / (r * r), plane(0) / (r * r);
    EXPECT_THAT(update.H, MatrixNear(H, 1e-14 / (r * r)));
    MatrixXd differences(2, 4);
    for (Eigen::Index j = 0; j < 4; ++j) {
      const VectorXd step = 1e-5 * r * VectorXd::Unit(4, j);
      const RangeAndBearing h;
      differences.col(j) = wrapped_bearing(h(ModelVector<double>(plane + step), 0),
                                           h(ModelVector<double>(plane - step), 0)) /
                           (2e-5 * r);
    }
    EXPECT_THAT(update.H, MatrixNear(differences, 1e-9 / r + 1e-10));
  }
}

// One state: S = P + R, and the density of N(0, S). The gain is P/S, and the variance P R/S.
TEST(ExtendedKalmanFilter, UpdatesOneStateInClosedForm) {
  ExtendedKalmanFilter filter(VectorXd::Constant(1, 1.0), MatrixXd::Constant(1, 1, 4.0));
  const ExtendedUpdate update =
      filter.update(kAngle, {}, VectorXd::Constant(1, 3.0), MatrixXd::Constant(1, 1, 1.0));
  EXPECT_DOUBLE_EQ(update.innovation(0), 2);
  EXPECT_DOUBLE_EQ(update.S(0, 0), 5);
  EXPECT_DOUBLE_EQ(update.innovation_square, 0.8);
  EXPECT_DOUBLE_EQ(std::exp(update.log_likelihood),
                   std::exp(-0.4) / std::sqrt(2 * std::numbers::pi * 5));
  EXPECT_DOUBLE_EQ(filter.x()(0), 2.6);
  EXPECT_DOUBLE_EQ(filter.P()(0, 0), 0.8);
}

// Two measurements at once, and one after the other: the same estimate, and the joint density is
// the product of the densities.
TEST(ExtendedKalmanFilter, LikelihoodsOfIndependentMeasurementsMultiply) {
  std::mt19937_64 random(4);
  const MatrixXd C = uniform_matrix(2, 3, random), P = random_positive(3, random);
  const VectorXd y = uniform_vector(2, random);
  const auto h = [&](const auto& x, const auto&) {
    return std::remove_cvref_t<decltype(x)>(C * x);
  };
  ExtendedKalmanFilter joint(VectorXd::Zero(3), P), single(VectorXd::Zero(3), P);
  const Vector2d R(0.2, 0.5);
  const ExtendedUpdate both = joint.update(h, {}, y, R.asDiagonal());
  double log_likelihood = 0;
  for (Eigen::Index i = 0; i < 2; ++i)
    log_likelihood += single
                          .update([&](const auto& x, const auto& u) { return h(x, u)(i); }, {},
                                  y.segment(i, 1), MatrixXd::Constant(1, 1, R(i)))
                          .log_likelihood;
  EXPECT_NEAR(both.log_likelihood, log_likelihood, 1e-13);
  EXPECT_THAT(joint.x(), MatrixNear(single.x(), 1e-14));
  EXPECT_THAT(joint.P(), MatrixNear(single.P(), 1e-14));
}

// The mean of eᵀ S⁻¹ e over n updates is ny ± √(2 ny / n).
TEST(ExtendedKalmanFilter, IsConsistentForAPendulum) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const Pendulum pendulum;
  const double dt = 0.01, deviation = 0.02;
  const MatrixXd Q = Vector2d(0, 1e-4).asDiagonal();
  const MatrixXd R = MatrixXd::Constant(1, 1, deviation * deviation);
  const auto sine = [](const auto& x, const auto&) {
    using std::sin;
    return sin(x(0));
  };
  ModelVector<double> truth{{0.8, 0.0}};
  ExtendedKalmanFilter filter(Vector2d(0.8 + 0.1 * normal(random), 0.1 * normal(random)),
                              0.01 * Matrix2d::Identity());
  const int steps = 5000;
  double sum = 0, error_sum = 0;
  for (int k = 0; k < steps; ++k) {
    const double torque = std::sin(0.01 * k);
    truth = pendulum(truth, torque, dt);
    truth(1) += 0.01 * normal(random);
    filter.predict(pendulum, torque, dt, Q);
    const VectorXd y = VectorXd::Constant(1, std::sin(truth(0)) + deviation * normal(random));
    sum += filter.update(sine, torque, y, R).innovation_square;
    const VectorXd error = filter.x() - truth;
    error_sum += error.dot(filter.P().inverse() * error);
  }
  EXPECT_NEAR(sum / steps, 1, 4 * std::sqrt(2.0 / steps));
  EXPECT_NEAR(error_sum / steps, 2, 0.5);  // errors of successive steps are correlated
}

// A circle about the beacon: the bearing passes ±π in each turn.
TEST(ExtendedKalmanFilter, IsConsistentForRangeAndBearing) {
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal;
  const double dt = 0.1, q = 0.05;  // [s], [m/s] per step
  const Vector2d deviations(0.1, 0.01);
  const MatrixXd R = deviations.cwiseAbs2().asDiagonal();
  const MatrixXd Q = Eigen::Vector4d(0, 0, q * q, q * q).asDiagonal();
  const RangeAndBearing h;
  ModelVector<double> truth{{10.0, 0.0, 0.0, 2.0}};
  ExtendedKalmanFilter filter(
      truth + 0.1 * VectorXd::NullaryExpr(4, [&] { return normal(random); }),
      0.01 * MatrixXd::Identity(4, 4));
  const int steps = 4000;
  double sum = 0;
  int crossings = 0;
  for (int k = 0; k < steps; ++k) {
    // Pulled toward the beacon by a known acceleration, so that it stays near.
    const Vector2d pull = -0.04 * truth.head<2>();
    const auto pulled = [&](const auto& x, const Vector2d& u, double period) {
      std::remove_cvref_t<decltype(x)> next = Motion{}(x, u, period);
      next(2) += period * u(0);
      next(3) += period * u(1);
      return next;
    };
    const double before = truth(1);
    truth = pulled(truth, pull, dt);
    crossings += truth(0) < 0 && before * truth(1) < 0;
    truth.tail<2>() += q * Vector2d(normal(random), normal(random));
    filter.predict(pulled, pull, dt, Q);
    Vector2d y = h(truth, 0);
    y += deviations.cwiseProduct(Vector2d(normal(random), normal(random)));
    y(1) = wrap_angle(y(1));
    sum += filter.update(h, {}, y, R, {.innovation = wrapped_bearing}).innovation_square;
  }
  EXPECT_GT(crossings, 5);
  EXPECT_NEAR(sum / steps, 2, 4 * std::sqrt(4.0 / steps));
}

TEST(ExtendedKalmanFilter, GateRejectsAnOutlierAndChangesNothing) {
  ExtendedKalmanFilter filter(Vector2d(0.1, 0), Matrix2d::Identity());
  const MatrixXd R = MatrixXd::Constant(1, 1, 1);
  const VectorXd outlier = VectorXd::Constant(1, 5.1);  // e² / S = 12.5
  const ExtendedUpdate rejected = filter.update(kAngle, {}, outlier, R, {.gate = 12.4});
  EXPECT_FALSE(rejected.used);
  EXPECT_DOUBLE_EQ(rejected.innovation_square, 12.5);
  EXPECT_TRUE(std::isfinite(rejected.log_likelihood));
  EXPECT_THAT(filter.x(), MatrixNear(Vector2d(0.1, 0), 0));
  EXPECT_THAT(filter.P(), MatrixNear(Matrix2d::Identity(), 0));
  EXPECT_TRUE(filter.update(kAngle, {}, outlier, R, {.gate = 12.6}).used);
  EXPECT_DOUBLE_EQ(filter.x()(0), 2.6);
}

// An attitude as a quaternion, turned by a gyroscope and corrected by the direction of gravity.
TEST(ExtendedKalmanFilter, CorrectionKeepsAQuaternionAtUnitLength) {
  ExtendedKalmanFilter filter(Eigen::Vector4d(1, 0, 0, 0), 0.01 * MatrixXd::Identity(4, 4),
                              [](VectorXd& q) { q.normalize(); });
  const auto turn = [](const auto& q, const Eigen::Vector3d& w, double dt) {
    auto next = q;
    next(0) += 0.5 * dt * (-q(1) * w(0) - q(2) * w(1) - q(3) * w(2));
    next(1) += 0.5 * dt * (q(0) * w(0) + q(2) * w(2) - q(3) * w(1));
    next(2) += 0.5 * dt * (q(0) * w(1) + q(3) * w(0) - q(1) * w(2));
    next(3) += 0.5 * dt * (q(0) * w(2) + q(1) * w(1) - q(2) * w(0));
    return next;
  };
  const auto down = [](const auto& q, const auto&) {  // the third row of R_WB
    return std::remove_cvref_t<decltype(q)>{{2.0 * (q(1) * q(3) - q(0) * q(2)),
                                             2.0 * (q(2) * q(3) + q(0) * q(1)),
                                             1.0 - 2.0 * (q(1) * q(1) + q(2) * q(2))}};
  };
  const MatrixXd Q = 1e-6 * MatrixXd::Identity(4, 4), R = 1e-4 * MatrixXd::Identity(3, 3);
  for (int k = 0; k < 200; ++k) {
    filter.predict(turn, Eigen::Vector3d(0.1, 0, 0), 0.01, Q);
    EXPECT_NEAR(filter.x().norm(), 1, 1e-15);
    const double roll = 0.3 + 0.1 * 0.01 * (k + 1);  // the filter starts 0.3 rad off
    filter.update(down, {}, Eigen::Vector3d(0, std::sin(roll), std::cos(roll)), R);
    EXPECT_NEAR(filter.x().norm(), 1, 1e-15);
  }
  EXPECT_NEAR(2 * std::atan2(filter.x()(1), filter.x()(0)), 0.5, 1e-3);
}

TEST(ExtendedKalmanFilter, RejectsWrongSettings) {
  const double nan = std::nan("");
  const auto make = [](const VectorXd& x0, const MatrixXd& P0) {
    return [x0, P0] { ExtendedKalmanFilter(x0, P0); };
  };
  const MatrixXd I = Matrix2d::Identity();
  EXPECT_THAT(
      make(VectorXd(), I),
      ThrowsMessage<InvalidInput>("extended filter: x0 is empty, expected at least one state"));
  EXPECT_THAT(
      make(Vector2d(0, nan), I),
      ThrowsMessage<InvalidInput>("extended filter: x0 has nan at (2,1), expected finite numbers"));
  EXPECT_THAT(make(Vector2d::Zero(), MatrixXd::Identity(3, 3)),
              ThrowsMessage<InvalidInput>(
                  "extended filter: P0 is 3x3, expected 2x2 (the filter has 2 states)"));
  EXPECT_THAT(
      make(Vector2d::Zero(), nan * I),
      ThrowsMessage<InvalidInput>("extended filter: P0 has nan at (1,1), expected finite numbers"));
  EXPECT_THAT(
      make(Vector2d::Zero(), Matrix2d{{1, 0.5}, {0.4, 1}}),
      ThrowsMessage<InvalidInput>(::testing::HasSubstr("extended filter: P0 is not symmetric")));
  EXPECT_THAT(make(Vector2d::Zero(), Matrix2d{{1e6, 0}, {0, -1e-9}}),
              ThrowsMessage<InvalidInput>("extended filter: P0 has the variance -1e-09 at (2,2), "
                                          "expected P0 >= 0 because it is a covariance"));
  EXPECT_THAT(make(Vector2d::Zero(), Matrix2d{{1e6, 2}, {2, 1e-6}}),
              ThrowsMessage<InvalidInput>(
                  "extended filter: P0 has a correlation matrix with the eigenvalue -1, expected "
                  "P0 >= 0 because it is a covariance"));
  EXPECT_THAT(make(Vector2d::Zero(), Matrix2d{{1, 1}, {1, 0}}),
              ThrowsMessage<InvalidInput>(::testing::HasSubstr(
                  "P0 has a covariance of a quantity without variance in row 2")));
  EXPECT_NO_THROW(make(Vector2d::Zero(), Matrix2d::Zero())());
  EXPECT_NO_THROW(make(Vector2d::Zero(), Matrix2d::Ones())());
}

// After each of these, the filter is as before.
TEST(ExtendedKalmanFilter, RejectsWrongStepsAndStaysAsItWas) {
  const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
  ExtendedKalmanFilter filter(Vector2d(0.2, 0.3), Matrix2d{{2, 0.1}, {0.1, 1}});
  const VectorXd x = filter.x();
  const MatrixXd P = filter.P(), I = Matrix2d::Identity(), one = MatrixXd::Ones(1, 1);
  const auto rejects = [&](const auto& call, const std::string& message) {
    EXPECT_THAT(call, ThrowsMessage<InvalidInput>(::testing::HasSubstr(message)));
    EXPECT_THAT(filter.x(), MatrixNear(x, 0));
    EXPECT_THAT(filter.P(), MatrixNear(P, 0));
  };
  const Pendulum f;
  for (const double dt : {nan, infinite, 0.0, -0.1})
    rejects([&] { filter.predict(f, 0.0, dt, I); }, "expected a positive number");
  rejects([&] { filter.predict(f, 0.0, 0.01, nan * I); }, "Q has nan at (1,1)");
  rejects([&] { filter.predict(f, 0.0, 0.01, -I); }, "Q has the variance -1 at (1,1)");
  rejects([&] { filter.predict(f, 0.0, 0.01, one); }, "Q is 1x1, expected 2x2");
  rejects([&] { filter.predict(f, nan, 0.01, I); }, "f(x, u, dt) has nan at (1,1)");
  const auto twice = [](const auto& x0, int, double) {
    return std::remove_cvref_t<decltype(x0)>(x0.replicate(2, 1));
  };
  rejects([&] { filter.predict(twice, 0, 0.01, I); }, "f(x, u, dt) is 4x1, expected 2x1");
  const auto kink = [](const auto& x0, double, double) {
    using std::sqrt;
    auto next = x0;
    next(0) = sqrt(x0(0) - x0(0));
    return next;
  };
  rejects([&] { filter.predict(kink, 0.0, 0.01, I); }, "the Jacobian of f has ");
  const auto large = [](const auto& x0, double, double) {
    return std::remove_cvref_t<decltype(x0)>(1e200 * x0);
  };
  rejects([&] { filter.predict(large, 0.0, 0.01, I); }, "the new P has inf");

  const VectorXd y = VectorXd::Constant(1, 0.5);
  rejects([&] { filter.update(kAngle, {}, nan * y, one); }, "y has nan at (1,1)");
  rejects([&] { filter.update(kAngle, {}, VectorXd(), one); }, "y is empty");
  rejects([&] { filter.update(kAngle, {}, y, nan * one); }, "R has nan at (1,1)");
  rejects([&] { filter.update(kAngle, {}, y, -one); }, "R has the variance -1 at (1,1)");
  rejects([&] { filter.update(kAngle, {}, y, 0 * one); }, "expected R > 0");
  rejects([&] { filter.update(kAngle, {}, y, I); }, "R is 2x2, expected 1x1 (y has 1 row)");
  rejects([&] { filter.update(kAngle, {}, Vector2d(1, 2), I); },
          "h(x, u) is 1x1, expected 2x1 (y has 2 rows)");
  rejects([&] { filter.update(kAngle, {}, Vector2d(1, 2), Matrix2d::Ones()); },
          "R has a correlation matrix with the eigenvalue");
  for (const double gate : {nan, 0.0, -1.0})
    rejects([&] { filter.update(kAngle, {}, y, one, {.gate = gate}); }, "gate is ");
  const auto root = [](const auto& x0, const auto&) {
    using std::sqrt;
    return sqrt(x0(0) - 1.0);
  };
  rejects([&] { filter.update(root, {}, y, one); }, "h(x, u) has ");
  const auto innovation = [](const VectorXd& value) {
    return ExtendedUpdateOptions{
        .innovation = [value](const VectorXd&, const VectorXd&) { return value; }};
  };
  rejects([&] { filter.update(kAngle, {}, y, one, innovation(nan * y)); },
          "the innovation has nan");
  rejects([&] { filter.update(kAngle, {}, y, one, innovation(x)); },
          "the innovation is 2x1, expected 1x1");
  rejects([&] { filter.update(kAngle, {}, 1e200 * y, one); }, "the innovation exceeds");

  ExtendedKalmanFilter corrected(x, P, [](VectorXd& state) { state.setConstant(std::nan("")); });
  EXPECT_THAT([&] { corrected.predict(f, 0.0, 0.01, I); },
              ThrowsMessage<InvalidInput>(::testing::HasSubstr("the new x has nan")));
}

}  // namespace
}  // namespace quadtune
