// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/actuator_lqi.hpp"

#include <gmock/gmock.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <complex>
#include <limits>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/model/mixer.hpp"
#include "quadtune/synthesis/flown_plant.hpp"
#include "quadtune/synthesis/lqr.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::HasSubstr;
using testing::MatrixRelativelyNear;
using ::testing::ThrowsMessage;

ActuatorLqiWeights weights_of(const Vehicle& vehicle, Index integrals) {
  VectorXd deviation(12);
  deviation << 0.5, 0.5, 0.5, 0.2, 0.2, 0.35, 0.5, 0.5, 0.5, 2, 2, 2;
  const Eigen::Vector4d authority =
      wrench_authority(vehicle, trim(vehicle, FlightCondition{}).u) * 0.1;
  ActuatorLqiWeights weights;
  weights.Q = deviation.cwiseAbs2().cwiseInverse().asDiagonal();
  weights.R = authority.cwiseAbs2().cwiseInverse().asDiagonal();
  weights.Q_integral = MatrixXd::Identity(integrals, integrals);
  return weights;
}

Vehicle lagging(const std::string& name, double lag) {
  Vehicle vehicle = load_vehicle(name);
  for (Rotor& rotor : vehicle.rotors) rotor.lag = lag;
  return vehicle;
}

TEST(ActuatorLqi, WithoutLagIsTheSampledRegulator) {
  const Vehicle vehicle = load_vehicle("uquad");
  const ActuatorLqiWeights weights = weights_of(vehicle, 0);
  ActuatorLqiOptions options;
  options.dt = 0.01;
  const ActuatorLqi lqi = actuator_lqi(vehicle, weights, options);
  ASSERT_TRUE(lqi.solved());
  LinearizeOptions of_hover;
  of_hover.inputs = InputKind::wrench;
  const ContinuousLti hover = linearize(vehicle, FlightCondition{}, of_hover).plant;
  const SampledLqr sampled = sample(hover, {weights.Q, weights.R, {}}, options.dt);
  EXPECT_THAT(lqi.gains.K, MatrixRelativelyNear(lqr(sampled.plant, sampled.weights).K, 1e-12));
  EXPECT_FALSE(lqi.gains.memory);
  EXPECT_EQ(lqi.gains.axes, PositionAxes::heading);
}

/// The maximum distance of the poles in `expected` to their nearest pole in `poles`.
double distance(const Eigen::VectorXcd& expected, const Eigen::VectorXcd& poles) {
  double worst = 0;
  for (const std::complex<double>& z : expected)
    worst = std::max(worst, (poles.array() - z).abs().minCoeff());
  return worst;
}

/// With true states, the law on the complete plant has the poles of the Riccati equation: the
/// model, the memory of the law and its integral agree with the simulation.
TEST(ActuatorLqi, HasThePolesOfItsRiccatiEquationInFlight) {
  struct Case {
    const char* vehicle;
    double lag;
    int past;
    InputKind inputs;
  };
  for (const Case& one :
       {Case{"mambo", 0.03, 0, InputKind::wrench}, Case{"mambo", 0.02, 3, InputKind::wrench},
        Case{"mambo", 0, 2, InputKind::wrench}, Case{"crazyflie", 0.072, 1, InputKind::wrench},
        Case{"mambo", 0.03, 2, InputKind::rotor_speed},
        Case{"uquad", 0.05, 1, InputKind::command}}) {
    const Vehicle vehicle = lagging(one.vehicle, one.lag);
    ActuatorLqiWeights weights = weights_of(vehicle, 4);
    if (one.inputs != InputKind::wrench) {
      const ActuatorModel model = actuator_model(vehicle, one.inputs);
      weights.R = (0.1 * model.hover.u0).cwiseAbs2().cwiseInverse().asDiagonal();
    }
    ActuatorLqiOptions options;
    options.past = one.past;
    options.inputs = one.inputs;
    options.integrals = {"px", "py", "pz", "yaw"};
    const ActuatorLqi lqi = actuator_lqi(vehicle, weights, options);
    ASSERT_TRUE(lqi.solved()) << lqi.riccati.culprit;
    const Eigen::VectorXcd expected =
        (lqi.model.A - lqi.model.B * lqi.riccati.K).eval().eigenvalues();
    EXPECT_LT(expected.cwiseAbs().maxCoeff(), 1);

    FlightSetup setup;
    setup.vehicle = vehicle;
    setup.estimator = EstimatorKind::truth;
    FlownPlantOptions of_plant;
    of_plant.inputs = one.inputs;
    of_plant.dt = options.dt;
    of_plant.command_delay = one.past * options.dt;
    const FlownPlant plant = flown_plant(setup, of_plant);
    const Eigen::VectorXcd flown = periodic_poles(
        closed(cut_at_inputs(plant.plant, flown_law(vehicle, lqi.gains, options.dt))));
    // Poles at 0 are multiple and therefore sensitive to rounding.
    EXPECT_LT(distance(expected, flown), one.past > 0 ? 2e-4 : 1e-8) << one.vehicle << one.past;
    EXPECT_LT(flown.cwiseAbs().maxCoeff(), 1);
  }
}

/// A weight on the change of the command reduces its first step.
TEST(ActuatorLqi, WeightOnTheChangeSmoothsTheCommand) {
  const Vehicle vehicle = load_vehicle("crazyflie");
  ActuatorLqiWeights weights = weights_of(vehicle, 0);
  ActuatorLqiOptions options;
  options.past = 1;
  double last = std::numeric_limits<double>::infinity();
  for (const double factor : {0.0, 0.1, 1.0, 10.0}) {
    weights.R_change = factor * weights.R;
    const ActuatorLqi lqi = actuator_lqi(vehicle, weights, options);
    ASSERT_TRUE(lqi.solved());
    const double first = std::abs(lqi.gains.K(1, 3));  // torque per roll
    EXPECT_LT(first, last);
    last = first;
  }
}

/// For rotors with different lags up and down, the design uses the slower lag, as the flown plant
/// does.
TEST(ActuatorLqi, UsesTheSlowerOfTwoLags) {
  const auto gains = [](double up, double down) {
    Vehicle vehicle = lagging("crazyflie", up);
    for (Rotor& rotor : vehicle.rotors) rotor.lag_down = down;
    ActuatorLqiOptions options;
    options.dt = 0.005;
    return actuator_lqi(vehicle, weights_of(vehicle, 0), options).gains;
  };
  const Gains slow = gains(0.05, std::nan(""));
  for (const Gains& other : {gains(0.02, 0.05), gains(0.05, 0.02)}) {
    EXPECT_EQ(other.memory->lag, slow.memory->lag);
    EXPECT_EQ(other.K, slow.K);
    EXPECT_EQ(other.memory->K_lag, slow.memory->K_lag);
  }
}

TEST(ActuatorLqi, RefusesWhatDoesNotFit) {
  Vehicle vehicle = load_vehicle("crazyflie");
  ActuatorLqiWeights weights = weights_of(vehicle, 0);
  ActuatorLqiOptions options;
  const auto refusal = [&](const char* message) {
    EXPECT_THAT([&] { (void)actuator_lqi(vehicle, weights, options); },
                ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  options.dt = 0;
  refusal("actuator LQI: dt is 0 s, expected a positive period");
  options.dt = 0.005;
  options.past = 41;
  refusal("actuator LQI: past is 41, expected 0 to 40 control periods");
  options.past = 0;
  weights.R_change = weights.R;
  refusal("actuator LQI: R_change is given but past is 0, expected past >= 1");
  weights.R_change.resize(0, 0);
  options.integrals = {"height"};
  weights.Q_integral = MatrixXd::Identity(1, 1);
  refusal("actuator LQI: no state 'height' to integrate, expected one of: px py pz");
  options.integrals = {};
  refusal("actuator LQI: Q_integral is 1x1, expected 0x0");
  weights.Q_integral.resize(0, 0);
  vehicle.rotors[2].lag = 0;
  refusal("actuator LQI: 'crazyflie' has rotors with and without lag");
}

}  // namespace
}  // namespace quadtune
