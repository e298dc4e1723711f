// SPDX-License-Identifier: Apache-2.0
/// An uncertain loop taken apart into loops that do not know of one another but by rounding.
#pragma once

#include <vector>

#include "certify/enclosed_loop.hpp"

namespace quadtune::internal {

/// One of them.
struct LoopPart {
  UncertainLoop loop;                ///< with the terms that move it alone
  std::vector<Eigen::Index> terms;   ///< which of the whole loop's
  std::vector<Eigen::Index> states;  ///< of the plant, likewise
  std::vector<Eigen::Index> memory;  ///< states of the law
  std::vector<Eigen::Index> inputs;  ///< of the plant

  /// The part's share of a box of the whole loop.
  [[nodiscard]] EnclosedBox share(const EnclosedBox& box) const;
  /// Where the part's closed-loop states stand among those of the whole loop.
  [[nodiscard]] std::vector<Eigen::Index> places(const UncertainLoop& whole, int past) const;
};

/// Entries below 1e-10 of the largest in their row or column, states in balanced units, do not join
/// two parts; what they do must be bounded by whoever proves something of the parts.
[[nodiscard]] std::vector<LoopPart> loop_parts(const UncertainLoop& loop, const EnclosedBox& box);

/// Which part each state, memory and input of the loop is in.
[[nodiscard]] PartNumbers part_numbers(const UncertainLoop& loop,
                                       const std::vector<LoopPart>& parts);

/// The loop as its only part.
[[nodiscard]] LoopPart whole_loop(const UncertainLoop& loop);

}  // namespace quadtune::internal
