// SPDX-License-Identifier: Apache-2.0
/// Looks for the worst loop of a family, and for the nearest that is unstable.
#pragma once

#include <random>
#include <vector>

#include "loop_parts.hpp"
#include "quadtune/synthesis/robustness.hpp"

namespace quadtune::internal {

/// Corners, drawn points, and from the best of them step by step to a place where no step along a
/// parameter is better. What it finds is true as far as computed poles are; what it does not find
/// may be there.
class RobustnessSearch {
 public:
  RobustnessSearch(const LoopFamily& family, std::uint64_t seed,
                   const std::function<bool()>& interrupted);

  /// The largest spectral radius in the family's box.
  [[nodiscard]] WorstCase worst();

  /// The smallest scale of the box at which a loop was found unstable, and that loop.
  struct Nearest {
    double scale;  ///< infinite where there is none
    WorstCase found;
  };
  [[nodiscard]] Nearest nearest();

 private:
  /// -1 … 1 for each parameter: from low over nominal to high.
  using Direction = Eigen::VectorXd;

  [[nodiscard]] Eigen::VectorXd parameters(const Direction& direction, double scale) const;
  [[nodiscard]] double radius(const Direction& direction, double scale) const;
  [[nodiscard]] double first_unstable(const Direction& direction, double up_to) const;
  [[nodiscard]] std::vector<Direction> starts();
  template <class Better>
  Direction climbed(Direction best, const Better& value) const;
  [[nodiscard]] bool stopped() const { return interrupted_ && interrupted_(); }

  const LoopFamily& family_;
  std::function<bool()> interrupted_;
  std::mt19937_64 random_;
  std::vector<LoopPart> parts_;
};

}  // namespace quadtune::internal
