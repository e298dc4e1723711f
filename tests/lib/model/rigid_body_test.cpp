// SPDX-License-Identifier: Apache-2.0
#include "quadtune/model/rigid_body.hpp"

#include <ceres/jet.h>
#include <gmock/gmock.h>

#include <numeric>
#include <random>

#include "integrate.hpp"
#include "matrix_near.hpp"
#include "plants/sample_vehicles.hpp"
#include "quadtune/convention.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using testing::integrate;
using testing::MatrixNear;
using testing::plus_quadrotor;
using testing::random_state;
using testing::random_vehicle;
using ::testing::ThrowsMessage;

using State = StateVector<double>;
using State13 = QuaternionState<double>;
using Speeds = RotorSpeeds<double>;

constexpr double kUquadHover = 316.103650939028;  // rad/s, published by the uquad project

Speeds random_speeds(std::mt19937_64& random, const Vehicle& vehicle) {
  Speeds speeds(static_cast<Eigen::Index>(vehicle.rotors.size()));
  for (Eigen::Index i = 0; i < speeds.size(); ++i)
    speeds(i) =
        std::uniform_real_distribution<double>(vehicle.motor.min, vehicle.motor.max)(random);
  return speeds;
}

TEST(RigidBody, HoversAtThePublishedSpeed) {
  const RigidBody body(plus_quadrotor());
  const BasicRotor<double>& rotor = body.rotors.front();
  const double f = body.mass * body.gravity / 4;  // the larger root of a2 w² + a1 w = f
  const double w =
      (-rotor.thrust_a1 + std::sqrt(rotor.thrust_a1 * rotor.thrust_a1 + 4 * rotor.thrust_a2 * f)) /
      (2 * rotor.thrust_a2);
  EXPECT_NEAR(w, kUquadHover, 1e-11);
  for (const double yaw : {0.0, 1.0, -2.5}) {
    State x = State::Zero();
    x(5) = yaw;
    const RotorLoads<double> loads = rotor_loads<double>(body, Speeds::Constant(4, w));
    EXPECT_THAT(state_derivative(body, x, loads), MatrixNear(State::Zero(), 1e-12));
    EXPECT_THAT(state_derivative(body, quaternion_state(x), loads),
                MatrixNear(State13::Zero(), 1e-12));
  }
}

TEST(RigidBody, AClockwiseRotorDrivesTheBodyCounterClockwise) {
  Vehicle vehicle = plus_quadrotor();
  vehicle.rotors.resize(1);
  vehicle.rotors[0].spin = Spin::clockwise;
  const RotorLoads<double> loads =
      rotor_loads<double>(RigidBody(vehicle), Speeds::Constant(1, kUquadHover));
  EXPECT_LT(loads.torque.z(), 0);            // to the left, seen from above
  EXPECT_GT(loads.angular_momentum.z(), 0);  // about +z, that is down
  EXPECT_LT(loads.force.z(), 0);             // up
  EXPECT_GT(loads.torque.y(), 0);            // a rotor in front lifts the nose
}

// A body with a wheel (a gyrostat) on which nothing acts keeps R (J w + h) and, the wheel's speed
// relative to the body being held by its motor without work on the body's rates, ½ wᵀ J w. This
// fixes the sign of -(w × h) from first principles.
TEST(RigidBody, TorqueFreeMotionKeepsEnergyAndAngularMomentum) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 5; ++trial) {
    Vehicle vehicle = random_vehicle(random, 4);
    vehicle.gravity = 0;
    vehicle.drag = {};
    const RigidBody body(vehicle);
    RotorLoads<double> loads;
    const double jz = body.J(2, 2);
    if (trial > 0) loads.angular_momentum = {0.3 * jz, -0.5 * jz, 2 * trial * jz};
    State13 x = quaternion_state(random_state(random));
    const auto momentum = [&](const State13& s) -> Eigen::Vector3d {
      const Eigen::Quaterniond q(s(3), s(4), s(5), s(6));
      return q.toRotationMatrix() * (body.J * s.tail<3>() + loads.angular_momentum);
    };
    const auto energy = [&](const State13& s) {
      return 0.5 * s.tail<3>().dot(body.J * s.tail<3>());
    };
    const double dt = 1e-3;
    const int steps = 2000;
    const State13 end =
        integrate([&](const State13& s) -> State13 { return state_derivative(body, s, loads); }, x,
                  dt, steps);
    // The method's error: at most (rate · dt)⁵/120 of the quantity a step. Nothing turns faster
    // than 25 rad/s here: rates of 5 rad/s, nutation below h/J = 16 rad/s.
    const double error = steps * std::pow(25 * dt, 5) / 120;
    EXPECT_THAT(momentum(end), MatrixNear(momentum(x), error * momentum(x).norm()));
    EXPECT_NEAR(energy(end), energy(x), error * energy(x));
    EXPECT_NEAR(end.segment<4>(3).norm(), 1, error);
    EXPECT_GT((end.tail<3>() - x.tail<3>()).norm(), 0.01);  // and it did tumble
  }
}

TEST(RigidBody, FallsFreelyHoweverItTumbles) {
  std::mt19937_64 random(2);
  Vehicle vehicle = random_vehicle(random, 6);
  vehicle.drag = {};
  const RigidBody body(vehicle);
  const State13 x = quaternion_state(random_state(random));
  const double t = 1.5;
  const int steps = 3000;
  const State13 end = integrate(
      [&](const State13& s) -> State13 { return state_derivative(body, s, RotorLoads<double>()); },
      x, t / steps, steps);
  const auto velocity = [](const State13& s) -> Eigen::Vector3d {
    return Eigen::Quaterniond(s(3), s(4), s(5), s(6)).toRotationMatrix() * s.segment<3>(7);
  };
  const Eigen::Vector3d g(0, 0, vehicle.gravity);
  const double tolerance = 1e-9;  // steps · (rate · dt)⁵/120 · speed = 3000 (5e-3)⁵/120 · 20
  EXPECT_THAT(velocity(end), MatrixNear(velocity(x) + g * t, tolerance));
  EXPECT_THAT(end.head<3>(), MatrixNear(x.head<3>() + velocity(x) * t + g * t * t / 2, tolerance));
}

TEST(RigidBody, DragOpposesEachComponentOfTheVelocity) {
  Vehicle vehicle = plus_quadrotor();
  vehicle.drag.cda = {0.01, 0.02, 0.03};
  vehicle.drag.linear = {0.1, 0.2, 0.3};
  const RigidBody body(vehicle, 0.5);
  const Eigen::Vector3d force = drag_force<double>(body, Eigen::Vector3d(2, -3, 0));
  EXPECT_THAT(force, MatrixNear(Eigen::Vector3d(-0.5 * 0.5 * 1.225 * 0.01 * 4 - 0.2,
                                                0.5 * 0.5 * 1.225 * 0.02 * 9 + 0.6, 0),
                                1e-15));
}

TEST(RigidBody, ThinnerAirTakesThrustAndTorqueInProportion) {
  const Vehicle vehicle = plus_quadrotor();
  const Speeds w = Speeds::Constant(4, 300) + Eigen::Vector4d(1, 2, 3, 4);
  const RotorLoads<double> full = rotor_loads<double>(RigidBody(vehicle), w);
  const RotorLoads<double> thin = rotor_loads<double>(RigidBody(vehicle, 0.7), w);
  EXPECT_THAT(thin.force, MatrixNear(0.7 * full.force, 1e-13));
  EXPECT_THAT(thin.torque, MatrixNear(0.7 * full.torque, 1e-13));
  EXPECT_THAT(thin.angular_momentum, MatrixNear(full.angular_momentum, 0));
}

TEST(RigidBody, JetsEqualCentralDifferences) {
  using Jet = ceres::Jet<double, 18>;
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const Vehicle vehicle = random_vehicle(random, 6);
    const RigidBody body(vehicle);
    const State x = random_state(random);
    const Speeds w = random_speeds(random, vehicle);
    StateVector<Jet> xj;
    RotorSpeeds<Jet> wj(6);
    for (int i = 0; i < 12; ++i) xj(i) = Jet(x(i), i);
    for (int i = 0; i < 6; ++i) wj(i) = Jet(w(i), 12 + i);
    const StateVector<Jet> fj = state_derivative(body, xj, rotor_loads(body, wj));
    Eigen::MatrixXd exact(12, 18), differences(12, 18);
    for (int i = 0; i < 12; ++i) exact.row(i) = fj(i).v.transpose();
    for (int j = 0; j < 18; ++j) {
      const double h = j < 12 ? 1e-5 : 1e-3;
      const auto at = [&](double step) -> State {
        State xs = x;
        Speeds ws = w;
        (j < 12 ? xs(j) : ws(j - 12)) += step;
        return state_derivative(body, xs, rotor_loads(body, ws));
      };
      differences.col(j) = (at(h) - at(-h)) / (2 * h);
    }
    // h² of the third derivatives plus the rounding eps/h of rates near 1e4.
    EXPECT_THAT(exact, MatrixNear(differences, 1e-9 * (1 + exact.norm())));
  }
}

TEST(RigidBody, EulerAndQuaternionFormAgreeAlongAMotion) {
  std::mt19937_64 random(4);
  for (int trial = 0; trial < 5; ++trial) {
    const Vehicle vehicle = random_vehicle(random, 4);
    const RigidBody body(vehicle);
    State x = random_state(random);
    x.segment<2>(3) *= 0.3;
    x.tail<3>() *= 0.3;
    const RotorLoads<double> loads = rotor_loads<double>(body, Speeds::Constant(4, 500));
    const double dt = 2e-4;
    const int steps = 1000;
    const State a = integrate(
        [&](const State& s) -> State { return state_derivative(body, s, loads); }, x, dt, steps);
    const State13 b =
        integrate([&](const State13& s) -> State13 { return state_derivative(body, s, loads); },
                  quaternion_state(x), dt, steps);
    ASSERT_LT(a.segment<2>(3).cwiseAbs().maxCoeff(), 1.4);
    EXPECT_THAT(euler_state(b), MatrixNear(a, 1e-9));
    EXPECT_GT((a - x).norm(), 0.1);
  }
}

// The equations of the uquad project, coded from its own pages: z up, psi roll, phi pitch, theta
// yaw, with the two signs of the gyroscopic torque corrected (docs/errata.md).
State uquad_equations(const State& x, const Speeds& w) {
  const double m = 1.741, L = 0.29, Ixx = 2.32e-2, Iyy = 2.32e-2, Izz = 4.37e-2, Izzm = 1.54e-5;
  const double psi = x(3), phi = x(4), theta = x(5);
  const Eigen::Vector3d v = x.segment<3>(6), q = x.segment<3>(9);
  const Eigen::ArrayXd T =
      4.60160135072435e-5 * w.array().square() - 0.00103822726273726 * w.array();
  const Eigen::ArrayXd Q = 3.4734e-6 * w.array().square() - 1.3205e-4 * w.array();
  const Eigen::Matrix3d R = (Eigen::AngleAxisd(theta, Eigen::Vector3d::UnitZ()) *
                             Eigen::AngleAxisd(phi, Eigen::Vector3d::UnitY()) *
                             Eigen::AngleAxisd(psi, Eigen::Vector3d::UnitX()))
                                .toRotationMatrix();
  const double h = Izzm * (w(0) - w(1) + w(2) - w(3));
  State d;
  d.head<3>() = R * v;
  d(3) = q(0) + std::tan(phi) * (std::sin(psi) * q(1) + std::cos(psi) * q(2));
  d(4) = std::cos(psi) * q(1) - std::sin(psi) * q(2);
  d(5) = (std::sin(psi) * q(1) + std::cos(psi) * q(2)) / std::cos(phi);
  d.segment<3>(6) = -q.cross(v) - R.transpose() * Eigen::Vector3d(0, 0, 9.81) +
                    Eigen::Vector3d(0, 0, T.sum() / m);
  d(9) = (q(1) * q(2) * (Iyy - Izz) + L * (T(1) - T(3)) - q(1) * h) / Ixx;
  d(10) = (q(0) * q(2) * (Izz - Ixx) + L * (T(2) - T(0)) + q(0) * h) / Iyy;
  d(11) = -(Q(0) - Q(1) + Q(2) - Q(3)) / Izz;
  return d;
}

TEST(RigidBody, TheSameFlightInTwoConventionsIsTheSameFlight) {
  std::mt19937_64 random(5);
  const Vehicle vehicle = plus_quadrotor();
  const RigidBody body(vehicle);
  const Convention& uquad = convention("uquad", "test");
  for (int trial = 0; trial < 5; ++trial) {
    State x = random_state(random);
    x.segment<2>(3) *= 0.3;
    x.tail<3>() *= 0.3;
    Speeds w = Speeds::Constant(4, kUquadHover) + Eigen::Vector4d(20, -12, 15, -7) * (trial - 2);
    const double dt = 1e-3;
    const int steps = 300;
    const State ned = integrate(
        [&](const State& s) -> State { return state_derivative(body, s, rotor_loads(body, w)); }, x,
        dt, steps);
    const State other = integrate([&](const State& s) { return uquad_equations(s, w); },
                                  State(uquad.from_ned * x), dt, steps);
    EXPECT_THAT(other, MatrixNear(uquad.from_ned * ned, 1e-9));
    EXPECT_GT((ned - x).norm(), 1);
  }
}

TEST(RigidBody, AWrenchIsTheSumOfTheRotors) {
  std::mt19937_64 random(6);
  const Vehicle vehicle = random_vehicle(random, 8);
  const RigidBody body(vehicle);
  const State x = random_state(random);
  const RotorLoads<double> rotors = rotor_loads(body, random_speeds(random, vehicle));
  Eigen::Vector4d wrench;
  wrench << -rotors.force.z(), rotors.torque;
  EXPECT_THAT(state_derivative(body, x, wrench_loads(wrench, rotors.angular_momentum.z())),
              MatrixNear(state_derivative(body, x, rotors), 1e-12));
}

TEST(RigidBody, FloatFollowsDouble) {
  std::mt19937_64 random(7);
  const Vehicle vehicle = random_vehicle(random, 4);
  const RigidBody body(vehicle);
  const State x = random_state(random);
  const Speeds w = random_speeds(random, vehicle);
  const State exact = state_derivative(body, x, rotor_loads(body, w));
  const StateVector<float> xf = x.cast<float>();
  const RotorSpeeds<float> wf = w.cast<float>();
  const StateVector<float> rough = state_derivative(body, xf, rotor_loads(body, wf));
  EXPECT_THAT(rough.cast<double>(), MatrixNear(exact, 1e-5 * exact.norm()));
}

TEST(RigidBody, RefusesWhatHasNoEquations) {
  const auto message = [](auto change) {
    return [change] {
      Vehicle vehicle = plus_quadrotor();
      change(vehicle);
      (void)RigidBody(vehicle);
    };
  };
  EXPECT_THAT(message([](Vehicle& v) { v.mass = -1; }),
              ThrowsMessage<InvalidInput>(HasSubstr("vehicle 'plus': mass is -1")));
  EXPECT_THAT(message([](Vehicle& v) { v.rotors.clear(); }),
              ThrowsMessage<InvalidInput>(HasSubstr("0 rotors, expected 1 to 16")));
  EXPECT_THAT(message([](Vehicle& v) { v.rotors.resize(17); }),
              ThrowsMessage<InvalidInput>(HasSubstr("17 rotors, expected 1 to 16")));
  EXPECT_THAT(message([](Vehicle& v) { v.inertia(0, 0) = -1; }),
              ThrowsMessage<InvalidInput>(HasSubstr("inertia is not symmetric and positive")));
  EXPECT_THAT(message([](Vehicle& v) { v.inertia(0, 1) = 1e-3; }),
              ThrowsMessage<InvalidInput>(HasSubstr("inertia is not symmetric and positive")));
  EXPECT_THAT([] { (void)RigidBody(plus_quadrotor(), -0.1); },
              ThrowsMessage<InvalidInput>(HasSubstr("density ratio is -0.1")));
}

}  // namespace
}  // namespace quadtune
