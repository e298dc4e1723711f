// SPDX-License-Identifier: Apache-2.0
#include "report/loops/flown_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "quadtune/internal/json.hpp"
#include "report/text/print.hpp"

namespace quadtune::report {

using internal::Json;

Json to_json(const FlownLoop& loop) {
  Json drifts = Json::array();
  for (const Signal& state : loop.drifts) drifts.push_back(state.name);
  return {{"stable", loop.stable()},
          {"largest_pole", std::abs(loop.mode.z)},
          {"mode",
           {{"states", loop.mode.states},
            {"decay_per_s", internal::finite_or_null(loop.decay())},
            {"frequency_rad_s", loop.frequency()}}},
          {"dt_s", loop.dt},
          {"periods", loop.period},
          {"height_m", loop.at.height},
          {"command_delay_s", loop.at.command_delay},
          {"estimator", loop.estimator},
          {"sensors", loop.sensors},
          {"drifts", drifts},
          {"notes", flown_notes(loop)}};
}

std::string to_text(const FlownLoop& loop) {
  std::string text =
      fmt::format("hover at {} m, estimator {}", number(loop.at.height), loop.estimator);
  if (loop.estimator != "truth") text += fmt::format(", {} sensors", loop.sensors);
  if (loop.at.command_delay > 0)
    text += fmt::format(", commands delayed by {} s", number(loop.at.command_delay));
  if (loop.period > 1)
    text += fmt::format("; the sample clocks repeat every {} periods", loop.period);
  return text + fmt::format("\n{}, largest |z| {:.6f}: {}",
                            loop.stable()  ? "stable"
                            : loop.grows() ? "UNSTABLE"
                                           : "neutral",
                            std::abs(loop.mode.z), in_words(loop));
}

}  // namespace quadtune::report
