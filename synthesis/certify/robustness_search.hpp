// SPDX-License-Identifier: Apache-2.0
/// Searches for the worst loop of a family, and for the nearest unstable one.
#pragma once

#include <map>
#include <mutex>
#include <random>
#include <vector>

#include "margins/loop_parts.hpp"
#include "quadtune/synthesis/robustness.hpp"

namespace quadtune::internal {

/// Evaluates the corners and random points, and improves the best of them by coordinate search to a
/// local optimum. Results are correct to the accuracy of the computed poles; a failed search does
/// not prove anything.
class RobustnessSearch {
 public:
  /// @param threads      maximum number of threads; the results do not depend on it
  /// @param interrupted  polled from any thread
  RobustnessSearch(const LoopFamily& family, std::uint64_t seed, std::size_t threads,
                   const std::function<bool()>& interrupted);

  /// Searches for the maximum spectral radius in the box of the family.
  [[nodiscard]] WorstCase worst();

  /// The smallest scale of the box at which an unstable loop was found, and that loop.
  struct Nearest {
    double scale;  ///< infinite if none was found
    WorstCase found;
  };
  [[nodiscard]] Nearest nearest();

 private:
  /// -1 … 1 for each parameter: -1 is low, 0 is nominal, 1 is high.
  using Direction = Eigen::VectorXd;

  [[nodiscard]] Eigen::VectorXd parameters(const Direction& direction, double scale) const;
  [[nodiscard]] double radius(const Direction& direction, double scale) const;
  [[nodiscard]] double radius_of(std::size_t part, const LoopPoint& point) const;
  [[nodiscard]] double first_unstable(const Direction& direction, double up_to) const;
  [[nodiscard]] std::vector<Direction> starts();
  /// Computes f(0) … f(count - 1); omits those that were not called before an interruption.
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
  /// Cache of spectral radii by the parameters and the delay of each part: most steps along a
  /// parameter leave most parts unchanged.
  mutable std::vector<std::map<std::vector<double>, double>> known_;
  mutable std::mutex mutex_;
};

}  // namespace quadtune::internal
