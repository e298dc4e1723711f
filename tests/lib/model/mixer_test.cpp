// SPDX-License-Identifier: Apache-2.0
#include "quadtune/model/mixer.hpp"

#include <gmock/gmock.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <random>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using testing::MatrixNear;
using testing::MatrixRelativelyNear;
using ::testing::ThrowsMessage;

constexpr double kB = 2e-5;  // thrust per squared speed
constexpr double kK = 3e-7;  // drag torque per squared speed
constexpr double kArm = 0.2;

// n rotors on a circle, the first at `first` radians clockwise from the front, going round
// clockwise seen from above, spins alternating from clockwise.
Vehicle ring(int n, double first) {
  Vehicle vehicle;
  vehicle.name = "ring";
  vehicle.mass = 1;
  vehicle.inertia = Eigen::Vector3d(0.01, 0.01, 0.018).asDiagonal();
  for (int i = 0; i < n; ++i) {
    const double angle = first + 2 * std::numbers::pi * i / n;
    Rotor rotor;
    rotor.position = {kArm * std::cos(angle), kArm * std::sin(angle), -0.01};
    rotor.spin = i % 2 == 0 ? Spin::clockwise : Spin::counter_clockwise;
    rotor.thrust_a2 = kB;
    rotor.torque_d2 = kK;
    vehicle.rotors.push_back(rotor);
  }
  vehicle.motor.min = 50;
  vehicle.motor.max = 800;
  validate(vehicle, "ring");
  return vehicle;
}

// The Mambo thesis, equation 2.23, motor 1 front, 2 right, 3 back, 4 left; 1 and 3 clockwise. It
// prints tau_y = l (T3 - T1); with z down and thrust along -z, r × F at the front is +l T1.
TEST(MixerMatrix, IsTheThesisPlusLayoutCorrected) {
  Eigen::Matrix4d expected;
  expected << kB, kB, kB, kB,       //
      0, -kArm * kB, 0, kArm * kB,  //
      kArm * kB, 0, -kArm * kB, 0,  //
      -kK, kK, -kK, kK;
  EXPECT_THAT(mixer_matrix(ring(4, 0)), MatrixNear(expected, 1e-21));
}

// Equation 2.26, motor 1 front left, 2 front right, 3 back right, 4 back left. Its rows called
// tau_x and tau_y are pitch and roll for thrust counted along +z; from the positions they are
// these.
TEST(MixerMatrix, IsTheThesisXLayoutCorrected) {
  const double h = kArm * std::numbers::sqrt2 / 2;
  Eigen::Matrix4d expected;
  expected << kB, kB, kB, kB,            //
      h * kB, -h * kB, -h * kB, h * kB,  //
      h * kB, h * kB, -h * kB, -h * kB,  //
      -kK, kK, -kK, kK;
  EXPECT_THAT(mixer_matrix(ring(4, -std::numbers::pi / 4)), MatrixNear(expected, 1e-20));
}

// The printed matrix 2.26 = [b b b b; -h -h h h; -h h h -h; -k k -k k] with its rows as they are:
// thrust along +z, so torques of thrust change sign, in the order force, pitch, roll, yaw.
TEST(ThrustMixer, HasTheRowsThatTheThesisPrints) {
  const Vehicle x = ring(4, -std::numbers::pi / 4);
  const Eigen::Matrix4d M = thrust_mixer(x).Ts2Q;
  const double h = kArm * std::numbers::sqrt2 / 2;
  EXPECT_THAT(M.row(0), MatrixNear(Eigen::RowVector4d(1, 1, 1, 1), 0));
  EXPECT_THAT(M.row(2), MatrixNear(h * Eigen::RowVector4d(-1, -1, 1, 1), 1e-16));
  EXPECT_THAT(M.row(3), MatrixNear(h * Eigen::RowVector4d(-1, 1, 1, -1), 1e-16));
}

// Public values of the Mambo's model project, single precision there.
TEST(ThrustMixer, IsTheMambosTs2Q) {
  const Vehicle mambo = load_vehicle("mambo");
  const ThrustMixer mixer = thrust_mixer(mambo);
  const double c = std::sqrt(0.0107 / 2) * 0.033;  // Cq/Ct r, 2.41374e-3 m
  const double a = 0.0624 / std::numbers::sqrt2;
  Eigen::Matrix4d Ts2Q;
  Ts2Q << 1, 1, 1, 1,  //
      c, -c, c, -c,    //
      -a, -a, a, a,    //
      -a, a, a, -a;
  EXPECT_THAT(mixer.Ts2Q, MatrixNear(Ts2Q, 1e-16));
  const double y = 103.573624;
  const double p = 5.66592;
  Eigen::Matrix4d Q2Ts;
  Q2Ts << 0.25, y, -p, -p,  //
      0.25, -y, -p, p,      //
      0.25, y, p, p,        //
      0.25, -y, p, -p;
  EXPECT_THAT(mixer.Q2Ts, MatrixRelativelyNear(Q2Ts, 1e-6));
  EXPECT_THAT(mixer.Ts2Q * mixer.Q2Ts,
              MatrixNear(Eigen::Matrix4d(Eigen::Matrix4d::Identity()), 1e-14));
}

TEST(Mambo, CommandsAndLimitsAreThePublicNumbers) {
  const Vehicle mambo = load_vehicle("mambo");
  const double hover = mambo.mass * mambo.gravity;
  EXPECT_NEAR(hover, 0.61803, 1e-15);
  EXPECT_NEAR(command_per_thrust(mambo) / 1530.72683, 1, 1e-6);
  EXPECT_NEAR(command_per_thrust(mambo) * hover / 4 / 236.5088, 1, 1e-6);
  EXPECT_NEAR(altitude_thrust_limit(mambo) / 1.20204335, 1, 1e-6);
}

// The equations of the uquad page in its own axes (y left, z up): roll L (T2 - T4), pitch
// L (T3 - T1), yaw -(Q1 - Q2 + Q3 - Q4); turned into ours, pitch and yaw change sign.
TEST(WrenchOfSpeeds, IsTheUquadsEquations) {
  const Vehicle uquad = load_vehicle("uquad");
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> speed(109, 387);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector4d w(speed(random), speed(random), speed(random), speed(random));
    Eigen::Array4d T = 4.60160135072435e-5 * w.array().square() - 0.00103822726273726 * w.array();
    Eigen::Array4d Q = 3.4734e-6 * w.array().square() - 1.3205e-4 * w.array();
    const Eigen::Vector4d expected(T.sum(), 0.29 * (T(1) - T(3)), -0.29 * (T(2) - T(0)),
                                   Q(0) - Q(1) + Q(2) - Q(3));
    EXPECT_THAT(wrench_of_speeds(uquad, w), MatrixNear(expected, 1e-13));
    EXPECT_THAT(wrench_of_speeds(uquad, w, 0.8), MatrixNear(0.8 * expected, 1e-13));
  }
}

// A rotor in front that pulls harder lifts the nose; one on the left rolls to the right; the
// clockwise ones that turn faster yaw the body to the left.
TEST(WrenchOfSpeeds, HasTheSignsOfTheBody) {
  const Vehicle plus = ring(4, 0);
  const Eigen::Vector4d hover = Eigen::Vector4d::Constant(300);
  const auto change = [&](int rotor) -> Eigen::Vector4d {
    return wrench_of_speeds(plus, Eigen::Vector4d(hover + Eigen::Vector4d::Unit(rotor))) -
           wrench_of_speeds(plus, hover);
  };
  EXPECT_GT(change(0)(2), 0);  // front: nose up
  EXPECT_GT(change(3)(1), 0);  // left: right side down
  EXPECT_LT(change(0)(3), 0);  // clockwise: nose to the left
  EXPECT_GT(change(1)(3), 0);
  EXPECT_GT(change(0)(0), 0);
}

TEST(WrenchJacobian, IsTheDifferenceQuotient) {
  const Vehicle uquad = load_vehicle("uquad");
  const Eigen::VectorXd w = Eigen::Vector4d(200, 250, 300, 350);
  const Eigen::MatrixXd J = wrench_jacobian(uquad, w, 0.9);
  for (int i = 0; i < 4; ++i) {
    const Eigen::VectorXd h = Eigen::Vector4d::Unit(i);  // exact for a quadratic
    EXPECT_THAT(
        J.col(i),
        MatrixNear((wrench_of_speeds(uquad, w + h, 0.9) - wrench_of_speeds(uquad, w - h, 0.9)) / 2,
                   1e-13));
  }
}

TEST(AllocationMatrix, IsTheMixerOverTheThrusts) {
  for (const int n : {4, 6, 8}) {
    const Vehicle vehicle = ring(n, 0.1);
    EXPECT_THAT(allocation_matrix(vehicle), MatrixNear(mixer_matrix(vehicle) / kB, 1e-15));
  }
}

// Any speeds within the limits make a wrench that the search finds again, for four rotors with the
// very same speeds, for more with speeds that need no more effort.
TEST(SpeedsForWrench, InvertsTheMapForAnyLayout) {
  std::mt19937_64 random(5);
  std::vector<Vehicle> vehicles = {load_vehicle("uquad"),
                                   load_vehicle("mambo"),
                                   load_vehicle("crazyflie"),
                                   ring(4, 0),
                                   ring(6, 0),
                                   ring(8, 0.2)};
  for (const Vehicle& vehicle : vehicles) {
    const auto n = static_cast<Eigen::Index>(vehicle.rotors.size());
    std::uniform_real_distribution<double> share(0.3, 0.7);
    for (int i = 0; i < 200; ++i) {
      Eigen::VectorXd w(n);
      for (Eigen::Index j = 0; j < n; ++j)
        w(j) = min_speed(vehicle) + share(random) * (max_speed(vehicle) - min_speed(vehicle));
      const Eigen::Vector4d wrench = wrench_of_speeds(vehicle, w);
      const MixResult result = speeds_for_wrench(vehicle, wrench);
      ASSERT_TRUE(result.solved()) << vehicle.name << ": " << result.culprit;
      EXPECT_LE(result.residual, 1e-11);
      EXPECT_LE(result.iterations, 20);
      if (n == 4) {
        EXPECT_THAT(result.w, MatrixRelativelyNear(w, 1e-9));
      }
      EXPECT_GE(result.w.minCoeff(), min_speed(vehicle));
      EXPECT_LE(result.w.maxCoeff(), max_speed(vehicle));
    }
  }
}

TEST(SpeedsForWrench, ReportsTheSaturatedRotorAndTheMissingWrench) {
  const Vehicle plus = ring(4, 0);
  const double max = max_thrust(plus);
  const MixResult result = speeds_for_wrench(plus, {max + 5, 0, 0, 0});
  EXPECT_EQ(result.status, MixStatus::saturated);
  EXPECT_NEAR(result.missing(0), 5, 1e-9);
  EXPECT_THAT(result.culprit, HasSubstr("rotor 1 is at its maximum speed of 800 rad/s"));
  EXPECT_THAT(result.culprit, HasSubstr("missing 5 N of T"));
  EXPECT_EQ(result.w.maxCoeff(), 800);
}

TEST(SpeedsForWrench, SaturatesAtTheMinimumSpeed) {
  const MixResult result = speeds_for_wrench(ring(4, 0), {0, 0, 0, 0});
  EXPECT_EQ(result.status, MixStatus::saturated);
  EXPECT_THAT(result.culprit, HasSubstr("minimum speed of 50 rad/s"));
  Vehicle free = ring(4, 0);
  free.motor.min = 0;
  EXPECT_TRUE(speeds_for_wrench(free, {0, 0, 0, 0}).solved());
  // Torque without thrust would require a rotor with negative thrust.
  EXPECT_EQ(speeds_for_wrench(free, {0, 1, 0, 0}).status, MixStatus::saturated);
}

// A hexarotor with one rotor at its limit shares the rest among the others.
TEST(SpeedsForWrench, SharesWhatARotorAtItsLimitCannotGive) {
  const Vehicle hexa = ring(6, 0);
  Eigen::VectorXd w(6);
  w << 800, 500, 500, 420, 500, 500;
  Eigen::Vector4d wrench = wrench_of_speeds(hexa, w);
  wrench(2) *= 1.05;
  const MixResult result = speeds_for_wrench(hexa, wrench);
  ASSERT_TRUE(result.solved()) << result.culprit;
  EXPECT_LE(result.w.maxCoeff(), 800);
}

TEST(SpeedsForWrench, ReportsTheWrenchThatALayoutCannotProduce) {
  Vehicle two = ring(4, 0);
  two.rotors.erase(two.rotors.begin() + 3);
  two.rotors.erase(two.rotors.begin() + 1);
  two.rotors[1].spin = Spin::counter_clockwise;  // one in front, one behind
  const MixResult result = speeds_for_wrench(two, {10, 0.1, 0, 0});
  EXPECT_EQ(result.status, MixStatus::infeasible);
  EXPECT_THAT(result.culprit,
              HasSubstr("the layout cannot produce this wrench; missing 0.1 N m of tau_x"));
  EXPECT_TRUE(speeds_for_wrench(two, {10, 0, 0, 0}).solved());
}

TEST(Mixer, RefusesWhatHasNoMatrix) {
  const Vehicle uquad = load_vehicle("uquad");
  EXPECT_THAT([&] { (void)mixer_matrix(uquad); },
              ThrowsMessage<InvalidInput>(HasSubstr(
                  "rotor 1 of 'uquad' has a thrust or torque with a linear term in speed")));
  EXPECT_THAT([&] { (void)allocation_matrix(uquad); },
              ThrowsMessage<InvalidInput>(HasSubstr("not proportional to its thrust")));
  EXPECT_THAT([&] { (void)command_per_thrust(uquad); },
              ThrowsMessage<InvalidInput>(HasSubstr("expected squared speeds")));
  EXPECT_THAT([] { (void)thrust_mixer(ring(6, 0)); },
              ThrowsMessage<InvalidInput>(HasSubstr("'ring' has 6 rotors, expected 4")));
  EXPECT_THROW((void)speeds_for_wrench(uquad, {1, std::nan(""), 0, 0}), InvalidInput);
  EXPECT_THROW((void)speeds_for_wrench(uquad, {1, 0, 0, 0}, 0), InvalidInput);
}

}  // namespace
}  // namespace quadtune
