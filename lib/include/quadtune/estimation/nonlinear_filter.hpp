// SPDX-License-Identifier: Apache-2.0
/// Interface between nonlinear filters over logs and the search for their noise covariances.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/estimation/filter_record.hpp"

namespace quadtune {

/// Linearized records of a filter, or the reason why there are none.
struct LinearizedLogs {
  std::vector<FilterRecord> records;  ///< one for each log; empty if there is a culprit
  std::string culprit;  ///< e.g. "log.csv: the velocity leaves the range of a double at 3.2 s"
};

/// An extended Kalman filter together with its logs.
class NonlinearFilter {
 public:
  NonlinearFilter() = default;
  NonlinearFilter(const NonlinearFilter&) = default;
  NonlinearFilter(NonlinearFilter&&) = default;
  NonlinearFilter& operator=(const NonlinearFilter&) = default;
  NonlinearFilter& operator=(NonlinearFilter&&) = default;
  virtual ~NonlinearFilter() = default;

  /// States, sensors and parameters; A, B, C and G do not refer to any particular instant.
  [[nodiscard]] virtual const FilterModel& model() const = 0;

  /// Linearizes the logs along the trajectory that the extended filter computes with these
  /// covariances: a linear filter over the result, with the same θ, has the innovations of the
  /// extended filter.
  /// @param theta  (p) as start_of(model())
  /// @param stop   called every thousand instants; true aborts with Interrupted. May be empty.
  /// @return       the instants of measurements(), NaN where a gate rejects one. A truth is
  ///               expressed in the states of the linear model, for inertial navigation the
  ///               rotation from the trajectory to the true attitude.
  [[nodiscard]] virtual LinearizedLogs linearize(const Eigen::Ref<const Eigen::VectorXd>& theta,
                                                 const std::function<bool()>& stop = {}) const = 0;

  /// All measurements of the logs, not linearized: one column per instant.
  [[nodiscard]] virtual const std::vector<FilterRecord>& measurements() const = 0;

  /// Records that were passed to the constructor and are not among measurements().
  [[nodiscard]] virtual const std::vector<LeftOutRecord>& left_out() const = 0;
};

/// Creates the extended filter of a nonlinear model over its logs. Each log begins at its first
/// measurement.
///
/// Inertial navigation starts at rest, at an unknown position, with the tilt that the accelerometer
/// measured in the preceding second. Of several candidate headings, that with the greatest
/// likelihood over the first half minute is chosen. P0 is the covariance of all states except the
/// attitude, whose initial uncertainty follows from this procedure. A rigid body is predicted as on
/// board, by Euler steps of at most 10 ms at constant rotor speeds; it starts with x0, except for
/// the angles and positions that the first samples measure.
///
/// A record with fewer than two instants of measurements is left out, since it contains no
/// innovation that depends on the motion.
///
/// @param model    nonlinear: inertial navigation, or a rigid body
/// @param records  inputs at every instant, and measurements where available
/// @param stop     called every thousand instants; true aborts with Interrupted. May be empty.
/// @throws InvalidInput  as validate() of the model and validate_samples(); if the model is linear,
///                       if a sensor measures the attitude of inertial navigation, or if no record
///                       has two instants of measurements
[[nodiscard]] std::unique_ptr<NonlinearFilter> nonlinear_filter(
    FilterModel model, const std::vector<FilterRecord>& records,
    const std::function<bool()>& stop = {});

}  // namespace quadtune
