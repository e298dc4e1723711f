// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/systems/pid_report.hpp"

#include <fmt/format.h>

#include "quadtune/internal/json.hpp"
#include "report/loops/loops.hpp"
#include "report/loops/margins_report.hpp"
#include "report/plots/figure.hpp"
#include "report/plots/loop_figure.hpp"
#include "report/text/print.hpp"

namespace quadtune::report {

using internal::Json;

Json to_json(const PidReport& report) {
  const PidGains& g = report.gains;
  const Json margins = to_json(report.margins);
  const Json& loop = margins["loops"][0];
  return {{"Kp", g.Kp},
          {"Ki", g.Ki},
          {"Kd", g.Kd},
          {"Tf", g.Tf},
          {"stable", report.margins.loops[0].stable},
          {"crossover", loop["crossover"]},
          {"phase_margin_deg", loop["phase_margin_deg"]},
          {"gain_margin_db", loop["gain_margin_db"]},
          {"Ms", loop["Ms"]},
          {"Mt", loop["Mt"]},
          {"how", report.how},
          {"margins", margins}};
}

std::string to_text(const PidReport& report) {
  const PidGains& g = report.gains;
  std::string gains = fmt::format("Kp {}", number(g.Kp));
  if (g.Ki != 0) gains += fmt::format("  Ki {} 1/s", number(g.Ki));
  if (g.Kd != 0) gains += fmt::format("  Kd {} s  Tf {} s", number(g.Kd), number(g.Tf));
  return section("gains", gains) + section("by", report.how) +
         section("margins", to_text(report.margins));
}

Figure pid_figure(const PidReport& report, const std::string& num, const std::string& den) {
  const PidGains& g = report.gains;
  std::string title = fmt::format("{}: Kp {}", to_string(report.type), number(g.Kp));
  if (g.Ki != 0) title += fmt::format(", Ki {} 1/s", number(g.Ki));
  if (g.Kd != 0) title += fmt::format(", Kd {} s, Tf {} s", number(g.Kd), number(g.Tf));
  title += fmt::format(" with num {}, den {}", num, den);
  if (report.plant.delay > 0) title += fmt::format(", delay {} s", number(report.plant.delay));
  return pid_figure(title, report.plant, g, report.margins);
}

}  // namespace quadtune::report
