// SPDX-License-Identifier: Apache-2.0
/// Errors of the states of a filter, for logs that contain the true states: relative to their
/// covariances, and in their units.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "quadtune/tuning/consistency.hpp"

namespace quadtune {

/// Tests whether the errors of the states agree with their covariances. For each state whose true
/// value is in a record, it compares the mean of (x - truth)²/P with the interval for the effective
/// number of independent errors, which is computed from their autocorrelation.
/// @return  checks "error" of the states; empty without true values
/// @throws InvalidInput  for options out of range.
[[nodiscard]] std::vector<ConsistencyCheck> check_errors(const FilterModel& model,
                                                         const std::vector<FilterRecord>& records,
                                                         const std::vector<FilterRun>& runs,
                                                         const ConsistencyOptions& options = {});

/// Runs of a filter with their records.
struct TrueRuns {
  const std::vector<FilterRecord>& records;  ///< with true states
  const std::vector<FilterRun>& runs;        ///< one for each record
};

/// Errors of one state at the same instants, by the covariances before and after.
struct StateAccuracy {
  std::string state;         ///< e.g. "velocity_x"; "attitude" for the angle of the whole rotation
  std::string unit;          ///< of the state, e.g. "m/s"
  Eigen::Index samples = 0;  ///< number of instants with a true value in both
  double before = std::numeric_limits<double>::quiet_NaN();  ///< root mean square error
  double after = std::numeric_limits<double>::quiet_NaN();   ///< root mean square error after
  /// Two-sided probability that errors with equal mean squares differ as much as these by chance,
  /// from the paired differences of their squares with the effective number of independent ones
  /// given by their autocorrelation.
  double p = std::numeric_limits<double>::quiet_NaN();
  bool held_out = false;  ///< over the held-out part; compare_errors() does not set it
};

/// Computes the root mean square errors of all states with true values, and of the attitude as one
/// rotation if the model has one and all of its true values are known.
/// @param model          of the runs
/// @param before, after  at the same instants
[[nodiscard]] std::vector<StateAccuracy> compare_errors(const FilterModel& model,
                                                        const TrueRuns& before,
                                                        const TrueRuns& after);

}  // namespace quadtune
