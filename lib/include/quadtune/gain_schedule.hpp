// SPDX-License-Identifier: Apache-2.0
/// State-feedback gains over a grid of flight conditions, with interpolation between the grid
/// points.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "quadtune/convention.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/lti.hpp"

namespace quadtune {

/// The quantities by which gains can be scheduled.
enum class ScheduleQuantity {
  speed,  ///< ground speed along the heading [m/s], ≥ 0
  climb,  ///< upward [m/s]
  /// Rate of the heading [rad/s], > 0 clockwise seen from above: a circle, or a spin if the speed
  /// is 0.
  yaw_rate,
  /// Ratio to the vehicle's mass, > 0; inertia and centre of mass do not change.
  mass,
  density,  ///< ratio to the vehicle's air density, > 0
};

/// "speed", "climb", "yaw_rate", "mass" or "density".
[[nodiscard]] std::string to_string(ScheduleQuantity quantity);
/// @throws InvalidInput  with the unknown name, the known quantities and the nearest of them.
[[nodiscard]] ScheduleQuantity schedule_quantity(const std::string& name, const std::string& where);
/// "m/s", "rad/s", or "" for a ratio.
[[nodiscard]] std::string unit(ScheduleQuantity quantity);

/// One axis of the grid.
struct ScheduleAxis {
  ScheduleQuantity quantity = ScheduleQuantity::speed;  ///< what varies along the axis
  std::vector<double> values;  ///< at least one, ascending, within the quantity's range

  friend bool operator==(const ScheduleAxis&, const ScheduleAxis&) = default;
};

/// Maximum number of grid points: a larger grid is most likely a mistyped step.
inline constexpr Eigen::Index kMaxSchedulePoints = 100'000;

/// Number of points of the grid.
/// @throws InvalidInput  with the name of the axis, if there are no axes, a quantity is repeated,
///                       values are missing, not finite, not ascending or out of the quantity's
///                       range, or the grid exceeds kMaxSchedulePoints.
Eigen::Index checked_grid_size(const std::vector<ScheduleAxis>& axes, const std::string& where);

/// The values of grid point `index`, one per axis. The last axis varies fastest.
[[nodiscard]] Eigen::VectorXd grid_point(const std::vector<ScheduleAxis>& axes, Eigen::Index index);

/// Text of such values, e.g. "speed 2.5, yaw_rate -1".
[[nodiscard]] std::string grid_words(const std::vector<ScheduleAxis>& axes,
                                     const Eigen::VectorXd& values);

/// The outcome of the design at one grid point.
enum class PointStatus {
  solved,
  no_trim,  ///< the vehicle cannot fly this condition
  /// The trim exists, but the Riccati equation has no stabilizing solution.
  no_gain,
};

/// "solved", "no trim" or "no gain".
[[nodiscard]] std::string to_string(PointStatus status);

/// The status of a name, the inverse of to_string().
/// @throws InvalidInput  with the unknown name and the three known ones.
[[nodiscard]] PointStatus point_status(const std::string& name, const std::string& where);

/// The outcome of a lookup in the schedule.
enum class LookupStatus {
  found,
  outside,     ///< outside the grid: gains are not extrapolated
  infeasible,  ///< a grid point that the interpolation needs has no gain
};

/// Gains interpolated between grid points, or the reason why there are none.
struct ScheduledGain {
  LookupStatus status = LookupStatus::outside;  ///< found, or why there are no gains
  Eigen::MatrixXd K;      ///< (nu × nx); empty unless found, like all matrices here
  Eigen::MatrixXd K_int;  ///< (nu × ni)
  Eigen::VectorXd x0;     ///< (nx) trim of the states
  Eigen::VectorXd u0;     ///< (nu) trim of the inputs
  /// The axis and its range, or the grid point and its reason; empty if found.
  std::string culprit;

  /// Whether there are gains.
  [[nodiscard]] bool found() const { return status == LookupStatus::found; }
};

/// Gains and trims over a grid. The gains of each point are applied as described at Gains.
struct GainSchedule {
  std::vector<ScheduleAxis> axes;                     ///< at least one; the last varies fastest
  std::vector<Signal> states;                         ///< nx
  std::vector<Signal> inputs;                         ///< nu
  std::vector<Signal> integrals;                      ///< ni, as in Gains
  std::string vehicle;                                ///< name of the vehicle
  std::string convention;                             ///< name of the convention
  InputKind input_kind = InputKind::rotor_speed;      ///< quantities that the law commands
  SignLaw sign_law = SignLaw::set_point_minus_state;  ///< sign law of the gains
  double dt = 0;   ///< sample period of the law [s]; 0 means continuous
  double yaw = 0;  ///< heading at the linearized instant [rad]

  // One entry or one column per grid point; a column stores its matrix in column-major order. NaN
  // unless solved.
  std::vector<PointStatus> status;   ///< one for each grid point
  std::vector<std::string> culprit;  ///< empty if solved
  Eigen::MatrixXd K;                 ///< (nu·nx × points)
  Eigen::MatrixXd K_int;             ///< (nu·ni × points)
  Eigen::MatrixXd x0;                ///< (nx × points)
  Eigen::MatrixXd u0;                ///< (nu × points)
  Eigen::VectorXd residual;          ///< of the Riccati equation, RiccatiResult::residual

  /// Number of grid points.
  [[nodiscard]] Eigen::Index size() const { return static_cast<Eigen::Index>(status.size()); }
  [[nodiscard]] Eigen::Index solved_count() const;  ///< number of grid points that have gains
  /// Whether a grid point has gains.
  [[nodiscard]] bool solved(Eigen::Index point) const {
    return status[static_cast<std::size_t>(point)] == PointStatus::solved;
  }

  /// The gains of one grid point; NaN unless solved.
  [[nodiscard]] Gains gains(Eigen::Index point) const;

  /// Multilinear interpolation, exact at the grid points. Points with zero weight need not be
  /// solved. An axis with a single value matches only that value, up to rounding.
  /// @param values  one per axis, in their order
  /// @throws InvalidInput  if the number of values is not the number of axes
  [[nodiscard]] ScheduledGain at(const Eigen::Ref<const Eigen::VectorXd>& values) const;
};

/// A schedule with this grid and these signals, to be filled by a solver or a reader. Its matrices
/// have room for all points and are NaN; every status is PointStatus::no_trim.
/// @throws InvalidInput  as checked_grid_size().
[[nodiscard]] GainSchedule empty_schedule(std::vector<ScheduleAxis> axes,
                                          std::vector<Signal> states, std::vector<Signal> inputs,
                                          std::vector<Signal> integrals);

}  // namespace quadtune
