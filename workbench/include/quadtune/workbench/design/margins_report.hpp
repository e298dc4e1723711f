// SPDX-License-Identifier: Apache-2.0
/// The margins of a loop's channels by name, with warnings about weak ones.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/synthesis/simultaneous_margins.hpp"

namespace quadtune {

/// Which margins of a loop are computed.
enum class MarginsEvidence {
  none,       ///< nothing
  essential,  ///< of the channels, one at a time
  full,       ///< also of all channels at once, which takes many times as long
};

/// "none", "essential" or "full".
/// @throws OptionError  "evidence", for other words
[[nodiscard]] MarginsEvidence margins_evidence(const std::string& word);

/// The margins of a loop's channels, one at a time and all at once.
struct MarginsReport {
  double dt = 0;                   ///< [s]; 0 for a continuous loop
  std::vector<std::string> names;  ///< of the channels
  std::vector<LoopMargins> loops;  ///< one per channel; empty with MarginsEvidence::none
  std::optional<SimultaneousDiskMargin> together;  ///< with MarginsEvidence::full
};

/// @param loop      under negative feedback
/// @param names     of the channels; empty for a single channel named "loop"
/// @param evidence  how much is computed
[[nodiscard]] MarginsReport margins_report(const OpenLoop& loop, std::vector<std::string> names,
                                           MarginsEvidence evidence = MarginsEvidence::full);

/// The most extensive evidence that takes about a second. It depends on the sizes only, so that the
/// result is the same on every machine.
[[nodiscard]] MarginsEvidence affordable_evidence(Eigen::Index states, Eigen::Index channels);

/// "u1", "u2", …: names for channels without names.
[[nodiscard]] std::vector<std::string> numbered(const std::string& letter, Eigen::Index count);

/// Warnings about weak margins: each channel with less than 6 dB in either direction, 30 degrees or
/// one sample of delay, by name. Empty if there are none.
[[nodiscard]] std::vector<std::string> margin_warnings(const MarginsReport& report);

/// Notes on conventions that affect the report: a crossover at 0 rad/s, crossovers that are not
/// listed.
[[nodiscard]] std::vector<std::string> margin_notes(const MarginsReport& report);

}  // namespace quadtune
