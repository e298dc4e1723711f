// SPDX-License-Identifier: Apache-2.0
#include "robustness_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace quadtune::internal {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kDrawn = 100;       // points beside the corners
constexpr int kMostCorners = 12;  // parameters of which all corners are looked at
constexpr std::size_t kClimbs = 4;
constexpr double kFinestStep = 1e-3;  // of half the box's width
constexpr int kStepsAlong = 24;       // of a ray, from nominal outwards
constexpr double kRayTolerance = 1e-4;

const double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

RobustnessSearch::RobustnessSearch(const LoopFamily& family, std::uint64_t seed,
                                   const std::function<bool()>& interrupted)
    : family_(family), interrupted_(interrupted), random_(seed) {
  const ParameterBox box = scaled_box(family, 1);
  const LoopBox loop_box = family.over(box.low, box.high);
  parts_ = loop_parts(family.loop, {loop_box.low, loop_box.high, 0, 0, 0});
}

VectorXd RobustnessSearch::parameters(const Direction& direction, double scale) const {
  VectorXd p(direction.size());
  for (Index i = 0; i < p.size(); ++i) {
    const UncertainParameter& parameter = family_.parameters[static_cast<std::size_t>(i)];
    const double t = direction(i);
    const double reach =
        t > 0 ? parameter.high - parameter.nominal : parameter.nominal - parameter.low;
    p(i) = parameter.nominal + scale * t * reach;
  }
  return p;
}

double RobustnessSearch::radius(const Direction& direction, double scale) const {
  const LoopPoint point = family_.at(parameters(direction, scale));
  double largest = 0;
  for (const LoopPart& part : parts_)
    largest = std::max(largest, spectral_radius(part.loop, point.numbers(part.terms), point.delay));
  return largest;
}

// The corners that differ, then points drawn evenly.
std::vector<RobustnessSearch::Direction> RobustnessSearch::starts() {
  std::vector<Index> free;
  VectorXd least = VectorXd::Zero(std::ssize(family_.parameters));
  VectorXd most = least;
  for (Index i = 0; i < least.size(); ++i) {
    const UncertainParameter& parameter = family_.parameters[static_cast<std::size_t>(i)];
    least(i) = parameter.low < parameter.nominal ? -1 : 0;
    most(i) = parameter.high > parameter.nominal ? 1 : 0;
    if (least(i) < most(i)) free.push_back(i);
  }
  std::vector<Direction> all = {VectorXd::Zero(least.size())};
  const std::size_t corners = std::size_t{1}
                              << std::min(free.size(), static_cast<std::size_t>(kMostCorners));
  for (std::size_t corner = 0; corner < corners; ++corner) {
    Direction direction = least;
    for (std::size_t b = 0; b < free.size(); ++b)
      if ((corner >> b & 1) != 0) direction(free[b]) = most(free[b]);
    all.push_back(std::move(direction));
  }
  for (int i = 0; i < kDrawn; ++i) {
    Direction direction = least;
    for (const Index j : free) {
      // 53 bits of the generator: the same on every machine.
      const double share = static_cast<double>(random_() >> 11) * 0x1p-53;
      direction(j) += share * (most(j) - least(j));
    }
    all.push_back(std::move(direction));
  }
  return all;
}

template <class Better>
RobustnessSearch::Direction RobustnessSearch::climbed(Direction best, const Better& value) const {
  double at_best = value(best);
  for (double step = 0.5; step >= kFinestStep && !stopped();) {
    bool moved = false;
    for (Index i = 0; i < best.size(); ++i)
      for (const double way : {-step, step}) {
        const UncertainParameter& parameter = family_.parameters[static_cast<std::size_t>(i)];
        Direction next = best;
        next(i) = std::clamp(best(i) + way, parameter.low < parameter.nominal ? -1.0 : 0.0,
                             parameter.high > parameter.nominal ? 1.0 : 0.0);
        if (next(i) == best(i)) continue;
        const double at_next = value(next);
        if (!(at_next > at_best)) continue;
        best = std::move(next);
        at_best = at_next;
        moved = true;
      }
    if (!moved) step /= 4;
  }
  return best;
}

WorstCase RobustnessSearch::worst() {
  std::vector<std::pair<double, Direction>> seen;
  for (Direction& direction : starts()) {
    if (stopped()) break;
    seen.emplace_back(radius(direction, 1), std::move(direction));
  }
  std::stable_sort(seen.begin(), seen.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  WorstCase worst;
  const auto value = [this](const Direction& direction) { return radius(direction, 1); };
  for (std::size_t i = 0; i < std::min(kClimbs, seen.size()); ++i) {
    const Direction top = climbed(seen[i].second, value);
    const double at_top = value(top);
    if (at_top > worst.radius) worst = {at_top, parameters(top, 1)};
  }
  return worst;
}

// Stability may be lost and won again along a ray: it is looked at in steps, then halved.
double RobustnessSearch::first_unstable(const Direction& direction, double up_to) const {
  const auto unstable = [&](double scale) {
    return WorstCase{radius(direction, scale), {}}.unstable();
  };
  double low = 0;
  double high = kInfinity;
  for (int step = 1; step <= kStepsAlong; ++step) {
    // Closer steps near the nominal loop.
    const double share = static_cast<double>(step) / kStepsAlong;
    const double scale = up_to * share * std::sqrt(share);
    if (unstable(scale)) {
      high = scale;
      break;
    }
    low = scale;
  }
  while (high < kInfinity && high - low > kRayTolerance * high) {
    const double middle = 0.5 * (low + high);
    (unstable(middle) ? high : low) = middle;
  }
  return high;
}

RobustnessSearch::Nearest RobustnessSearch::nearest() {
  std::vector<std::pair<double, Direction>> seen;
  double least = family_.greatest_scale;
  for (Direction& direction : starts()) {
    if (stopped()) break;
    const double scale = first_unstable(direction, least);
    if (!(scale < kInfinity)) continue;
    least = std::min(least, scale);
    seen.emplace_back(scale, std::move(direction));
  }
  if (seen.empty()) return {kInfinity, {}};
  // The last found are the least.
  std::stable_sort(seen.begin(), seen.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  Direction best = seen.front().second;
  for (std::size_t i = 0; i < std::min(kClimbs, seen.size()); ++i) {
    const Direction top = climbed(seen[i].second, [&](const Direction& direction) {
      return -first_unstable(direction, 1.0001 * least);
    });
    const double scale = first_unstable(top, 1.0001 * least);
    if (scale > least) continue;
    least = scale;
    best = top;
  }
  return {least, {radius(best, least), parameters(best, least)}};
}

}  // namespace quadtune::internal
