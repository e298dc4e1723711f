// SPDX-License-Identifier: Apache-2.0
/// Flying gain schedules: which gains apply, the loop that they close, complete flights.
#include <gmock/gmock.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "matrix_near.hpp"
#include "quadtune/control/scheduled_feedback.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/linearize/linearize.hpp"
#include "quadtune/tuning/schedule.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/design/standard_lqr.hpp"
#include "quadtune/workbench/flight/fly.hpp"
#include "same_flight.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::ThrowsMessage;
constexpr double kDt = 0.005;

/// Weights by Bryson's rule at every point, from the 12 states to the wrench.
GainSchedule schedule_of(const Vehicle& vehicle, std::vector<ScheduleAxis> axes) {
  LqrDesign design;
  design.input_kind = InputKind::wrench;
  const Linearization words =
      linearize(vehicle, TrimResult(), {design.convention, design.input_kind, {}});
  for (const Signal& state : words.plant.states) design.states.push_back(state.name);
  for (const Signal& input : words.plant.inputs) design.inputs.push_back(input.name);
  const LqrWeights weights = standard_weights(cascade_vehicle(vehicle, vehicle.name));
  design.Q = weights.Q;
  design.R = weights.R;
  return gain_schedule(vehicle, std::move(axes), design);
}

std::vector<ScheduleAxis> speeds_and_turns() {
  return {{ScheduleQuantity::speed, {0, 1, 2, 3}}, {ScheduleQuantity::yaw_rate, {-1, 0, 1}}};
}

/// The state and the reference of a vehicle that flies at the trim, at some heading.
struct Flying {
  Estimate<double> estimate;
  Reference<double> reference;
};

Flying along(const VectorXd& x0, double heading) {
  Flying flying;
  flying.estimate.x = x0;
  flying.estimate.x(5) = heading;
  flying.reference.yaw = heading;
  flying.reference.velocity = rotation_of_euler(x0(3), x0(4), heading) * x0.segment<3>(kVelocity);
  return flying;
}

/// The response of the law, including the part of the velocity that the trim has removed.
VectorXd answer(ScheduledFeedback& schedule, StateFeedbackSettings<double> law,
                const Estimate<double>& estimate, Reference<double> reference) {
  schedule.set(estimate, reference, law);
  reference.velocity -= schedule.trim_velocity(reference.yaw);
  StateFeedbackState<double> state;
  return step(law, state, estimate, reference).head(law.inputs);
}

class ScheduledFeedbackOfCrazyflie : public ::testing::Test {
 protected:
  ScheduledFeedbackOfCrazyflie()
      : vehicle_(load_vehicle("crazyflie")),
        schedule_(std::make_shared<const GainSchedule>(schedule_of(vehicle_, speeds_and_turns()))),
        law_(state_feedback_settings(vehicle_, hover_gains(*schedule_), kDt, {})) {}

  Vehicle vehicle_;
  std::shared_ptr<const GainSchedule> schedule_;
  StateFeedbackSettings<double> law_;
};

// At a trim the law gives u0, and its derivative is -K of this point: by central differences of the
// complete law, interpolation and change of axes included. A law whose trim followed the estimate,
// or whose set point turned with it, would have another derivative.
TEST_F(ScheduledFeedbackOfCrazyflie, HasTheDesignedGainAsItsDerivativeAtEveryTrim) {
  constexpr double kHeading = 0.8, kStep = 1e-6;
  int turning = 0;
  for (Eigen::Index p = 0; p < schedule_->size(); ++p) {
    ASSERT_TRUE(schedule_->solved(p)) << schedule_->culprit[static_cast<std::size_t>(p)];
    const VectorXd x0 = schedule_->x0.col(p);
    const VectorXd at = grid_point(schedule_->axes, p);
    const auto law_at = [&](const Estimate<double>& estimate) {
      ScheduledFeedback schedule(vehicle_, schedule_, kDt);
      Flying flying = along(x0, kHeading);
      // The previous period determines how fast the reference turns.
      flying.reference.yaw = kHeading - kDt * at(1);
      StateFeedbackSettings<double> before = law_;
      schedule.set(flying.estimate, flying.reference, before);
      flying.reference.yaw = kHeading;
      return answer(schedule, law_, estimate, flying.reference);
    };
    const Flying trimmed = along(x0, kHeading);
    EXPECT_THAT(law_at(trimmed.estimate), MatrixNear(schedule_->u0.col(p), 1e-6)) << at.transpose();
    MatrixXd derivative(law_.inputs, 12);
    for (int j = 0; j < 12; ++j) {
      Estimate<double> more = trimmed.estimate, less = trimmed.estimate;
      more.x(j) += kStep;
      less.x(j) -= kStep;
      derivative.col(j) = (law_at(more) - law_at(less)) / (2 * kStep);
    }
    // North and east of the world differ from the axes of the heading.
    MatrixXd K = schedule_->gains(p).K;
    const MatrixXd position = K.leftCols(2);
    Eigen::Matrix2d turn;
    turn << std::cos(kHeading), std::sin(kHeading), -std::sin(kHeading), std::cos(kHeading);
    K.leftCols(2) = position * turn;
    const double max = K.cwiseAbs().maxCoeff();
    EXPECT_THAT(derivative, MatrixNear(-K, 1e-4 * max)) << at.transpose();
    turning += at(0) > 0 && at(1) != 0 ? 1 : 0;
  }
  EXPECT_EQ(turning, 6);
}

TEST_F(ScheduledFeedbackOfCrazyflie, GainsFollowTheEstimateAndTrimsTheReference) {
  ScheduledFeedback schedule(vehicle_, schedule_, kDt);
  StateFeedbackSettings<double> law = law_;
  Estimate<double> estimate;
  estimate.x(kVelocity) = 2;  // to the north, nose to the north
  Reference<double> reference;
  reference.velocity.x() = 1;
  schedule.set(estimate, reference, law);
  const ScheduledGain gain = schedule_->at(Eigen::Vector2d(2, 0));
  const ScheduledGain trim = schedule_->at(Eigen::Vector2d(1, 0));
  EXPECT_EQ(law.K.topRows(4), gain.K);
  EXPECT_EQ(law.x0, trim.x0);
  EXPECT_EQ(law.u0.head(4), trim.u0);
  EXPECT_GT((gain.K - trim.K).norm(), 1e-6);
  EXPECT_LT(trim.x0(4), -1e-3);  // nose down
}

TEST_F(ScheduledFeedbackOfCrazyflie, HoldsTheEdgeBeyondTheGrid) {
  ScheduledFeedback schedule(vehicle_, schedule_, kDt);
  StateFeedbackSettings<double> law = law_;
  Estimate<double> estimate;
  estimate.x(kVelocity) = 30;
  Reference<double> reference;
  reference.velocity.x() = -30;  // backward: the grid starts at 0
  schedule.set(estimate, reference, law);
  EXPECT_EQ(law.K.topRows(4), schedule_->at(Eigen::Vector2d(3, 0)).K);
  EXPECT_EQ(law.u0.head(4), schedule_->at(Eigen::Vector2d(0, 0)).u0);
}

TEST_F(ScheduledFeedbackOfCrazyflie, AStepOfTheHeadingIsNoTurn) {
  ScheduledFeedback schedule(vehicle_, schedule_, kDt);
  StateFeedbackSettings<double> law = law_;
  Reference<double> reference;
  reference.velocity.x() = 1;
  schedule.set({}, reference, law);
  const VectorXd straight = law.x0;
  reference.yaw = 1;
  reference.velocity = {std::cos(1.0), std::sin(1.0), 0};
  schedule.set({}, reference, law);
  EXPECT_THAT(MatrixXd(law.x0), MatrixNear(straight, 1e-9));
  reference.yaw = 1 + 0.5 * kDt;
  reference.velocity = {std::cos(reference.yaw), std::sin(reference.yaw), 0};
  schedule.set({}, reference, law);
  EXPECT_THAT(MatrixXd(law.x0), MatrixNear(schedule_->at(Eigen::Vector2d(1, 0.5)).x0, 1e-6));
}

TEST_F(ScheduledFeedbackOfCrazyflie, HoldsTheLastGainWhereThereIsNone) {
  GainSchedule holed = *schedule_;
  for (Eigen::Index p = 0; p < holed.size(); ++p) {
    if (grid_point(holed.axes, p)(0) < 3) continue;
    holed.status[static_cast<std::size_t>(p)] = PointStatus::no_trim;
    holed.culprit[static_cast<std::size_t>(p)] = "too fast";
  }
  ScheduledFeedback schedule(vehicle_, std::make_shared<const GainSchedule>(holed), kDt);
  StateFeedbackSettings<double> law = law_;
  Estimate<double> estimate;
  estimate.x(kVelocity) = 2;
  schedule.set(estimate, {}, law);
  const MatrixXd last = law.K;
  estimate.x(kVelocity) = 2.5;
  schedule.set(estimate, {}, law);
  EXPECT_EQ(MatrixXd(law.K), last);
  estimate.x(kVelocity) = std::nan("");
  schedule.set(estimate, {}, law);
  EXPECT_EQ(MatrixXd(law.K), last);

  holed.status[1] = PointStatus::no_gain;
  holed.culprit[1] = "no stabilizing solution";
  EXPECT_THAT([&] { (void)hover_gains(holed); },
              ThrowsMessage<InvalidInput>(
                  HasSubstr("has no gain at speed 0, yaw_rate 0, where a flight begins: no gain")));
}

// The thrust at hover would be too high by a tenth.
TEST_F(ScheduledFeedbackOfCrazyflie, IsRefusedForAnotherMass) {
  const GainSchedule heavy = schedule_of(vehicle_, {{ScheduleQuantity::mass, {1.1, 1.2}}});
  EXPECT_THAT([&] { (void)hover_gains(heavy); },
              ThrowsMessage<InvalidInput>(HasSubstr("mass is 1.1 to 1.2 of the vehicle's, expected "
                                                    "a range that contains 1")));
  const GainSchedule around = schedule_of(vehicle_, {{ScheduleQuantity::mass, {0.9, 1.2}}});
  const GainSchedule own = schedule_of(vehicle_, {{ScheduleQuantity::mass, {1}}});
  EXPECT_NEAR(hover_gains(around).u0(0) / hover_gains(own).u0(0), 1, 1e-9);
}

TEST(ScheduledFlight, IsThatOfTheSingleLawWhereAllPointsAreAlike) {
  const Vehicle vehicle = load_vehicle("mambo");
  GainSchedule alike = schedule_of(vehicle, {{ScheduleQuantity::speed, {0, 1}}});
  for (MatrixXd* matrix : {&alike.K, &alike.K_int, &alike.x0, &alike.u0})
    matrix->col(1) = matrix->col(0);
  const StateFeedbackController scheduled = scheduled_controller(vehicle, alike, kDt);
  StateFeedbackController single = scheduled;
  single.schedule = nullptr;
  const auto flown = [&](const Controller& controller) {
    ChosenLaw law;
    law.controller = controller;
    return fly_planned(plan_flight(FlightOptions(), vehicle, load_mission("lemniscate"), law))
        .result;
  };
  const FlightResult a = flown(scheduled), b = flown(single);
  EXPECT_EQ(a.end, FlightEnd::completed);
  EXPECT_EQ(a.end_time, b.end_time);
  EXPECT_LT((a.final_state - b.final_state).norm(), 1e-9);
  EXPECT_GT(a.final_state.head<3>().norm(), 0.1);
}

TEST(ScheduledFlight, FlightsInAPackHaveTheBytesOfSingleFlights) {
  const Vehicle vehicle = load_vehicle("mambo");
  const StateFeedbackController controller =
      scheduled_controller(vehicle, schedule_of(vehicle, speeds_and_turns()), kDt);
  ChosenLaw law;
  law.controller = controller;
  const PlannedFlight plan = plan_flight(FlightOptions(), vehicle, load_mission("circle"), law);
  std::vector<FlightSetup> setups;
  for (std::uint64_t flight = 0; flight < 8; ++flight) {
    setups.push_back(plan.setup);
    setups.back().flight = static_cast<std::uint32_t>(flight);
  }
  const std::vector<FlightResult> packed = fly_all(setups);
  for (std::size_t i = 0; i < setups.size(); ++i) {
    EXPECT_EQ(packed[i].end, FlightEnd::completed);
    EXPECT_STREQ(testing::first_difference(packed[i], fly(setups[i])), "") << i;
  }
  EXPECT_NE(packed[0].final_state, packed[1].final_state);
}

}  // namespace
}  // namespace quadtune
