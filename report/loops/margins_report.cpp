// SPDX-License-Identifier: Apache-2.0
#include "report/loops/margins_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "quadtune/internal/json.hpp"
#include "report/text/print.hpp"

namespace quadtune::report {
namespace {

using internal::finite_or_null;
using internal::Json;

/// "12.3", or "-" for what is infinite: nothing is there to be met.
/// At most six characters where `decimals` is 2, eight where it is 1.
std::string cell(double value, int decimals = 1) {
  if (!std::isfinite(value)) return "-";
  const double size = std::abs(value);
  if (size >= 1e6) return fmt::format("{:.0e}", value);
  return fmt::format("{:.{}f}", value, decimals > 1 && size >= 1000 ? 0 : decimals);
}

Json crossovers_json(const LoopMargins& margins) {
  Json gain = Json::array();
  for (const GainCrossover& at : margins.gain_crossovers)
    gain.push_back({{"w", at.w},
                    {"phase_margin_deg", degrees(at.phase_margin)},
                    {"delay_margin_s", finite_or_null(at.delay_margin)}});
  Json phase = Json::array();
  for (const PhaseCrossover& at : margins.phase_crossovers)
    phase.push_back({{"w", finite_or_null(at.w)}, {"gain_margin_db", decibels(at.gain_margin)}});
  return {{"gain_crossovers", gain},
          {"phase_crossovers", phase},
          {"far_phase_crossovers", margins.far_phase_crossovers}};
}

Json disk_json(const DiskMargin& disk) {
  return {{"disk_alpha", disk.alpha},
          {"disk_frequency", finite_or_null(disk.w)},
          {"disk_gain_margin_db", finite_or_null(decibels(disk.gain_high))},
          {"disk_phase_margin_deg", degrees(disk.phase)}};
}

Json loop_json(const std::string& name, const LoopMargins& margins) {
  Json json = {{"name", name},
               {"stable", margins.stable},
               {"gain_margin_db", finite_or_null(decibels(margins.gain_margin))},
               {"gain_reduction_db", finite_or_null(decibels(margins.gain_reduction))},
               {"phase_margin_deg", finite_or_null(degrees(margins.phase_margin))},
               {"crossover", margins.crossover},
               {"delay_margin_s", finite_or_null(margins.delay_margin)},
               {"Ms", finite_or_null(margins.Ms)},
               {"Mt", finite_or_null(margins.Mt)}};
  json.update(disk_json(margins.disk));
  json.update(crossovers_json(margins));
  return json;
}

}  // namespace

Json to_json(const MarginsReport& report) {
  Json json;
  json["loops"] = Json::array();
  for (std::size_t i = 0; i < report.loops.size(); ++i)
    json["loops"].push_back(loop_json(report.names[i], report.loops[i]));
  json["multivariable"] = nullptr;
  if (report.together) {
    json["multivariable"] = disk_json(report.together->guaranteed);
    json["multivariable"]["disk_alpha_destabilizing"] = report.together->alpha_destabilizing;
  }
  return json;
}

std::string to_text(const MarginsReport& report) {
  if (report.loops.empty()) return "not computed";
  const bool sampled = report.dt > 0;
  std::string text = fmt::format(
      "{:<12} {:>8} {:>8} {:>8} {:>9} {:>9} {:>8} {:>6} {:>6} {:>6} {:>7}\n", "", "gain up",
      "gain dn", "phase", "crossover", "delay", "", "Ms", "Mt", "disk", "at");
  text += fmt::format("{:<12} {:>8} {:>8} {:>8} {:>9} {:>9} {:>8} {:>6} {:>6} {:>6} {:>7}\n",
                      "loop", "[dB]", "[dB]", "[deg]", "[rad/s]", "[ms]", sampled ? "[sample]" : "",
                      "", "", "alpha", "[rad/s]");
  for (std::size_t i = 0; i < report.loops.size(); ++i) {
    const LoopMargins& m = report.loops[i];
    text += fmt::format(
        "{:<12} {:>8} {:>8} {:>8} {:>9} {:>9} {:>8} {:>6} {:>6} {:>6} {:>7}{}\n", report.names[i],
        cell(decibels(m.gain_margin)), cell(decibels(m.gain_reduction)),
        cell(degrees(m.phase_margin)), m.crossover > 0 ? fmt::format("{:.4g}", m.crossover) : "-",
        cell(1e3 * m.delay_margin), sampled ? cell(m.delay_margin / report.dt) : "", cell(m.Ms, 2),
        cell(m.Mt, 2), cell(m.disk.alpha, 3), m.stable ? fmt::format("{:.3g}", m.disk.w) : "-",
        m.stable ? "" : "  UNSTABLE");
  }
  if (report.loops.size() < 2 || !report.together) {
    text.pop_back();
    return text;
  }
  const DiskMargin& all = report.together->guaranteed;
  if (all.alpha == 0) return text + "all at once  UNSTABLE";
  return text + fmt::format(
                    "all at once  disk alpha {:.3f} at {:.3g} rad/s: {} dB and {:.1f} deg in "
                    "every loop together; alpha {:.3f} can destabilize",
                    all.alpha, all.w, cell(decibels(all.gain_high)), degrees(all.phase),
                    report.together->alpha_destabilizing);
}

}  // namespace quadtune::report
