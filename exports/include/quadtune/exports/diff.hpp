// SPDX-License-Identifier: Apache-2.0
/// Two gains entry by entry, whatever conventions they are written in.
#pragma once

#include <string>
#include <vector>

#include "quadtune/design.hpp"
#include "quadtune/gains.hpp"

namespace quadtune {

/// One entry that differs.
struct DiffEntry {
  std::string matrix;     ///< "K" or "K_int"; of a cascade "Kp", "Ki", "Kd" or the number's name
  std::string input;      ///< row, in the first gain's words; of a cascade the loop
  std::string state;      ///< column, in the first gain's words; of a cascade empty
  double a = 0;           ///< in the first gain
  double b = 0;           ///< in the second, turned into the first's convention and sign law
  double difference = 0;  ///< b - a
  double relative = 0;    ///< |b - a| over the scale of the entry
};

/// What differs.
struct GainsDiff {
  double max_relative = 0;
  std::vector<DiffEntry> entries;  ///< those that are not equal, the largest relative first
};

/// Compares K and K_int by what states and inputs mean.
///
/// The scale of an entry is the largest entry of its row or of its column in either gain, whichever
/// is smaller, and at least 1e-13 of the largest entry of the matrix. So 1e-16 against 0 counts as
/// rounding, and a small entry is still measured against its peers.
///
/// @throws InvalidInput  if the gains have other kinds of inputs, other units, or other states or
///                       integrals; the message names what the one has and the other has not.
[[nodiscard]] GainsDiff diff(const Gains& a, const Gains& b);

/// Compares two cascades: gains, period, limits, rule of the integrals (as its place among the
/// rules). The scale of a number is the larger of the two; where only one is finite, the relative
/// difference is 1.
[[nodiscard]] GainsDiff diff(const CascadeDesign& a, const CascadeDesign& b);

/// "K(w1, x)", "Kp(roll)", "dt_s".
[[nodiscard]] std::string name_of(const DiffEntry& entry);

}  // namespace quadtune
