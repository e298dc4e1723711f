// SPDX-License-Identifier: Apache-2.0
/// The laws of two files, compared entry by entry.
#pragma once

#include <string>

#include "quadtune/exports/diff.hpp"

namespace quadtune {

/// What differs, and what was left out.
struct LawsDifference {
  GainsDiff entries;
  std::string
      left_out;  ///< "state feedback" or "PID cascade", which one of the two lacks; or empty
};

/// Compares what both files hold: state feedback with state feedback, cascade with cascade.
/// @param first, second  as read_given_laws() takes them
/// @throws InvalidInput  if they have no law of one kind, or as diff()
/// @throws FileError, NoSolution
[[nodiscard]] LawsDifference diff_laws(const std::string& first, const std::string& second);

}  // namespace quadtune
