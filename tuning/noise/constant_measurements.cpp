// SPDX-License-Identifier: Apache-2.0
#include "noise/constant_measurements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace quadtune::internal {
namespace {

using Eigen::Index;

/// Relative rounding error of the sums of a filter.
constexpr double kRounding = 1e-12;

/// Whether only the measurements prevent R(i, i) from becoming zero.
bool is_free(const FilterModel& model, const CovarianceModel& R, Index i) {
  if (R.fixed(i, i) > 0) return false;
  const auto to_be_found = [&](int parameter) {
    const NoiseParameter& p = model.parameters[static_cast<std::size_t>(parameter)];
    return !p.fixed && !p.prior;
  };
  bool depends = false;
  for (const ScaledCovariance& term : R.scaled) {
    if (term.shape(i, i) == 0) continue;
    if (!to_be_found(term.parameter)) return false;
    depends = true;
  }
  for (const FullCovariance& term : R.full) {
    const auto entry = std::find(term.entries.begin(), term.entries.end(), static_cast<int>(i));
    if (entry == term.entries.end()) continue;
    const auto row = static_cast<int>(entry - term.entries.begin());
    if (!to_be_found(term.first_parameter + row * (row + 1) / 2 + row)) return false;
    depends = true;
  }
  return depends;
}

}  // namespace

std::string constant_measurement(const FilterModel& model,
                                 const std::vector<FilterRecord>& records) {
  Index row = 0;
  for (const FilterSensor& sensor : model.sensors)
    for (Index i = 0; i < sensor.C.rows(); ++i, ++row) {
      if (!is_free(model, sensor.R, i)) continue;
      double first = std::nan("");
      Index count = 0;
      bool changes = false;
      for (std::size_t r = 0; r < records.size() && !changes; ++r)
        for (Index k = 0; k < records[r].samples() && !changes; ++k) {
          const double y = records[r].y(row, k);
          if (std::isnan(y)) continue;
          if (count == 0) first = y;
          changes = y != first;
          ++count;
        }
      if (changes || count < 2) continue;
      const Signal& output = sensor.outputs[static_cast<std::size_t>(i)];
      return fmt::format(
          "{}: {} is constant over the fitted part: all {} measurements are {:.6g}{}{}; expected "
          "varying ones, because their noise is estimated from them",
          sensor.name, output.name, count, first, output.unit.empty() ? "" : " ", output.unit);
    }
  return "";
}

namespace {

/// The longest stretch of equal measurements of one output.
struct Stretch {
  Index length = 0;
  double value = 0, from = 0, to = 0;  ///< to: time of the last one [s]
  /// Number of measurements of the output, and of equal consecutive ones
  Index count = 0, repeats = 0;
};

Stretch longest_stretch(const std::vector<FilterRecord>& records, Index row) {
  Stretch longest, now;
  Index count = 0, repeats = 0;
  for (const FilterRecord& record : records) {
    now.length = 0;
    for (Index k = 0; k < record.samples(); ++k) {
      const double y = record.y(row, k), t = record.time[static_cast<std::size_t>(k)];
      if (std::isnan(y)) continue;
      ++count;
      if (now.length > 0 && y == now.value) {
        ++repeats;
        ++now.length;
        now.to = t;
      } else {
        now = {1, y, t, t};
      }
      if (now.length > longest.length) longest = now;
    }
  }
  longest.count = count;
  longest.repeats = repeats;
  return longest;
}

bool is_no_chance(const Stretch& stretch) {
  if (stretch.length < 50 || 20 * stretch.length < stretch.count || stretch.length == stretch.count)
    return false;
  const auto elsewhere = static_cast<double>(stretch.count - stretch.length);
  const double share =
      (static_cast<double>(stretch.repeats - (stretch.length - 1)) + 1) / (elsewhere + 2);
  return static_cast<double>(stretch.length) * -std::log(share) >
         std::log(1000 * static_cast<double>(stretch.count));
}

}  // namespace

std::vector<std::string> hanging_measurements(const FilterModel& model,
                                              const std::vector<FilterRecord>& records) {
  std::vector<std::string> result;
  Index row = 0;
  for (const FilterSensor& sensor : model.sensors)
    for (const Signal& output : sensor.outputs) {
      const Stretch stretch = longest_stretch(records, row++);
      if (!is_no_chance(stretch)) continue;
      result.push_back(fmt::format(
          "{}: {} is {:.6g}{}{} in {} of {} measurements, consecutively from {:.6g} s to "
          "{:.6g} s: the sensor is stuck, or stationary with a resolution coarser than its noise",
          sensor.name, output.name, stretch.value, output.unit.empty() ? "" : " ", output.unit,
          stretch.length, stretch.count, stretch.from, stretch.to));
    }
  return result;
}

std::string exact_measurement(const FilterModel& model, const std::vector<FilterRecord>& records,
                              const std::vector<FilterRun>& runs) {
  Index row = 0;
  for (const FilterSensor& sensor : model.sensors)
    for (Index i = 0; i < sensor.C.rows(); ++i, ++row) {
      if (!is_free(model, sensor.R, i)) continue;
      double max = 0, size = 0;
      Index count = 0;
      for (std::size_t r = 0; r < runs.size(); ++r)
        for (Index k = 0; k < runs[r].innovation.cols(); ++k) {
          const double e = runs[r].innovation(row, k);
          if (std::isnan(e)) continue;
          ++count;
          max = std::max(max, std::abs(e));
          size = std::max(size, std::abs(records[r].y(row, k)));
        }
      if (count < 2 || max > kRounding * size) continue;
      return fmt::format(
          "{}: the model predicts all {} measurements of {} to {:.2g}, which is rounding; expected "
          "ones with noise, because it is estimated from them",
          sensor.name, count, sensor.outputs[static_cast<std::size_t>(i)].name, max);
    }
  return "";
}

}  // namespace quadtune::internal
