// SPDX-License-Identifier: Apache-2.0
/// PID gains for a transfer function, as text, JSON and picture.
#pragma once

#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/design/pid_report.hpp"
#include "report/plots/figure.hpp"

namespace quadtune::report {

/// The gains, the margins of their loop, and "how" they were found.
[[nodiscard]] internal::Json to_json(const PidReport& report);
[[nodiscard]] std::string to_text(const PidReport& report);

/// @param num, den  the plant's, as they were asked for
[[nodiscard]] Figure pid_figure(const PidReport& report, const std::string& num,
                                const std::string& den);

}  // namespace quadtune::report
