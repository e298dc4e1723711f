// SPDX-License-Identifier: Apache-2.0
#include "simulation/mission/climb.hpp"

#include <algorithm>
#include <cmath>

namespace quadtune {
namespace {

/// Maximum speed of a climb: the rate, or the speed at which acceleration changes to deceleration.
double top_speed(double height, double rate) {
  return std::min(rate, std::sqrt(kClimbAcceleration * height));
}

}  // namespace

double climb_duration(double height, double rate) {
  if (!(height > 0)) return 0;
  const double top = top_speed(height, rate);
  return height / top + top / kClimbAcceleration;
}

ClimbPoint climb_at(double height, double rate, double t) {
  if (!(t > 0) || !(height > 0)) return {};
  const double duration = climb_duration(height, rate);
  if (t >= duration) return {height, 0};
  const double top = top_speed(height, rate), ramp = top / kClimbAcceleration;
  if (t < ramp) return {0.5 * kClimbAcceleration * t * t, kClimbAcceleration * t};
  if (t <= duration - ramp) return {top * (t - 0.5 * ramp), top};
  const double left = duration - t;
  return {height - 0.5 * kClimbAcceleration * left * left, kClimbAcceleration * left};
}

}  // namespace quadtune
