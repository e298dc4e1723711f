// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/plant.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <array>
#include <bit>
#include <cstdint>
#include <random>
#include <vector>

#include "matrix_near.hpp"
#include "plants/sample_vehicles.hpp"
#include "quadtune/linearize/linearize.hpp"
#include "quadtune/simulation/pack.hpp"
#include "quadtune/simulation/pack_math.hpp"
#include "quadtune/simulation/packed_body.hpp"

namespace quadtune {
namespace {

using Eigen::Vector3d;
using testing::MatrixNear;
using testing::plus_quadrotor;
using testing::random_state;
using testing::random_vehicle;

using Direct = Plant<double, 0>;

Direct without_ground(const Vehicle& vehicle) {
  Direct plant(RigidBody(vehicle), GroundContact<double>{});
  plant.ground.present = false;
  return plant;
}

Eigen::Matrix3d rotation(const Direct::State& x) { return Direct::attitude(x).toRotationMatrix(); }

// Without drag, thrust and ground: a parabola, and Euler's equations.
TEST(Plant, FallsFreelyAndKeepsEnergyAndAngularMomentum) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 5; ++trial) {
    Vehicle vehicle = random_vehicle(random, 4);
    vehicle.drag = {};
    Direct plant = without_ground(vehicle);
    Direct::State x = quaternion_state(random_state(random));
    plant.command(Eigen::Vector4d::Zero(), x);
    const Direct::State from = x;
    const auto momentum = [&](const Direct::State& s) -> Vector3d {
      return rotation(s) * (plant.body().J * s.tail<3>());
    };
    const auto energy = [&](const Direct::State& s) {
      return 0.5 * plant.body().mass * s.segment<3>(7).squaredNorm() +
             0.5 * s.tail<3>().dot(plant.body().J * s.tail<3>()) -
             plant.body().mass * plant.body().gravity * s(2);
    };
    const double h = 1e-3, t = 2;
    for (int i = 0; i < 2000; ++i) x = plant.step(Integrator::runge_kutta_4, x, h);
    const Vector3d v = rotation(from) * from.segment<3>(7);
    const Vector3d g(0, 0, vehicle.gravity);
    EXPECT_THAT(x.head<3>(), MatrixNear(Vector3d(from.head<3>() + v * t + g * t * t / 2), 1e-7));
    EXPECT_THAT(Vector3d(rotation(x) * x.segment<3>(7)), MatrixNear(Vector3d(v + g * t), 1e-8));
    EXPECT_NEAR(energy(x), energy(from), 1e-8 * std::abs(energy(from)) + 1e-8);
    EXPECT_THAT(momentum(x), MatrixNear(momentum(from), 1e-9 * momentum(from).norm()));
    EXPECT_GT((x.tail<3>() - from.tail<3>()).norm(), 0.01);  // and it did tumble
    EXPECT_THAT(plant.specific_force(x), MatrixNear(Vector3d(Vector3d::Zero()), 0));
  }
}

// A rotor with lag follows its command as 1 - e^(-t/lag), and one without at once.
TEST(Plant, RotorsFollowWithTheirLag) {
  Vehicle vehicle = plus_quadrotor();
  for (std::size_t i = 0; i < 3; ++i) vehicle.rotors[i].lag = 0.02 * static_cast<double>(i + 1);
  Plant<double, 4> plant(RigidBody(vehicle), GroundContact<double>{});
  plant.ground.present = false;
  Plant<double, 4>::State x = Plant<double, 4>::State::Zero();
  x(3) = 1;
  x.tail<4>().setConstant(200);
  const Eigen::Vector4d asked(300, 310, 320, 330);
  plant.command(asked, x);
  EXPECT_EQ(x(kRotorSpeeds + 3), 330);
  for (int i = 0; i < 100; ++i) x = plant.step(Integrator::runge_kutta_4, x, 5e-4);
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(x(kRotorSpeeds + i),
                asked(i) + (200 - asked(i)) * std::exp(-0.05 / (0.02 * (i + 1))), 1e-6);
  EXPECT_EQ(plant.rotor_speeds(x)(3), 330);
}

// The whole vehicle's angular momentum changes by the drag torques alone while the rotors run up.
TEST(Plant, ARotorThatSpeedsUpTurnsTheBodyBack) {
  Vehicle vehicle = plus_quadrotor();
  for (Rotor& rotor : vehicle.rotors) {
    rotor.lag = 0.05;
    rotor.torque_d1 = rotor.torque_d2 = 0;
  }
  Plant<double, 4> plant(RigidBody(vehicle), GroundContact<double>{});
  plant.ground.present = false;
  Plant<double, 4>::State x = Plant<double, 4>::State::Zero();
  x(3) = 1;
  plant.command(Eigen::Vector4d(300, 0, 300, 0), x);
  for (int i = 0; i < 200; ++i) x = plant.step(Integrator::runge_kutta_4, x, 1e-3);
  const double rotors = 1.54e-5 * -(x(13) + x(15));  // 1 and 3 turn counter-clockwise
  EXPECT_NEAR(plant.body().J(2, 2) * x(12) + rotors, 0, 1e-12);
  EXPECT_GT(x(12), 0.1);
}

TEST(Plant, WindActsAsItsOwnOppositeMotion) {
  std::mt19937_64 random(2);
  const Vehicle vehicle = random_vehicle(random, 4);
  Direct still = without_ground(vehicle), windy = still;
  for (int trial = 0; trial < 10; ++trial) {
    Direct::State x = quaternion_state(random_state(random));
    const Eigen::Vector4d w(400, 410, 420, 430);
    const Vector3d wind(3, -2, 1);
    windy.windy = true;
    windy.wind = wind;
    still.command(w, x);
    windy.command(w, x);
    // Seen from the air that moves along, the air stands still: the same specific force.
    Direct::State seen = x;
    seen.segment<3>(7) -= rotation(x).transpose() * wind;
    EXPECT_THAT(windy.specific_force(x), MatrixNear(still.specific_force(seen), 1e-12));
    const Direct::State a = windy.derivative(x), b = still.derivative(seen);
    EXPECT_THAT(Vector3d(a.segment<3>(7) + Vector3d(x.tail<3>()).cross(Vector3d(x.segment<3>(7)))),
                MatrixNear(Vector3d(b.segment<3>(7) +
                                    Vector3d(seen.tail<3>()).cross(Vector3d(seen.segment<3>(7)))),
                           1e-11));
  }
}

// An accelerometer measures v' + w × v - g according to the equations.
TEST(Plant, SpecificForceIsWhatTheMotionShows) {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 10; ++trial) {
    const Vehicle vehicle = random_vehicle(random, 6);
    Plant<double, Eigen::Dynamic> plant(RigidBody(vehicle),
                                        ground_contact(vehicle.mass, 1.0, 0.02, 0.2));
    plant.windy = true;
    plant.wind = {1, 2, -1};
    Plant<double, Eigen::Dynamic>::State x(kRotorSpeeds + 6);
    x.head<13>() = quaternion_state(random_state(random));
    x(2) = trial % 2 ? 0.01 : -20;  // in the ground, and above it
    x.tail<6>().setConstant(450);
    plant.command(RotorSpeeds<double>::Constant(6, 470), x);
    const Vector3d velocity = x.segment<3>(7), rates = x.segment<3>(10);
    const Eigen::Matrix3d R = plant.attitude(x).toRotationMatrix();
    const Vector3d felt = Vector3d(plant.derivative(x).segment<3>(7)) + rates.cross(velocity) -
                          R.transpose() * Vector3d(0, 0, vehicle.gravity);
    EXPECT_THAT(plant.specific_force(x), MatrixNear(felt, 1e-9 * (1 + felt.norm())));
  }
}

// Over a while the linear model and the plant part by what is quadratic in the perturbation, at
// rest, in a line, in a circle and turning on the spot.
TEST(Plant, AgreesWithItsLinearModelToSecondOrder) {
  std::vector<Vehicle> vehicles = {plus_quadrotor(), load_vehicle("mambo")};
  vehicles[0].drag.linear = {0.1, 0.1, 0.15};
  vehicles[0].drag.cda = {0.01, 0.01, 0.02};
  std::mt19937_64 random(4);
  vehicles.push_back(random_vehicle(random, 6));
  FlightCondition hover, line, circle, spin;
  hover.yaw = 0.7;
  circle.kind = FlightKind::circle;
  circle.speed = 2;
  circle.radius = -3;
  spin.kind = FlightKind::spin;
  spin.yaw_rate = 1.5;
  spin.yaw = 0.3;
  line.kind = FlightKind::line;
  line.speed = 3;
  line.climb = 0.5;
  line.yaw = -1;
  for (const Vehicle& vehicle : vehicles)
    for (const FlightCondition& condition : {hover, line, circle, spin}) {
      const Linearization linear = linearize(vehicle, condition);
      ASSERT_TRUE(linear.solved()) << linear.trim.culprit;
      const Eigen::Index rotors = linear.u0.size();
      Eigen::VectorXd dx(12), du(rotors);
      for (Eigen::Index i = 0; i < 12; ++i)
        dx(i) = std::uniform_real_distribution<double>(-1, 1)(random);
      for (Eigen::Index i = 0; i < rotors; ++i)
        du(i) = 0.02 * linear.u0(i) * std::uniform_real_distribution<double>(-1, 1)(random);
      const double h = 1e-3;
      const int steps = 200;
      const auto after = [&](double size) -> StateVector<double> {
        Direct plant = without_ground(vehicle);
        Direct::State x = quaternion_state<double>(linear.x0 + size * dx);
        plant.command(linear.u0 + size * du, x);
        for (int i = 0; i < steps; ++i) x = plant.step(Integrator::runge_kutta_4, x, h);
        return euler_state<double>(x);
      };
      Eigen::VectorXd deviation = dx;
      const auto f = [&](double, const Eigen::VectorXd& at) -> Eigen::VectorXd {
        return linear.plant.A * at + linear.plant.B * du;
      };
      for (int i = 0; i < steps; ++i) deviation = runge_kutta_4_step(f, 0, deviation, h);
      const StateVector<double> trimmed = after(0);
      // The deviation of the position is measured along axes that turn with the heading.
      const double turned = linear.trim.yaw_rate * h * steps;
      const Eigen::Matrix2d back = Eigen::Rotation2Dd(-turned).toRotationMatrix();
      const auto difference = [&](double size) {
        StateVector<double> change = after(size) - trimmed;
        change.head<2>() = Eigen::Vector2d(back * change.head<2>());
        return (change - size * deviation).norm();
      };
      const double coarse = difference(0.02), fine = difference(0.01), finest = difference(0.005);
      EXPECT_NEAR(coarse / fine, 4, 0.3) << vehicle.name << " " << to_string(condition.kind);
      EXPECT_NEAR(fine / finest, 4, 0.15) << vehicle.name << " " << to_string(condition.kind);
      EXPECT_LT(finest, 1e-2 * 0.005 * deviation.norm());
      if (linear.trim.yaw_rate != 0) continue;
      // The trim itself moves in a line.
      StateVector<double> expected = linear.x0;
      expected += linear.x0_rate * (h * steps);
      EXPECT_THAT(trimmed, MatrixNear(Eigen::VectorXd(expected), 1e-7));
    }
}

// The steps that leave out absent terms have the bytes of those with all terms, in the air and
// during a fall to the ground.
template <int N>
void step_equals_all_terms(int rotors) {
  std::mt19937_64 random(7);
  using Whole = Plant<Pack<1>, N>;
  for (int trial = 0; trial < 64; ++trial) {
    const int terms = trial % 32;
    // Slowly, and so fast that the vehicle meets the ground in the middle of a step.
    const bool fast = trial >= 32;
    Vehicle vehicle = random_vehicle(random, rotors);
    for (Rotor& rotor : vehicle.rotors) {
      rotor.lag = 0.03;
      if (terms & 1) rotor.lag_down = 0.05;
      rotor.drag = terms & 2 ? 1e-5 : 0;
      rotor.inflow = terms & 2 ? 2e-5 : 0;
      rotor.flapping = terms & 2 ? 1e-6 : 0;
      rotor.ground_effect = (terms & 4) != 0;
      rotor.radius = 0.1;
    }
    if (terms & 8) vehicle.drag = {};
    const auto body = packed_body<1>({RigidBody(vehicle)});
    Whole plant(body, ground_contact(body.mass, body.J(0, 0), Pack<1>(0.2)));
    plant.windy = (terms & 16) != 0;
    if (plant.windy) plant.wind << 3, -2, 1;
    typename Whole::State x;
    if constexpr (N == Eigen::Dynamic) x.resize(kRotorSpeeds + rotors);
    const QuaternionState<double> start = quaternion_state(random_state(random));
    for (int i = 0; i < x.size(); ++i) x(i) = i < 13 ? start(i) : 300.0;
    x(2) = fast ? -2.1 + 0.05 * (trial % 8) : -0.6;
    const Vector3d velocity = rotation(start).transpose() * Vector3d(0, 0, fast ? 100 : 1);
    for (int i = 0; i < 3; ++i) x(kBodyVelocity + i) = velocity(i);
    RotorSpeeds<Pack<1>> asked(rotors);
    for (int i = 0; i < rotors; ++i) asked(i) = 100.0 + 60 * i;
    plant.command(asked, x);
    bool touched = false, flew = false;
    for (int k = 0; k < (fast ? 7 : 300); ++k) {
      const bool near = lane(x(2), 0) > -0.2;
      touched = touched || near;
      flew = flew || !near;
      typename Whole::State all = runge_kutta_4_step(
          [&](double, const typename Whole::State& at) { return plant.derivative(at); }, 0, x,
          0.004);
      Whole::restore_norm(all);
      x = plant.step(Integrator::runge_kutta_4, x, 0.004);
      for (int i = 0; i < x.size(); ++i)
        ASSERT_EQ(std::bit_cast<std::uint64_t>(lane(x(i), 0)),
                  std::bit_cast<std::uint64_t>(lane(all(i), 0)))
            << trial << " " << k << " " << i;
    }
    EXPECT_TRUE(touched && flew) << trial;
  }
}

TEST(Plant, StepsWithFewerTermsHaveTheSameBytes) {
  step_equals_all_terms<0>(4);
  step_equals_all_terms<4>(4);
  step_equals_all_terms<Eigen::Dynamic>(6);
}

// Several vehicles at once each move as they do alone, on the ground and in the air.
TEST(Plant, EachLaneIsAVehicleOfItsOwn) {
  std::mt19937_64 random(5);
  std::array<RigidBody, 4> bodies;
  for (RigidBody& body : bodies) body = RigidBody(random_vehicle(random, 4));
  const BasicRigidBody<Pack<4>> packed = packed_body<4>(bodies);
  using Alone = Plant<Pack<1>, 0>;
  using Together = Plant<Pack<4>, 0>;
  Together together(packed, ground_contact(packed.mass, packed.J(0, 0), Pack<4>(0.2)));
  Together::State x;
  std::array<Alone::State, 4> xs;
  std::array<Alone, 4> plants;
  RotorSpeeds<Pack<4>> speeds(4);
  for (std::size_t l = 0; l < 4; ++l) {
    const BasicRigidBody<Pack<1>> one = packed_body<1>({bodies[l]});
    plants[l] = Alone(one, ground_contact(one.mass, one.J(0, 0), Pack<1>(0.2)));
    Direct::State start = quaternion_state(random_state(random));
    start(2) = l < 2 ? -0.05 : -3;
    RotorSpeeds<Pack<1>> own(4);
    for (int i = 0; i < 4; ++i) {
      own(i) = 300 + 40 * i + 10 * static_cast<int>(l);
      set_lane(speeds(i), static_cast<int>(l), lane(own(i), 0));
    }
    for (int i = 0; i < 13; ++i) {
      xs[l](i) = start(i);
      set_lane(x(i), static_cast<int>(l), start(i));
    }
    plants[l].command(own, xs[l]);
  }
  together.command(speeds, x);
  const Together::State start = x;
  const std::array<Alone::State, 4> starts = xs;
  for (const Integrator method : {Integrator::bogacki_shampine_3, Integrator::runge_kutta_4}) {
    x = start;
    xs = starts;
    for (int step = 0; step < 400; ++step) {
      x = together.step(method, x, 0.005);
      for (std::size_t l = 0; l < 4; ++l) {
        xs[l] = plants[l].step(method, xs[l], 0.005);
        for (int i = 0; i < 13; ++i)
          ASSERT_EQ(lane(x(i), static_cast<int>(l)), lane(xs[l](i), 0))
              << step << " " << l << " " << i;
      }
    }
  }
}

}  // namespace
}  // namespace quadtune
