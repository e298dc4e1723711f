// SPDX-License-Identifier: Apache-2.0
/// Linear systems in series, for loops of a controller and a plant.
#pragma once

#include <Eigen/Core>

#include "quadtune/lti.hpp"

namespace quadtune {

/// The system whose input drives `first` and whose output is that of `second`, driven by the output
/// of `first`: with transfer functions, second(s) first(s). States: those of `first`, then those of
/// `second`. The result has explicit C and D and no names.
/// @throws InvalidInput  as validate(), or if `second` does not have as many inputs as `first`
///                       has outputs
[[nodiscard]] ContinuousLti series(const ContinuousLti& first, const ContinuousLti& second);
/// @throws InvalidInput  likewise, or if the sample periods differ
[[nodiscard]] DiscreteLti series(const DiscreteLti& first, const DiscreteLti& second);

/// The same with a constant gain in place of one of the two systems.
[[nodiscard]] ContinuousLti series(const ContinuousLti& first, const Eigen::MatrixXd& second);

/// The same for a discrete system.
[[nodiscard]] DiscreteLti series(const DiscreteLti& first, const Eigen::MatrixXd& second);

/// The same with the gain first.
[[nodiscard]] ContinuousLti series(const Eigen::MatrixXd& first, const ContinuousLti& second);

/// The same for a discrete system.
[[nodiscard]] DiscreteLti series(const Eigen::MatrixXd& first, const DiscreteLti& second);

}  // namespace quadtune
