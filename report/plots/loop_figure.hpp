// SPDX-License-Identifier: Apache-2.0
/// The pictures of `margins` and `pid`.
#pragma once

#include <string>

#include "quadtune/synthesis/pid_gains.hpp"
#include "report/loops/margins_report.hpp"
#include "report/plots/figure.hpp"

namespace quadtune::report {

/// Set-point step, Bode, Nyquist with the disk, sensitivity and pole map of a loop. Of many
/// channels those with the least disk margins.
/// @param report  margins_report() of this loop
[[nodiscard]] Figure margins_figure(const std::string& title, const OpenLoop& loop,
                                    const MarginsReport& report);

/// The same of C P, with the answer to a step of load at the plant's input for the sensitivity.
[[nodiscard]] Figure pid_figure(const std::string& title, const ContinuousTransferFunction& plant,
                                const PidGains& gains, const MarginsReport& report);

}  // namespace quadtune::report
