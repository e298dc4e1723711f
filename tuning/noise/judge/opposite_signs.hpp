// SPDX-License-Identifier: Apache-2.0
/// Detects channels of a log whose sign is opposite to that of the model.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/tuning/innovation_likelihood.hpp"

namespace quadtune::internal {

/// Names the sensors and inputs with whose opposite sign the same covariances explain the records
/// much better. Large process noise makes a filter follow measurements of the wrong sign, so that
/// its innovations alone may be consistent.
/// @param model    a linear model; the result is empty for others
/// @param records  without rejected measurements; the first 20,000 samples of each are used
/// @param theta    (p) estimated covariances
/// @return  a message; empty if no sign is doubtful
/// @throws Interrupted  if `interrupted` returns true
[[nodiscard]] std::string opposite_signs(const FilterModel& model,
                                         const std::vector<FilterRecord>& records,
                                         const Eigen::VectorXd& theta,
                                         const std::function<bool()>& interrupted);

}  // namespace quadtune::internal
