// SPDX-License-Identifier: Apache-2.0
/// Where a text covers no curve.
#pragma once

#include <vector>

namespace quadtune::report {

/// A point or a size in a panel: (0, 0) is its lower left corner, (1, 1) its upper right one.
struct Spot {
  double x, y;
};

/// A rectangle by its lower left corner and size.
struct Box {
  double x, y, width, height;
};

/// One panel's room: what is drawn in it, and the texts placed so far.
class Placement {
 public:
  /// A curve that texts should not cover; its points are joined by lines.
  void avoid(const std::vector<Spot>& curve);

  /// A box beside the point, the nearest that covers least; no later one will overlap it.
  [[nodiscard]] Box beside(Spot anchor, double width, double height);

  /// A box in the corner where it covers least.
  [[nodiscard]] Box in_corner(double width, double height);

 private:
  [[nodiscard]] double cost(const Box& box) const;

  std::vector<Spot> taken_;
  std::vector<Box> boxes_;
};

}  // namespace quadtune::report
