// SPDX-License-Identifier: Apache-2.0
#include "noise/autocovariance/uniform_stretches.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/joined.hpp"

namespace quadtune::internal {
namespace {

using Eigen::Index;

/// Largest deviation of a step of a continuous model from the period, as a share: the innovations
/// are computed with the length of each step, and only their theory assumes equal steps.
constexpr double kJitter = 0.05;

enum class Measured { nothing, part, all };

Measured measured(const FilterRecord& record, Index k, const std::vector<Index>& outputs) {
  std::size_t count = 0;
  for (const Index i : outputs) count += !std::isnan(record.y(i, k));
  return count == 0 ? Measured::nothing : count < outputs.size() ? Measured::part : Measured::all;
}

std::vector<Index> measured_outputs(const FilterModel& model,
                                    const std::vector<FilterRecord>& records) {
  std::vector<Index> outputs;
  for (Index i = 0; i < model.outputs(); ++i)
    if (std::any_of(records.begin(), records.end(), [&](const FilterRecord& record) {
          return !record.y.row(i).array().isNaN().all();
        }))
      outputs.push_back(i);
  return outputs;
}

/// Calls f(k, step) for each instant with all outputs; step is the time since the previous one, 0
/// if anything else was measured in between.
template <class Function>
void each_sample(const FilterRecord& record, const std::vector<Index>& outputs, Function&& f) {
  Index before = -1;
  for (Index k = 0; k < record.samples(); ++k) {
    const Measured what = measured(record, k, outputs);
    if (what == Measured::nothing) continue;
    if (what == Measured::part) {
      before = -1;
      continue;
    }
    const auto at = [&](Index i) { return record.time[static_cast<std::size_t>(i)]; };
    f(k, before < 0 ? 0.0 : at(k) - at(before));
    before = k;
  }
}

/// The mean of the steps close to their median.
double period_of(const FilterModel& model, Samples& steps) {
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  const double median = *middle;
  if (model.dt > 0) return static_cast<double>(std::llround(median / model.dt)) * model.dt;
  double sum = 0, count = 0;
  for (const double step : steps)
    if (std::abs(step - median) <= kJitter * median) {
      sum += step;
      ++count;
    }
  return sum / count;
}

std::string why_parted(const FilterModel& model, const std::vector<FilterRecord>& records,
                       const std::vector<Index>& outputs) {
  std::vector<std::string> words;
  Index i = 0;
  for (const FilterSensor& sensor : model.sensors)
    for (const Signal& output : sensor.outputs) {
      if (std::find(outputs.begin(), outputs.end(), i) != outputs.end()) {
        Index count = 0;
        for (const FilterRecord& record : records)
          count += (!record.y.row(i).array().isNaN()).count();
        words.push_back(fmt::format("{}: {} {} times", sensor.name, output.name, count));
      }
      ++i;
    }
  return fmt::format("{}", internal::joined(words, ", "));
}

}  // namespace

bool is_measured(const FilterRecord& record, Index instant, const std::vector<Index>& outputs) {
  return measured(record, instant, outputs) != Measured::nothing;
}

UniformStretches find_uniform_stretches(const FilterModel& model,
                                        const std::vector<FilterRecord>& records) {
  UniformStretches found;
  found.outputs = measured_outputs(model, records);
  Samples steps;
  Index together = 0;
  for (const FilterRecord& record : records)
    each_sample(record, found.outputs, [&](Index, double step) {
      ++together;
      if (step > 0) steps.push_back(step);
    });
  if (found.outputs.empty()) {
    found.culprit = "nothing is measured";
    return found;
  }
  found.culprit = found.outputs.size() == 1
                      ? fmt::format("the log has {}", internal::counted(together, "sample"))
                      : fmt::format("all outputs are measured at the same instant {} times ({})",
                                    together, why_parted(model, records, found.outputs));
  if (steps.empty()) return found;
  found.dt = period_of(model, steps);
  const double jitter = model.dt > 0 ? 0.5 * model.dt : kJitter * found.dt;
  Index alike = 0;
  for (std::size_t r = 0; r < records.size(); ++r) {
    bool open = false;
    each_sample(records[r], found.outputs, [&](Index k, double step) {
      if (open && step > 0 && std::abs(step - found.dt) <= jitter) {
        found.stretches.back().last = k;
        ++found.stretches.back().samples;
        ++alike;
      } else {
        found.stretches.push_back({r, k, k, 1});
        open = true;
      }
    });
  }
  if (2 * alike < static_cast<Index>(steps.size()))
    found.culprit = fmt::format("of {} steps from one measurement to the next, {} have {:.4g} s",
                                steps.size(), alike, found.dt);
  std::vector<Index> lengths;
  lengths.reserve(found.stretches.size());
  Index total = 0;
  for (const UniformStretch& stretch : found.stretches) {
    lengths.push_back(stretch.samples);
    total += stretch.samples;
  }
  std::sort(lengths.rbegin(), lengths.rend());
  Index sum = 0;
  for (const Index length : lengths) {
    sum += length;
    found.typical = length;
    if (2 * sum >= total) break;
  }
  return found;
}

}  // namespace quadtune::internal
