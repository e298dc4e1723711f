// SPDX-License-Identifier: Apache-2.0
/// Measurements that never change, or as the model says to the last digit: no noise can be found
/// from them.
#pragma once

#include <string>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/estimation/filter_record.hpp"
#include "quadtune/tuning/innovation_likelihood.hpp"

namespace quadtune::internal {

/// Of the outputs whose variance is to be found from the records alone, one of which all
/// measurements are the same number: its variance would run to zero, and with it often the
/// likelihood to infinity.
/// @param records  not linearized
/// @return         a sentence about it; "" where there is none
[[nodiscard]] std::string constant_measurement(const FilterModel& model,
                                               const std::vector<FilterRecord>& records);

/// Of these outputs one that the filter predicts to rounding, all of it: then both variances run to
/// zero, and what is found is the rounding's.
/// @param runs  of the records
[[nodiscard]] std::string exact_measurement(const FilterModel& model,
                                            const std::vector<FilterRecord>& records,
                                            const std::vector<FilterRun>& runs);

/// Outputs that stay the same number for long although they change otherwise, as a sensor does that
/// hangs: for 50 measurements and one in twenty, and longer than equal neighbours follow each other
/// elsewhere but once in a thousand logs.
/// @param records  not linearized
/// @return         a sentence about each
[[nodiscard]] std::vector<std::string> hanging_measurements(
    const FilterModel& model, const std::vector<FilterRecord>& records);

}  // namespace quadtune::internal
