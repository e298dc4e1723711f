// SPDX-License-Identifier: Apache-2.0
/// Gains with a given structure for programs that implement only matrices.
#include "quadtune/workbench/design/matrix_report.hpp"

#include <gmock/gmock.h>

#include <string>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/uquad.hpp"
#include "quadtune/linearize/linearize.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/flight/fly.hpp"
#include "sanitized.hpp"
#include "source_folder.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::MatrixRelativelyNear;
using ::testing::ThrowsMessage;

/// A law of all 12 states with distinct entries.
Gains any_gains(const Vehicle& vehicle) {
  Gains gains;
  gains.states = ned_convention().states;
  gains.inputs = ned_convention().wrench;
  gains.K = MatrixXd::NullaryExpr(4, 12, [](auto i, auto j) {
    return 1 + 0.37 * static_cast<double>(i) - 0.11 * static_cast<double>(j * (i + 1));
  });
  gains.K_int = MatrixXd::NullaryExpr(4, 4, [](auto i, auto j) {
    return 0.5 - 0.23 * static_cast<double>(i) + 0.07 * static_cast<double>(j * j);
  });
  for (const int state : {0, 1, 2, 5})
    gains.integrals.push_back({gains.states[static_cast<std::size_t>(state)].name, ""});
  gains.x0 = Eigen::VectorXd::Zero(12);
  gains.u0 = Eigen::Vector4d(vehicle.mass * vehicle.gravity, 0, 0, 0);
  gains.vehicle = vehicle.name;
  gains.convention = "ned";
  gains.input_kind = InputKind::wrench;
  gains.dt = 0.01;
  return gains;
}

/// B K is the acceleration with which a law responds to a deviation. In other inputs and axes, the
/// vehicle responds equally: with T the map of the states, B_c K_c s T = T B K, s the sign law.
TEST(MatrixInWords, AnswersWithTheSameAccelerations) {
  for (const std::string name : {"uquad", "mambo", "crazyflie", "hexa-550"}) {
    const Vehicle vehicle = load_vehicle(
        name == "hexa-550" ? testing::source_folder() + "/vehicles/hexa-550.toml" : name);
    const Gains gains = any_gains(vehicle);
    LinearizeOptions own;
    own.inputs = InputKind::wrench;
    const MatrixXd wanted = linearize(vehicle, FlightCondition{}, own).plant.B * gains.K;
    for (const Convention& target : conventions())
      for (const InputKind kind : {InputKind::wrench, InputKind::rotor_speed,
                                   InputKind::rotor_thrust, InputKind::command}) {
        const Gains other = describe(gains, vehicle, {target.name, kind});
        LinearizeOptions words;
        words.convention = target.name;
        words.inputs = kind;
        const Linearization model = linearize(vehicle, FlightCondition{}, words);
        ASSERT_EQ(other.states, model.plant.states);
        ASSERT_EQ(other.inputs, model.plant.inputs);
        const double law = other.sign_law == SignLaw::set_point_minus_state ? 1 : -1;
        const MatrixXd seen =
            law * target.from_ned.transpose() * model.plant.B * other.K * target.from_ned;
        EXPECT_THAT(seen, MatrixRelativelyNear(wanted, 1e-11))
            << name << " " << target.name << " " << to_string(kind);
        EXPECT_THAT(other.u0, MatrixRelativelyNear(model.u0, 1e-12));
      }
  }
}

class MatrixLaw : public ::testing::TestWithParam<std::pair<const char*, MatrixConvention>> {};

/// Within its bounds at every nominal member, stable at the others, with the estimator of the
/// flight program; a flight with it passes.
TEST_P(MatrixLaw, KeepsItsBoundsAndFlies) {
  if (testing::kSanitized) GTEST_SKIP() << "minutes; FlownDesign runs the same search";
  const auto [name, words] = GetParam();
  const Vehicle vehicle = load_vehicle(name);
  LqiDesign design;
  design.dt = words.convention == "uquad" ? 0.01 : 0.005;
  design.matrix = words;
  const MatrixReport report = matrix_report(vehicle, design);
  EXPECT_EQ(report.flown.estimator, words.convention == "ned" ? "general" : words.convention);
  EXPECT_THAT(report.design.notes, IsEmpty());
  EXPECT_LE(report.design.Ms(), 2 * 1.005);
  EXPECT_GE(report.design.disk(), 0.5 / 1.005);
  for (const FlownAxisGains& axis : report.design.axes)
    for (const LoopMargins& margins : axis.margins) EXPECT_TRUE(margins.stable);
  EXPECT_FALSE(report.flown.grows()) << describe(report.flown);
  EXPECT_FALSE(report.gains.memory);
  FlightOptions options;
  options.estimator = report.flown.estimator;
  const FlownFlight flight = fly_planned(
      plan_flight(options, vehicle, load_mission("take-off-and-land"),
                  ChosenLaw{feedback_controller(report.gains, design.dt), "matrix", {}}));
  EXPECT_TRUE(flight.passed) << ::testing::PrintToString(reasons(flight));
}

INSTANTIATE_TEST_SUITE_P(
    Vehicles, MatrixLaw,
    ::testing::Values(std::pair("uquad", MatrixConvention{"uquad", InputKind::rotor_speed}),
                      std::pair("mambo", MatrixConvention{"mambo", InputKind::wrench}),
                      std::pair("crazyflie", MatrixConvention{"ned", InputKind::wrench})),
    [](const auto& test) { return std::string(test.param.first); });

TEST(MatrixReport, TakesTheWeightsOfTheDesign) {
  const Vehicle vehicle = load_vehicle("rolling-spider");
  LqiDesign design;
  design.matrix = MatrixConvention{};
  const MatrixReport usual = matrix_report(vehicle, design);
  LqiDesign dearer = design;
  Eigen::VectorXd R(4);
  for (std::size_t i = 0; i < kFlownAxes.size(); ++i)
    R(wrench_of(kFlownAxes[i])) = 100 * usual.weights[i].r;
  dearer.R = R;
  const MatrixReport soft = matrix_report(vehicle, dearer);
  EXPECT_LT(soft.gains.K.norm(), 0.8 * usual.gains.K.norm());
  for (const LoopMargins& loop : soft.flown.margins.loops) EXPECT_TRUE(loop.stable);
}

TEST(MatrixReportBadInput, RefusesWhatAMatrixCannotHold) {
  const Vehicle vehicle = load_vehicle("rolling-spider");
  LqiDesign design;
  design.matrix = MatrixConvention{};
  const auto refused = [&](const LqiDesign& asked, const char* message) {
    EXPECT_THAT([&] { (void)matrix_report(vehicle, asked); },
                ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  LqiDesign past = design;
  past.past = 2;
  refused(past, "was given past commands or weights of changes, expected none");
  LqiDesign integrals = design;
  integrals.integrals = {"px"};
  refused(integrals, "the integrals of this matrix law are 'px', expected px py pz yaw");
  LqiDesign weights = design;
  weights.Q_integral = Eigen::Vector4d(1, 1, 0, 1);
  refused(weights, "the weights of pz and of its integral are");
  LqiDesign words = design;
  words.matrix->convention = "px4";
  refused(words, "no convention 'px4'");
  Gains memory = any_gains(vehicle);
  memory.memory = CommandMemory{};
  EXPECT_THAT([&] { (void)describe(memory, vehicle, MatrixConvention{}); },
              ThrowsMessage<InvalidInput>(HasSubstr("feeds back its past commands")));
}

}  // namespace
}  // namespace quadtune
