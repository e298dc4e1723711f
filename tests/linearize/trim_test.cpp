// SPDX-License-Identifier: Apache-2.0
#include "quadtune/linearize/trim.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <random>

#include "integrate.hpp"
#include "matrix_near.hpp"
#include "plants/sample_vehicles.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/model/rigid_body.hpp"

namespace quadtune {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::MatrixNear;
using testing::plus_quadrotor;
using testing::random_vehicle;
using ::testing::ThrowsMessage;

constexpr double kUquadHover = 316.103650939028;  // rad/s, published by the uquad project

FlightCondition hover(double yaw = 0) { return {.kind = FlightKind::hover, .yaw = yaw}; }
FlightCondition line(double speed, double climb = 0, double yaw = 0) {
  return {.kind = FlightKind::line, .yaw = yaw, .speed = speed, .climb = climb};
}
FlightCondition spin(double yaw_rate, double climb = 0, double yaw = 0) {
  return {.kind = FlightKind::spin, .yaw = yaw, .climb = climb, .yaw_rate = yaw_rate};
}
FlightCondition circle(double radius, double speed, double climb = 0, double yaw = 0) {
  return {.kind = FlightKind::circle, .yaw = yaw, .speed = speed, .climb = climb, .radius = radius};
}

Vehicle with_limits(Vehicle vehicle, double min, double max) {
  vehicle.motor.min = min;
  vehicle.motor.max = max;
  return vehicle;
}

// The equations of motion themselves at the trim: what must stand still does, the rest moves as the
// condition says.
void expect_steady(const Vehicle& vehicle, const TrimResult& result) {
  ASSERT_TRUE(result.solved()) << to_string(result.status) << ": " << result.culprit;
  const FlightCondition& c = result.condition;
  const RigidBody body(vehicle, result.density_ratio);
  const StateVector<double> x = result.x;
  const RotorSpeeds<double> w = result.u;
  const StateVector<double> derivative = state_derivative(body, x, rotor_loads(body, w));
  StateVector<double> expected = StateVector<double>::Zero();
  expected.head<3>() << c.speed * std::cos(c.yaw), c.speed * std::sin(c.yaw), -c.climb;
  expected(5) = c.kind == FlightKind::circle ? c.speed / c.radius : c.yaw_rate;
  // The residual is scaled by m g and m g L; undone here for the entries of v' and w'.
  const double arm = vehicle.rotors.front().position.norm();
  const double scale =
      vehicle.gravity * std::max(1.0, vehicle.mass * arm / vehicle.inertia.diagonal().minCoeff());
  EXPECT_THAT(derivative, MatrixNear(expected, 1e-12 * scale + 1e-14 * c.speed));
  EXPECT_LE(result.residual, 1e-10);
  EXPECT_TRUE(result.culprit.empty());
  EXPECT_GE(result.u.minCoeff(), speed_of_command(vehicle.motor, vehicle.motor.min) * (1 - 1e-8));
  EXPECT_LE(result.u.maxCoeff(), speed_of_command(vehicle.motor, vehicle.motor.max) * (1 + 1e-8));
}

TEST(Trim, HoverOfEveryBuiltInVehicleIsAnEquilibrium) {
  for (const std::string& name : built_in_vehicles()) {
    const Vehicle vehicle = load_vehicle(name);
    const TrimResult result = trim(vehicle, hover());
    ASSERT_TRUE(result.solved()) << name << ": " << result.culprit;
    const RigidBody body(vehicle);
    const StateVector<double> x = result.x;
    const RotorSpeeds<double> w = result.u;
    EXPECT_THAT(state_derivative(body, x, rotor_loads(body, w)),
                MatrixNear(StateVector<double>::Zero(), 1e-12))
        << name;
  }
}

TEST(Trim, HoverOfTheUquadIsThePublishedSpeedAtAnyYaw) {
  for (const double yaw : {0.0, 0.7, -3.0}) {
    const TrimResult result = trim(plus_quadrotor(), hover(yaw));
    expect_steady(plus_quadrotor(), result);
    EXPECT_THAT(result.u, MatrixNear(Eigen::VectorXd::Constant(4, kUquadHover), 1e-9));
    Eigen::VectorXd x = Eigen::VectorXd::Zero(12);
    x(5) = yaw;
    EXPECT_THAT(result.x, MatrixNear(x, 1e-12));
    EXPECT_NEAR(result.tilt, 0, 1e-7);
    EXPECT_NEAR(result.thrust.sum(), 1.741 * 9.81, 1e-11);
  }
  const double max = 4 * (4.60160135072435e-5 * 387 * 387 - 0.00103822726273726 * 387);
  EXPECT_NEAR(trim(plus_quadrotor(), hover()).thrust_to_weight, max / (1.741 * 9.81), 1e-14);
}

TEST(Trim, HoverOfTheMamboIsThePublishedCommand) {
  const Vehicle vehicle = load_vehicle("mambo");
  const TrimResult result = trim(vehicle, hover());
  ASSERT_TRUE(result.solved()) << result.culprit;
  for (Eigen::Index i = 0; i < 4; ++i)
    EXPECT_NEAR(command_of_speed(vehicle.motor, result.u(i)), 236.5088, 5e-5);
}

TEST(Trim, WithoutDragALineIsFlownAsAHover) {
  const TrimResult result = trim(plus_quadrotor(), line(12, 1, 0.4));
  expect_steady(plus_quadrotor(), result);
  EXPECT_THAT(result.u, MatrixNear(Eigen::VectorXd::Constant(4, kUquadHover), 1e-9));
  EXPECT_NEAR(result.tilt, 0, 1e-7);
  EXPECT_THAT(result.x.segment<3>(6), MatrixNear(Eigen::Vector3d(12, 0, -1), 1e-12));
}

// Isotropic linear drag d: D = d V against the flight, so tan(pitch) = -d V / (m g + d climb).
TEST(Trim, ALineWithDragLeansByTheBalanceOfForces) {
  Vehicle vehicle = plus_quadrotor();
  vehicle.drag.linear.setConstant(0.4);
  const double weight = vehicle.mass * vehicle.gravity;
  for (const double climb : {0.0, 2.0, -2.0}) {
    const TrimResult result = trim(vehicle, line(5, climb));
    expect_steady(vehicle, result);
    const double down = weight + 0.4 * climb;
    EXPECT_NEAR(result.x(4), -std::atan(0.4 * 5 / down), 1e-13);
    EXPECT_NEAR(result.tilt, std::atan(0.4 * 5 / down), 1e-13);
    EXPECT_NEAR(result.thrust.sum(), std::hypot(0.4 * 5, down), 1e-11);
  }
}

// Quadratic drag along body x only: at pitch a the speed along it is V cos a, and the thrust has no
// part along it: m g sin(-a) = (rho/2) cda (V cos a)².
TEST(Trim, ALineWithQuadraticDragMeetsItsEquation) {
  Vehicle vehicle = plus_quadrotor();
  vehicle.drag.cda.x() = 0.05;
  const TrimResult result = trim(vehicle, line(8));
  expect_steady(vehicle, result);
  const double pitch = result.x(4);
  EXPECT_NEAR(vehicle.mass * vehicle.gravity * std::sin(-pitch),
              0.5 * vehicle.air_density * 0.05 * std::pow(8 * std::cos(pitch), 2), 1e-12);
}

TEST(Trim, ACircleWithoutDragIsACoordinatedTurn) {
  for (const double radius : {6.0, -6.0}) {
    const double speed = 4, climb = 0.5;
    const TrimResult result = trim(plus_quadrotor(), circle(radius, speed, climb, 1.0));
    expect_steady(plus_quadrotor(), result);
    const double roll = std::atan(speed * speed / (9.81 * radius));
    const double turn = speed / radius;
    EXPECT_NEAR(result.yaw_rate, turn, 1e-15);
    EXPECT_NEAR(result.x(3), roll, 1e-13);
    EXPECT_NEAR(result.x(4), 0, 1e-13);
    EXPECT_NEAR(result.x(5), 1.0, 0);
    EXPECT_THAT(
        result.x.tail<3>(),
        MatrixNear(Eigen::Vector3d(0, turn * std::sin(roll), turn * std::cos(roll)), 1e-13));
    EXPECT_NEAR(result.thrust.sum(), 1.741 * 9.81 / std::cos(roll), 1e-11);
  }
}

// p = -ψ' sin θ, q = ψ' cos θ sin φ, r = ψ' cos θ cos φ.
TEST(Trim, ACircleWithDragKeepsTheKinematics) {
  Vehicle vehicle = plus_quadrotor();
  vehicle.drag.linear = {0.3, 0.4, 0.5};
  const TrimResult result = trim(vehicle, circle(5, 3));
  expect_steady(vehicle, result);
  const double roll = result.x(3), pitch = result.x(4), turn = 3.0 / 5;
  EXPECT_LT(pitch, -0.01);
  EXPECT_THAT(result.x.tail<3>(),
              MatrixNear(turn * Eigen::Vector3d(-std::sin(pitch), std::cos(pitch) * std::sin(roll),
                                                std::cos(pitch) * std::cos(roll)),
                         1e-14));
}

TEST(Trim, RandomVehiclesFlySteadily) {
  std::mt19937_64 random(11);
  for (const int rotors : {4, 6, 8, 16})
    for (int trial = 0; trial < 15; ++trial) {
      const Vehicle vehicle = random_vehicle(random, rotors);
      const double yaw = std::uniform_real_distribution<double>(-3, 3)(random);
      expect_steady(vehicle, trim(vehicle, hover(yaw)));
      expect_steady(vehicle, trim(vehicle, line(6, 1, yaw)));
      expect_steady(vehicle, trim(vehicle, circle(-8, 5, -0.5, yaw)));
    }
}

TEST(Trim, ThinnerAirTakesFasterRotors) {
  Vehicle vehicle = plus_quadrotor();
  for (Rotor& rotor : vehicle.rotors) rotor.thrust_a1 = rotor.torque_d1 = 0;
  const double dense = trim(vehicle, hover()).u(0);
  const TrimResult thin = trim(vehicle, hover(), {.density_ratio = 0.8});
  expect_steady(vehicle, thin);
  EXPECT_NEAR(thin.u(0), dense / std::sqrt(0.8), 1e-9);
}

TEST(Trim, ASymmetricHexacopterSharesEqually) {
  Vehicle vehicle = plus_quadrotor();
  const Rotor rotor = vehicle.rotors.front();
  vehicle.rotors.assign(6, rotor);
  for (int i = 0; i < 6; ++i) {
    const double angle = i * std::numbers::pi / 3;
    vehicle.rotors[static_cast<std::size_t>(i)].position = {0.3 * std::cos(angle),
                                                            0.3 * std::sin(angle), 0};
    vehicle.rotors[static_cast<std::size_t>(i)].spin =
        i % 2 ? Spin::clockwise : Spin::counter_clockwise;
  }
  const TrimResult result = trim(vehicle, hover());
  expect_steady(vehicle, result);
  EXPECT_THAT(result.thrust, MatrixNear(Eigen::VectorXd::Constant(6, 1.741 * 9.81 / 6), 1e-11));
}

// The thrusts of least sum of squares are a combination of what a thrust does to lift, roll, pitch
// and yaw: no other sharing that balances is shorter.
TEST(Trim, MoreThanFourRotorsShareWithLeastSquares) {
  std::mt19937_64 random(12);
  for (int trial = 0; trial < 10; ++trial) {
    const Vehicle vehicle = random_vehicle(random, 8);
    const TrimResult result = trim(vehicle, hover());
    expect_steady(vehicle, result);
    Eigen::MatrixXd effect(8, 4);
    for (int i = 0; i < 8; ++i) {
      const Rotor& rotor = vehicle.rotors[static_cast<std::size_t>(i)];
      const double torque_per_thrust = (2 * rotor.torque_d2 * result.u(i) + rotor.torque_d1) /
                                       (2 * rotor.thrust_a2 * result.u(i) + rotor.thrust_a1);
      effect.row(i) << 1, rotor.position.y(), rotor.position.x(),
          spin_sign(rotor.spin) * torque_per_thrust;
    }
    const Eigen::MatrixXd normal = effect.transpose() * effect;
    const Eigen::VectorXd projected =
        effect * normal.llt().solve(effect.transpose() * result.thrust);
    EXPECT_THAT(projected, MatrixNear(result.thrust, 1e-8));
  }
}

// Each rotor of six alone at a corner of its own: limits that exclude the shortest sharing, but not
// every sharing, leave the trim solvable.
TEST(Trim, RotorsAtALimitLeaveTheRestToOthers) {
  std::mt19937_64 random(13);
  Vehicle vehicle = random_vehicle(random, 6);
  const TrimResult free = trim(vehicle, hover());
  expect_steady(vehicle, free);
  ASSERT_GT(free.u.maxCoeff() - free.u.minCoeff(), 1);
  vehicle.motor.max = free.u.maxCoeff() - 0.2;
  const TrimResult bounded = trim(vehicle, hover());
  expect_steady(vehicle, bounded);
  EXPECT_NEAR(bounded.u.maxCoeff(), vehicle.motor.max, 1e-7);
  EXPECT_GT(bounded.thrust.norm(), free.thrust.norm());
}

TEST(Trim, TooHeavyReportsTheMissingThrust) {
  Vehicle vehicle = plus_quadrotor();
  vehicle.mass = 4;
  const TrimResult result = trim(vehicle, hover());
  EXPECT_EQ(result.status, TrimStatus::not_enough_thrust);
  EXPECT_EQ(result.culprit,
            "hover needs 39.24 N, the rotors give at most 25.96 N at 387 rad/s: 13.28 N short");
  EXPECT_LT(result.thrust_to_weight, 1);
  EXPECT_TRUE(result.x.array().isNaN().all());
  EXPECT_TRUE(result.u.array().isNaN().all());
  EXPECT_EQ(result.u.size(), 4);
}

TEST(Trim, TooFastNamesTheTilt) {
  Vehicle vehicle = plus_quadrotor();
  vehicle.drag.linear.setConstant(0.5);
  const TrimResult result = trim(vehicle, line(60));
  EXPECT_EQ(result.status, TrimStatus::not_enough_thrust);
  EXPECT_THAT(result.culprit, HasSubstr("line at 60 m/s needs a tilt of 60.3° and 34.52 N, the "
                                        "rotors give at most 25.96 N at 387 rad/s: 8.56 N short"));
}

// Flown by the nonlinear equations with the rotors held, a spin stays on its spot and on its axis.
TEST(Trim, ASpinTurnsOnTheSpot) {
  std::mt19937_64 random(4);
  for (int i = 0; i < 20; ++i) {
    const Vehicle vehicle = random_vehicle(random, i % 2 ? 4 : 6);
    const double rate = i % 4 < 2 ? 1.5 : -0.8;
    const double climb = i % 3 == 0 ? 0.5 : 0;
    const TrimResult result = trim(vehicle, spin(rate, climb, 0.4));
    expect_steady(vehicle, result);
    EXPECT_EQ(result.yaw_rate, rate);
    const RigidBody body(vehicle);
    const RotorSpeeds<double> w = result.u;
    const auto motion = [&](const StateVector<double>& x) {
      return state_derivative(body, x, rotor_loads(body, w));
    };
    const double time = 0.5;
    const StateVector<double> end =
        testing::integrate(motion, StateVector<double>(result.x), time / 500, 500);
    StateVector<double> expected = result.x;
    expected(2) -= climb * time;
    expected(5) += rate * time;
    EXPECT_THAT(end, MatrixNear(expected, 1e-6)) << "vehicle " << i;
  }
}

// An even vehicle spins level, at the hover's speeds but for the moment that drives nothing.
TEST(Trim, ASpinOfAnEvenVehicleIsAHover) {
  const TrimResult still = trim(plus_quadrotor(), hover());
  const TrimResult turning = trim(plus_quadrotor(), spin(2));
  ASSERT_TRUE(turning.solved()) << turning.culprit;
  EXPECT_THAT(turning.u, MatrixNear(still.u, 1e-9));
  EXPECT_NEAR(turning.tilt, 0, 1e-10);
  EXPECT_NEAR(turning.x(11), 2, 1e-12);
}

TEST(Trim, ASpinIsTheLimitOfTightCircles) {
  std::mt19937_64 random(5);
  const Vehicle vehicle = random_vehicle(random, 4);
  const TrimResult on_the_spot = trim(vehicle, spin(1.5));
  const TrimResult tight = trim(vehicle, circle(1e-7, 1.5e-7));
  ASSERT_TRUE(tight.solved()) << tight.culprit;
  EXPECT_THAT(on_the_spot.u, MatrixNear(tight.u, 1e-4));
  EXPECT_THAT(on_the_spot.x, MatrixNear(tight.x, 1e-6));
}

TEST(Trim, RejectsInvalidSpins) {
  const auto refuses = [](const FlightCondition& condition, const std::string& why) {
    EXPECT_THAT([&] { (void)trim(plus_quadrotor(), condition); },
                ThrowsMessage<InvalidInput>(HasSubstr(why)));
  };
  refuses(spin(0), "yaw rate is 0 rad/s, expected a positive number");
  refuses(spin(std::nan("")), "yaw rate is nan");
  refuses({.kind = FlightKind::spin, .speed = 1, .yaw_rate = 1}, "speed is 1 m/s, expected 0");
  refuses({.kind = FlightKind::circle, .speed = 1, .radius = 1, .yaw_rate = 1},
          "yaw rate is 1 rad/s, expected 0 for a circle because it is speed/radius");
  refuses({.kind = FlightKind::hover, .yaw_rate = 1}, "expected 0 for a hover");
}

TEST(Trim, TooTightACircleHasNoTrim) {
  const TrimResult result = trim(plus_quadrotor(), circle(1, 10));
  EXPECT_EQ(result.status, TrimStatus::not_enough_thrust);
  EXPECT_THAT(result.culprit, HasSubstr("circle of 1 m at 10 m/s needs a tilt of 84.4°"));
}

TEST(Trim, OneRotorTooFastIsNamed) {
  Vehicle vehicle = plus_quadrotor();
  // The centre of mass well in front of the middle: the front rotor (1) carries more.
  for (Rotor& rotor : vehicle.rotors) rotor.position.x() -= 0.12;
  const TrimResult result = trim(with_limits(vehicle, 50, 360), hover());
  EXPECT_EQ(result.status, TrimStatus::rotor_too_fast);
  EXPECT_THAT(result.culprit, AllOf(HasSubstr("hover needs 17.08 N in all, and rotor "),
                                    HasSubstr("limit 360.0 rad/s")));
}

TEST(Trim, RotorsBelowTheirMinimumSpeedAreReported) {
  const TrimResult result = trim(with_limits(plus_quadrotor(), 330, 387), hover());
  EXPECT_EQ(result.status, TrimStatus::rotor_too_slow);
  EXPECT_THAT(result.culprit, HasSubstr("would have to turn at 316.1 rad/s, minimum 330.0 rad/s: "
                                        "13.9 rad/s too slow"));
}

// Below a thousandth of the maximum speed, the curve of a rotor is continued by a line.
TEST(Trim, AThrustThatNoSpeedGivesIsReportedAsAThrust) {
  Vehicle vehicle = plus_quadrotor();
  for (Rotor& rotor : vehicle.rotors) rotor.thrust_a2 *= 1e12;
  const TrimResult result = trim(with_limits(vehicle, 0, 1000), hover());
  EXPECT_EQ(result.status, TrimStatus::rotor_too_slow);
  EXPECT_THAT(result.culprit, AllOf(HasSubstr("would have to give 4.27 N, minimum "),
                                    HasSubstr(" N, its thrust at 1.0 rad/s")));
}

TEST(Trim, ARotorThatWouldHaveToPushDownIsNamed) {
  Vehicle vehicle = plus_quadrotor();
  for (Rotor& rotor : vehicle.rotors) rotor.position.x() -= 0.32;  // all behind the centre of mass
  const TrimResult result = trim(with_limits(vehicle, 50, 2000), hover());
  EXPECT_EQ(result.status, TrimStatus::rotor_too_slow);
  EXPECT_THAT(result.culprit, HasSubstr("would have to push down with"));
}

TEST(Trim, FallingFasterThanDragHoldsHasNoTrim) {
  Vehicle vehicle = plus_quadrotor();
  vehicle.drag.linear.setConstant(1);
  const TrimResult result = trim(vehicle, line(0, -30));
  EXPECT_EQ(result.status, TrimStatus::rotor_too_slow);
  EXPECT_THAT(result.culprit, HasSubstr("line at 0 m/s climbing -30 m/s needs"));
}

TEST(Trim, RotorsThatAllTurnOneWayCannotBalanceYaw) {
  Vehicle vehicle = plus_quadrotor();
  for (Rotor& rotor : vehicle.rotors) rotor.spin = Spin::clockwise;
  const TrimResult result = trim(vehicle, hover());
  EXPECT_EQ(result.status, TrimStatus::no_authority);
  EXPECT_THAT(
      result.culprit,
      HasSubstr("yaw cannot be balanced: thrusts that carry the weight and balance "
                "the torques as far as possible leave a torque of 1.22 N m; 4 of 4 rotors turn"));
}

TEST(Trim, TooFewRotorsHaveNoAuthority) {
  Vehicle vehicle = plus_quadrotor();
  vehicle.rotors.resize(3);
  EXPECT_EQ(trim(vehicle, hover()).status, TrimStatus::no_authority);
  vehicle.rotors.resize(1);
  EXPECT_EQ(trim(vehicle, hover()).status, TrimStatus::no_authority);
}

TEST(Trim, EndsForEveryRequest) {
  std::mt19937_64 random(14);
  for (int trial = 0; trial < 100; ++trial) {
    Vehicle vehicle = random_vehicle(random, trial % 2 ? 4 : 6);
    const auto between = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    vehicle.drag.cda *= between(0, 20);
    const FlightCondition wanted = trial % 3
                                       ? circle(between(0.1, 20), between(0.1, 50), between(-9, 9))
                                       : line(between(0, 80), between(-30, 30));
    const TrimResult result = trim(vehicle, wanted);
    if (result.solved()) {
      expect_steady(vehicle, result);
    } else {
      EXPECT_NE(result.status, TrimStatus::not_run);
      EXPECT_FALSE(result.culprit.empty());
      EXPECT_TRUE(result.u.array().isNaN().all());
    }
    EXPECT_NE(result.status, TrimStatus::no_convergence) << result.culprit;
  }
}

TEST(Trim, RefusesConditionsThatAreNoFlight) {
  const double nan = std::nan("");
  const auto refusal = [](const FlightCondition& c) {
    return [c] { (void)trim(plus_quadrotor(), c); };
  };
  EXPECT_THAT(refusal(line(-1)),
              ThrowsMessage<InvalidInput>(HasSubstr("trim: speed is -1 m/s, expected a finite")));
  EXPECT_THAT(refusal(line(nan)), ThrowsMessage<InvalidInput>(HasSubstr("speed is nan m/s")));
  EXPECT_THAT(refusal(hover(INFINITY)), ThrowsMessage<InvalidInput>(HasSubstr("yaw is inf rad")));
  EXPECT_THAT(refusal(line(1, nan)), ThrowsMessage<InvalidInput>(HasSubstr("climb is nan m/s")));
  EXPECT_THAT(refusal(circle(0, 3)), ThrowsMessage<InvalidInput>(HasSubstr("radius is 0 m")));
  EXPECT_THAT(refusal(circle(nan, 3)), ThrowsMessage<InvalidInput>(HasSubstr("radius is nan m")));
  EXPECT_THAT(refusal(circle(3, 0)), ThrowsMessage<InvalidInput>(HasSubstr("speed is 0 m/s")));
  FlightCondition moving = hover();
  moving.speed = 3;
  EXPECT_THAT(refusal(moving), ThrowsMessage<InvalidInput>(HasSubstr("the hover has speed 3 m/s")));
  FlightCondition bent = line(3);
  bent.radius = 5;
  EXPECT_THAT(refusal(bent),
              ThrowsMessage<InvalidInput>(HasSubstr("radius is 5 m, expected 0 for a line")));
  EXPECT_THAT([] { (void)trim(plus_quadrotor(), hover(), {.density_ratio = 0}); },
              ThrowsMessage<InvalidInput>(HasSubstr("density ratio is 0")));
  EXPECT_THAT([] { (void)trim(plus_quadrotor(), hover(), {.max_iterations = 0}); },
              ThrowsMessage<InvalidInput>(HasSubstr("max_iterations is 0")));
}

TEST(Trim, RefusesAThrustThatDoesNotRise) {
  Vehicle vehicle = plus_quadrotor();
  vehicle.rotors[2].thrust_a1 = -1;
  EXPECT_THAT([&] { (void)trim(vehicle, hover()); },
              ThrowsMessage<InvalidInput>(HasSubstr("rotor 3: thrust")));
}

TEST(Trim, ReadsHonestlyBeforeItRan) {
  const TrimResult result;
  EXPECT_FALSE(result.solved());
  EXPECT_EQ(to_string(result.status), "not run");
}

}  // namespace
}  // namespace quadtune
