// SPDX-License-Identifier: Apache-2.0
#include "report/loops/vehicle_cascade.hpp"

#include <fmt/format.h>

#include "quadtune/internal/json.hpp"
#include "report/gains/laws_json.hpp"
#include "report/gains/matrix_report.hpp"
#include "report/loops/cascade_report.hpp"
#include "report/loops/flown_report.hpp"
#include "report/loops/margins_report.hpp"
#include "report/plots/loop_figure.hpp"
#include "report/text/print.hpp"

namespace quadtune::report {

using internal::Json;

Json to_json(const VehicleCascade& cascade) {
  Json json = to_json(cascade.report);
  json["method"] = cascade.flown ? "flown" : "loops";
  json["plant"] = cascade.ideal ? "ideal" : cascade.flown ? "flown" : "lag";
  if (cascade.flown) json["flown"] = family_json(*cascade.flown);
  json["flown_loop"] = Json();
  if (cascade.loop) {
    json["flown_loop"] = to_json(*cascade.loop);
    json["flown_loop"]["margins"] = to_json(cascade.loop->margins);
  }
  add_laws(json, cascade.content);
  return json;
}

std::string to_text(const VehicleCascade& cascade) {
  std::string text = to_text(cascade.report);
  if (cascade.flown) text += section("flown", family_text(*cascade.flown));
  if (cascade.loop)
    text += section("flown loop", to_text(*cascade.loop)) +
            section("margins of the flown loop", to_text(cascade.loop->margins));
  return text;
}

Figure cascade_figure(const VehicleCascade& cascade) {
  const CascadeReport& report = cascade.report;
  return margins_figure(fmt::format("PID cascade of {} every {} s, cut at the wrench",
                                    report.vehicle, number(report.specification.dt)),
                        OpenLoop(report.open_loop), report.margins);
}

}  // namespace quadtune::report
