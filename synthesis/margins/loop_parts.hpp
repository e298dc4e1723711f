// SPDX-License-Identifier: Apache-2.0
/// Splits an uncertain loop into loops that are decoupled up to rounding.
#pragma once

#include <vector>

#include "certify/enclosed_loop.hpp"

namespace quadtune::internal {

/// One decoupled part of an uncertain loop.
struct LoopPart {
  UncertainLoop loop;                ///< with only the terms that affect it
  std::vector<Eigen::Index> terms;   ///< indices among those of the whole loop
  std::vector<Eigen::Index> states;  ///< states of the plant, likewise
  std::vector<Eigen::Index> memory;  ///< states of the law, likewise
  std::vector<Eigen::Index> inputs;  ///< inputs of the plant, likewise

  /// Projects a box of the whole loop on the parameters of the part.
  [[nodiscard]] EnclosedBox share(const EnclosedBox& box) const;
  /// Indices of the part's closed-loop states among those of the whole loop.
  [[nodiscard]] std::vector<Eigen::Index> places(const UncertainLoop& whole, int past) const;
};

/// Splits a loop into its parts. Entries below 1e-10 of the largest in their row or column, with
/// balanced states, are not regarded as couplings; a proof about the parts must bound their effect.
[[nodiscard]] std::vector<LoopPart> loop_parts(const UncertainLoop& loop, const EnclosedBox& box);

/// The index of the part to which each state, memory and input of the loop belongs.
[[nodiscard]] PartNumbers part_numbers(const UncertainLoop& loop,
                                       const std::vector<LoopPart>& parts);

/// The whole loop as a single part.
[[nodiscard]] LoopPart whole_loop(const UncertainLoop& loop);

}  // namespace quadtune::internal
