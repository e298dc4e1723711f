// SPDX-License-Identifier: Apache-2.0
/// A gain schedule as it runs on board: which gains and trims hold in a control period.
/// Method: docs/theory.md, "Gain schedules".
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "quadtune/control/state_feedback_law.hpp"
#include "quadtune/estimation/on_board.hpp"
#include "quadtune/gain_schedule.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// The gains of a schedule where the vehicle hovers, or at the point of the grid that is nearest to
/// hover: what a flight begins with. Position counts in heading axes, because the models of a
/// schedule know one heading only, and integrals stop at the limits of the motors.
/// @throws InvalidInput  if the schedule has no gain there, or an axis of mass or density that does
///                       not contain 1, the vehicle's own
[[nodiscard]] Gains hover_gains(const GainSchedule& schedule);

/// Interpolates gains by the estimated flight and trims by the flight of the reference.
///
/// In u = u0 + K (x0 - x), x0 and u0 follow the reference and K follows the estimate. Where the
/// vehicle flies as the reference does, the error is zero, so that the derivative of K does not
/// enter the linearization: near every point of the grid the loop has the poles that were designed
/// there. A trim that followed the estimate would feed the estimated speed back to the inputs.
///
/// Values beyond the grid count as its nearest edge. A reference that turns faster than the grid
/// reaches is a step, not a rotation, and counts as not turning. Where the grid has no gain, the
/// last gain or trim holds.
class ScheduledFeedback {
 public:
  /// @param dt  control period [s]
  /// @throws InvalidInput  as hover_gains() and state_feedback_settings()
  ScheduledFeedback(const Vehicle& vehicle, std::shared_ptr<const GainSchedule> schedule,
                    double dt);

  /// Sets K and K_int, x0 and u0 of a law, and nothing else. Call it once in every period.
  void set(const Estimate<double>& estimate, const Reference<double>& reference,
           StateFeedbackSettings<double>& law);

  /// The velocity of the present trim over the ground, in world axes [m/s].
  /// @param heading  of the vehicle [rad]
  [[nodiscard]] Vector3<double> trim_velocity(double heading) const;

 private:
  /// The nearest values of the grid, one for each axis.
  [[nodiscard]] Eigen::VectorXd on_grid(const Vector3<double>& velocity, double heading,
                                        double yaw_rate) const;

  std::shared_ptr<const GainSchedule> schedule_;
  FeedbackWords words_;
  double dt_;
  double greatest_turn_ = 0;          ///< of the grid [rad/s]
  std::optional<double> yaw_before_;  ///< of the reference [rad]
  Eigen::VectorXd gain_at_, trim_at_;
  StateFeedbackSettings<double> now_;
};

}  // namespace quadtune
