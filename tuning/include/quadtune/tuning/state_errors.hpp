// SPDX-License-Identifier: Apache-2.0
/// How far a filter's states are from what they truly were, where a log tells: by their
/// covariances, and in their units.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "quadtune/tuning/consistency.hpp"

namespace quadtune {

/// Whether the errors of the states are what their covariances say: of each state whose truth a
/// record tells, the mean of (x - truth)²/P in the band of as many independent errors as there are,
/// counted by their autocorrelation.
/// @return  checks "error" of the states, none without truth
/// @throws InvalidInput  for options out of range.
[[nodiscard]] std::vector<ConsistencyCheck> check_errors(const FilterModel& model,
                                                         const std::vector<FilterRecord>& records,
                                                         const std::vector<FilterRun>& runs,
                                                         const ConsistencyOptions& options = {});

/// A filter's runs with the records that they are of.
struct TrueRuns {
  const std::vector<FilterRecord>& records;
  const std::vector<FilterRun>& runs;
};

/// Errors of one state in the same instants by the covariances before and after.
struct StateAccuracy {
  std::string state;         ///< e.g. "velocity_x"; "attitude" for the angle of the whole rotation
  std::string unit;          ///< of the state, e.g. "m/s"
  Eigen::Index samples = 0;  ///< instants with a truth, of both
  double before = std::numeric_limits<double>::quiet_NaN();  ///< root mean square error
  double after = std::numeric_limits<double>::quiet_NaN();
  /// Probability that errors which are as large in the mean differ as much as these do by chance,
  /// from the squares' differences in pairs, as many of them independent as their autocorrelation
  /// says; two-sided.
  double p = std::numeric_limits<double>::quiet_NaN();
  bool held_out = false;  ///< over a stretch that no fit has seen; compare_errors() does not know
};

/// Root mean square errors of all states whose truth is told, and of the attitude as one rotation
/// where the model has one and all of its truth is told.
/// @param before, after  of the same instants
[[nodiscard]] std::vector<StateAccuracy> compare_errors(const FilterModel& model,
                                                        const TrueRuns& before,
                                                        const TrueRuns& after);

}  // namespace quadtune
