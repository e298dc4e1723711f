// SPDX-License-Identifier: Apache-2.0
#include "pid/gain_gaps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace quadtune::internal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double dot(std::complex<double> a, std::complex<double> b) {
  return a.real() * b.real() + a.imag() * b.imag();
}

}  // namespace

void forbid(const AffineResponse& larger, const AffineResponse& smaller, double min, double w,
            std::vector<GainInterval>& forbidden) {
  // square g² + 2 half g + constant must not be negative.
  const double square = std::norm(larger.beta) - std::norm(smaller.beta);
  const double half = dot(larger.alpha, larger.beta) - dot(smaller.alpha, smaller.beta);
  const double constant = std::norm(larger.alpha) - std::norm(smaller.alpha) - min * min;
  const auto add = [&](double low, double high) {
    if (high > 0 && high > low) forbidden.push_back({std::max(low, 0.0), high, w});
  };
  const double discriminant = half * half - square * constant;
  if (discriminant < 0) {
    if (square < 0) add(0, kInfinity);
    return;
  }
  const double root = std::sqrt(discriminant);
  const double far = half > 0 ? -half - root : -half + root;  // square times a root, uncancelled
  const double first = square != 0 ? far / square : kInfinity;
  const double second = far != 0 ? constant / far : 0;
  const double low = std::min(first, second);
  const double high = std::max(first, second);
  if (square > 0) {
    add(low, high);
  } else if (square < 0) {
    add(0, low);
    add(high, kInfinity);
  } else if (half < 0) {
    add(second, kInfinity);
  } else {
    add(0, second);
  }
}

std::vector<GainInterval> feasible_intervals(std::vector<GainInterval>& forbidden,
                                             double& reached) {
  std::sort(forbidden.begin(), forbidden.end(),
            [](const GainInterval& p, const GainInterval& q) { return p.low < q.low; });
  std::vector<GainInterval> gaps;
  reached = 0;
  for (const GainInterval& f : forbidden) {
    if (f.low > reached) gaps.push_back({reached, f.low, f.w});
    reached = std::max(reached, f.high);
  }
  return gaps;
}

}  // namespace quadtune::internal
