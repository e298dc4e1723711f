// SPDX-License-Identifier: Apache-2.0
/// Compares two sets of gains entry by entry, also across conventions.
#pragma once

#include <string>
#include <vector>

#include "quadtune/design.hpp"
#include "quadtune/gains.hpp"

namespace quadtune {

/// One entry that differs.
struct DiffEntry {
  std::string matrix;     ///< "K" or "K_int"; for a cascade "Kp", "Ki", "Kd" or the name of the
                          ///< number
  std::string input;      ///< row, in the names of the first gains; for a cascade the loop
  std::string state;      ///< column, in the names of the first gains; for a cascade empty
  double a = 0;           ///< in the first gain
  double b = 0;           ///< in the second, converted to the convention and sign law of the first
  double difference = 0;  ///< b - a
  double relative = 0;    ///< |b - a| over the scale of the entry
};

/// The differences between two sets of gains.
struct GainsDiff {
  double max_relative = 0;         ///< the maximum of DiffEntry::relative; 0 if all entries agree
  std::vector<DiffEntry> entries;  ///< entries that differ, sorted by decreasing relative
                                   ///< difference
};

/// Compares K and K_int by the meaning of states and inputs.
///
/// The scale of an entry is the smaller of the largest entry of its row and the largest entry of
/// its column (each over both gains), and at least 1e-13 of the largest entry of the matrix. Thus
/// 1e-16 against 0 counts as rounding, and a small entry is still compared with entries of its own
/// size.
///
/// @throws InvalidInput  if the gains have different kinds of inputs, units, states or integrals;
///                       the message names those that only one of them has
[[nodiscard]] GainsDiff diff(const Gains& a, const Gains& b);

/// Compares two cascades: gains, period, limits and anti-windup rule (as its index). The scale of a
/// number is the larger of the two magnitudes. If only one of the two is finite, the relative
/// difference is 1.
[[nodiscard]] GainsDiff diff(const CascadeDesign& a, const CascadeDesign& b);

/// For example "K(w1, x)", "Kp(roll)" or "dt_s".
[[nodiscard]] std::string name_of(const DiffEntry& entry);

}  // namespace quadtune
