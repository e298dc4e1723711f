// SPDX-License-Identifier: Apache-2.0
#include "report/plots/label_placement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace quadtune::report {
namespace {

constexpr double kSpacing = 0.01;  ///< of the points that stand for a curve
constexpr double kMargin = 0.015;  ///< kept free around a text and at the panel's edge

bool inside(const Box& box, Spot spot) {
  return spot.x > box.x && spot.x < box.x + box.width && spot.y > box.y &&
         spot.y < box.y + box.height;
}

bool overlap(const Box& a, const Box& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

Box widened(const Box& box) {
  return {box.x - kMargin, box.y - kMargin, box.width + 2 * kMargin, box.height + 2 * kMargin};
}

bool in_panel(const Box& box) {
  return box.x >= 0 && box.y >= 0 && box.x + box.width <= 1 && box.y + box.height <= 1;
}

}  // namespace

void Placement::avoid(const std::vector<Spot>& curve) {
  const Box panel{0, 0, 1, 1};
  for (std::size_t i = 0; i < curve.size(); ++i) {
    if (inside(panel, curve[i])) taken_.push_back(curve[i]);
    if (i + 1 == curve.size()) break;
    const Spot step{curve[i + 1].x - curve[i].x, curve[i + 1].y - curve[i].y};
    constexpr double kMost = 200;  // of a line that leaves the panel far behind
    const double parts = std::min(std::ceil(std::hypot(step.x, step.y) / kSpacing), kMost);
    for (int k = 1; k < static_cast<int>(parts); ++k) {
      const Spot between{curve[i].x + step.x * k / parts, curve[i].y + step.y * k / parts};
      if (inside(panel, between)) taken_.push_back(between);
    }
  }
}

double Placement::cost(const Box& box) const {
  const Box room = widened(box);
  if (!in_panel(room)) return std::numeric_limits<double>::infinity();
  double sum = 0;
  for (const Box& other : boxes_)
    if (overlap(room, other)) sum += 1000;
  for (const Spot& spot : taken_)
    if (inside(room, spot)) sum += 1;
  return sum;
}

Box Placement::beside(Spot anchor, double width, double height) {
  Box best{std::clamp(anchor.x, 0.0, std::max(0.0, 1 - width)),
           std::clamp(anchor.y, 0.0, std::max(0.0, 1 - height)), width, height};
  double least = std::numeric_limits<double>::infinity();
  constexpr std::array<double, 5> kAway = {0.03, 0.07, 0.12, 0.18, 0.26};
  constexpr std::array<Spot, 8> kSides = {
      {{1, 0}, {-1, 0}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}, {0, 1}, {0, -1}}};
  for (const double away : kAway) {
    for (const Spot& side : kSides) {
      const Box box{anchor.x + side.x * away + (side.x - 1) / 2 * width,
                    anchor.y + side.y * away + (side.y - 1) / 2 * height, width, height};
      const double total = cost(box) + 20 * away;
      if (total >= least) continue;
      least = total;
      best = box;
    }
  }
  boxes_.push_back(best);
  return best;
}

Box Placement::in_corner(double width, double height) {
  Box best{};
  double least = std::numeric_limits<double>::infinity();
  const double right = std::max(1 - width - 2 * kMargin, kMargin);
  const double top = std::max(1 - height - 2 * kMargin, kMargin);
  const double left = 2 * kMargin;
  const double low = 2 * kMargin;
  for (const Spot& corner : std::array<Spot, 6>{{{right, top},
                                                 {right, low},
                                                 {left, top},
                                                 {left, low},
                                                 {left + (right - left) / 2, top},
                                                 {left + (right - left) / 2, low}}}) {
    const Box box{corner.x, corner.y, width, height};
    double total = cost(box);
    if (!std::isfinite(total)) total = 1e6;  // wider than the panel: anywhere is as bad
    if (total >= least) continue;
    least = total;
    best = box;
  }
  boxes_.push_back(best);
  return best;
}

}  // namespace quadtune::report
