// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "matrix_near.hpp"
#include "plants/sample_vehicles.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/linearize/linearize.hpp"
#include "quadtune/linearize/trim.hpp"
#include "quadtune/simulation/flight.hpp"
#include "quadtune/simulation/plant.hpp"
#include "same_flight.hpp"
#include "vehicle_text.hpp"

namespace quadtune {
namespace {

using Eigen::Vector3d;
using testing::first_difference;
using ::testing::HasSubstr;
using testing::MatrixNear;
using testing::plus_quadrotor;
using testing::random_state;
using testing::random_vehicle;
using ::testing::ThrowsMessage;
using testing::vehicle_text;

constexpr double kDrag = 3e-4, kInflow = 2e-4, kFlapping = 5e-5;

Vehicle in_air(Vehicle vehicle) {
  for (Rotor& rotor : vehicle.rotors) {
    rotor.drag = kDrag;
    rotor.inflow = kInflow;
    rotor.flapping = kFlapping;
  }
  return vehicle;
}

// Hubs in the plane of the centre of mass at distance L, all at the speed w.
TEST(RotorAirflow, HasItsClosedForms) {
  const RigidBody body(in_air(plus_quadrotor()), 0.8);
  ASSERT_TRUE(body.has_airflow);
  const double w = 300, k = 0.8 * w, L = 0.29;
  const Eigen::Vector4d speeds = Eigen::Vector4d::Constant(w);
  const auto air = [&](const Vector3d& airspeed, const Vector3d& rates) {
    RotorLoads<double> loads;
    add_airflow(body, speeds, airspeed, rates, loads);
    return loads;
  };
  const RotorLoads<double> moving = air({2, -3, 1}, {0, 0, 0});
  EXPECT_THAT(
      moving.force,
      MatrixNear(Vector3d(-4 * kDrag * k * 2, 4 * kDrag * k * 3, -4 * kInflow * k * 1), 1e-13));
  // The disc tilts back: forward flight pitches up, flight to the left rolls right.
  EXPECT_THAT(moving.torque,
              MatrixNear(Vector3d(4 * kFlapping * k * 3, 4 * kFlapping * k * 2, 0), 1e-13));
  // Turning moves the hubs: rolling is damped by inflow, yawing by drag.
  const RotorLoads<double> turning = air({0, 0, 0}, {1, 2, 3});
  EXPECT_THAT(turning.force, MatrixNear(Vector3d(0, 0, 0), 1e-13));
  EXPECT_THAT(turning.torque,
              MatrixNear(Vector3d(-2 * L * L * kInflow * k * 1, -2 * L * L * kInflow * k * 2,
                                  -4 * L * L * kDrag * k * 3),
                         1e-13));
}

// Hubs above the centre of mass: the drag there pitches the nose up, as flapping does.
TEST(RotorAirflow, ActsAtTheHubs) {
  Vehicle vehicle = plus_quadrotor();
  for (Rotor& rotor : vehicle.rotors) {
    rotor.drag = kDrag;
    rotor.position.z() = -0.05;
  }
  RotorLoads<double> loads;
  add_airflow(RigidBody(vehicle), Eigen::Vector4d::Constant(300), Vector3d(2, 0, 0),
              Vector3d(0, 0, 0), loads);
  EXPECT_NEAR(loads.torque.y(), 0.05 * 4 * kDrag * 300 * 2, 1e-13);
}

TEST(RotorAirflow, DissipatesAndIsLinear) {
  std::mt19937_64 random(4);
  for (int trial = 0; trial < 20; ++trial) {
    Vehicle vehicle = in_air(random_vehicle(random, 6));
    for (Rotor& rotor : vehicle.rotors) rotor.flapping = 0;
    const RigidBody body(vehicle);
    const StateVector<double> x = random_state(random);
    const Vector3d v = x.segment<3>(kVelocity), w = x.segment<3>(kRates);
    const Eigen::VectorXd speeds = Eigen::VectorXd::LinSpaced(6, 300, 500);
    RotorLoads<double> one, twice;
    add_airflow(body, speeds, v, w, one);
    add_airflow(body, speeds, Vector3d(2 * v), Vector3d(2 * w), twice);
    EXPECT_LT(one.force.dot(v) + one.torque.dot(w), 0);
    EXPECT_THAT(twice.force, MatrixNear(Vector3d(2 * one.force), 1e-12));
    EXPECT_THAT(twice.torque, MatrixNear(Vector3d(2 * one.torque), 1e-12));
  }
}

// v' = -(Σ k w / m) v and the like, in A of every kind of input.
TEST(RotorAirflow, IsInTheLinearModel) {
  const Vehicle vehicle = in_air(plus_quadrotor());
  for (const InputKind inputs :
       {InputKind::rotor_speed, InputKind::wrench, InputKind::rotor_thrust, InputKind::command}) {
    LinearizeOptions options;
    options.inputs = inputs;
    const Linearization model = linearize(vehicle, FlightCondition{}, options);
    ASSERT_TRUE(model.solved());
    const double sum = 4 * model.trim.u.mean(), m = vehicle.mass;
    const Eigen::MatrixXd& A = model.plant.A;
    EXPECT_NEAR(A(6, 6), -kDrag * sum / m, 1e-12);
    EXPECT_NEAR(A(7, 7), -kDrag * sum / m, 1e-12);
    EXPECT_NEAR(A(8, 8), -kInflow * sum / m, 1e-12);
    EXPECT_NEAR(A(9, 7), -kFlapping * sum / vehicle.inertia(0, 0), 1e-12);
    EXPECT_NEAR(A(10, 6), kFlapping * sum / vehicle.inertia(1, 1), 1e-12);
    EXPECT_NEAR(A(11, 11), -0.29 * 0.29 * kDrag * sum / vehicle.inertia(2, 2), 1e-12);
  }
}

TEST(RotorAirflow, LinearModelIsTheSlopeOfTheEquations) {
  std::mt19937_64 random(5);
  for (int trial = 0; trial < 5; ++trial) {
    Vehicle vehicle = in_air(random_vehicle(random, 4));
    for (Rotor& rotor : vehicle.rotors) rotor.drag *= 0.1, rotor.inflow *= 0.1;
    FlightCondition line;
    line.kind = FlightKind::line;
    line.speed = 3;
    line.climb = 1;
    const Linearization model = linearize(vehicle, line);
    ASSERT_TRUE(model.solved()) << model.trim.culprit;
    const RigidBody body(vehicle);
    const Eigen::VectorXd& u = model.trim.u;
    const auto f = [&](const StateVector<double>& x) {
      const Vector3d v = x.segment<3>(kVelocity), w = x.segment<3>(kRates);
      return state_derivative(body, x, rotor_loads(body, u, v, w));
    };
    const StateVector<double> x0 = model.trim.x;
    // The trim is steady.
    EXPECT_THAT(Eigen::VectorXd(f(x0).tail<6>()), MatrixNear(Eigen::VectorXd::Zero(6), 1e-9));
    const double h = 1e-5;
    Eigen::MatrixXd slope(12, 12);
    for (int j = 0; j < 12; ++j) {
      StateVector<double> low = x0, high = x0;
      low(j) -= h, high(j) += h;
      slope.col(j) = (f(high) - f(low)) / (2 * h);
    }
    EXPECT_THAT(model.plant.A, MatrixNear(slope, 1e-6 * slope.cwiseAbs().maxCoeff()));
  }
}

// In a steady climb at c the rotors turn as fast as gives T = m g at rest plus Σ inflow w c.
TEST(RotorAirflow, CostsThrustInAClimb) {
  Vehicle vehicle = plus_quadrotor();
  for (Rotor& rotor : vehicle.rotors) rotor.inflow = 1e-3;
  FlightCondition climb;
  climb.kind = FlightKind::line;
  climb.climb = 2;
  const TrimResult up = trim(vehicle, climb);
  ASSERT_TRUE(up.solved());
  const double w = up.u(0);
  EXPECT_NEAR(4 * (rotor_thrust(vehicle.rotors[0], w) - 1e-3 * w * 2),
              vehicle.mass * vehicle.gravity, 1e-9);
  EXPECT_GT(w, trim(vehicle, FlightCondition{}).u(0));
}

template <int N>
void expect_that_wind_is_opposite_motion() {
  std::mt19937_64 random(6);
  Vehicle vehicle = in_air(random_vehicle(random, 4));
  for (Rotor& rotor : vehicle.rotors) rotor.lag = N == 0 ? 0 : 0.05;
  Plant<double, N> still(RigidBody(vehicle), GroundContact<double>{});
  still.ground.present = false;
  Plant<double, N> windy = still;
  windy.windy = true;
  for (int trial = 0; trial < 10; ++trial) {
    typename Plant<double, N>::State x;
    x.setZero();
    x.template head<13>() = quaternion_state(random_state(random));
    const Eigen::Vector4d w(400, 410, 420, 430);
    if constexpr (N == 4) x.template tail<4>() = w;
    windy.wind = {3, -2, 1};
    still.command(w, x);
    windy.command(w, x);
    auto seen = x;
    seen.template segment<3>(7) -=
        Plant<double, N>::attitude(x).toRotationMatrix().transpose() * windy.wind;
    EXPECT_THAT(windy.specific_force(x), MatrixNear(still.specific_force(seen), 1e-12));
    EXPECT_THAT(
        Vector3d(windy.derivative(x).template segment<3>(kBodyRates)),
        MatrixNear(Vector3d(still.derivative(seen).template segment<3>(kBodyRates)), 1e-10));
    // The equations of the rigid body give the same.
    const StateVector<double> e = euler_state(QuaternionState<double>(x.template head<13>()));
    const Vector3d v = e.segment<3>(kVelocity), rates = e.segment<3>(kRates);
    const StateVector<double> d =
        state_derivative(still.body(), e, rotor_loads(still.body(), w, v, rates));
    EXPECT_THAT(Vector3d(still.derivative(x).template segment<3>(kBodyVelocity)),
                MatrixNear(Vector3d(d.segment<3>(kVelocity)), 1e-10));
    EXPECT_THAT(Vector3d(still.derivative(x).template segment<3>(kBodyRates)),
                MatrixNear(Vector3d(d.segment<3>(kRates)), 1e-9));
  }
}

TEST(RotorAirflow, FeelsWindAsItsOwnOppositeMotion) {
  expect_that_wind_is_opposite_motion<0>();
  expect_that_wind_is_opposite_motion<4>();
}

// Σ k w / m of damping: a push dies away with that rate.
TEST(RotorAirflow, SlowsALevelVehicleDown) {
  Vehicle vehicle = plus_quadrotor();
  for (Rotor& rotor : vehicle.rotors) rotor.drag = kDrag;
  Plant<double, 0> plant(RigidBody(vehicle), GroundContact<double>{});
  plant.ground.present = false;
  Plant<double, 0>::State x = Plant<double, 0>::State::Zero();
  x(3) = 1;
  x(7) = 2;
  const Eigen::VectorXd hover = trim(vehicle, FlightCondition{}).u;
  plant.command(hover, x);
  for (int i = 0; i < 1000; ++i) x = plant.step(Integrator::runge_kutta_4, x, 2e-3);
  EXPECT_NEAR(x(7), 2 * std::exp(-2 * kDrag * hover.sum() / vehicle.mass), 1e-9);
}

// Cheeseman and Bennett's ratio at h/r of 1/2 and less (held), 1, 2 and far away.
TEST(GroundEffect, HasItsClosedForm) {
  EXPECT_DOUBLE_EQ(ground_effect(0.1, 0.1), 16.0 / 15);
  EXPECT_DOUBLE_EQ(ground_effect(0.1, 0.2), 64.0 / 63);
  EXPECT_DOUBLE_EQ(ground_effect(0.1, 0.05), 4.0 / 3);
  EXPECT_DOUBLE_EQ(ground_effect(0.1, 0.01), 4.0 / 3);
  EXPECT_DOUBLE_EQ(ground_effect(0.1, -3.0), 4.0 / 3);
  EXPECT_NEAR(ground_effect(0.1, 10.0), 1, 1e-5);
  EXPECT_EQ(ground_effect(0.0, 0.0), 1);
}

TEST(GroundEffect, LiftsAndLevelsNearTheGround) {
  Vehicle vehicle = plus_quadrotor();
  for (Rotor& rotor : vehicle.rotors) {
    rotor.radius = 0.12;
    rotor.ground_effect = true;
    rotor.position.z() = -0.03;
  }
  for (const double lag : {0.0, 0.05}) {
    for (Rotor& rotor : vehicle.rotors) rotor.lag = lag;
    const auto felt = [&](double height, double roll) {
      const auto of = [&](auto plant) {
        auto x = typename decltype(plant)::State(decltype(plant)::State::Zero());
        x(2) = -height;
        x(3) = std::cos(roll / 2), x(4) = std::sin(roll / 2);
        const Eigen::Vector4d w = Eigen::Vector4d::Constant(300);
        if (lag > 0) x.template tail<4>() = w;
        plant.command(w, x);
        return std::pair(Vector3d(plant.specific_force(x)),
                         Vector3d(plant.derivative(x).template segment<3>(kBodyRates)));
      };
      return lag > 0 ? of(Plant<double, 4>(RigidBody(vehicle), GroundContact<double>{}))
                     : of(Plant<double, 0>(RigidBody(vehicle), GroundContact<double>{}));
    };
    const double thrust = rotor_thrust(vehicle.rotors[0], 300.0) / vehicle.mass;
    EXPECT_NEAR(felt(0.09, 0).first.z(), -4 * thrust * 16 / 15, 1e-10);  // hubs at 0.12 m
    EXPECT_NEAR(felt(50, 0).first.z(), -4 * thrust * ground_effect(0.12, 50.03), 1e-12);
    // The lower side has more thrust: rolled to the right it is rolled back.
    EXPECT_LT(felt(0.15, 0.2).second.x(), -0.1);
    EXPECT_NEAR(felt(50, 0.2).second.x(), 0, 1e-6);
  }
}

// Vehicles with and without, in one pack and alone.
TEST(RotorAirflow, FliesAloneAsTogether) {
  for (const double lag : {0.0, 0.02}) {
    std::vector<FlightSetup> all;
    for (std::uint32_t i = 0; i < 7; ++i) {
      FlightSetup setup;
      setup.vehicle = load_vehicle("mambo");
      setup.controller = CascadeController{setup.vehicle.published_cascade->gains};
      setup.mission = load_mission("hover");
      setup.duration = 3;
      setup.log = true;
      setup.flight = i;
      for (Rotor& rotor : setup.vehicle.rotors) rotor.lag = lag;
      setup.flown = setup.vehicle;
      for (Rotor& rotor : setup.flown->rotors) {
        if (i % 2) rotor.drag = 1e-6 * i;
        if (i % 3 == 1) rotor.inflow = 2e-6;
        if (i == 4) rotor.flapping = 1e-8;
        rotor.ground_effect = i % 3 == 2;
        if (i >= 3 && lag > 0) rotor.lag_down = 0.04;
      }
      setup.environment.wind.mean = {i % 2 ? 0.3 : 0, 0.1, 0};
      setup.environment.wind.turbulence = i % 3 ? 0 : 1;
      all.push_back(setup);
    }
    const std::vector<FlightResult> together = fly_all(all, 1);
    for (std::size_t i = 0; i < all.size(); ++i)
      EXPECT_STREQ(first_difference(together[i], fly(all[i])), "") << i << " lag " << lag;
    EXPECT_STRNE(first_difference(together[0], together[1]), "");
  }
}

TEST(RotorAirflow, IsReadAndRefused) {
  const Vehicle vehicle = parse_vehicle(
      vehicle_text("radius_m = 0.1\nground_effect = true\ndrag_N_s2_per_rad_m = 1e-5\n"
                   "inflow_N_s2_per_rad_m = 2e-5\nflapping_N_s2_per_rad = 3e-7",
                   "drag_N_s2_per_rad_m = 4e-5"),
      "x.toml");
  EXPECT_EQ(vehicle.rotors[0].drag, 4e-5);
  EXPECT_EQ(vehicle.rotors[1].drag, 1e-5);
  EXPECT_EQ(vehicle.rotors[1].inflow, 2e-5);
  EXPECT_EQ(vehicle.rotors[1].flapping, 3e-7);
  EXPECT_TRUE(vehicle.rotors[3].ground_effect);
  EXPECT_TRUE(has_aerodynamics(vehicle));
  EXPECT_FALSE(has_aerodynamics(plus_quadrotor()));
  const auto refusal = [](const std::string& shared, const std::string& message) {
    EXPECT_THAT([&] { (void)parse_vehicle(vehicle_text(shared), "x.toml"); },
                ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  refusal("drag_N_s2_per_rad_m = -1", "drag_N_s2_per_rad_m in [rotor] is -1, expected 0 or more");
  refusal("inflow_N_s2_per_rad_m = -1", "inflow_N_s2_per_rad_m in [rotor] is -1, expected 0 or");
  refusal("flapping_N_s2_per_rad = -1", "flapping_N_s2_per_rad in [rotor] is -1, expected 0 or");
  refusal("ground_effect = true", "has ground_effect but no radius_m, expected the radius");
  refusal("drag_N_s_per_m = 1", "drag_N_s_per_m");
}

}  // namespace
}  // namespace quadtune
