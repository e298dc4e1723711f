// SPDX-License-Identifier: Apache-2.0
/// The parameters of a firmware on a vehicle, for `import`.
#include <fmt/format.h>

#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/firmware/firmware_import.hpp"
#include "report/gains/gains.hpp"
#include "report/loops/loops.hpp"
#include "report/loops/margins_report.hpp"
#include "report/text/print.hpp"
#include "report/text/rows.hpp"

namespace quadtune::report {

using internal::Json;

namespace {

Json turn_margins_json(const LoopMargins& margins) {
  return {{"stable", margins.stable},
          {"crossover", margins.crossover},
          {"phase_margin_deg", degrees(margins.phase_margin)},
          {"gain_margin_db", decibels(margins.gain_margin)},
          {"delay_margin_s", margins.delay_margin},
          {"Ms", margins.Ms}};
}

Json imported_loops_json(const FirmwareImport& import) {
  Json loops = Json::array();
  for (const FirmwareLoop& loop : import.loops) {
    if (!loop.flies) continue;
    loops.push_back({{"name", to_string(loop.axis)},
                     {"Kp", loop.Kp()},
                     {"Ki", loop.Ki()},
                     {"Kd", loop.Kd()},
                     {"derivative", loop.derivative()},
                     {"double_integral", loop.double_integral()},
                     {"per_unit", loop.scale}});
  }
  return loops;
}

Json turns_json(const FirmwareImport& import) {
  Json turns = Json::array();
  for (const FirmwareTurn& turn : import.turns)
    turns.push_back({{"name", to_string(turn.gains.axis)},
                     {"inertia", turn.inertia},
                     {"delay_s", turn.delay},
                     {"lag_s", turn.lag},
                     {"rate", turn_margins_json(turn.rate)},
                     {"whole", turn_margins_json(turn.whole)}});
  return turns;
}

std::string firmware_words(const Firmware& firmware) {
  return fmt::format("{} {}{}{}", to_string(firmware.kind), firmware.version,
                     firmware.setup.empty() ? "" : ", propellers ", firmware.setup);
}

}  // namespace

Json to_json(const FirmwareImport& import) {
  Json json = {
      {"firmware", to_string(import.firmware.kind)},
      {"version", import.firmware.version},
      {"setup", import.firmware.setup.empty() ? Json(nullptr) : Json(import.firmware.setup)},
      {"vehicle", import.vehicle.name},
      {"loops", imported_loops_json(import)},
      {"turns", turns_json(import)},
      {"notes", import.notes}};
  json["flown_loop"] = Json();
  if (import.flown) {
    json["flown_loop"] = to_json(*import.flown);
    json["flown_loop"]["margins"] = to_json(import.flown->margins);
  }
  add_laws(json, import.content);
  return json;
}

std::string to_text(const FirmwareImport& import) {
  std::string text =
      section("firmware", firmware_words(import.firmware)) +
      section("vehicle", import.vehicle.name) +
      section("loops", "gains in SI, without the signs of a design file\n" +
                           table(imported_loops_json(import),
                                 {{"name", "loop"},
                                  {"Kp", "Kp", "", ".4g"},
                                  {"Ki", "Ki", "", ".4g"},
                                  {"Kd", "|Kd|", "", ".4g"},
                                  {"derivative", "D", "", ".3g"},
                                  {"per_unit", "per unit", "of output", ".4g"}})) +
      section("rotation",
              "with the filters, rate and delay of the firmware, and the motor lag\n" +
                  table(turns_json(import), {{"name", "loop"},
                                             {"rate/crossover", "rate", "[rad/s]", ".3g"},
                                             {"rate/phase_margin_deg", "phase", "[deg]", ".1f"},
                                             {"rate/Ms", "Ms", "", ".2f"},
                                             {"whole/crossover", "whole", "[rad/s]", ".3g"},
                                             {"whole/gain_margin_db", "gain", "[dB]", ".1f"},
                                             {"whole/phase_margin_deg", "phase", "[deg]", ".1f"},
                                             {"whole/Ms", "Ms", "", ".2f"},
                                             {.key = "whole/stable", .no = "UNSTABLE"}}));
  if (import.flown)
    text += section("flown loop", to_text(*import.flown)) +
            section("margins of the flown loop", to_text(import.flown->margins));
  return text;
}

}  // namespace quadtune::report
