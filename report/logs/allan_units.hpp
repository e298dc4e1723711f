// SPDX-License-Identifier: Apache-2.0
/// The noises of an Allan deviation in the units in which data sheets give them.
#pragma once

#include <string>
#include <vector>

#include "quadtune/tuning/allan.hpp"

namespace quadtune::report {

/// A reading with its names and units.
struct AllanLine {
  std::string title;  ///< for a person
  std::string key;    ///< for JSON
  AllanReading reading;
  std::string unit;
  double factor = 1;       ///< from `unit` to `other_unit`
  std::string other_unit;  ///< as data sheets have it; empty for none
};

/// Noise density, bias instability, random walk, quantization.
[[nodiscard]] std::vector<AllanLine> allan_lines(const AllanAnalysis& analysis,
                                                 const std::string& unit);

}  // namespace quadtune::report
