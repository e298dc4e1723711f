// SPDX-License-Identifier: Apache-2.0
/// The page of what `quadtune tune kalman` found.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "report/logs/tune_report.hpp"
#include <cstdint>
#include <functional>
#include <string>

#include "report/page/tuning_page.hpp"

namespace quadtune::report {

/// Runs filter and smoother over the logs with the covariances before and after.
/// @param holdout  share of each record that was kept from the fit
/// @param threads  to use; 0: one for each processor
/// @param command  the command line that made it; may be empty
/// @throws Interrupted  where a signal came
[[nodiscard]] TuningPage page_of(const TuneReport& report, double holdout, std::uint64_t seed,
                                 std::size_t threads, const std::string& command,
                                 const std::function<bool()>& stop = {});

}  // namespace quadtune::report
