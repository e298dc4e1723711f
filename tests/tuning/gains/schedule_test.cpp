// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/schedule.hpp"

#include <gmock/gmock.h>

#include <cstring>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/linearize/linearize.hpp"
#include "quadtune/synthesis/state_feedback.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using testing::MatrixRelativelyNear;
using ::testing::ThrowsMessage;

/// Unit weights for all states and integrals.
LqrDesign design_for(const Vehicle& vehicle, const std::vector<std::string>& integrals = {},
                     LqrMethod method = LqrMethod::continuous) {
  LqrDesign design;
  design.convention = "uquad";
  design.method = method;
  design.dt = method == LqrMethod::continuous ? 0 : 0.01;
  const Linearization words =
      linearize(vehicle, TrimResult(), {design.convention, design.input_kind, {}});
  for (const Signal& state : words.plant.states) design.states.push_back(state.name);
  for (const Signal& input : words.plant.inputs) design.inputs.push_back(input.name);
  design.Q = Eigen::VectorXd::Ones(12).asDiagonal();
  design.R = 0.01 * Eigen::MatrixXd::Identity(std::ssize(design.inputs), std::ssize(design.inputs));
  design.integrals = integrals;
  design.Q_integral = Eigen::MatrixXd::Identity(std::ssize(integrals), std::ssize(integrals));
  return design;
}

/// A variety of flights: rest, lines, circles in both directions, spins, climbs, loads, thin air.
std::vector<ScheduleAxis> wide_grid() {
  return {{ScheduleQuantity::speed, {0, 1, 2.5}},
          {ScheduleQuantity::climb, {0, 0.5}},
          {ScheduleQuantity::yaw_rate, {-1, 0, 0.5}},
          {ScheduleQuantity::mass, {0.9, 1, 1.1}},
          {ScheduleQuantity::density, {0.95, 1}}};
}

/// The result of `quadtune lqr` at one point.
StateFeedback alone(const Vehicle& vehicle, const LqrDesign& design, const GainSchedule& schedule,
                    Eigen::Index index, Linearization& model) {
  const SchedulePoint point =
      schedule_point(vehicle, schedule.axes, grid_point(schedule.axes, index), schedule.yaw);
  Vehicle moved = vehicle;
  moved.mass = point.mass;
  TrimOptions air;
  air.density_ratio = point.density_ratio;
  model = linearize(moved, point.condition, linearize_options(design), air);
  return state_feedback(model.plant, design);
}

void expect_as_alone(const Vehicle& vehicle, const LqrDesign& design,
                     const GainSchedule& schedule) {
  for (Eigen::Index i = 0; i < schedule.size(); ++i) {
    const std::string where = grid_words(schedule.axes, grid_point(schedule.axes, i));
    Linearization model;
    ASSERT_TRUE(schedule.solved(i)) << where << schedule.culprit[static_cast<std::size_t>(i)];
    const StateFeedback one = alone(vehicle, design, schedule, i, model);
    ASSERT_TRUE(one.solved()) << where;
    const Gains gains = schedule.gains(i);
    EXPECT_THAT(gains.K, MatrixRelativelyNear(one.K, 1e-9)) << where;
    if (one.K_int.size() > 0) {
      EXPECT_THAT(gains.K_int, MatrixRelativelyNear(one.K_int, 1e-9)) << where;
    }
    EXPECT_LE((gains.x0 - model.x0).norm(), 1e-9) << where;
    EXPECT_THAT(gains.u0, MatrixRelativelyNear(model.u0, 1e-9)) << where;
    EXPECT_LE(schedule.residual(i), 1e-12);
  }
}

TEST(GainScheduleSolver, EveryPointEqualsASingleSolve) {
  const Vehicle vehicle = load_vehicle("uquad");
  const LqrDesign design = design_for(vehicle);
  const GainSchedule schedule = gain_schedule(vehicle, wide_grid(), design, {.yaw = 0.3});
  ASSERT_EQ(schedule.size(), 108);
  EXPECT_EQ(schedule.states.front().name, design.states.front());
  EXPECT_EQ(schedule.vehicle, "uquad");
  expect_as_alone(vehicle, design, schedule);
}

TEST(GainScheduleSolver, SupportsIntegralsAndEveryMethod) {
  const Vehicle vehicle = load_vehicle("mambo");
  const std::vector<ScheduleAxis> axes = {{ScheduleQuantity::speed, {0, 0.5, 1}},
                                          {ScheduleQuantity::yaw_rate, {-0.5, 0, 0.5}}};
  for (const LqrMethod method : {LqrMethod::continuous, LqrMethod::discrete, LqrMethod::sampled}) {
    const LqrDesign design = design_for(vehicle, {"x", "z"}, method);
    const GainSchedule schedule = gain_schedule(vehicle, axes, design);
    EXPECT_EQ(schedule.dt, design.dt);
    ASSERT_EQ(schedule.integrals.size(), 2u);
    EXPECT_EQ(schedule.integrals[0], (Signal{"x", "m s"}));
    expect_as_alone(vehicle, design, schedule);
  }
}

bool same_bytes(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() &&
         std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

// Two incomplete runs, with points without a trim among them.
TEST(GainScheduleSolver, BytesDoNotDependOnTheThreads) {
  const Vehicle vehicle = load_vehicle("uquad");
  const LqrDesign design = design_for(vehicle, {"z"});
  std::vector<ScheduleAxis> axes = {{ScheduleQuantity::speed, {}},
                                    {ScheduleQuantity::yaw_rate, {-2, -1, 0, 1, 2}},
                                    {ScheduleQuantity::mass, {0.9, 1, 1.1}}};
  for (int i = 0; i < 21; ++i) axes[0].values.push_back(0.5 * i);
  const GainSchedule one = gain_schedule(vehicle, axes, design, {.threads = 1});
  EXPECT_GT(one.solved_count(), 200);
  EXPECT_LT(one.solved_count(), one.size());
  for (const std::size_t threads : {2, 3, 7, 100}) {
    const GainSchedule many = gain_schedule(vehicle, axes, design, {.threads = threads});
    EXPECT_EQ(many.status, one.status) << threads;
    EXPECT_EQ(many.culprit, one.culprit) << threads;
    EXPECT_TRUE(same_bytes(many.K, one.K)) << threads;
    EXPECT_TRUE(same_bytes(many.K_int, one.K_int)) << threads;
    EXPECT_TRUE(same_bytes(many.x0, one.x0)) << threads;
    EXPECT_TRUE(same_bytes(many.u0, one.u0)) << threads;
    EXPECT_TRUE(same_bytes(many.residual, one.residual)) << threads;
  }
}

TEST(GainScheduleSolver, MarksPointsThatCannotBeFlown) {
  const Vehicle vehicle = load_vehicle("uquad");
  const GainSchedule schedule = gain_schedule(
      vehicle, {{ScheduleQuantity::speed, {1, 8}}, {ScheduleQuantity::yaw_rate, {0, 2}}},
      design_for(vehicle));
  EXPECT_TRUE(schedule.solved(0));
  EXPECT_TRUE(schedule.solved(1));
  EXPECT_TRUE(schedule.solved(2));
  EXPECT_EQ(schedule.status[3], PointStatus::no_trim);
  EXPECT_THAT(schedule.culprit[3], HasSubstr("circle of 4 m at 8 m/s needs a tilt of"));
  EXPECT_TRUE(schedule.K.col(3).array().isNaN().all());
  EXPECT_TRUE(schedule.x0.col(3).array().isNaN().all());
  EXPECT_FALSE(schedule.at(Eigen::Vector2d(5, 1)).found());
  EXPECT_TRUE(schedule.at(Eigen::Vector2d(5, 0)).found());
}

// The integral of a position with weight 0 does not affect the cost: its mode at 0 remains.
TEST(GainScheduleSolver, MarksPointsWithoutAGain) {
  const Vehicle vehicle = load_vehicle("uquad");
  LqrDesign design = design_for(vehicle, {"z"});
  design.Q_integral(0, 0) = 0;
  const GainSchedule schedule =
      gain_schedule(vehicle, {{ScheduleQuantity::mass, {0.9, 1, 1.1}}}, design);
  EXPECT_EQ(schedule.solved_count(), 0);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(schedule.status[i], PointStatus::no_gain);
    EXPECT_THAT(schedule.culprit[i], HasSubstr("not detectable: mode at 0"));
    EXPECT_TRUE(schedule.x0.col(static_cast<Eigen::Index>(i)).array().isNaN().all());
  }
}

TEST(GainScheduleSolver, ScalesTheMassAndNothingElse) {
  const Vehicle vehicle = load_vehicle("uquad");
  const SchedulePoint point = schedule_point(vehicle, {{ScheduleQuantity::mass, {1.1}}},
                                             Eigen::VectorXd::Constant(1, 1.1), 0.2);
  EXPECT_DOUBLE_EQ(point.mass, 1.1 * vehicle.mass);
  EXPECT_EQ(point.condition.kind, FlightKind::hover);
  EXPECT_EQ(point.condition.yaw, 0.2);
  EXPECT_EQ(point.density_ratio, 1);
}

TEST(GainScheduleSolver, RejectsUnsolvableDesigns) {
  const Vehicle vehicle = load_vehicle("uquad");
  const std::vector<ScheduleAxis> axes = {{ScheduleQuantity::speed, {0, 1, 2}}};
  LqrDesign design = design_for(vehicle);
  design.R(1, 1) = -1;
  for (const std::size_t threads : {1, 4})
    EXPECT_THAT([&] { (void)gain_schedule(vehicle, axes, design, {.threads = threads}); },
                ThrowsMessage<InvalidInput>(HasSubstr("R has eigenvalue -1")));
  design = design_for(vehicle, {}, LqrMethod::discrete);
  design.dt = 0;
  EXPECT_THAT([&] { (void)gain_schedule(vehicle, axes, design); },
              ThrowsMessage<InvalidInput>(HasSubstr("dt is 0 s, expected a positive number")));
  EXPECT_THAT([&] { (void)gain_schedule(vehicle, {}, design_for(vehicle)); },
              ThrowsMessage<InvalidInput>(HasSubstr("no axis")));
}

TEST(GainScheduleSolver, StopsWhenAsked) {
  const Vehicle vehicle = load_vehicle("uquad");
  EXPECT_THROW((void)gain_schedule(vehicle, {{ScheduleQuantity::speed, {0, 1}}},
                                   design_for(vehicle), {.interrupted = [] { return true; }}),
               Interrupted);
}

}  // namespace
}  // namespace quadtune
