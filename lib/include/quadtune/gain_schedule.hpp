// SPDX-License-Identifier: Apache-2.0
/// State-feedback gains over a grid of flights, interpolated between its points.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "quadtune/convention.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/lti.hpp"

namespace quadtune {

/// What a gain may be scheduled by.
enum class ScheduleQuantity {
  speed,     ///< over the ground along the heading [m/s], ≥ 0
  climb,     ///< upward [m/s]
  yaw_rate,  ///< of the heading [rad/s], > 0 clockwise seen from above: a circle, or a spin at rest
  mass,      ///< over the vehicle's, > 0; the inertia and the centre of mass stay
  density,   ///< of the air over the vehicle's, > 0
};

/// "speed", "climb", "yaw_rate", "mass" or "density".
[[nodiscard]] std::string to_string(ScheduleQuantity quantity);
/// @throws InvalidInput  naming the word, the quantities that exist, and the nearest.
[[nodiscard]] ScheduleQuantity schedule_quantity(const std::string& name, const std::string& where);
/// "m/s", "rad/s", or "" for a ratio.
[[nodiscard]] std::string unit(ScheduleQuantity quantity);

/// One direction of the grid.
struct ScheduleAxis {
  ScheduleQuantity quantity = ScheduleQuantity::speed;
  std::vector<double> values;  ///< ≥ 1 of them, ascending, within the quantity's range

  friend bool operator==(const ScheduleAxis&, const ScheduleAxis&) = default;
};

/// Largest number of points of a grid: a larger one is a mistyped step.
inline constexpr Eigen::Index kMostSchedulePoints = 100'000;

/// Number of points of the grid.
/// @throws InvalidInput  naming the axis: none, a quantity twice, values that are none, not
///                       ascending or out of the quantity's range, more than kMostSchedulePoints.
Eigen::Index checked_grid_size(const std::vector<ScheduleAxis>& axes, const std::string& where);

/// The values (one for each axis) of point `index` of the grid, whose last axis runs fastest.
[[nodiscard]] Eigen::VectorXd grid_point(const std::vector<ScheduleAxis>& axes, Eigen::Index index);

/// "speed 2.5, yaw_rate -1" of such values.
[[nodiscard]] std::string grid_words(const std::vector<ScheduleAxis>& axes,
                                     const Eigen::VectorXd& values);

/// How one point of the grid came out.
enum class PointStatus {
  solved,
  no_trim,  ///< the vehicle cannot fly there
  no_gain,  ///< it can, but the Riccati equation has no stabilizing solution
};

/// "solved", "no trim" or "no gain", and back.
[[nodiscard]] std::string to_string(PointStatus status);
[[nodiscard]] PointStatus point_status(const std::string& name, const std::string& where);

/// What a look into the schedule gives.
enum class LookupStatus {
  found,
  outside,     ///< beyond the grid: gains are not extrapolated
  infeasible,  ///< a point of the grid that is needed has no gain
};

/// Gains between the points of a schedule, or why there are none.
struct ScheduledGain {
  LookupStatus status = LookupStatus::outside;
  Eigen::MatrixXd K;      ///< (nu × nx); empty unless found, as all here
  Eigen::MatrixXd K_int;  ///< (nu × ni)
  Eigen::VectorXd x0;     ///< (nx) trim of the states
  Eigen::VectorXd u0;     ///< (nu) trim of the inputs
  std::string culprit;    ///< the axis and its range, or the point and its reason; empty when found

  [[nodiscard]] bool found() const { return status == LookupStatus::found; }
};

/// Gains with their trims over a grid; each is applied as Gains are.
struct GainSchedule {
  std::vector<ScheduleAxis> axes;  ///< ≥ 1; the last runs fastest
  std::vector<Signal> states;      ///< nx
  std::vector<Signal> inputs;      ///< nu
  std::vector<Signal> integrals;   ///< ni, as in Gains
  std::string vehicle;             ///< name
  std::string convention;          ///< name
  InputKind input_kind = InputKind::rotor_speed;
  SignLaw sign_law = SignLaw::set_point_minus_state;
  double dt = 0;   ///< sample period of the law [s]; 0 means continuous
  double yaw = 0;  ///< heading at the linearized instant [rad]

  // One entry or column for each point; a column holds its matrix column by column. NaN unless
  // solved.
  std::vector<PointStatus> status;
  std::vector<std::string> culprit;  ///< empty where solved
  Eigen::MatrixXd K;                 ///< (nu·nx × points)
  Eigen::MatrixXd K_int;             ///< (nu·ni × points)
  Eigen::MatrixXd x0;                ///< (nx × points)
  Eigen::MatrixXd u0;                ///< (nu × points)
  Eigen::VectorXd residual;          ///< of the Riccati equation, RiccatiResult::residual

  [[nodiscard]] Eigen::Index size() const { return static_cast<Eigen::Index>(status.size()); }
  [[nodiscard]] Eigen::Index solved_count() const;
  [[nodiscard]] bool solved(Eigen::Index point) const {
    return status[static_cast<std::size_t>(point)] == PointStatus::solved;
  }

  /// The gains of one point; NaN unless solved.
  [[nodiscard]] Gains gains(Eigen::Index point) const;

  /// Multilinear interpolation. Exact at the points of the grid; a point of no weight is not
  /// needed. Axes of one value hold for that value only, to rounding.
  /// @param values  one for each axis, in their order
  /// @throws InvalidInput  for another number of values
  [[nodiscard]] ScheduledGain at(const Eigen::Ref<const Eigen::VectorXd>& values) const;
};

/// A schedule of this grid and of these signals with room for all points, all NaN and without
/// status: what a solver or a reader fills.
/// @throws InvalidInput  as checked_grid_size().
[[nodiscard]] GainSchedule empty_schedule(std::vector<ScheduleAxis> axes,
                                          std::vector<Signal> states, std::vector<Signal> inputs,
                                          std::vector<Signal> integrals);

}  // namespace quadtune
