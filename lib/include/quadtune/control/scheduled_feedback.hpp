// SPDX-License-Identifier: Apache-2.0
/// A gain schedule as it runs on board: selects gains and trims in every control period.
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

/// The gains of a schedule at hover, or at the grid point nearest to hover, with which a flight
/// begins. Position errors use heading axes, because the models of a schedule have a single
/// heading, and integrals use conditional integration.
/// @throws InvalidInput  if the schedule has no gain there, or if an axis of mass or density does
///                       not contain 1, the vehicle's own value
[[nodiscard]] Gains hover_gains(const GainSchedule& schedule);

/// Interpolates gains at the estimated flight condition and trims at that of the reference.
///
/// In u = u0 + K (x0 - x), x0 and u0 follow the reference and K follows the estimate. If the
/// vehicle flies as the reference does, the error is zero, and the derivative of K does not enter
/// the linearization: near every grid point the loop has the poles designed there. A trim that
/// followed the estimate would feed the estimated speed back to the inputs.
///
/// Values outside the grid are replaced by the nearest edge of the grid. A reference whose yaw
/// changes faster than the maximum yaw rate of the grid is a step and counts as not rotating. If
/// the grid has no gain at a point, the last gain or trim is kept.
class ScheduledFeedback {
 public:
  /// @param vehicle   valid, the one that the schedule was computed for
  /// @param schedule  not null; with a gain at hover
  /// @param dt        control period [s]
  /// @throws InvalidInput  as hover_gains() and state_feedback_settings()
  ScheduledFeedback(const Vehicle& vehicle, std::shared_ptr<const GainSchedule> schedule,
                    double dt);

  /// Sets K, K_int, x0 and u0 of a law, and nothing else. Call it once per period.
  void set(const Estimate<double>& estimate, const Reference<double>& reference,
           StateFeedbackSettings<double>& law);

  /// Ground velocity of the present trim in world axes [m/s].
  /// @param heading  heading of the vehicle [rad]
  [[nodiscard]] Vector3<double> trim_velocity(double heading) const;

 private:
  /// The nearest grid values, one per axis.
  [[nodiscard]] Eigen::VectorXd on_grid(const Vector3<double>& velocity, double heading,
                                        double yaw_rate) const;

  std::shared_ptr<const GainSchedule> schedule_;
  FeedbackTransformation words_;
  double dt_;
  double max_yaw_rate_ = 0;           ///< maximum yaw rate of the grid [rad/s]
  std::optional<double> yaw_before_;  ///< previous yaw of the reference [rad]
  Eigen::VectorXd gain_at_, trim_at_;
  StateFeedbackSettings<double> now_;
};

}  // namespace quadtune
