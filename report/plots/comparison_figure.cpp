// SPDX-License-Identifier: Apache-2.0
#include "report/plots/comparison_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "report/plots/loop_panels.hpp"

namespace quadtune::report {
namespace {

/// The range of the exact response. A response that leaves it by far, such as that of a method that
/// makes the system unstable, is cut off.
struct Range {
  double low = 0, high = 0;
};

Range range_of(const Comparison& comparison) {
  Range range;
  for (const double y : comparison.continuous.y) {
    if (!std::isfinite(y)) continue;
    range.low = std::min(range.low, y);
    range.high = std::max(range.high, y);
  }
  if (range.low == range.high) range.high = 1;
  return range;
}

Panel steps(const Comparison& comparison) {
  std::vector<NamedResponse> responses;
  for (const SampledMethod& method : comparison.methods)
    responses.push_back({method.name, {comparison.times, method.outputs}, comparison.dt});
  responses.push_back({"exact", comparison.continuous});
  Panel panel = step_panel("Step response", "output", responses);
  panel.series.back().style = kFaintStyle;
  const Range exact = range_of(comparison);
  const double room = 0.15 * (exact.high - exact.low);
  panel.y.range = fmt::format("[{:.6g}:{:.6g}]", exact.low - room, exact.high + room);
  return panel;
}

Panel step_errors(const Comparison& comparison) {
  std::vector<NamedResponse> errors;
  for (const SampledMethod& method : comparison.methods) {
    StepResponse error{comparison.times, method.outputs};
    const std::size_t count = std::min(error.y.size(), comparison.exact.size());
    error.t.resize(count);
    error.y.resize(count);
    for (std::size_t k = 0; k < count; ++k) error.y[k] -= comparison.exact[k];
    errors.push_back({method.name, std::move(error), comparison.dt});
  }
  Panel panel = step_panel("Error of the step response", "output - exact", errors);
  const Range exact = range_of(comparison);
  const double far = 0.6 * (exact.high - exact.low);
  panel.y.range = fmt::format("[{:.6g}<*:*<{:.6g}]", -far, far);
  add_level(panel, panel.series.front().x, 0);
  return panel;
}

Panel frequency_errors(const Comparison& comparison) {
  Panel panel{.title = "Frequency response, error at each frequency",
              .x = {.label = "frequency [rad/s]", .logarithmic = true},
              .y = {.label = "|G_d/G - 1|", .logarithmic = true, .range = "[1e-6:2<*<1e3]"},
              .series = {}};
  for (std::size_t i = 0; i < comparison.methods.size(); ++i)
    panel.series.push_back({.name = comparison.methods[i].name,
                            .x = comparison.frequencies,
                            .y = comparison.methods[i].frequency_error,
                            .style = line_style(i)});
  add_level(panel, comparison.frequencies, 1);
  return panel;
}

Panel poles(const Comparison& comparison) {
  std::vector<PointSet> sets;
  sets.push_back({"exact", circle_style(6), comparison.exact_poles});
  for (std::size_t i = 0; i < comparison.methods.size(); ++i)
    sets.push_back({comparison.methods[i].name, cross_style(i), comparison.methods[i].poles});
  return pole_panel("Poles", sets, comparison.dt);
}

}  // namespace

Figure comparison_figure(const Comparison& comparison) {
  return {.title = comparison.title,
          .subtitle = {},
          .columns = 2,
          .panels = {steps(comparison), frequency_errors(comparison), step_errors(comparison),
                     poles(comparison)}};
}

}  // namespace quadtune::report
