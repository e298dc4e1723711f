// SPDX-License-Identifier: Apache-2.0
/// The size of innovations over time: the moving average of e²/S.
#pragma once

#include <Eigen/Core>
#include <limits>

#include "quadtune/tuning/innovation_likelihood.hpp"

namespace quadtune {

/// The moving average with its interval.
struct RunningSize {
  /// (N) mean over the innovations around the instant; NaN where there is no innovation, and within
  /// half a window of the ends.
  Eigen::VectorXd value;
  /// Interval that contains the value at any one instant with the given probability if the filter
  /// is right: χ² with as many degrees of freedom as the window has innovations, divided by that
  /// number.
  double low = std::numeric_limits<double>::quiet_NaN();
  double high = std::numeric_limits<double>::quiet_NaN();  ///< upper end of that interval
};

/// Computes the moving average of e²/S of one output.
/// @param run         computed
/// @param output      index among the outputs of all sensors
/// @param window      number of innovations of a mean, ≥ 1
/// @param confidence  0 … 1
/// @throws InvalidInput  for numbers out of range, or a run that was not computed.
[[nodiscard]] RunningSize normalized_innovation_window(const FilterRun& run, Eigen::Index output,
                                                       int window, double confidence = 0.95);

}  // namespace quadtune
