// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/design/gains_difference.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "quadtune/errors.hpp"
#include "quadtune/workbench/design/given_gains.hpp"

namespace quadtune {

LawsDifference diff_laws(const std::string& first, const std::string& second) {
  const StoredLaws a = read_given_laws(first).laws;
  const StoredLaws b = read_given_laws(second).laws;
  const bool gains = a.gains && b.gains;
  const bool cascade = a.cascade && b.cascade;
  if (!gains && !cascade)
    throw InvalidInput(second,
                       fmt::format("has a {}, but {} has a {}; expected laws of the same kind",
                                   b.gains ? "state feedback" : "PID cascade", first,
                                   a.gains ? "state feedback" : "PID cascade"));
  LawsDifference difference;
  if (a.gains.has_value() != b.gains.has_value() || a.cascade.has_value() != b.cascade.has_value())
    difference.left_out = gains ? "PID cascade" : "state feedback";
  GainsDiff& all = difference.entries;
  if (gains) all = diff(*a.gains, *b.gains);
  if (!cascade) return difference;
  const GainsDiff more = diff(*a.cascade, *b.cascade);
  all.max_relative = std::max(all.max_relative, more.max_relative);
  all.entries.insert(all.entries.end(), more.entries.begin(), more.entries.end());
  return difference;
}

}  // namespace quadtune
