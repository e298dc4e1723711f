// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/kalman_filter.hpp"

#include <gmock/gmock.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "matrix_near.hpp"
#include "numbers.hpp"
#include "pack_functions.hpp"
#include "shared_data.hpp"

namespace quadtune {
namespace {

using testing::lane_of;
using testing::MatrixNear;
using Row2 = Eigen::Matrix<double, 1, 2>;
using testing::kInfinity;
using testing::kNaN;

template <class T>
KalmanModel<T, 2, 1> altitude_model() {
  KalmanModel<T, 2, 1> model;
  model.F(0, 1) = T(0.005);
  model.G(1, 0) = T(0.005);
  model.Q(1, 1) = T(0.0005);
  return model;
}

template <int nx>
class RandomFilter {
 public:
  explicit RandomFilter(unsigned seed) : random_(seed) {}
  double number() { return std::normal_distribution<double>()(random_); }
  template <int rows, int cols>
  Eigen::Matrix<double, rows, cols> matrix() {
    Eigen::Matrix<double, rows, cols> M;
    for (int i = 0; i < rows * cols; ++i) M(i) = number();
    return M;
  }
  KalmanState<double, nx> state() {
    KalmanState<double, nx> s;
    s.x = matrix<nx, 1>();
    const Eigen::Matrix<double, nx, nx> root = matrix<nx, nx>();
    s.P = root * root.transpose();
    return s;
  }

 private:
  std::mt19937_64 random_;
};

TEST(KalmanFilter, SettlesOnTheMambosPublishedGains) {
  QUADTUNE_REQUIRE_DATA(data);
  std::ifstream file(data / "known" / "mambo_kalman.json");
  const auto known = nlohmann::json::parse(file).at("cases");
  const auto number = [](const nlohmann::json& j) { return std::stod(j.get<std::string>()); };

  const KalmanModel<double, 2, 1> model = altitude_model<double>();
  KalmanState<double, 2> state;
  Eigen::Vector2d gain;
  for (int k = 0; k < 20000; ++k) {
    predict(model, state, Eigen::Matrix<double, 1, 1>(0.0));
    gain = state.P.col(0) / (state.P(0, 0) + 0.1);
    if (k < 19999) update(state, Row2(1, 0), 0, 0.1, true);
  }
  const auto& altitude = known.at(0).at("reference50");
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(gain(i), number(altitude.at("M").at(i).at(0)), 1e-15);
    for (int j = 0; j < 2; ++j)
      EXPECT_NEAR(state.P(i, j), number(altitude.at("P").at(i).at(j)), 1e-16);
  }
  update(state, Row2(1, 0), 0, 0.1, true);
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      EXPECT_NEAR(state.P(i, j), number(altitude.at("Z").at(i).at(j)), 1e-16);

  KalmanModel<double, 2, 2> horizontal;
  horizontal.Q = 0.09 * Eigen::Matrix2d::Identity();
  KalmanState<double, 2> velocity;
  for (int k = 0; k < 1000; ++k) {
    predict(horizontal, velocity, Eigen::Vector2d::Zero());
    update(velocity, Eigen::Matrix2d::Identity(), Eigen::Vector2d::Zero(),
           5 * Eigen::Matrix2d::Identity(), true);
  }
  const double Z = number(known.at(1).at("reference50").at("Z").at(0).at(0));
  EXPECT_THAT(velocity.P, MatrixNear(Eigen::Matrix2d(Z * Eigen::Matrix2d::Identity()), 1e-15));
}

// A random walk seen in noise: P = (Q + √(Q² + 4 Q R))/2 before the measurement.
TEST(KalmanFilter, SettlesOnTheClosedFormOfARandomWalk) {
  KalmanModel<double, 1, 1> model;
  model.Q(0, 0) = 0.09;
  KalmanState<double, 1> state;
  using One = Eigen::Matrix<double, 1, 1>;
  for (int k = 0; k < 500; ++k) {
    predict(model, state, One(0.0));
    update(state, One(1.0), 0, 5, true);
  }
  predict(model, state, One(0.0));
  EXPECT_NEAR(state.P(0, 0), (0.09 + std::sqrt(0.09 * 0.09 + 4 * 0.09 * 5)) / 2, 1e-15);
}

// A constant measured n times, nothing known before: the mean, and R/n.
TEST(KalmanFilter, AveragesAConstant) {
  KalmanState<double, 1> state;
  state.P(0, 0) = 1e12;
  using One = Eigen::Matrix<double, 1, 1>;
  for (const double y : {3.0, 5.0, 1.0, 7.0}) update(state, One(1.0), y, 2, true);
  EXPECT_NEAR(state.x(0), 4, 1e-10);
  EXPECT_NEAR(state.P(0, 0), 0.5, 1e-10);
}

TEST(KalmanFilter, JosephEqualsThePlainForm) {
  RandomFilter<3> random(1);
  for (int trial = 0; trial < 100; ++trial) {
    const KalmanState<double, 3> before = random.state();
    const Eigen::Matrix<double, 2, 3> C = random.matrix<2, 3>();
    const Eigen::Vector2d y = random.matrix<2, 1>();
    const Eigen::Matrix2d root = random.matrix<2, 2>();
    const Eigen::Matrix2d R = root * root.transpose() + 0.1 * Eigen::Matrix2d::Identity();
    const Eigen::Matrix2d S = C * before.P * C.transpose() + R;
    const Eigen::Matrix<double, 3, 2> K = before.P * C.transpose() * S.inverse();
    const double scale = before.P.norm() + 1;

    KalmanState<double, 3> pair = before;
    const auto both_used = update(pair, C, y, R, true);
    EXPECT_TRUE(both_used.used);
    const Eigen::Vector2d e = y - C * before.x;
    EXPECT_NEAR(both_used.innovation_square, e.dot(S.inverse() * e), 1e-11 * scale);
    EXPECT_THAT(pair.x, MatrixNear(before.x + K * e, 1e-12 * scale));
    EXPECT_THAT(pair.P, MatrixNear(before.P - K * C * before.P, 1e-12 * scale));

    KalmanState<double, 3> single = before;
    update(single, C.row(0), y(0), R(0, 0), true);
    const Eigen::Vector3d k = before.P * C.row(0).transpose() / S(0, 0);
    EXPECT_THAT(single.x, MatrixNear(before.x + k * e(0), 1e-12 * scale));
    EXPECT_THAT(single.P, MatrixNear(before.P - k * C.row(0) * before.P, 1e-12 * scale));
  }
}

// With independent noises, one after the other is both at once; and so is the sparse form.
TEST(KalmanFilter, OneAfterTheOtherEqualsBothAtOnce) {
  RandomFilter<3> random(2);
  for (int trial = 0; trial < 100; ++trial) {
    const KalmanState<double, 3> before = random.state();
    Eigen::Matrix<double, 2, 3> C = random.matrix<2, 3>();
    C(0, 1) = 0;
    C(1, 0) = 0;
    const Eigen::Vector2d y = random.matrix<2, 1>();
    const Eigen::Matrix2d R = Eigen::Vector2d(0.3, 2).asDiagonal();
    KalmanState<double, 3> pair = before;
    KalmanState<double, 3> sequence = before;
    KalmanState<double, 3> sparse = before;
    update(pair, C, y, R, true);
    for (int i = 0; i < 2; ++i) update(sequence, C.row(i), y(i), R(i, i), true);
    const SparseRow<double, 2> rows[] = {{{0, 2}, {C(0, 0), C(0, 2)}},
                                         {{1, 2}, {C(1, 1), C(1, 2)}}};
    for (int i = 0; i < 2; ++i) update(sparse, rows[i], y(i) - C.row(i) * sparse.x, R(i, i), true);
    const double scale = before.P.norm() + 1;
    EXPECT_THAT(sequence.x, MatrixNear(pair.x, 1e-12 * scale));
    EXPECT_THAT(sequence.P, MatrixNear(pair.P, 1e-12 * scale));
    EXPECT_THAT(sparse.x, MatrixNear(pair.x, 1e-12 * scale));
    EXPECT_THAT(sparse.P, MatrixNear(pair.P, 1e-12 * scale));
  }
}

// Very good measurements of a badly known state: P - K C P loses its sign in single precision.
TEST(KalmanFilter, JosephStaysSymmetricAndPositive) {
  RandomFilter<3> random(3);
  constexpr double kLarge = 1e3;  // against 10⁻²: five of the seven digits there are
  int plain_failures = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const KalmanState<double, 3> start = random.state();
    KalmanState<float, 3> state;
    state.P = ((start.P + Eigen::Matrix3d::Identity()) * kLarge).cast<float>();
    Eigen::Matrix3f plain = state.P;
    for (int k = 0; k < 5; ++k) {
      const Eigen::Matrix<float, 1, 3> C = random.matrix<1, 3>().cast<float>();
      update(state, C, 0, 1e-2F, true);
      const Eigen::Vector3f K = plain * C.transpose() / ((C * plain * C.transpose())(0) + 1e-2F);
      plain -= Eigen::Matrix3f(K * C * plain);
    }
    EXPECT_EQ((state.P - state.P.transpose()).norm(), 0.0F);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(state.P.cast<double>());
    EXPECT_GT(eigen.eigenvalues()(0), 0) << "trial " << trial;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen_plain(
        Eigen::Matrix3d(0.5 * (plain + plain.transpose()).cast<double>()));
    plain_failures += eigen_plain.eigenvalues()(0) <= 0;
  }
  EXPECT_GT(plain_failures, 0) << "the problem is too easy to tell the forms apart";
}

TEST(KalmanFilter, LeavesAllAsItIsWithoutABelievableMeasurement) {
  RandomFilter<3> random(4);
  const KalmanState<double, 3> before = random.state();
  const auto unchanged = [&](const KalmanState<double, 3>& after) {
    return (after.x.array() == before.x.array()).all() &&
           (after.P.array() == before.P.array()).all();
  };
  const Eigen::Matrix<double, 1, 3> C(1, 0, 0);
  const Eigen::Matrix<double, 2, 3> CC = Eigen::Matrix<double, 2, 3>::Identity();
  const Eigen::Matrix2d RR = Eigen::Matrix2d::Identity();
  const SparseRow<double, 1> sparse = {{0}, {1.0}};
  KalmanState<double, 3> after = before;
  const double far = before.x(0) + 100;
  EXPECT_FALSE(update(after, C, 1, 1, false).used);
  EXPECT_FALSE(update(after, C, kNaN, 1, true).used);
  EXPECT_FALSE(update(after, C, kInfinity, 1, true).used);
  EXPECT_FALSE(update(after, C, far, 1, true, 9).used);
  EXPECT_FALSE(update(after, CC, {1, 1}, RR, false).used);
  EXPECT_FALSE(update(after, CC, {1, kNaN}, RR, true).used);
  EXPECT_FALSE(update(after, CC, {kInfinity, 1}, RR, true).used);
  EXPECT_FALSE(update(after, CC, {far, before.x(1)}, RR, true, 9).used);
  EXPECT_FALSE(update(after, sparse, 1, 1, false).used);
  EXPECT_FALSE(update(after, sparse, kNaN, 1, true).used);
  EXPECT_FALSE(update(after, sparse, kInfinity, 1, true).used);
  EXPECT_FALSE(update(after, sparse, 100, 1, true, 9).used);
  EXPECT_TRUE(unchanged(after));
  // What the gate refused can still be counted.
  EXPECT_NEAR(update(after, C, far, 1, true, 9).innovation_square, 100 * 100 / (before.P(0, 0) + 1),
              1e-9);
  // P = 0 and R = 0: no gain is defined.
  KalmanState<double, 3> certain;
  EXPECT_FALSE(update(certain, C, 1, 0, true).used);
  EXPECT_EQ(certain.x, Eigen::Vector3d::Zero());
  EXPECT_TRUE(update(after, C, far, 1, true, 1e9).used);
  EXPECT_FALSE(unchanged(after));
}

// Each lane with its own measurement, mask and noise, against the lane alone, bit for bit.
TEST(KalmanFilter, LanesDoNotDependOnEachOther) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  KalmanState<Pack<4>, 2> together;
  std::array<KalmanState<Pack<1>, 2>, 4> alone;
  for (int k = 0; k < 300; ++k) {
    Eigen::Matrix<Pack<4>, 1, 1> u;
    Pack<4> y;
    Eigen::Matrix<Pack<4>, 2, 1> yy;
    Mask<4> fresh;
    for (int i = 0; i < 4; ++i) {
      set_lane(u(0), i, normal(random));
      set_lane(y, i, normal(random));
      set_lane(yy(0), i, normal(random));
      set_lane(yy(1), i, normal(random));
      set_lane(fresh, i, normal(random) > 0);
    }
    const auto both_of = [](auto& state, const auto& drive, const auto& one, const auto& two,
                            const auto& mask, auto scalar) {
      using T = decltype(scalar);
      predict(altitude_model<T>(), state, drive);
      update(state, Eigen::Matrix<T, 1, 2>(T(1), T(0)), one, T(0.1), mask, T(6));
      update(state, Eigen::Matrix<T, 2, 2>(Eigen::Matrix<T, 2, 2>::Identity()), two,
             Eigen::Matrix<T, 2, 2>(Eigen::Matrix<T, 2, 2>::Identity() * T(5)), mask);
      update(state, SparseRow<T, 1>{{1}, {T(1)}}, one, T(3), logical_not(mask));
    };
    both_of(together, u, y, yy, fresh, Pack<4>());
    for (int i = 0; i < 4; ++i) {
      const Eigen::Matrix<Pack<1>, 1, 1> u1(Pack<1>(lane(u(0), i)));
      const Eigen::Matrix<Pack<1>, 2, 1> yy1(lane(yy(0), i), lane(yy(1), i));
      both_of(alone[i], u1, Pack<1>(lane(y, i)), yy1, Mask<1>(lane(fresh, i)), Pack<1>());
      ASSERT_EQ(lane_of(together.x, i), lane_of(alone[i].x, 0)) << "step " << k;
      ASSERT_EQ(lane_of(together.P, i), lane_of(alone[i].P, 0)) << "step " << k;
    }
  }
}

TEST(KalmanFilter, SinglePrecisionFollowsDouble) {
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal;
  KalmanState<double, 2> exact;
  KalmanState<float, 2> single;
  for (int k = 0; k < 2000; ++k) {
    const double u = normal(random);
    const double y = 0.3 * normal(random);
    predict(altitude_model<double>(), exact, Eigen::Matrix<double, 1, 1>(u));
    predict(altitude_model<float>(), single, Eigen::Matrix<float, 1, 1>(static_cast<float>(u)));
    update(exact, Row2(1, 0), y, 0.1, true);
    update(single, Eigen::Matrix<float, 1, 2>(1, 0), static_cast<float>(y), 0.1F, true);
  }
  EXPECT_THAT(single.x.cast<double>(), MatrixNear(exact.x, 1e-5));
  EXPECT_THAT(single.P.cast<double>(), MatrixNear(exact.P, 1e-6));
}

}  // namespace
}  // namespace quadtune
