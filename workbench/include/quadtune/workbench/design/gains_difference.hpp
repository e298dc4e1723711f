// SPDX-License-Identifier: Apache-2.0
/// Compares the laws of two files entry by entry.
#pragma once

#include <string>

#include "quadtune/exports/diff.hpp"

namespace quadtune {

/// The differences, and the laws that were not compared.
struct LawsDifference {
  GainsDiff entries;  ///< of the laws that both files have
  /// "state feedback" or "PID cascade" if only one of the files has it, otherwise empty.
  std::string left_out;
};

/// Compares the laws that both files have: state feedback with state feedback, cascade with
/// cascade.
/// @param first, second  paths that read_given_laws() accepts
/// @throws InvalidInput  if the files have no kind of law in common, or as diff()
/// @throws FileError, NoSolution
[[nodiscard]] LawsDifference diff_laws(const std::string& first, const std::string& second);

}  // namespace quadtune
