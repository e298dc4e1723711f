// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/record_of_log.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "quadtune/errors.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune {
namespace {

using Eigen::Index;

/// Instants nearer than this are one [s].
constexpr double kSameInstant = 1e-7;
/// An input that is away for so many of its typical periods is not held any longer.
constexpr double kLongestHold = 10;

/// One sample: of an output (index ≥ 0) or of an input (index < 0: -1 - i).
struct Sample {
  std::int64_t instant;
  Index signal;
  double value;
};

class Builder {
 public:
  Builder(const FilterModel& model, const std::vector<ChannelUse>& uses, const std::string& name)
      : model_(model), uses_(uses), name_(name), unit_(model.dt > 0 ? model.dt : kSameInstant) {
    for (const Signal& input : model.inputs) known_.push_back(input.name);
    for (const FilterSensor& sensor : model.sensors)
      for (const Signal& output : sensor.outputs) known_.push_back(output.name);
  }

  std::vector<FilterRecord> build() {
    assign();
    gather();
    std::vector<FilterRecord> records = split();
    if (records.empty())
      throw InvalidInput(name_,
                         "no measurement falls into the time of all inputs, expected some "
                         "that do");
    return records;
  }

 private:
  void assign() {
    of_signal_.assign(known_.size(), nullptr);
    for (const ChannelUse& use : uses_) {
      const auto found = std::find(known_.begin(), known_.end(), use.signal);
      if (found == known_.end())
        throw InvalidInput(
            name_, fmt::format("the model '{}' has no '{}', expected one of {}{}", model_.name,
                               internal::printable(use.signal), fmt::join(known_, ", "),
                               internal::did_you_mean(use.signal, known_)));
      const auto k = static_cast<std::size_t>(found - known_.begin());
      if (of_signal_[k] != nullptr)
        throw InvalidInput(name_, fmt::format("'{}' came twice, expected it once", use.signal));
      of_signal_[k] = &use.series;
      const std::string unit = signal(k).unit;
      if (!unit.empty() && !use.series.unit.empty()) require_unit(use.series, unit, name_);
      require_usable(use.series, name_);
    }
    bool measured = false;
    for (std::size_t k = 0; k < known_.size(); ++k) {
      if (k < model_.inputs.size() && of_signal_[k] == nullptr)
        throw InvalidInput(name_,
                           fmt::format("the model '{}' needs its input '{}', expected a channel "
                                       "for it",
                                       model_.name, known_[k]));
      measured = measured || (k >= model_.inputs.size() && of_signal_[k] != nullptr);
    }
    if (!measured)
      throw InvalidInput(
          name_,
          fmt::format("no measurement of the model '{}' came, expected one of "
                      "{}",
                      model_.name,
                      fmt::join(known_.begin() + static_cast<std::ptrdiff_t>(model_.inputs.size()),
                                known_.end(), ", ")));
  }

  [[nodiscard]] const Signal& signal(std::size_t k) const {
    if (k < model_.inputs.size()) return model_.inputs[k];
    return sensor_of(k - model_.inputs.size()).second;
  }

  [[nodiscard]] std::pair<const FilterSensor&, const Signal&> sensor_of(std::size_t output) const {
    for (const FilterSensor& sensor : model_.sensors) {
      if (output < sensor.outputs.size()) return {sensor, sensor.outputs[output]};
      output -= sensor.outputs.size();
    }
    throw InvalidInput(name_, "an output that the model does not have");
  }

  void gather() {
    double start = std::numeric_limits<double>::infinity();
    for (const LogSeries* series : of_signal_)
      if (series != nullptr) start = std::min(start, series->time.front());
    start_ = start;
    for (std::size_t k = 0; k < known_.size(); ++k) {
      if (of_signal_[k] == nullptr) continue;
      const bool is_input = k < model_.inputs.size();
      const Index index =
          is_input ? -1 - static_cast<Index>(k) : static_cast<Index>(k - model_.inputs.size());
      const double delay = is_input ? 0 : sensor_of(k - model_.inputs.size()).first.delay;
      for (std::size_t i = 0; i < of_signal_[k]->time.size(); ++i)
        samples_.push_back({std::llround((of_signal_[k]->time[i] - delay - start) / unit_), index,
                            of_signal_[k]->values[i]});
      if (is_input) longest_hold_.push_back(kLongestHold * typical_period(*of_signal_[k]));
    }
    std::stable_sort(samples_.begin(), samples_.end(),
                     [](const Sample& a, const Sample& b) { return a.instant < b.instant; });
  }

  [[nodiscard]] double typical_period(const LogSeries& series) const {
    std::vector<double> steps;
    for (std::size_t i = 1; i < series.time.size(); ++i)
      steps.push_back(series.time[i] - series.time[i - 1]);
    if (steps.empty()) return std::numeric_limits<double>::infinity();
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    return *middle / unit_;
  }

  /// Instant by instant, from where all inputs are known to where one stays away too long.
  std::vector<FilterRecord> split() {
    std::vector<FilterRecord> records;
    const std::size_t nu = model_.inputs.size();
    const Index ny = model_.outputs();
    std::vector<double> held(nu, 0);
    std::vector<std::int64_t> since(nu, std::numeric_limits<std::int64_t>::min());
    std::vector<double> times, y, u;
    const auto finish = [&] {
      const auto N = static_cast<Index>(times.size());
      const bool measured =
          std::any_of(y.begin(), y.end(), [](double value) { return !std::isnan(value); });
      if (N >= 2 && measured)
        records.push_back({name_, times, Eigen::Map<Eigen::MatrixXd>(y.data(), ny, N),
                           Eigen::Map<Eigen::MatrixXd>(u.data(), static_cast<Index>(nu), N)});
      times.clear();
      y.clear();
      u.clear();
    };
    for (std::size_t i = 0; i < samples_.size();) {
      const std::int64_t now = samples_[i].instant;
      std::vector<double> row(static_cast<std::size_t>(ny), std::nan(""));
      for (; i < samples_.size() && samples_[i].instant == now; ++i) {
        const Sample& sample = samples_[i];
        if (sample.signal < 0) {
          const auto k = static_cast<std::size_t>(-1 - sample.signal);
          if (since[k] != std::numeric_limits<std::int64_t>::min() &&
              static_cast<double>(now - since[k]) > longest_hold_[k])
            finish();
          held[k] = sample.value;
          since[k] = now;
        } else {
          double& slot = row[static_cast<std::size_t>(sample.signal)];
          if (!std::isnan(slot) && model_.dt > 0)
            throw InvalidInput(
                name_, fmt::format("two samples of '{}' at {:.6g} s fall into one period of {} s, "
                                   "expected one because the model is discrete",
                                   known_[nu + static_cast<std::size_t>(sample.signal)],
                                   start_ + static_cast<double>(now) * unit_, model_.dt));
          slot = sample.value;
        }
      }
      bool known = true;
      for (std::size_t k = 0; k < nu; ++k)
        known = known && since[k] != std::numeric_limits<std::int64_t>::min() &&
                static_cast<double>(now - since[k]) <= longest_hold_[k];
      if (!known) {
        finish();
        continue;
      }
      times.push_back(start_ + static_cast<double>(now) * unit_);
      y.insert(y.end(), row.begin(), row.end());
      u.insert(u.end(), held.begin(), held.end());
    }
    finish();
    return records;
  }

  const FilterModel& model_;
  const std::vector<ChannelUse>& uses_;
  const std::string& name_;
  double unit_;
  double start_ = 0;
  std::vector<std::string> known_;  ///< inputs, then outputs
  std::vector<const LogSeries*> of_signal_;
  std::vector<Sample> samples_;
  std::vector<double> longest_hold_;  ///< of each input, in units of instants
};

}  // namespace

std::vector<FilterRecord> records_of_log(const FilterModel& model,
                                         const std::vector<ChannelUse>& uses,
                                         const std::string& name) {
  return Builder(model, uses, name).build();
}

}  // namespace quadtune
