// SPDX-License-Identifier: Apache-2.0
#include "report/plots/allan_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace quadtune::report {
namespace {

struct Noise {
  const char* name;
  double (*variance)(double tau);  ///< for a coefficient of 1
};

constexpr std::size_t kNoises = kAllanNoises;
const Noise kLines[kNoises] = {
    {"quantization", [](double tau) { return 3 / (tau * tau); }},
    {"noise density", [](double tau) { return 1 / tau; }},
    {"flicker", [](double) { return 2 * std::numbers::ln2 / std::numbers::pi; }},
    {"random walk", [](double tau) { return tau / 3; }}};

}  // namespace

Figure allan_figure(const SensorAllan& allan) {
  const auto& [record, analysis] = allan;
  Series intervals{.name = "95 %", .style = "lines lw 2 lc rgb '#8C8C8C'"};
  Series points{.name = "deviation", .style = "points pt 7 ps 0.6 lc rgb '#000000'"};
  Series fit{.name = "fit", .style = line_style(0)};
  double lowest = std::numeric_limits<double>::infinity();
  double highest = 0;
  for (const AllanCurvePoint& at : analysis.curve) {
    points.x.push_back(at.point.tau);
    points.y.push_back(at.point.deviation);
    fit.x.push_back(at.point.tau);
    fit.y.push_back(at.model);
    for (const double y : {at.low, at.high, std::nan("")}) {  // a bar, and a gap
      intervals.x.push_back(at.point.tau);
      intervals.y.push_back(y);
    }
    lowest = std::min({lowest, at.point.deviation, at.model});
    highest = std::max({highest, at.point.deviation, at.model});
  }
  Panel panel{.title = "",
              .x = {.label = "tau [s]", .logarithmic = true},
              .y = {.label = record.unit.empty() ? "deviation" : "deviation [" + record.unit + "]",
                    .logarithmic = true,
                    .range = fmt::format("[{:.6g}:{:.6g}]", lowest / 2, 2 * highest)},
              .series = {intervals, fit}};
  for (std::size_t k = 0; k < kNoises; ++k) {
    if (!(analysis.variances[k] > 0)) continue;
    Series line{.name = kLines[k].name, .x = fit.x, .style = line_style(k + 1)};
    for (const double tau : line.x)
      line.y.push_back(std::sqrt(analysis.variances[k] * kLines[k].variance(tau)));
    panel.series.push_back(std::move(line));
  }
  panel.series.push_back(points);
  return {.title = fmt::format("Allan deviation of {}", record.column),
          .subtitle = fmt::format("{}, {} samples over {:.4g} s", record.log, record.rate.size(),
                                  static_cast<double>(record.rate.size()) * record.dt),
          .columns = 1,
          .panels = {panel}};
}

}  // namespace quadtune::report
