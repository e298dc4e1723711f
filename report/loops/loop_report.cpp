// SPDX-License-Identifier: Apache-2.0
#include "report/loops/loop_report.hpp"

#include <fmt/format.h>

#include "quadtune/internal/json.hpp"
#include "report/loops/flown_report.hpp"
#include "report/loops/margins_report.hpp"
#include "report/text/print.hpp"

namespace quadtune::report {

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
