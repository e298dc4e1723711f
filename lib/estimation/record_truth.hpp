// SPDX-License-Identifier: Apache-2.0
/// True states from a log, at the instants of a filter's records.
#pragma once

#include <string>
#include <vector>

#include "quadtune/estimation/record_of_log.hpp"

namespace quadtune::internal {

/// Maximum gap of a series, in typical periods, over which it is held or interpolated.
inline constexpr double kMaxHold = 10;
/// Instants closer than this are equal [s].
inline constexpr double kSameInstant = 1e-7;

/// Median time between samples [s].
[[nodiscard]] double typical_period(const LogSeries& series);

/// Fills FilterRecord::truth as described for records_of_log().
/// @throws InvalidInput
void add_truths(const FilterModel& model, const std::vector<ChannelUse>& truths,
                const std::string& name, std::vector<FilterRecord>& records);

}  // namespace quadtune::internal
