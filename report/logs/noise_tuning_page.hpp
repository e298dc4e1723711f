// SPDX-License-Identifier: Apache-2.0
/// The page of the noise covariances that were found for a filter.
#pragma once

#include <cstdint>
#include <string>

#include "quadtune/workbench/logs/noise_evidence.hpp"
#include "report/page/tuning_page.hpp"

namespace quadtune::report {

/// @param command  the command line that made it; may be empty
[[nodiscard]] TuningPage page_of(const TunedNoise& tuned, const NoiseEvidence& evidence,
                                 std::uint64_t seed, const std::string& command);

}  // namespace quadtune::report
