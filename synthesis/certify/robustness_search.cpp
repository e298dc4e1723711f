// SPDX-License-Identifier: Apache-2.0
#include "certify/robustness_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "quadtune/internal/border.hpp"
#include "quadtune/internal/in_parallel.hpp"

namespace quadtune::internal {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kDrawn = 100;      // random points in addition to the corners
constexpr int kMaxCorners = 12;  // with more parameters, not all corners are evaluated
constexpr std::size_t kClimbs = 4;
// Number of rays that are searched together. A constant, so that the result does not depend on the
// number of threads.
constexpr std::size_t kSearchedTogether = 16;
constexpr double kFinestStep = 1e-3;  // relative to half the width of the box
constexpr int kStepsAlong = 24;       // steps along a ray, from nominal outwards
constexpr double kRayTolerance = 1e-4;

const double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

RobustnessSearch::RobustnessSearch(const LoopFamily& family, std::uint64_t seed,
                                   std::size_t threads, const std::function<bool()>& interrupted)
    : family_(family), threads_(thread_count(threads)), interrupted_(interrupted), random_(seed) {
  const ParameterBox box = scaled_box(family, 1);
  const LoopBox loop_box = family.over(box.low, box.high);
  parts_ = loop_parts(family.loop, {loop_box.low, loop_box.high, 0, 0, 0});
  known_.resize(parts_.size());
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
  for (std::size_t i = 0; i < parts_.size(); ++i) largest = std::max(largest, radius_of(i, point));
  return largest;
}

double RobustnessSearch::radius_of(std::size_t part, const LoopPoint& point) const {
  const VectorXd numbers = point.numbers(parts_[part].terms);
  std::vector<double> key(numbers.begin(), numbers.end());
  key.push_back(point.delay);
  {
    const std::lock_guard lock(mutex_);
    const auto known = known_[part].find(key);
    if (known != known_[part].end()) return known->second;
  }
  const double radius = spectral_radius(parts_[part].loop, numbers, point.delay);
  const std::lock_guard lock(mutex_);
  known_[part].emplace(std::move(key), radius);
  return radius;
}

// The distinct corners, then uniformly distributed random points.
std::vector<RobustnessSearch::Direction> RobustnessSearch::starts() {
  std::vector<Index> free;
  VectorXd min = VectorXd::Zero(std::ssize(family_.parameters));
  VectorXd max = min;
  for (Index i = 0; i < min.size(); ++i) {
    const UncertainParameter& parameter = family_.parameters[static_cast<std::size_t>(i)];
    min(i) = parameter.low < parameter.nominal ? -1 : 0;
    max(i) = parameter.high > parameter.nominal ? 1 : 0;
    if (min(i) < max(i)) free.push_back(i);
  }
  std::vector<Direction> all = {VectorXd::Zero(min.size())};
  const std::size_t corners = std::size_t{1}
                              << std::min(free.size(), static_cast<std::size_t>(kMaxCorners));
  for (std::size_t corner = 0; corner < corners; ++corner) {
    Direction direction = min;
    for (std::size_t b = 0; b < free.size(); ++b)
      if ((corner >> b & 1) != 0) direction(free[b]) = max(free[b]);
    all.push_back(std::move(direction));
  }
  for (int i = 0; i < kDrawn; ++i) {
    Direction direction = min;
    for (const Index j : free) {
      // Uses 53 bits of the generator, so that the points are the same on every machine.
      const double share = static_cast<double>(random_() >> 11) * 0x1p-53;
      direction(j) += share * (max(j) - min(j));
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

template <class F>
auto RobustnessSearch::each(std::size_t count, const F& f) const {
  std::vector<decltype(f(std::size_t{0}))> results(count);
  std::vector<char> called(count, 0);  // not bool, whose elements share bytes
  const auto one = [&](std::size_t i) {
    if (stopped()) return;
    results[i] = f(i);
    called[i] = 1;
  };
  in_parallel(count, threads_, [&] { return one; }, {});
  results.resize(
      static_cast<std::size_t>(std::find(called.begin(), called.end(), 0) - called.begin()));
  return results;
}

WorstCase RobustnessSearch::worst() {
  const std::vector<Direction> all = starts();
  const std::vector<double> radii =
      each(all.size(), [&](std::size_t i) { return radius(all[i], 1); });
  std::vector<std::size_t> order(radii.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return radii[a] > radii[b]; });
  const auto value = [this](const Direction& direction) { return radius(direction, 1); };
  const std::vector<WorstCase> tops =
      each(std::min(kClimbs, order.size()), [&](std::size_t i) -> WorstCase {
        const Direction top = climbed(all[order[i]], value);
        return {value(top), parameters(top, 1)};
      });
  WorstCase worst;
  for (const WorstCase& top : tops)
    if (top.radius > worst.radius) worst = top;
  return worst;
}

// Stability may be lost and regained along a ray: scans it in steps, then bisects.
double RobustnessSearch::first_unstable(const Direction& direction, double up_to) const {
  const auto unstable = [&](double scale) {
    return WorstCase{radius(direction, scale), {}}.unstable();
  };
  double low = 0;
  for (int step = 1; step <= kStepsAlong; ++step) {
    // The steps are closer near the nominal loop.
    const double share = static_cast<double>(step) / kStepsAlong;
    const double scale = up_to * share * std::sqrt(share);
    if (unstable(scale)) return internal::border(unstable, scale, low, kRayTolerance).holds;
    low = scale;
  }
  return kInfinity;
}

RobustnessSearch::Nearest RobustnessSearch::nearest() {
  struct Ray {
    double scale = kInfinity;
    Direction direction;
  };
  const std::vector<Direction> all = starts();
  std::vector<Ray> seen;
  double min = family_.max_scale;
  for (std::size_t first = 0; first < all.size() && !stopped(); first += kSearchedTogether) {
    const double up_to = min;
    const std::size_t count = std::min(kSearchedTogether, all.size() - first);
    for (Ray& ray : each(count, [&](std::size_t i) -> Ray {
           return {first_unstable(all[first + i], up_to), all[first + i]};
         })) {
      if (!(ray.scale < kInfinity)) continue;
      min = std::min(min, ray.scale);
      seen.push_back(std::move(ray));
    }
  }
  if (seen.empty()) return {kInfinity, {}};
  std::stable_sort(seen.begin(), seen.end(),
                   [](const Ray& a, const Ray& b) { return a.scale < b.scale; });
  const double up_to = 1.0001 * min;
  Ray best = seen.front();
  for (const Ray& top : each(std::min(kClimbs, seen.size()), [&](std::size_t i) -> Ray {
         const Direction found = climbed(seen[i].direction, [&](const Direction& direction) {
           return -first_unstable(direction, up_to);
         });
         return {first_unstable(found, up_to), found};
       }))
    if (top.scale <= best.scale) best = top;
  return {best.scale, {radius(best.direction, best.scale), parameters(best.direction, best.scale)}};
}

}  // namespace quadtune::internal
