// SPDX-License-Identifier: Apache-2.0
#include "report/plots/comparison_figure.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "report/plots/loop_panels.hpp"

namespace quadtune::report {
namespace {

struct Range {
  double low, high;
};

/// Of the exact response; what leaves it by far, such as the response of an unstable picture of the
/// system, is not followed.
Range range_of(const Comparison& comparison) {
  Range range{0, 0};
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
  responses.reserve(comparison.methods.size() + 1);
  for (const SampledMethod& method : comparison.methods)
    responses.push_back({method.name,
                         nth_look(responses.size()),
                         {comparison.times, method.outputs},
                         comparison.dt});
  responses.push_back({"exact", {Look::kFaint, 0, 2}, comparison.continuous});
  Panel panel = step_panel("Step response", "output", responses);
  const Range exact = range_of(comparison);
  const double room = 0.15 * (exact.high - exact.low);
  panel.y.low = exact.low - room;
  panel.y.high = exact.high + room;
  return panel;
}

Panel step_errors(const Comparison& comparison) {
  std::vector<NamedResponse> errors;
  errors.reserve(comparison.methods.size());
  for (const SampledMethod& method : comparison.methods) {
    StepResponse error{comparison.times, method.outputs};
    const std::size_t count = std::min(error.y.size(), comparison.exact.size());
    error.t.resize(count);
    error.y.resize(count);
    for (std::size_t k = 0; k < count; ++k) error.y[k] -= comparison.exact[k];
    errors.push_back({method.name, nth_look(errors.size()), std::move(error), comparison.dt});
  }
  Panel panel = step_panel("Error of the step response", "output - exact", errors);
  const Range exact = range_of(comparison);
  // The axis is that of the methods that stay near; one that does not leaves the panel.
  const double far = 0.6 * (exact.high - exact.low);
  double most = 0;
  for (const Series& series : panel.series) {
    double worst = 0;
    for (const double error : series.y)
      worst = std::isfinite(error) ? std::max(worst, std::abs(error)) : 2 * far;
    if (worst <= far) most = std::max(most, worst);
  }
  most = most > 0 ? 1.1 * most : far;
  if (most > 0) {
    panel.y.low = -most;
    panel.y.high = most;
  }
  return panel;
}

Panel frequency_errors(const Comparison& comparison) {
  constexpr double kLeast = 1e-6;  // what is exact is below the axis
  Panel panel{.title = "Frequency response, error at each frequency",
              .x = {.label = "frequency [rad/s]", .logarithmic = true},
              .y = {.label = "|G_d/G - 1|", .logarithmic = true, .low = kLeast},
              .series = {}};
  double most = 1;
  for (std::size_t i = 0; i < comparison.methods.size(); ++i) {
    const SampledMethod& method = comparison.methods[i];
    for (const double error : method.frequency_error)
      if (error < 1e3) most = std::max(most, error);
    panel.series.push_back({.name = method.name,
                            .x = comparison.frequencies,
                            .y = method.frequency_error,
                            .look = nth_look(i)});
  }
  panel.y.high = 2 * most;
  return panel;
}

Panel poles(const Comparison& comparison) {
  std::vector<PointSet> sets;
  sets.reserve(comparison.methods.size() + 1);
  sets.push_back({"exact", Shape::circles, Look::kInk, comparison.exact_poles});
  for (std::size_t i = 0; i < comparison.methods.size(); ++i)
    sets.push_back({comparison.methods[i].name, Shape::crosses, nth_look(i).color,
                    comparison.methods[i].poles});
  return pole_panel("Poles", sets, comparison.dt);
}

}  // namespace

Figure comparison_figure(const Comparison& comparison) {
  return {.title = comparison.title,
          .subtitle = {},
          .columns = 2,
          .shared_legend = true,
          .panels = {steps(comparison), frequency_errors(comparison), step_errors(comparison),
                     poles(comparison)}};
}

}  // namespace quadtune::report
