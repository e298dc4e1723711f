// SPDX-License-Identifier: Apache-2.0
// The family of hovers must agree with the linearization of each of its vehicles.
#include "quadtune/tuning/uncertain_vehicle.hpp"

#include <gmock/gmock.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "matrix_near.hpp"
#include "quadtune/discretize/delay.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/linearize/linearize.hpp"
#include "quadtune/synthesis/actuator_lqi.hpp"
#include "quadtune/synthesis/state_feedback.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::HasSubstr;

/// LQR of unit weights, integrals of the named states.
Gains gains_for(const Vehicle& vehicle, const std::string& words, InputKind kind, double dt,
                const std::vector<std::string>& integrals = {}) {
  LinearizeOptions options;
  options.convention = words;
  options.inputs = kind;
  const Linearization model = linearize(vehicle, FlightCondition{}, options);
  LqrDesign design;
  design.convention = words;
  design.input_kind = kind;
  design.integrals = integrals;
  design.Q = MatrixXd::Identity(12, 12);
  design.R = model.plant.B.squaredNorm() / 16 * MatrixXd::Identity(4, 4);
  const auto ni = static_cast<Eigen::Index>(integrals.size());
  design.Q_integral = MatrixXd::Identity(ni, ni);
  design.method = LqrMethod::discrete;
  design.dt = dt;
  const StateFeedback feedback = state_feedback(model.plant, design);
  EXPECT_TRUE(feedback.riccati.solved()) << feedback.riccati.culprit;
  Gains gains;
  gains.K = feedback.K;
  gains.K_int = feedback.K_int;
  gains.states = model.plant.states;
  gains.inputs = model.plant.inputs;
  gains.integrals = integral_signals(gains.states, integrals);
  gains.x0 = model.x0;
  gains.u0 = model.u0;
  gains.vehicle = vehicle.name;
  gains.convention = words;
  gains.input_kind = kind;
  gains.sign_law = convention(words, "test").sign_law;
  gains.dt = dt;
  if (gains.sign_law == SignLaw::state_minus_set_point) {
    gains.K *= -1;
    gains.K_int *= -1;
  }
  return gains;
}

/// p is mass, inertia x y z, thrust, delay.
Vehicle changed(Vehicle vehicle, const VectorXd& p) {
  vehicle.mass *= p(0);
  for (int i = 0; i < 3; ++i) vehicle.inertia(i, i) *= p(1 + i);
  for (Rotor& rotor : vehicle.rotors) {
    rotor.thrust_a2 *= p(4);
    rotor.thrust_a1 *= p(4);
    rotor.torque_d2 *= p(4);
    rotor.torque_d1 *= p(4);
  }
  return vehicle;
}

/// Independent computation: trim, Jacobians, hold and delay of the changed vehicle, and the law
/// around it.
double radius_of(const Vehicle& vehicle, const Gains& gains, double delay) {
  LinearizeOptions options;
  options.convention = gains.convention;
  options.inputs = gains.input_kind;
  const Linearization model = linearize(vehicle, FlightCondition{}, options);
  EXPECT_TRUE(model.solved()) << model.trim.culprit;
  if (delay == 0) {
    const DiscreteLti loop = open_loop(discretize_zoh(model.plant, gains.dt), gains);
    return (loop.A - loop.B * loop.C).eigenvalues().cwiseAbs().maxCoeff();
  }
  // open_loop() does not support a delayed plant: its integrals and outputs are added here.
  const DiscreteLti plant =
      discretize_zoh(model.plant, gains.dt, {VectorXd::Constant(model.plant.B.cols(), delay), {}});
  const DiscreteLti law = open_loop(discretize_zoh(model.plant, gains.dt), gains);
  const Eigen::Index nx = model.plant.A.rows();
  const Eigen::Index ni = law.A.rows() - nx;
  const Eigen::Index n = plant.A.rows();
  MatrixXd M = MatrixXd::Zero(n + ni, n + ni);
  M.topLeftCorner(n, n) = plant.A;
  M.block(0, 0, n, nx) -= plant.B * law.C.leftCols(nx);
  M.topRightCorner(n, ni) = -plant.B * law.C.rightCols(ni);
  M.block(n, 0, ni, nx) = law.A.bottomLeftCorner(ni, nx);
  M.bottomRightCorner(ni, ni).setIdentity();
  return M.eigenvalues().cwiseAbs().maxCoeff();
}

TEST(UncertainHover, IsTheLoopOfEveryVehicleOfTheBox) {
  struct Case {
    const char* vehicle;
    const char* words;
    InputKind kind;
    std::vector<std::string> integrals;
  };
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(0.85, 1.15);
  for (const Case& c : {Case{"uquad", "uquad", InputKind::rotor_speed, {"x", "z"}},
                        Case{"uquad", "ned", InputKind::command, {}},
                        Case{"mambo", "mambo", InputKind::command, {"pz"}},
                        Case{"mambo", "ned", InputKind::rotor_thrust, {}}}) {
    Vehicle vehicle = load_vehicle(c.vehicle);
    vehicle.drag.linear << 0.05, 0.03, 0.1;
    const double dt = 0.01;
    const Gains gains = gains_for(vehicle, c.words, c.kind, dt, c.integrals);
    VehicleUncertainty u;
    u.mass = u.inertia = u.thrust = {0.85, 1.15};
    u.delay = {0, 0.03};
    const LoopFamily family = uncertain_hover(vehicle, gains, u);
    const LoopBox box = family.over(scaled_box(family, 1).low, scaled_box(family, 1).high);
    for (int trial = 0; trial < 10; ++trial) {
      VectorXd p(6);
      for (int i = 0; i < 5; ++i) p(i) = trial == 0 ? 1 : uniform(random);
      // Linearization assumes that commanded thrusts are the true ones; on board they follow the
      // nominal curve.
      if (c.kind == InputKind::rotor_thrust) p(4) = 1;
      p(5) = trial % 2 == 0 ? 0 : 0.03 * (uniform(random) - 0.85) / 0.3;
      const LoopPoint point = family.at(p);
      EXPECT_NEAR(spectral_radius(family.loop, point.numbers, point.delay),
                  radius_of(changed(vehicle, p), gains, p(5)), 1e-7)
          << c.vehicle << " " << p.transpose();
      EXPECT_TRUE((point.numbers.array() >= box.low.array()).all() &&
                  (point.numbers.array() <= box.high.array()).all())
          << point.numbers.transpose();
    }
    EXPECT_THAT(family.at(VectorXd::Ones(6)).numbers,
                testing::MatrixNear(VectorXd::Ones(5), 1e-12));
  }
}

// A wrench is distributed by the nominal curves: all components scale with the ratio of thrust.
TEST(UncertainHover, ScalesAWrenchByTheRatioOfThrust) {
  const Vehicle vehicle = load_vehicle("mambo");
  const Gains gains = gains_for(vehicle, "mambo", InputKind::wrench, 0.005);
  const LoopFamily family = uncertain_hover(vehicle, gains, {{0.9, 1.1}, {0.8, 1.2}, {0.9, 1.1}});
  const VectorXd p = (VectorXd(6) << 0.95, 0.8, 1.1, 1.2, 1.08, 0).finished();
  EXPECT_THAT(
      family.at(p).numbers,
      testing::MatrixNear(
          (VectorXd(4) << 1.08 / 0.95, 1.08 / 0.8, 1.08 / 1.1, 1.08 / 1.2).finished(), 1e-14));
}

// The bounds are attained at corners of the box, so they are tight.
TEST(UncertainHover, BoundsRotorSpeedsTightly) {
  const Vehicle vehicle = load_vehicle("uquad");
  const Gains gains = gains_for(vehicle, "uquad", InputKind::rotor_speed, 0.01);
  const LoopFamily family = uncertain_hover(vehicle, gains, {{0.8, 1.2}, {0.8, 1.2}, {0.9, 1.1}});
  const ParameterBox box = scaled_box(family, 1);
  const LoopBox bounds = family.over(box.low, box.high);
  VectorXd min = VectorXd::Constant(4, 1e9);
  VectorXd max = -min;
  for (int corner = 0; corner < 32; ++corner) {
    VectorXd p = box.low;
    for (int i = 0; i < 5; ++i)
      if ((corner >> i & 1) != 0) p(i) = box.high(i);
    min = min.cwiseMin(family.at(p).numbers);
    max = max.cwiseMax(family.at(p).numbers);
  }
  EXPECT_THAT(bounds.low, testing::MatrixNear(min, 1e-12));
  EXPECT_THAT(bounds.high, testing::MatrixNear(max, 1e-12));
}

// The lag of a motor reduces the phase as its time constant predicts; a tiny lag has no effect.
TEST(UncertainHover, IncludesTheMotorLag) {
  const Vehicle vehicle = load_vehicle("uquad");
  const Gains gains = gains_for(vehicle, "uquad", InputKind::rotor_speed, 0.01);
  const auto radius = [&](double lag) {
    VehicleUncertainty u;
    u.lag = {lag, lag};
    const LoopFamily family = uncertain_hover(vehicle, gains, u);
    const LoopPoint nominal = family.at((VectorXd(6) << 1, 1, 1, 1, 1, 0).finished());
    return spectral_radius(family.loop, nominal.numbers, nominal.delay);
  };
  EXPECT_NEAR(radius(1e-5), radius(0), 1e-4);
  EXPECT_GT(std::abs(radius(0.1) - radius(0)), 1e-5);
}

TEST(UncertainHover, EndsWhereTheVehicleCannotHover) {
  const Vehicle vehicle = load_vehicle("uquad");
  const Gains gains = gains_for(vehicle, "uquad", InputKind::rotor_speed, 0.01);
  const LoopFamily family = uncertain_hover(vehicle, gains, {{0.9, 1.1}, {1, 1}, {0.9, 1.1}});
  // Thrust-to-weight 1.52: (1 + s/10)/(1 - s/10) = 1.52.
  EXPECT_NEAR(family.max_scale, 10 * 0.52 / 2.52, 0.01);
  EXPECT_THAT(family.max_scale_reason, HasSubstr("hover needs"));
  EXPECT_EQ(cannot_hover(vehicle, 1, 1), "");
  EXPECT_THAT(cannot_hover(vehicle, 2, 1),
              HasSubstr("with 2 times the mass and 1 times the thrust, "));
}

template <class Call>
std::string refusal(const Call& call) {
  try {
    (void)call();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "nothing was refused";
}

// At the nominal parameters and with the delay that the law assumes, a law for lagging rotors has
// the poles of its Riccati equation.
TEST(UncertainHover, HasThePolesOfALawWithMemory) {
  Vehicle vehicle = load_vehicle("crazyflie");
  for (Rotor& rotor : vehicle.rotors) rotor.inertia = rotor.drag = rotor.inflow = 0;
  ActuatorLqiOptions options;
  options.dt = 0.005;
  options.past = 2;
  options.integrals = {"px", "py", "pz", "yaw"};
  VectorXd deviation(12);
  deviation << 0.5, 0.5, 0.5, 0.2, 0.2, 0.35, 0.5, 0.5, 0.5, 2, 2, 2;
  const Eigen::Vector4d command(0.03, 3e-4, 3e-4, 1e-4);  // [N], [N m]
  ActuatorLqiWeights weights;
  weights.Q = deviation.cwiseAbs2().cwiseInverse().asDiagonal();
  weights.Q_integral = MatrixXd::Identity(4, 4);
  weights.R = command.cwiseAbs2().cwiseInverse().asDiagonal();
  const ActuatorLqi lqi = actuator_lqi(vehicle, weights, options);
  ASSERT_TRUE(lqi.solved()) << lqi.riccati.culprit;
  VehicleUncertainty u;
  const double lag = vehicle.rotors[0].lag;
  u.lag = {lag, lag};
  u.delay = {2 * options.dt, 2 * options.dt};
  const LoopFamily family = uncertain_hover(vehicle, lqi.gains, u);
  VectorXd nominal(static_cast<Eigen::Index>(family.parameters.size()));
  for (std::size_t i = 0; i < family.parameters.size(); ++i)
    nominal(static_cast<Eigen::Index>(i)) = family.parameters[i].nominal;
  const LoopPoint point = family.at(nominal);
  const Eigen::VectorXcd poles =
      closed_loop_matrix(family.loop, point.numbers, point.delay).eigenvalues();
  for (const std::complex<double>& z : lqi.riccati.poles) {
    if (std::abs(z) > 0.1) {
      EXPECT_LT((poles.array() - z).abs().minCoeff(), 1e-7) << z;
    }
  }
  EXPECT_LT(poles.cwiseAbs().maxCoeff(), 1);
}

TEST(UncertainHover, RejectsUnsupportedVehicles) {
  const Vehicle uquad = load_vehicle("uquad");
  const Gains gains = gains_for(uquad, "uquad", InputKind::rotor_speed, 0.01);
  const auto with = [&](const VehicleUncertainty& u) {
    return refusal([&] { return uncertain_hover(uquad, gains, u); });
  };
  EXPECT_THAT(with({{1.1, 1.2}, {1, 1}, {1, 1}}),
              HasSubstr("mass is 1.1 … 1.2, expected a range of positive ratios that contains 1"));
  EXPECT_THAT(with({{0, 1}, {1, 1}, {1, 1}}), HasSubstr("mass is 0 … 1"));
  EXPECT_THAT(with({{1, 1}, {1, 1}, {1, 1}, {0.2, 0.1}}), HasSubstr("delay is 0.2 … 0.1 s"));
  EXPECT_THAT(with({{1, 1}, {1, 1}, {1, 1}, {0, 0}, {0, 0.1}}), HasSubstr("lag is 0 … 0.1 s"));
  const auto changed_is_refused = [&](const auto& change) {
    Vehicle vehicle = uquad;
    change(vehicle);
    return refusal([&] { return uncertain_hover(vehicle, gains, {}); });
  };
  EXPECT_THAT(changed_is_refused([](Vehicle& v) { v.inertia(0, 1) = v.inertia(1, 0) = 1e-4; }),
              HasSubstr("the inertia matrix has off-diagonal entries, expected principal axes"));
  EXPECT_THAT(changed_is_refused([](Vehicle& v) { v.rotors[0].thrust_a2 *= 1.01; }),
              HasSubstr("the rotors have different curves"));
  EXPECT_THAT(changed_is_refused([](Vehicle& v) { v.mass *= 3; }), HasSubstr("hover"));
  Gains moving = gains;
  moving.x0(6) = 1;
  EXPECT_THAT(refusal([&] { return uncertain_hover(uquad, moving, {}); }),
              HasSubstr("a moving or tilted flight condition, expected a hover"));
  Gains continuous = gains;
  continuous.dt = 0;
  EXPECT_THAT(refusal([&] { return uncertain_hover(uquad, continuous, {}); }),
              HasSubstr("no sample period"));
}

}  // namespace
}  // namespace quadtune
