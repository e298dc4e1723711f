// SPDX-License-Identifier: Apache-2.0
/// The pictures of `margins` and `pid`.
#pragma once

#include <string>

#include "quadtune/synthesis/pid/pid_gains.hpp"
#include "report/loops/margins_report.hpp"
#include "report/plots/figure.hpp"

namespace quadtune::report {

/// Step response to the set point, Bode plots, Nyquist plot with the disk margin, sensitivity and
/// pole map of a loop. Of many channels, it shows those with the smallest disk margins.
/// @param report  margins_report() of this loop
[[nodiscard]] Figure margins_figure(const std::string& title, const OpenLoop& loop,
                                    const MarginsReport& report);

/// The same for C P, with the response to a load step at the plant's input instead of the
/// sensitivity.
[[nodiscard]] Figure pid_figure(const std::string& title, const ContinuousTransferFunction& plant,
                                const PidGains& gains, const MarginsReport& report);

}  // namespace quadtune::report
