// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <random>

#include "matrix_near.hpp"
#include "plants/sample_vehicles.hpp"
#include "quadtune/control/allocation.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/model/mixer.hpp"

namespace quadtune {
namespace {

using Eigen::Vector4d;
using ::testing::HasSubstr;
using testing::MatrixNear;
using testing::plus_quadrotor;
using testing::random_vehicle;
using ::testing::StrEq;
using ::testing::ThrowsMessage;

Vector4d draw_scaled(std::mt19937_64& random, const Vector4d& scale) {
  std::uniform_real_distribution<double> between(-1, 1);
  return scale.cwiseProduct(
      Vector4d(between(random), between(random), between(random), between(random)));
}

// The public mixer of the Mambo, thrusts counted downward: t = Q2Ts [Fz τz τy τx].
TEST(OnBoardAllocation, IsTheMambosMixer) {
  const Vehicle mambo = load_vehicle("mambo");
  const Allocation<double> law = allocation(mambo);
  const Eigen::Matrix4d Q2Ts = thrust_mixer(mambo).Q2Ts;
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const Vector4d wrench =
        Vector4d(0.618, 0, 0, 0) + draw_scaled(random, Vector4d(0.2, 2e-3, 2e-3, 3e-4));
    const Vector4d thrusts = -Q2Ts * Vector4d(-wrench(0), wrench(3), wrench(2), wrench(1));
    const RotorSpeeds<double> speeds = speeds_of_wrench<double>(law, wrench);
    for (int i = 0; i < 4; ++i)
      EXPECT_NEAR(rotor_thrust(mambo.rotors[0], speeds(i)), thrusts(i), 1e-14);
    EXPECT_THAT(Vector4d(wrench_of_speeds(mambo, speeds)), MatrixNear(wrench, 1e-14));
  }
}

// Thrust and the torques of roll and pitch are met exactly; yaw to second order where the drag
// torque is not in proportion to the thrust.
TEST(OnBoardAllocation, MeetsTheWrench) {
  std::mt19937_64 random(2);
  std::vector<Vehicle> vehicles = {plus_quadrotor(), load_vehicle("uquad")};
  for (const int rotors : {4, 6, 8}) vehicles.push_back(random_vehicle(random, rotors));
  for (const Vehicle& vehicle : vehicles) {
    const Allocation<double> law = allocation(vehicle);
    const double weight = vehicle.mass * vehicle.gravity;
    const double torque = 0.05 * weight * vehicle.rotors[0].position.norm();
    for (int trial = 0; trial < 20; ++trial) {
      const Vector4d change =
          draw_scaled(random, Vector4d(0.2 * weight, torque, torque, 0.02 * torque));
      const auto missed = [&](double size) -> Vector4d {
        const Vector4d wrench = Vector4d(weight, 0, 0, 0) + size * change;
        return Vector4d(wrench_of_speeds(vehicle, speeds_of_wrench<double>(law, wrench))) - wrench;
      };
      EXPECT_THAT(Eigen::Vector3d(missed(1).head<3>()),
                  MatrixNear(Eigen::Vector3d(Eigen::Vector3d::Zero()), 1e-12 * weight))
          << vehicle.name;
      EXPECT_LT(std::abs(missed(1)(3)), 0.02 * change.norm());
      const double hover = missed(0)(3);
      const double whole = missed(0.25)(3) - hover, half = missed(0.125)(3) - hover;
      EXPECT_NEAR(whole, 4 * half, 0.25 * std::abs(whole) + 1e-12);
    }
  }
}

// More than four rotors: the thrusts have the least sum of squares, orthogonal to the null space.
TEST(OnBoardAllocation, SharesByLeastNorm) {
  std::mt19937_64 random(3);
  const Vehicle vehicle = random_vehicle(random, 8);
  const Allocation<double> law = allocation(vehicle);
  const Eigen::MatrixXd P = law.P.topRows(8);
  Eigen::MatrixXd M(4, 8);
  for (int i = 0; i < 8; ++i) {
    const Rotor& r = vehicle.rotors[static_cast<std::size_t>(i)];
    const double w = rotor_speed_for_thrust(r, law.thrust0(i));
    M.col(i) << 1, -r.position.y(), r.position.x(),
        -spin_sign(r.spin) * (2 * r.torque_d2 * w + r.torque_d1) /
            (2 * r.thrust_a2 * w + r.thrust_a1);
  }
  EXPECT_THAT(Eigen::MatrixXd(M * P), MatrixNear(Eigen::MatrixXd::Identity(4, 4), 1e-12));
  const Eigen::MatrixXd projector = P * M;
  EXPECT_THAT(projector, MatrixNear(Eigen::MatrixXd(projector.transpose()), 1e-12));
}

TEST(OnBoardAllocation, SpeedsInvertTheThrustCurve) {
  for (const double a1 : {0.0, 1e-3, -1e-3})
    for (const double w : {30.0, 100.0, 387.0, 2000.0}) {
      const double thrust = 4.6e-5 * w * w + a1 * w;
      EXPECT_NEAR(speed_for_thrust(thrust, 4.6e-5, a1), w, 1e-11 * w) << a1;
    }
  EXPECT_EQ(speed_for_thrust(-1.0, 4.6e-5, 1e-3), 0);
  EXPECT_EQ(speed_for_thrust(0.0, 4.6e-5, 1e-3), 0);
  // Where the curve is negative at first, no thrust is the speed at which it crosses 0.
  EXPECT_DOUBLE_EQ(speed_for_thrust(0.0, 4.6e-5, -1e-3), 1e-3 / 4.6e-5);
  EXPECT_DOUBLE_EQ(speed_for_thrust(-5.0, 4.6e-5, -1e-3), 1e-3 / 4.6e-5);
}

TEST(OnBoardAllocation, RefusesRotorsThatCannot) {
  Vehicle three = plus_quadrotor();
  three.rotors.pop_back();
  EXPECT_THAT([&] { (void)allocation(three); },
              ThrowsMessage<InvalidInput>(HasSubstr("the rotors cannot produce every wrench")));
  Vehicle aside = plus_quadrotor();
  for (Rotor& rotor : aside.rotors) rotor.position.x() += 1;
  EXPECT_THAT(
      [&] { (void)allocation(aside); },
      ThrowsMessage<InvalidInput>(HasSubstr("hover requires negative thrust from a rotor")));
  Vehicle many = plus_quadrotor();
  many.rotors.resize(17, many.rotors[0]);
  EXPECT_THAT([&] { (void)allocation(many); },
              ThrowsMessage<InvalidInput>(StrEq("vehicle 'plus': 17 rotors, expected 1 to 16")));
}

}  // namespace
}  // namespace quadtune
