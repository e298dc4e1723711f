// SPDX-License-Identifier: Apache-2.0
#include "report/plots/allan_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

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
  Series band, points, fit;
  points.name = "deviation";
  points.shape = Shape::dots;
  points.look = {Look::kInk, 0, 3};
  fit.name = "fit";
  fit.look = nth_look(0);
  band.name = "95 %";
  band.look = {Look::kFaint, 0, 2};
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (const AllanCurvePoint& at : analysis.curve) {
    points.x.push_back(at.point.tau);
    points.y.push_back(at.point.deviation);
    fit.x.push_back(at.point.tau);
    fit.y.push_back(at.model);
    for (const double y : {at.low, at.high, std::nan("")}) {  // a bar, and a break
      band.x.push_back(at.point.tau);
      band.y.push_back(y);
    }
    least = std::min(least, std::min(at.point.deviation, at.model));
    most = std::max(most, std::max(at.point.deviation, at.model));
  }
  Panel panel{.title = "",
              .x = {.label = "tau [s]", .logarithmic = true},
              .y = {.label = record.unit.empty() ? "deviation" : "deviation [" + record.unit + "]",
                    .logarithmic = true,
                    .low = least / 2,
                    .high = 2 * most},
              .series = {band, fit}};
  for (std::size_t k = 0; k < kNoises; ++k) {
    if (!(analysis.variances[k] > 0)) continue;
    Series line;
    line.name = kLines[k].name;
    line.look = nth_look(k + 1);
    line.look.dash = 1;
    line.look.width = 2;
    for (const AllanCurvePoint& at : analysis.curve) {
      const double y = std::sqrt(analysis.variances[k] * kLines[k].variance(at.point.tau));
      if (y < least / 2 || y > 2 * most) continue;
      line.x.push_back(at.point.tau);
      line.y.push_back(y);
    }
    if (line.x.size() > 1) panel.series.push_back(line);
  }
  panel.series.push_back(points);
  return {.title = fmt::format("Allan deviation of {}", record.column),
          .subtitle = fmt::format("{}, {} samples over {:.4g} s", record.log, record.rate.size(),
                                  static_cast<double>(record.rate.size()) * record.dt),
          .columns = 1,
          .shared_legend = false,
          .panels = {panel}};
}

}  // namespace quadtune::report
