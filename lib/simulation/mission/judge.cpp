// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "quadtune/simulation/mission.hpp"

namespace quadtune {
namespace {

// Time by which a flight may end before its mission [s], since the duration need not be a multiple
// of the control period.
constexpr double kEarly = 0.1;

}  // namespace

Verdict judge(const Mission& mission, const MetricValues& values) {
  Verdict verdict;
  verdict.checks.reserve(mission.limits.size() + 1);
  const double flown = values[Metric::duration];
  const double min = std::max(mission.duration - kEarly, 0.0);
  verdict.checks.push_back({Metric::duration, flown, min, true, flown >= min});
  for (const Limit& limit : mission.limits) {
    const double value = values[limit.metric];
    verdict.checks.push_back({limit.metric, value, limit.max, false, value <= limit.max});
  }
  verdict.ok = std::all_of(verdict.checks.begin(), verdict.checks.end(),
                           [](const LimitCheck& check) { return check.ok; });
  return verdict;
}

}  // namespace quadtune
