// SPDX-License-Identifier: Apache-2.0
/// Margins as text and JSON, for `margins`, `lqr` and `design`.
#pragma once

#include <string>
#include <vector>

#include "quadtune/internal/json.hpp"
#include "quadtune/synthesis/simultaneous_margins.hpp"

namespace quadtune::cli {

/// The margins of a loop's channels, one at a time and all at once.
struct MarginsReport {
  double dt = 0;                   ///< [s]; 0 of a continuous loop
  std::vector<std::string> names;  ///< of the channels
  std::vector<LoopMargins> loops;  ///< one for each
  SimultaneousDiskMargin together;
};

/// @param names  of the channels; empty for one that is just "loop"
[[nodiscard]] MarginsReport margins_report(const OpenLoop& loop, std::vector<std::string> names);

/// "u1", "u2", …: channels without names.
[[nodiscard]] std::vector<std::string> numbered(const std::string& letter, Eigen::Index count);

/// "loops" and "multivariable". What is infinite is null.
[[nodiscard]] internal::Json to_json(const MarginsReport& report);

/// A table with a row for each channel, and a line for all at once.
[[nodiscard]] std::string to_text(const MarginsReport& report);

/// What a careful engineer would not fly: each channel with less than 6 dB either way, 30 degrees
/// or one sample of delay, by name. Empty when all is well.
[[nodiscard]] std::vector<std::string> margin_warnings(const MarginsReport& report);

}  // namespace quadtune::cli
