// SPDX-License-Identifier: Apache-2.0
/// The default designs on the flown plant satisfy their bounds for the built-in vehicles.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"
#include "quadtune/workbench/flown/flown_gains.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"
#include "quadtune/workbench/flown/flown_lqi.hpp"
#include "quadtune/workbench/vehicle/new_vehicle.hpp"
#include "sanitized.hpp"
#include "source_folder.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using testing::MatrixRelativelyNear;

PlannedFlight plan_of(const Vehicle& vehicle, const Controller& controller) {
  return plan_flight(FlightOptions{}, vehicle, load_mission("hover"),
                     ChosenLaw{controller, "test"});
}

class FlownDesign : public ::testing::TestWithParam<const char*> {};

/// Every nominal member has Ms ≤ 2 and a disk ≥ 0.5, the others are stable; and the cascade of
/// those gains on the complete plant, its groups of axes together, is stable at every height.
TEST_P(FlownDesign, CascadeKeepsItsBounds) {
  if (testing::kSanitized && GetParam() == std::string("uquad"))
    GTEST_SKIP() << "minutes for its period of 100 samples";
  const Vehicle vehicle = load_vehicle(GetParam());
  const FlownGains gains = flown_gains(vehicle);
  EXPECT_THAT(gains.notes, ::testing::IsEmpty());
  EXPECT_LE(gains.Ms(), 2 * 1.005);
  EXPECT_GE(gains.disk(), 0.5 / 1.005);
  for (const FlownAxisGains& axis : gains.axes) {
    EXPECT_TRUE(axis.search.solved()) << to_string(axis.axis) << axis.search.culprit;
    ASSERT_EQ(axis.margins.size(), gains.family.size());
    for (const LoopMargins& margins : axis.margins) EXPECT_TRUE(margins.stable);
  }
  const PlannedFlight plan = plan_of(vehicle, CascadeController{as_cascade(gains, 0.005)});
  for (const double height : {0.5, 1.1, 3.0}) {
    FlownLoopOptions at;
    at.height = height;
    at.evidence = MarginsEvidence::none;
    const FlownLoop loop = flown_loop(plan, at);
    EXPECT_TRUE(loop.stable()) << height << ": " << describe(loop);
  }
}

/// Torques of 1e-4 N m: the rounding errors of an earlier command must not couple yaw with roll,
/// whose position then drifts in the group of yaw.
TEST(FlownDesignOfATinyHexacopter, IsFoundAndKeepsItsBounds) {
  MeasuredVehicle measured;
  measured.name = "tiny";
  measured.mass = 0.0876;
  measured.arm = 0.0378;
  measured.propeller = 0.0363;
  measured.rotors = 6;
  measured.layout = FrameLayout::plus;
  measured.first_spin = Spin::counter_clockwise;
  measured.thrust_to_weight = 2.74;
  measured.motor_lag = 0.008;
  const Vehicle vehicle = new_vehicle(measured).vehicle;
  const FlownGains gains = flown_gains(vehicle);
  EXPECT_LE(gains.Ms(), 2 * 1.005);
  EXPECT_GE(gains.disk(), 0.5 / 1.005);
  for (const FlownFamilyMember& member : gains.family)
    for (const Signal& state : axis_part(member.plant, FlownAxis::yaw).states)
      EXPECT_THAT(state.name, ::testing::AllOf(::testing::Ne("roll"), ::testing::Ne("p")));
  const FlownLoop loop =
      flown_loop(plan_of(vehicle, CascadeController{as_cascade(gains, 0.005)}), FlownLoopOptions{});
  EXPECT_TRUE(loop.stable()) << describe(loop);
}

/// Heights, 45° and 6 dB at every output of the law with the estimator in the loop.
TEST_P(FlownDesign, RegulatorHasItsMargins) {
  if (testing::kSanitized && GetParam() == std::string("uquad"))
    GTEST_SKIP() << "minutes for its period of 100 samples";
  const Vehicle vehicle = load_vehicle(GetParam());
  const FlownLqi design = flown_lqi(vehicle);
  EXPECT_TRUE(design.met);
  EXPECT_GE(design.share, 1);
  for (const std::vector<LoopMargins>& axis : design.margins) {
    ASSERT_EQ(axis.size(), design.family.size());
    for (std::size_t i = 0; i < axis.size(); ++i) {
      EXPECT_TRUE(axis[i].stable) << design.family[i].name;
      if (!design.family[i].nominal) continue;
      EXPECT_GE(axis[i].phase_margin, 0.785398);
      EXPECT_GE(axis[i].gain_margin, 2);
      EXPECT_LE(axis[i].gain_reduction, 0.5);
      EXPECT_GE(axis[i].disk.alpha, 0.5);
    }
  }
  // All groups of axes together, with the flown gains.
  const PlannedFlight plan =
      plan_of(vehicle, feedback_controller(design.lqi.gains, design.lqi.gains.dt));
  FlownLoopOptions at;
  at.evidence = MarginsEvidence::none;
  const FlownLoop loop = flown_loop(plan, at);
  EXPECT_TRUE(loop.stable()) << describe(loop);
}

INSTANTIATE_TEST_SUITE_P(Vehicles, FlownDesign,
                         ::testing::Values("mambo", "crazyflie", "rolling-spider", "uquad"));

/// A delayed gyroscope reduces the margins, and larger weights on the commands restore them.
TEST(FlownLqi, SoftensItsWeightsUntilTheMarginsHold) {
  if (testing::kSanitized) GTEST_SKIP() << "takes a minute; FlownDesign runs the same code";
  Vehicle vehicle = load_vehicle("rolling-spider");
  vehicle.sensors.gyroscope->delay += 0.03;
  FlownLqiOptions options;
  const FlownLqi design = flown_lqi(vehicle, options);
  EXPECT_TRUE(design.met);
  EXPECT_GT(*std::max_element(design.softened.begin(), design.softened.end()), 1);
  EXPECT_FALSE(design.notes.empty());
  const ActuatorLqiWeights usual = lqi_weights(standard_axes(vehicle), standard_integrals());
  for (std::size_t axis = 0; axis < kFlownAxes.size(); ++axis) {
    const Index input = wrench_of(kFlownAxes[axis]);
    EXPECT_EQ(design.weights.R(input, input), design.softened[axis] * usual.R(input, input));
  }
  // The default weights, which are not changed if they are given, do not have the margins.
  options.weights = usual;
  const FlownLqi given = flown_lqi(vehicle, options);
  EXPECT_FALSE(given.met);
  EXPECT_EQ(given.softened, (std::array<double, 4>{1, 1, 1, 1}));
}

/// Both lags of a rotor, up and down, are 40 % longer and shorter in the family.
TEST(FlownFamily, VariesBothLags) {
  Vehicle vehicle = load_vehicle("crazyflie");
  const auto poles = [](const FlownFamilyMember& member) { return member.plant.plant.A; };
  for (Rotor& rotor : vehicle.rotors) {
    rotor.lag = 0.02;
    rotor.lag_down = 0.03;
  }
  const auto two = flown_family(vehicle, InputKind::wrench, 0.005);
  for (Rotor& rotor : vehicle.rotors) {
    rotor.lag = 0.03;
    rotor.lag_down = std::nan("");
  }
  const auto one = flown_family(vehicle, InputKind::wrench, 0.005);
  ASSERT_EQ(two.size(), one.size());
  for (std::size_t i = 0; i < two.size(); ++i)
    EXPECT_EQ(poles(two[i])[0], poles(one[i])[0]) << two[i].name;
}

/// Motor lags of 60 ms and more: a weaker inner loop does not help, a slower outer one does.
TEST(FlownLqi, LowersTheWeightsOfPositionsForSlowRotors) {
  if (testing::kSanitized) GTEST_SKIP() << "some twenty designs, a minute each with sanitizers";
  const Vehicle hexa = load_vehicle(testing::source_folder() + "/vehicles/hexa-550.toml");
  const FlownLqi design = flown_lqi(hexa);
  EXPECT_TRUE(design.met);
  EXPECT_EQ(design.softened, (std::array<double, 4>{1, 1, 1, 1}));
  EXPECT_EQ(design.lowered, (std::array<double, 4>{4, 4, 1, 1}));
  const ActuatorLqiWeights usual = lqi_weights(standard_axes(hexa), standard_integrals());
  for (const Eigen::Index i : {0, 1}) {
    EXPECT_EQ(design.weights.Q(i, i), usual.Q(i, i) / 4);
    EXPECT_EQ(design.weights.Q_integral(i, i), usual.Q_integral(i, i) / 4);
  }
  EXPECT_EQ(design.weights.Q(2, 2), usual.Q(2, 2));
  ASSERT_EQ(design.notes.size(), 2);
  EXPECT_EQ(design.notes[0],
            "the weights of px and its integral were divided by 4 for the margins of the flown "
            "loop");
}

/// A law predicts by the delay of the commands plus that of the gyroscope.
TEST(FlownLqi, PredictsByTheDelayOfTheCommands) {
  if (testing::kSanitized) GTEST_SKIP() << "takes a minute; FlownDesign runs the same code";
  Vehicle vehicle = load_vehicle("rolling-spider");
  const FlownLqiOptions options;
  // Its file has no delays: the law needs no past commands.
  EXPECT_FALSE(flown_lqi(vehicle, options).lqi.gains.memory);
  vehicle.motor.delay = 0.05;
  const auto memory = flown_lqi(vehicle, options).lqi.gains.memory;
  ASSERT_TRUE(memory);
  EXPECT_GE(memory->past, 6);
}

TEST(FlownGains, CascadeIsTheSameLawAsItsMatrix) {
  const Vehicle vehicle = load_vehicle("crazyflie");
  FlownGains gains;
  for (const FlownAxis axis : kFlownAxes) {
    FlownAxisGains one;
    one.axis = axis;
    one.F = Eigen::RowVectorXd::LinSpaced(std::ssize(states_of(axis)) + 1, 1, 2);
    if (axis == FlownAxis::north || axis == FlownAxis::altitude) one.F = -one.F;
    gains.axes.push_back(one);
  }
  const double dt = 0.005;
  const DiscreteLti cascade = flown_law(as_cascade(gains, dt), PidMethod::backward_euler);
  const DiscreteLti matrix = flown_law(vehicle, as_state_feedback(gains, vehicle, dt), dt);
  EXPECT_THAT(cascade.D, MatrixRelativelyNear(matrix.D, 1e-12));
  // The first response to the integral of each law: C B.
  EXPECT_THAT(MatrixXd(cascade.C * cascade.B),
              MatrixRelativelyNear(MatrixXd(matrix.C * matrix.B), 1e-12));
}

/// In the search, the cascade with its Ki is a gain on a plant with two more states. The complete
/// plant with the cascade has the same margins; the groups of axes of this symmetric vehicle are
/// decoupled.
TEST(FlownGains, TiltIntegralIsThatOfTheCascade) {
  const Vehicle vehicle = load_vehicle("crazyflie");
  const FlownGains gains = flown_gains(vehicle);
  const CascadeGains cascade = as_cascade(gains, 0.005);
  const FlownLoop loop = flown_loop(plan_of(vehicle, CascadeController{cascade}), {});
  for (const FlownAxisGains& axis : {gains.axes[0], gains.axes[1]}) {
    ASSERT_GT(axis.tilt_integral, 0) << to_string(axis.axis);
    const bool north = axis.axis == FlownAxis::north;
    const PidLoop& tilt = cascade.loops[index_of(north ? CascadeAxis::pitch : CascadeAxis::roll)];
    EXPECT_DOUBLE_EQ(tilt.Ki, axis.tilt_integral * tilt.Kp);
    const LoopMargins& whole = loop.margins.loops[static_cast<std::size_t>(wrench_of(axis.axis))];
    const LoopMargins& own = axis.margins.front();
    EXPECT_NEAR(own.Ms, whole.Ms, 1e-4 * whole.Ms);
    EXPECT_NEAR(own.phase_margin, whole.phase_margin, 1e-4);
    EXPECT_NEAR(own.gain_margin, whole.gain_margin, 1e-4 * whole.gain_margin);
  }
}

TEST(FlownGains, TiltIntegralOnlyWhereALoadTiltsTheVehicle) {
  for (const FlownAxisGains& axis : flown_gains(load_vehicle("mambo")).axes)
    EXPECT_EQ(axis.tilt_integral, 0) << to_string(axis.axis);
  FlownGainsOptions options;
  options.tilt_integral = false;
  for (const FlownAxisGains& axis : flown_gains(load_vehicle("crazyflie"), options).axes)
    EXPECT_EQ(axis.tilt_integral, 0) << to_string(axis.axis);
}

TEST(FlownGainsBadInput, AMatrixHoldsNoTiltIntegral) {
  FlownGains gains;
  gains.axes.resize(1);
  gains.axes[0].F = Eigen::RowVectorXd::Ones(5);
  gains.axes[0].tilt_integral = 1;
  EXPECT_THAT([&] { (void)as_state_feedback(gains, load_vehicle("crazyflie"), 0.005); },
              ::testing::ThrowsMessage<InvalidInput>(
                  ::testing::HasSubstr("the gains of north have an integral in the tilt loop")));
}

TEST(FlownAxisBadInput, ATiltIntegralNeedsATiltAndAPositiveRate) {
  PeriodicLti plant;
  plant.A = {MatrixXd::Identity(2, 2)};
  plant.B = {MatrixXd::Ones(2, 1)};
  plant.C = MatrixXd::Identity(2, 2);
  plant.dt = 0.005;
  EXPECT_THAT([&] { (void)with_tilt_integral(plant, 1); },
              ::testing::ThrowsMessage<InvalidInput>(
                  ::testing::HasSubstr("1 inputs and 2 outputs, expected 1 (torque)")));
  plant.C = MatrixXd::Ones(4, 2);
  for (const double rate : {std::nan(""), 0.0, -1.0, 200.0})
    EXPECT_THAT(
        [&] { (void)with_tilt_integral(plant, rate); },
        ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr("expected 0 to 200 1/s")));
}

}  // namespace
}  // namespace quadtune
