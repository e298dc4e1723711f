// SPDX-License-Identifier: Apache-2.0
/// The margins of a loop's channels by name, and what a careful engineer would say of them.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/synthesis/simultaneous_margins.hpp"

namespace quadtune {

/// How much is told of a loop.
enum class MarginsEvidence {
  none,       ///< nothing
  essential,  ///< the channels, one at a time
  full,       ///< and all at once, which takes many times as long
};

/// "none", "essential" or "full".
/// @throws OptionError  "evidence", for other words
[[nodiscard]] MarginsEvidence margins_evidence(const std::string& word);

/// The margins of a loop's channels, one at a time and all at once.
struct MarginsReport {
  double dt = 0;                   ///< [s]; 0 of a continuous loop
  std::vector<std::string> names;  ///< of the channels
  std::vector<LoopMargins> loops;  ///< one for each; empty with MarginsEvidence::none
  std::optional<SimultaneousDiskMargin> together;  ///< with MarginsEvidence::full
};

/// @param names  of the channels; empty for one that is just "loop"
[[nodiscard]] MarginsReport margins_report(const OpenLoop& loop, std::vector<std::string> names,
                                           MarginsEvidence evidence = MarginsEvidence::full);

/// The most evidence that takes about a second, from the sizes alone, so that it is the same
/// everywhere.
[[nodiscard]] MarginsEvidence affordable_evidence(Eigen::Index states, Eigen::Index channels);

/// "u1", "u2", …: channels without names.
[[nodiscard]] std::vector<std::string> numbered(const std::string& letter, Eigen::Index count);

/// What a careful engineer would not fly: each channel with less than 6 dB either way, 30 degrees
/// or one sample of delay, by name. Empty when all is well.
[[nodiscard]] std::vector<std::string> margin_warnings(const MarginsReport& report);

/// Conventions where they act: a crossover at 0 rad/s, crossovers that are not listed.
[[nodiscard]] std::vector<std::string> margin_notes(const MarginsReport& report);

}  // namespace quadtune
