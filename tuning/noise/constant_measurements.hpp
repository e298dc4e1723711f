// SPDX-License-Identifier: Apache-2.0
/// Detection of measurements that are constant, or that the model predicts exactly: their noise
/// cannot be estimated.
#pragma once

#include <string>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/estimation/filter_record.hpp"
#include "quadtune/tuning/innovation_likelihood.hpp"

namespace quadtune::internal {

/// Detects an output whose variance is estimated from the records alone and whose measurements are
/// all equal: its variance would converge to zero, and the likelihood often to infinity.
/// @param records  not linearized
/// @return         a message about the first such output; "" if there is none
[[nodiscard]] std::string constant_measurement(const FilterModel& model,
                                               const std::vector<FilterRecord>& records);

/// Detects such an output if the filter predicts all its measurements up to rounding: the variances
/// of process and measurement noise would both converge to zero, and the estimate would be
/// determined by rounding.
/// @param runs  of the records
/// @return      a message about the first such output; "" if there is none
[[nodiscard]] std::string exact_measurement(const FilterModel& model,
                                            const std::vector<FilterRecord>& records,
                                            const std::vector<FilterRun>& runs);

/// Detects outputs that are constant for long although they change otherwise, like those of a
/// sensor that is stuck: for at least 50 measurements and one in twenty, and for longer than equal
/// consecutive measurements occur elsewhere with a probability of one in a thousand logs.
/// @param records  not linearized
/// @return         one message for each such output
[[nodiscard]] std::vector<std::string> hanging_measurements(
    const FilterModel& model, const std::vector<FilterRecord>& records);

}  // namespace quadtune::internal
