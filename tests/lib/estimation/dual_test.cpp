// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/dual.hpp"

#include <ceres/jet.h>

#include <Eigen/LU>
#include <random>

#include "matrix_near.hpp"
#include "quadtune/model/rigid_body.hpp"
#include "uniform_matrix.hpp"

namespace quadtune {
namespace {

using testing::MatrixNear;
using CeresJet = ceres::Jet<double, 4>;

// Each operation, of arguments in (0.1, 0.9) and (-0.9, 0.9): entry by entry in one vector.
template <class T>
ModelVector<T> every_operation(const T& x, const T& y) {
  using std::abs, std::acos, std::asin, std::atan, std::atan2, std::cos, std::cosh, std::exp,
      std::hypot, std::log, std::pow, std::sin, std::sinh, std::sqrt, std::tan, std::tanh;
  T in_place = x;
  in_place += y;
  in_place *= x;
  in_place -= y * y;
  in_place /= x + 2.0;
  ModelVector<T> all(26);
  all << x + y, x - y, x * y, y / x, -y, +y, 2.0 * x, 1.0 / x, y - 1.0, in_place, sqrt(x), sin(y),
      cos(y), tan(y), asin(y), acos(y), atan(y), atan2(y, x), atan2(x, -x), hypot(x, y), exp(y),
      log(x), sinh(y) + cosh(y) + tanh(y), abs(y), pow(x, 1.7), pow(x, y);
  return all;
}

TEST(Dual, EqualsTheJetsOfCeres) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> positive(0.1, 0.9), any(-0.9, 0.9);
  for (int trial = 0; trial < 50; ++trial) {
    const double x = positive(random), y = any(random);
    const Eigen::Vector4d dx = testing::uniform_vector(4, random),
                          dy = testing::uniform_vector(4, random);
    CeresJet jx(x), jy(y);
    jx.v = dx;
    jy.v = dy;
    const ModelVector<Dual> ours = every_operation(Dual(x, dx), Dual(y, dy));
    const ModelVector<CeresJet> theirs = every_operation(jx, jy);
    for (Eigen::Index i = 0; i < ours.size(); ++i) {
      SCOPED_TRACE(i);
      EXPECT_NEAR(ours(i).value, theirs(i).a, 4e-16 * std::abs(theirs(i).a));
      EXPECT_THAT(ours(i).slope, MatrixNear(theirs(i).v, 4e-15 * (1 + theirs(i).v.norm())));
    }
  }
}

TEST(Dual, PowersOfZeroHaveSlopes) {
  const Dual zero(0, Eigen::Vector4d::Ones());
  EXPECT_EQ(pow(zero, 2).slope(0), 0);
  EXPECT_EQ(pow(zero, 1).slope(0), 1);
  EXPECT_EQ(pow(zero, 0).slope(0), 0);
  EXPECT_EQ(pow(zero, 0).value, 1);
  EXPECT_EQ(pow(zero - 2.0, Dual(3)).value, -8);
  EXPECT_EQ(pow(zero - 2.0, Dual(3)).slope(0), 12);
  EXPECT_FALSE(isfinite(sqrt(zero)));
}

TEST(Dual, ComparesByValue) {
  const Dual one(1, Eigen::Vector4d::Ones());
  EXPECT_TRUE(one == 1.0 && one < 2.0 && one >= 0.5 && one != 3.0);
  EXPECT_EQ(std::max(one, Dual(2)).value, 2);
}

// d(M⁻¹)/dt = -M⁻¹ Ṁ M⁻¹, and a matrix of numbers times one of duals.
TEST(Dual, WorksInMatrices) {
  std::mt19937_64 random(2);
  const Eigen::Matrix3d M = testing::uniform_matrix(3, 3, random) + 3 * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d rate = testing::uniform_matrix(3, 3, random);
  Eigen::Matrix<Dual, 3, 3> dual = M.cast<Dual>();
  for (Eigen::Index i = 0; i < 9; ++i) dual(i).slope(0) = rate(i);
  const Eigen::Matrix<Dual, 3, 3> inverse = dual.inverse();
  const Eigen::Matrix<Dual, 3, 3> product = M * inverse;
  const auto slopes = [](const Eigen::Matrix<Dual, 3, 3>& of) {
    return Eigen::Matrix3d(of.unaryExpr([](const Dual& entry) { return entry.slope(0); }));
  };
  EXPECT_THAT(slopes(inverse), MatrixNear(-M.inverse() * rate * M.inverse(), 1e-15));
  EXPECT_THAT(slopes(product), MatrixNear(-rate * M.inverse(), 1e-15));
}

// The physics of the library: a user's filter may use them. 12 states need three passes.
TEST(Linearized, EqualsTheJetsOfCeresForTheRigidBody) {
  Vehicle vehicle = load_vehicle("crazyflie");
  vehicle.drag = {};
  const RigidBody body(vehicle);
  const RotorSpeeds<double> speeds = RotorSpeeds<double>::Constant(4, 2000);
  const RotorLoads<double> loads = rotor_loads<double>(body, speeds);
  const auto f = [&](const auto& x) {
    using T = typename std::remove_cvref_t<decltype(x)>::Scalar;
    RotorLoads<T> cast;
    cast.force = loads.force.template cast<T>();
    cast.torque = loads.torque.template cast<T>();
    cast.angular_momentum = loads.angular_momentum.template cast<T>();
    return StateVector<T>(state_derivative(body, StateVector<T>(x), cast));
  };
  std::mt19937_64 random(3);
  const Eigen::VectorXd x = testing::uniform_vector(12, random);
  const Linearized ours = linearized(f, x);
  using Jet12 = ceres::Jet<double, 12>;
  ModelVector<Jet12> jets(12);
  for (int i = 0; i < 12; ++i) jets(i) = Jet12(x(i), i);
  const StateVector<Jet12> theirs = f(jets);
  ASSERT_EQ(ours.value.size(), 12);
  for (Eigen::Index i = 0; i < 12; ++i) {
    EXPECT_EQ(ours.value(i), theirs(i).a);
    EXPECT_THAT(ours.jacobian.row(i).transpose(), MatrixNear(theirs(i).v, 1e-14));
  }
}

TEST(Linearized, RejectsAVaryingSizeAndAnEmptyVector) {
  int calls = 0;
  const auto f = [&](const ModelVector<Dual>& x) { return ModelVector<Dual>(x.head(++calls)); };
  EXPECT_THAT([&] { (void)linearized(f, Eigen::VectorXd::Ones(5)); },
              ::testing::ThrowsMessage<InvalidInput>(
                  "linearized: the size of f(x) varies, expected a constant size"));
  EXPECT_THAT([&] { (void)linearized(f, Eigen::VectorXd()); },
              ::testing::ThrowsMessage<InvalidInput>(
                  "linearized: x is empty, expected at least one entry"));
}

}  // namespace
}  // namespace quadtune
