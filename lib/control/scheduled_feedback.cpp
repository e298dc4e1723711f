// SPDX-License-Identifier: Apache-2.0
#include "quadtune/control/scheduled_feedback.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

const ScheduleAxis* axis_of(const GainSchedule& schedule, ScheduleQuantity quantity) {
  for (const ScheduleAxis& axis : schedule.axes)
    if (axis.quantity == quantity) return &axis;
  return nullptr;
}

double nearest(const ScheduleAxis& axis, double value) {
  return std::clamp(value, axis.values.front(), axis.values.back());
}

/// Mass and density have the vehicle's own values, the only ones that the law knows.
Eigen::VectorXd nearest_values(const GainSchedule& schedule, double speed, double climb,
                               double yaw_rate) {
  Eigen::VectorXd values(std::ssize(schedule.axes));
  for (Eigen::Index a = 0; a < values.size(); ++a) {
    const ScheduleAxis& axis = schedule.axes[static_cast<std::size_t>(a)];
    double value = 1;
    if (axis.quantity == ScheduleQuantity::speed) value = speed;
    if (axis.quantity == ScheduleQuantity::climb) value = climb;
    if (axis.quantity == ScheduleQuantity::yaw_rate) value = yaw_rate;
    values(a) = nearest(axis, value);
  }
  return values;
}

/// Gains for another mass or air density have the wrong thrust at hover.
void require_unscaled_vehicle(const GainSchedule& schedule) {
  constexpr double kRounding = 1e-9;
  for (const ScheduleAxis& axis : schedule.axes) {
    const bool ratio =
        axis.quantity == ScheduleQuantity::mass || axis.quantity == ScheduleQuantity::density;
    if (ratio && std::abs(nearest(axis, 1) - 1) > kRounding)
      throw InvalidInput(
          "schedule",
          fmt::format("{} is {} to {} of the vehicle's, expected a range that contains "
                      "1 because the law assumes the mass and air density of the vehicle file",
                      to_string(axis.quantity), axis.values.front(), axis.values.back()));
  }
}

double turn_of_reference(double now, double before, double dt, double max) {
  constexpr double kRounding = 1e-6;  // relative to a difference of two headings
  const double rate = (now - before) / dt;
  return std::abs(rate) <= max * (1 + kRounding) ? rate : 0;
}

}  // namespace

Gains hover_gains(const GainSchedule& schedule) {
  require_unscaled_vehicle(schedule);
  const Eigen::VectorXd at = nearest_values(schedule, 0, 0, 0);
  const ScheduledGain found = schedule.at(at);
  if (!found.found())
    throw InvalidInput("schedule", "has no gain at " + grid_words(schedule.axes, at) +
                                       ", where a flight begins: " + found.culprit);
  Gains gains = schedule.gains(0);
  gains.K = found.K;
  gains.K_int = found.K_int;
  gains.x0 = found.x0;
  gains.u0 = found.u0;
  gains.axes = PositionAxes::heading;
  gains.limits.conditional_integration = true;
  return gains;
}

ScheduledFeedback::ScheduledFeedback(const Vehicle& vehicle,
                                     std::shared_ptr<const GainSchedule> schedule, double dt)
    : schedule_(std::move(schedule)), dt_(dt) {
  const Gains gains = hover_gains(*schedule_);
  words_ = feedback_words(vehicle, gains);
  now_ = state_feedback_settings(vehicle, gains, dt, {});
  if (const ScheduleAxis* turn = axis_of(*schedule_, ScheduleQuantity::yaw_rate))
    max_yaw_rate_ = std::max(std::abs(turn->values.front()), std::abs(turn->values.back()));
}

Eigen::VectorXd ScheduledFeedback::on_grid(const Vector3<double>& velocity, double heading,
                                           double yaw_rate) const {
  const double along = std::cos(heading) * velocity.x() + std::sin(heading) * velocity.y();
  return nearest_values(*schedule_, along, -velocity.z(), yaw_rate);
}

Vector3<double> ScheduledFeedback::trim_velocity(double heading) const {
  const StateVector<double>& x0 = now_.x0;
  return rotation_of_euler(x0(3), x0(4), heading) * x0.segment<3>(kVelocity);
}

void ScheduledFeedback::set(const Estimate<double>& estimate, const Reference<double>& reference,
                            StateFeedbackSettings<double>& law) {
  const StateVector<double>& x = estimate.x;
  const Matrix3<double> R_WB = rotation_of_euler(x(3), x(4), x(5));
  const Vector3<double> rates = x.segment<3>(kRates);
  const double turn =
      (rates.y() * std::sin(x(3)) + rates.z() * std::cos(x(3))) / std::max(0.1, std::cos(x(4)));
  Eigen::VectorXd at =
      x.allFinite() ? on_grid(R_WB * x.segment<3>(kVelocity), x(5), turn) : gain_at_;
  if (at.size() > 0 && (gain_at_.size() == 0 || at != gain_at_)) {
    gain_at_ = at;
    if (const ScheduledGain found = schedule_->at(at); found.found())
      words_.set_gain(found.K, found.K_int, now_);
  }
  const double turns =
      turn_of_reference(reference.yaw, yaw_before_.value_or(reference.yaw), dt_, max_yaw_rate_);
  yaw_before_ = reference.yaw;
  at = on_grid(reference.velocity, reference.yaw, turns);
  if (trim_at_.size() == 0 || at != trim_at_) {
    trim_at_ = at;
    if (const ScheduledGain found = schedule_->at(at); found.found())
      words_.set_trim(found.x0, found.u0, now_);
  }
  law.K = now_.K;
  law.K_int = now_.K_int;
  law.x0 = now_.x0;
  law.u0 = now_.u0;
}

}  // namespace quadtune
