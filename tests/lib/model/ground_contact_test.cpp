// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <vector>

#include "matrix_near.hpp"
#include "plants/sample_vehicles.hpp"
#include "quadtune/simulation/plant.hpp"

namespace quadtune {
namespace {

using Eigen::Vector3d;
using testing::MatrixNear;
using testing::plus_quadrotor;

using Direct = Plant<double, 0>;
constexpr double kStep = 0.005;

constexpr std::array kMethods = {Integrator::euler, Integrator::bogacki_shampine_3,
                                 Integrator::runge_kutta_4};

std::vector<Vehicle> vehicles() {
  return {plus_quadrotor(), load_vehicle("mambo"), load_vehicle("crazyflie")};
}

double reach_of(const Vehicle& vehicle) {
  double reach = 0;
  for (const Rotor& rotor : vehicle.rotors)
    reach = std::max(reach, rotor.position.cwiseAbs().maxCoeff());
  return reach;
}

Direct on_the_ground(const Vehicle& vehicle) {
  const double moment = std::min(vehicle.inertia(0, 0), vehicle.inertia(1, 1));
  return Direct(RigidBody(vehicle), ground_contact(vehicle.mass, moment, reach_of(vehicle)));
}

Direct::State at_rest(const Vehicle& vehicle) {
  Direct::State x = Direct::State::Zero();
  x(2) = vehicle.gravity / 3600;  // g/60²
  x(3) = 1;
  return x;
}

Direct::State started(Direct& plant, Direct::State x) {
  plant.command(RotorSpeeds<double>::Zero(plant.body().rotor_count), x);
  return x;
}

// Motion, height and springs.
double energy(const Direct& plant, const Direct::State& x) {
  double sum = 0.5 * plant.body().mass * x.segment<3>(7).squaredNorm() +
               0.5 * x.tail<3>().dot(plant.body().J * x.tail<3>()) -
               plant.body().mass * plant.body().gravity * x(2);
  const Eigen::Matrix3d R = Direct::attitude(x).toRotationMatrix();
  for (const double sx : {1.0, -1.0})
    for (const double sy : {1.0, -1.0}) {
      const Vector3d foot = plant.ground.leg_reach * Vector3d(sx, sy, 0);
      const double depth = x(2) + R.row(2).dot(foot);
      if (depth > 0) sum += 0.5 * plant.ground.stiffness * depth * depth;
    }
  return sum;
}

bool in_contact(const Direct& plant, const Direct::State& x) {
  const Eigen::Matrix3d R = Direct::attitude(x).toRotationMatrix();
  for (const double sx : {1.0, -1.0})
    for (const double sy : {1.0, -1.0})
      if (x(2) + R.row(2).dot(plant.ground.leg_reach * Vector3d(sx, sy, 0)) > 0) return true;
  return false;
}

TEST(GroundContact, RestsAtItsDepth) {
  for (const Vehicle& vehicle : vehicles())
    for (const Integrator method : kMethods) {
      Direct plant = on_the_ground(vehicle);
      const Direct::State rest = started(plant, at_rest(vehicle));
      EXPECT_THAT(plant.derivative(rest), MatrixNear(Eigen::VectorXd::Zero(13), 1e-12));
      EXPECT_THAT(plant.specific_force(rest), MatrixNear(Vector3d(0, 0, -vehicle.gravity), 1e-12));
      Direct::State x = rest;
      x(2) = -0.05;
      for (int i = 0; i < 600; ++i) x = plant.step(method, x, kStep);
      EXPECT_THAT(x, MatrixNear(rest, 1e-10)) << vehicle.name << " " << to_string(method);
    }
}

// Whatever pushes it a little, it comes to rest: no method at 5 ms makes it rock or turn on its
// feet. With feet at the uquad's arms it would rock with 0.4 rad/s for ever.
TEST(GroundContact, SettlesFromEveryPush) {
  for (const Vehicle& vehicle : vehicles())
    for (const Integrator method : kMethods)
      for (int i = kBodyVelocity; i < kRotorSpeeds; ++i) {
        Direct plant = on_the_ground(vehicle);
        Direct::State x = started(plant, at_rest(vehicle));
        x(i) = 0.02;
        for (int k = 0; k < 1000; ++k) x = plant.step(method, x, kStep);
        EXPECT_LT(x.segment<6>(7).norm(), 1e-9)
            << vehicle.name << " " << to_string(method) << " " << i;
      }
}

// However it falls, it never leaves the ground with more energy than it came with, and in the end
// it rests, on its feet or on its head.
TEST(GroundContact, NeverGivesBackMoreThanItTook) {
  for (const Vehicle& vehicle : vehicles())
    for (const Integrator method : kMethods)
      for (const double tilt : {0.0, 0.3, -0.6, 1.2})
        for (const double height : {0.05, 0.5, 2.0}) {
          Direct plant = on_the_ground(vehicle);
          StateVector<double> start = StateVector<double>::Zero();
          start.segment<8>(2) << -height, tilt, 0.4 * tilt, 0.7, height, 0.3, 0, 0;
          Direct::State x = started(plant, quaternion_state(start));
          double before = energy(plant, x);  // when it last was in the air
          bool touched = false;
          int bounces = 0;
          for (int k = 0; k < 1600; ++k) {
            x = plant.step(method, x, kStep);
            ASSERT_TRUE(x.allFinite());
            if (in_contact(plant, x)) {
              touched = true;
              continue;
            }
            if (touched) {
              ++bounces;
              EXPECT_LT(energy(plant, x), before) << vehicle.name << " " << to_string(method) << " "
                                                  << tilt << " " << height << " " << bounces;
            }
            before = energy(plant, x);
            touched = false;
          }
          EXPECT_TRUE(touched);
          EXPECT_LT(x.segment<6>(7).norm(), 1e-6)
              << vehicle.name << " " << to_string(method) << " " << tilt << " " << height;
          EXPECT_NEAR(energy(plant, x), energy(plant, at_rest(vehicle)), 1e-6 * vehicle.mass);
          EXPECT_NEAR(std::abs(Direct::attitude(x).toRotationMatrix()(2, 2)), 1, 1e-6);
        }
}

// A foot that leaves the ground is not held back: lifted at once, the vehicle feels no ground.
TEST(GroundContact, DoesNotPull) {
  Direct plant = on_the_ground(plus_quadrotor());
  Direct::State x = started(plant, at_rest(plus_quadrotor()));
  for (const double up : {0.5, 1.0, 5.0}) {
    x(9) = -up;  // the damper alone would pull with 4 d up
    EXPECT_LE(plant.derivative(x)(9), plant.body().gravity * (1 + 1e-15));
    EXPECT_DOUBLE_EQ(plant.derivative(x)(9), plant.body().gravity);
  }
  x(2) = -1e-9;
  x(9) = 10;
  EXPECT_DOUBLE_EQ(plant.derivative(x)(9), plant.body().gravity);  // nor pushed before it is there
}

// Friction holds against a wind up to its coefficient: what it needs it finds at a creeping speed
// v, μ m g v / √(v² + slip²) = force. Beyond it the vehicle slides away.
TEST(GroundContact, HoldsInTheWindUpToItsFriction) {
  Vehicle vehicle = plus_quadrotor();
  vehicle.drag.linear = {1, 1, 0};
  const double max = 0.6 * vehicle.mass * vehicle.gravity;
  for (const double share : {0.2, 0.5, 0.8, 1.5}) {
    Direct plant = on_the_ground(vehicle);
    Direct::State x = started(plant, at_rest(vehicle));
    plant.windy = true;
    plant.wind = {share * max, 0, 0};  // 1 N s/m
    for (int k = 0; k < 2000; ++k) x = plant.step(Integrator::bogacki_shampine_3, x, kStep);
    const double v = x(7);
    if (share > 1) {
      EXPECT_GT(v, 1);
      continue;
    }
    EXPECT_NEAR(max * v / std::hypot(v, 0.05) + v, share * max, 1e-6);
    EXPECT_LT(v, 0.07);
    EXPECT_NEAR(x(2), vehicle.gravity / 3600, 1e-6);
  }
}

TEST(GroundContact, IsAsStiffAsItSays) {
  const GroundContact<double> ground = ground_contact(2.0, 0.02, 0.3, 0.1);
  EXPECT_DOUBLE_EQ(4 * ground.stiffness / 2, 60 * 60);  // ω² of the bounce
  EXPECT_DOUBLE_EQ(4 * ground.damping, 2 * std::sqrt(4 * ground.stiffness * 2));  // critical
  EXPECT_DOUBLE_EQ(ground.leg_reach, 0.1);                                        // √(J/m)
  EXPECT_DOUBLE_EQ(ground.leg_height, 0.1);
  EXPECT_DOUBLE_EQ(ground_contact(2.0, 0.02, 0.05).leg_reach, 0.05);
}

}  // namespace
}  // namespace quadtune
