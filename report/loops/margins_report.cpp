// SPDX-License-Identifier: Apache-2.0
#include "report/loops/margins_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "quadtune/internal/json.hpp"
#include "report/text/print.hpp"
#include "report/text/rows.hpp"

namespace quadtune::report {
namespace {

using internal::Json;

Json crossovers_json(const LoopMargins& margins) {
  Json gain = Json::array();
  for (const GainCrossover& at : margins.gain_crossovers)
    gain.push_back({{"w", at.w},
                    {"phase_margin_deg", degrees(at.phase_margin)},
                    {"delay_margin_s", at.delay_margin}});
  Json phase = Json::array();
  for (const PhaseCrossover& at : margins.phase_crossovers)
    phase.push_back({{"w", at.w}, {"gain_margin_db", decibels(at.gain_margin)}});
  return {{"gain_crossovers", gain},
          {"phase_crossovers", phase},
          {"far_phase_crossovers", margins.far_phase_crossovers}};
}

Json disk_json(const DiskMargin& disk) {
  return {{"disk_alpha", disk.alpha},
          {"disk_frequency", disk.w},
          {"disk_gain_margin_db", decibels(disk.gain_high)},
          {"disk_gain_reduction_db", disk.gain_low > 0 ? Json(decibels(disk.gain_low)) : Json()},
          {"disk_phase_margin_deg", degrees(disk.phase)}};
}

Json loop_json(const std::string& name, const LoopMargins& margins) {
  Json json = {{"name", name},
               {"stable", margins.stable},
               {"gain_margin_db", decibels(margins.gain_margin)},
               {"gain_reduction_db", decibels(margins.gain_reduction)},
               {"phase_margin_deg", degrees(margins.phase_margin)},
               {"crossover", margins.crossover},
               {"delay_margin_s", margins.delay_margin},
               {"Ms", margins.Ms},
               {"Ms_frequency", margins.w_Ms},
               {"Mt", margins.Mt},
               {"Mt_frequency", margins.w_Mt}};
  json.update(disk_json(margins.disk));
  json.update(crossovers_json(margins));
  return json;
}

Json margins_json(const MarginsReport& report) {
  Json loops = Json::array();
  for (std::size_t i = 0; i < report.loops.size(); ++i)
    loops.push_back(loop_json(report.names[i], report.loops[i]));
  return loops;
}

}  // namespace

Json to_json(const MarginsReport& report) {
  Json json = {{"loops", margins_json(report)}};
  json["multivariable"] = nullptr;
  if (report.together) {
    json["multivariable"] = disk_json(report.together->guaranteed);
    json["multivariable"]["disk_alpha_destabilizing"] = report.together->alpha_destabilizing;
  }
  return json;
}

std::string to_text(const MarginsReport& report) {
  if (report.loops.empty()) return "not computed";
  std::vector<Column> columns = {{"name", "loop"},
                                 {"gain_margin_db", "gain up", "[dB]", ".1f"},
                                 {"gain_reduction_db", "gain dn", "[dB]", ".1f"},
                                 {"phase_margin_deg", "phase", "[deg]", ".1f"},
                                 {"crossover", "crossover", "[rad/s]", ".4g", 1, "-"},
                                 {"delay_margin_s", "delay", "[ms]", ".1f", 1e3}};
  if (report.dt > 0) columns.push_back({"delay_margin_s", "", "[sample]", ".1f", 1 / report.dt});
  columns.insert(columns.end(), {{"Ms", "Ms", "", ".2f"},
                                 {"Mt", "Mt", "", ".2f"},
                                 {"disk_alpha", "disk", "alpha", ".3f"},
                                 {"disk_frequency", "at", "[rad/s]", ".3g", 1, "-"},
                                 {.key = "stable", .no = "UNSTABLE"}});
  std::string text = table(margins_json(report), columns);
  if (report.loops.size() < 2 || !report.together) return text;
  const DiskMargin& all = report.together->guaranteed;
  if (all.alpha == 0) return text + "\nall at once  UNSTABLE";
  return text + fmt::format(
                    "\nall at once  disk alpha {:.3f} at {:.3g} rad/s: {} dB and {:.1f} deg in "
                    "every loop together; some change of alpha {:.3f} makes it unstable",
                    all.alpha, all.w, figure(decibels(all.gain_high), ".1f"), degrees(all.phase),
                    report.together->alpha_destabilizing);
}

}  // namespace quadtune::report
