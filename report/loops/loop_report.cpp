// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/design/named_loop.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"
#include "report/loops/loops.hpp"
#include "report/loops/margins_report.hpp"
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
            {"decay_per_s", loop.decay()},
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
    text += fmt::format("; the sample times of the sensors repeat every {} periods", loop.period);
  return text + fmt::format("\n{}, largest |z| {:.6f}: {}",
                            loop.stable()  ? "stable"
                            : loop.grows() ? "UNSTABLE"
                                           : "neutral",
                            std::abs(loop.mode.z), describe(loop));
}

internal::Json to_json(const LoopReport& report) {
  const OpenLoop& loop = report.loop.loop;
  internal::Json json = to_json(report.margins());
  json["time"] = loop.discrete() ? "discrete" : "continuous";
  json["dt"] = loop.discrete() ? internal::Json(loop.dt()) : internal::Json();
  if (!report.loop.controller.empty()) json["plant"] = report.flown ? "flown" : "ideal";
  if (report.flown) {
    json["flown"] = to_json(*report.flown);
    json["ideal"] = to_json(report.ideal);
  }
  return json;
}

std::string to_text(const LoopReport& report) {
  const OpenLoop& loop = report.loop.loop;
  std::string text =
      section("loop", loop.discrete() ? fmt::format("discrete, every {} s", number(loop.dt()))
                                      : "continuous");
  if (!report.flown) return text + section("margins", to_text(report.ideal));
  return text + section("flown loop", to_text(*report.flown)) +
         section("margins of the flown loop", to_text(report.flown->margins)) +
         section("margins of the ideal plant", to_text(report.ideal));
}

}  // namespace quadtune::report
