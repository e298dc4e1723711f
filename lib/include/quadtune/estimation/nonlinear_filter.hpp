// SPDX-License-Identifier: Apache-2.0
/// A filter of a nonlinear system over its logs, as the search for its noise sees it.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/estimation/filter_record.hpp"

namespace quadtune {

/// Records of a filter, or why there are none.
struct LinearizedLogs {
  std::vector<FilterRecord> records;
  std::string culprit;  ///< e.g. "log.csv: the velocity leaves the range of a double at 3.2 s"
};

/// An extended Kalman filter with its logs.
class NonlinearFilter {
 public:
  NonlinearFilter() = default;
  NonlinearFilter(const NonlinearFilter&) = default;
  NonlinearFilter(NonlinearFilter&&) = default;
  NonlinearFilter& operator=(const NonlinearFilter&) = default;
  NonlinearFilter& operator=(NonlinearFilter&&) = default;
  virtual ~NonlinearFilter() = default;

  /// States, sensors and parameters; A, B, C and G are those of no instant in particular.
  [[nodiscard]] virtual const FilterModel& model() const = 0;

  /// The logs, linearized along the path that the extended filter takes with these covariances: a
  /// linear filter over them with the same θ has the extended filter's innovations.
  /// @param theta  (p) as start_of(model())
  /// @param stop   asked every thousand instants; true ends it with Interrupted. May be empty.
  /// @return       the instants of measurements(), NaN where a gate refuses one; a truth is in the
  ///               terms of that linear model: of inertial navigation the true turn from its path
  [[nodiscard]] virtual LinearizedLogs linearize(const Eigen::Ref<const Eigen::VectorXd>& theta,
                                                 const std::function<bool()>& stop = {}) const = 0;

  /// All measurements of the logs, not linearized: one column an instant.
  [[nodiscard]] virtual const std::vector<FilterRecord>& measurements() const = 0;

  /// Which of the records it was made of are not among measurements().
  [[nodiscard]] virtual const std::vector<LeftOutRecord>& left_out() const = 0;
};

/// The extended filter of a nonlinear model over its logs, from the first measurement of each on.
///
/// Inertial navigation begins with the tilt that the accelerometer showed in the second before, at
/// rest, at an unknown position; of the directions that it might have faced, with that of the
/// greatest likelihood over the first half minute. P0 is that of all states but the attitude, of
/// which these are the doubts. A rigid body is predicted as on board by Euler steps of at most
/// 10 ms, its rotors' speeds held, and begins with x0 but for the angles and places that the first
/// samples show.
///
/// A record with fewer than two instants of measurements is left out: nothing moves in it that any
/// innovation could tell.
///
/// @param records  inputs at every instant, and the measurements where there are any
/// @param stop     asked every thousand instants; true ends it with Interrupted. May be empty.
/// @throws InvalidInput  as validate() of the model and validate_samples(); for a linear model, a
///                       sensor that measures the attitude of inertial navigation, and where no
///                       record has two instants of measurements.
[[nodiscard]] std::unique_ptr<NonlinearFilter> nonlinear_filter(
    FilterModel model, const std::vector<FilterRecord>& records,
    const std::function<bool()>& stop = {});

}  // namespace quadtune
