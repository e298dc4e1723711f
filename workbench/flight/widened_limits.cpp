// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/flight/widened_limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "quadtune/workbench/flight/fly.hpp"

namespace quadtune {
namespace {

/// The largest limit that a mission accepts [unit].
constexpr double kLargest = 1e12;

struct Floor {
  double bound;  ///< rms of the optimal filter's error
  double value;  ///< the tightest limit that it satisfies
};

/// The rarely exceeded maximum of an error with kRmsOverBound times the bound's rms.
double most_floor(double most_rarely) { return kRmsOverBound * most_rarely; }

double rms_floor(const ErrorSize& size) {
  return std::max(kRmsOverBound * size.rms, size.rms_rarely);
}

std::optional<Floor> floor_of(Metric metric, const MissionBound& bound) {
  switch (metric) {
    case Metric::tracking_rms:
      return Floor{bound.tracking.rms, rms_floor(bound.tracking)};
    case Metric::tracking_max:
      return Floor{bound.tracking.rms, most_floor(bound.tracking.most_rarely)};
    case Metric::height_rms:
      return Floor{bound.height.rms, rms_floor(bound.height)};
    case Metric::height_max:
    case Metric::height_peak:
      return Floor{bound.height.rms, most_floor(bound.height.most_rarely)};
    case Metric::yaw_rms:
      return Floor{bound.heading.rms, rms_floor(bound.heading)};
    case Metric::yaw_max:
      return Floor{bound.heading.rms, most_floor(bound.heading.most_rarely)};
    case Metric::estimate_rms:
      return Floor{bound.estimate.rms, rms_floor(bound.estimate)};
    case Metric::estimate_max:
      return Floor{bound.estimate.rms, most_floor(bound.estimate.most_rarely)};
    case Metric::final_distance:
      return Floor{std::hypot(bound.horizontal_end, bound.height_end),
                   most_floor(bound.final_rarely)};
    case Metric::position_drift:
      return Floor{bound.horizontal_end, most_floor(bound.drift_rarely)};
    case Metric::overshoot:
      return Floor{bound.overshoot.rms, most_floor(bound.overshoot.most_rarely)};
    case Metric::yaw_overshoot:
      return Floor{bound.yaw_overshoot.rms, most_floor(bound.yaw_overshoot.most_rarely)};
    default:
      return std::nullopt;
  }
}

}  // namespace

std::vector<WidenedLimit> widen_limits(const MissionBound& bound, Mission& mission) {
  std::vector<WidenedLimit> widened;
  for (Limit& limit : mission.limits) {
    const std::optional<Floor> floor = floor_of(limit.metric, bound);
    if (!floor || !(floor->value > limit.max)) continue;
    const double judged = std::min(floor->value, kLargest);
    widened.push_back({name_of(limit.metric), label_of(limit.metric), unit_of(limit.metric),
                       limit.max, floor->bound, judged});
    limit.max = judged;
  }
  const bool settles =
      std::any_of(mission.limits.begin(), mission.limits.end(),
                  [](const Limit& limit) { return limit.metric == Metric::settling_time; });
  if (!settles) return widened;
  SettlingRule& rule = mission.settling;
  const auto widen = [&](const char* what, const char* label, const char* unit, double asked,
                         const ErrorSize& size, double& settled) {
    const double max = most_floor(size.most_rarely);
    if (!(max > asked)) return;
    settled = std::min(max, kLargest);
    widened.push_back({what, label, unit, asked, size.rms, settled});
  };
  widen("settling_band", "settling band", "m", rule.band, bound.tracking, rule.settled_band);
  widen("settling_yaw_band", "settling band of the yaw", "rad", rule.yaw_band, bound.heading,
        rule.settled_yaw_band);
  return widened;
}

std::string describe(const WidenedLimit& widened) {
  const std::string unit = widened.unit == "1" ? "" : " " + widened.unit;
  return fmt::format(
      "limit {:.3g}{} widened to {:.3g}{}, because the sensors alone cause {:.3g}{} rms",
      widened.asked, unit, widened.judged, unit, widened.bound, unit);
}

}  // namespace quadtune
