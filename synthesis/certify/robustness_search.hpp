// SPDX-License-Identifier: Apache-2.0
/// Looks for the worst loop of a family, and for the nearest that is unstable.
#pragma once

#include <map>
#include <mutex>
#include <random>
#include <vector>

#include "margins/loop_parts.hpp"
#include "quadtune/synthesis/robustness.hpp"

namespace quadtune::internal {

/// Corners, drawn points, and from the best of them step by step to a place where no step along a
/// parameter is better. What it finds is true as far as computed poles are; what it does not find
/// may be there.
class RobustnessSearch {
 public:
  /// @param threads      at most so many at once; what is found does not depend on it
  /// @param interrupted  asked by any thread
  RobustnessSearch(const LoopFamily& family, std::uint64_t seed, std::size_t threads,
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
  [[nodiscard]] double radius_of(std::size_t part, const LoopPoint& point) const;
  [[nodiscard]] double first_unstable(const Direction& direction, double up_to) const;
  [[nodiscard]] std::vector<Direction> starts();
  /// f(0) … f(count - 1), of those that were called before the search was stopped.
  template <class F>
  [[nodiscard]] auto each(std::size_t count, const F& f) const;
  template <class Better>
  Direction climbed(Direction best, const Better& value) const;
  [[nodiscard]] bool stopped() const { return interrupted_ && interrupted_(); }

  const LoopFamily& family_;
  std::size_t threads_;
  std::function<bool()> interrupted_;
  std::mt19937_64 random_;
  std::vector<LoopPart> parts_;
  /// Radii by the numbers and the delay of each part: most steps along a parameter leave most parts
  /// as they are.
  mutable std::vector<std::map<std::vector<double>, double>> known_;
  mutable std::mutex mutex_;
};

}  // namespace quadtune::internal
