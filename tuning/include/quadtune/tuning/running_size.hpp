// SPDX-License-Identifier: Apache-2.0
/// The size of innovations over time: the mean of e²/S over a window that goes along.
#pragma once

#include <Eigen/Core>
#include <limits>

#include "quadtune/tuning/innovation_likelihood.hpp"

namespace quadtune {

struct RunningSize {
  /// (N) mean of the innovations about the instant; NaN where nothing was compared, and within half
  /// a window of the ends.
  Eigen::VectorXd value;
  /// In which it stays with the probability asked for, at any one instant, if the filter is right:
  /// χ² of as many degrees as the window has innovations, divided by them.
  double low = std::numeric_limits<double>::quiet_NaN();
  double high = std::numeric_limits<double>::quiet_NaN();
};

/// @param output      index among the outputs of all sensors
/// @param window      innovations of a mean, ≥ 1
/// @param confidence  0 … 1
/// @throws InvalidInput  for numbers out of range, or a run that was not computed.
[[nodiscard]] RunningSize running_size(const FilterRun& run, Eigen::Index output, int window,
                                       double confidence = 0.95);

}  // namespace quadtune
