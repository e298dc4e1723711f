// SPDX-License-Identifier: Apache-2.0
#include "report/flights/campaign_figures.hpp"

#include <algorithm>
#include <iterator>
#include <limits>

namespace quadtune::report {

bool is_shown(Metric metric) {
  static constexpr Metric kShown[] = {
      Metric::settling_time, Metric::overshoot,    Metric::tracking_rms,   Metric::tracking_max,
      Metric::height_max,    Metric::yaw_max,      Metric::tilt_max,       Metric::saturation_time,
      Metric::energy,        Metric::estimate_rms, Metric::touchdown_speed};
  return std::find(std::begin(kShown), std::end(kShown), metric) != std::end(kShown);
}

std::string unit_shown(Metric metric) { return unit_of(metric) == "1" ? "" : unit_of(metric); }

double limit_of(const Mission& mission, Metric metric) {
  for (const Limit& limit : mission.limits)
    if (limit.metric == metric) return limit.most;
  return std::numeric_limits<double>::quiet_NaN();
}

bool surely_not_zero(const Estimated& e) { return e.low > 0 || e.high < 0; }

}  // namespace quadtune::report
