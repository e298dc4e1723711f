// SPDX-License-Identifier: Apache-2.0
/// What a log tells of the true states, at the instants of a filter's records.
#pragma once

#include <string>
#include <vector>

#include "quadtune/estimation/record_of_log.hpp"

namespace quadtune::internal {

/// A series that is away for so many of its typical periods is not held or interpolated.
inline constexpr double kLongestHold = 10;
/// Instants nearer than this are one [s].
inline constexpr double kSameInstant = 1e-7;

/// Median time from sample to sample [s].
[[nodiscard]] double typical_period(const LogSeries& series);

/// Fills FilterRecord::truth in, as records_of_log() says.
/// @throws InvalidInput
void add_truths(const FilterModel& model, const std::vector<ChannelUse>& truths,
                const std::string& name, std::vector<FilterRecord>& records);

}  // namespace quadtune::internal
