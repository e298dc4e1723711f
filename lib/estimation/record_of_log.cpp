// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/record_of_log.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "estimation/record_truth.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune {
namespace {

using Eigen::Index;

/// The remaining samples of one signal, in chronological order.
struct Cursor {
  const LogSeries* series = nullptr;  ///< null: not given
  double delay = 0;
  std::size_t next = 0;
};

class Builder {
 public:
  Builder(const FilterModel& model, const std::vector<ChannelUse>& uses, const std::string& name,
          std::vector<LeftOutRecord>* left_out)
      : model_(model),
        uses_(uses),
        name_(name),
        left_out_(left_out),
        unit_(model.dt > 0 ? model.dt : internal::kSameInstant) {
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
                         "no measurement lies in the interval that all inputs cover, expected at "
                         "least one");
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
                               internal::printable(use.signal), internal::joined(known_, ", "),
                               internal::did_you_mean(use.signal, known_)));
      const auto k = static_cast<std::size_t>(found - known_.begin());
      if (of_signal_[k] != nullptr)
        throw InvalidInput(name_, fmt::format("'{}' is given twice, expected once", use.signal));
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
          fmt::format("no measurement of the model '{}' is given, expected one of "
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
    start_ = std::numeric_limits<double>::infinity();
    for (const LogSeries* series : of_signal_)
      if (series != nullptr) start_ = std::min(start_, series->time.front());
    for (std::size_t k = 0; k < known_.size(); ++k) {
      const bool is_input = k < model_.inputs.size();
      const double delay = is_input ? 0 : sensor_of(k - model_.inputs.size()).first.delay;
      cursors_.push_back({of_signal_[k], delay});
      if (of_signal_[k] != nullptr) require_countable(*of_signal_[k], delay);
      if (is_input)
        longest_hold_.push_back(internal::kMaxHold * internal::typical_period(*of_signal_[k]) /
                                unit_);
    }
  }

  /// Instants are integers and must be in their range.
  void require_countable(const LogSeries& series, double delay) const {
    constexpr double kMax = 4e18;
    for (const double time : {series.time.front(), series.time.back()})
      if (!(std::abs(time - delay - start_) < kMax * unit_))
        throw InvalidInput(
            name_, fmt::format("'{}' has a sample {:.4g} s after the first sample of all "
                               "channels{}, expected less "
                               "than {:.2g} s because instants are resolved to {:.2g} s",
                               internal::printable(series.name), time - start_,
                               delay != 0 ? fmt::format(" and a delay of {:.4g} s", delay) : "",
                               kMax * unit_, unit_));
  }

  [[nodiscard]] static bool is_left(const Cursor& cursor) {
    return cursor.series != nullptr && cursor.next < cursor.series->time.size();
  }
  /// Instant of the cursor's next sample.
  [[nodiscard]] std::int64_t instant(const Cursor& cursor) const {
    return std::llround((cursor.series->time[cursor.next] - cursor.delay - start_) / unit_);
  }
  /// The next instant of all cursors; empty if no samples remain.
  [[nodiscard]] std::optional<std::int64_t> next_instant() const {
    std::optional<std::int64_t> next;
    for (const Cursor& cursor : cursors_)
      if (is_left(cursor)) next = next ? std::min(*next, instant(cursor)) : instant(cursor);
    return next;
  }

  /// Builds the records instant by instant, each from the time at which all inputs are known to a
  /// gap of an input.
  std::vector<FilterRecord> split() {
    std::vector<FilterRecord> records;
    const std::size_t nu = model_.inputs.size();
    const Index ny = model_.outputs();
    std::vector<double> held(nu, 0);
    std::vector<std::int64_t> since(nu, std::numeric_limits<std::int64_t>::min());
    Samples times, y, u;
    std::size_t max = 0;  // expected number of instants
    for (const LogSeries* series : of_signal_)
      if (series != nullptr) max = std::max(max, series->time.size());
    times.reserve(max);
    y.reserve(max * static_cast<std::size_t>(ny));
    u.reserve(max * nu);
    const auto finish = [&] {
      const auto N = static_cast<Index>(times.size());
      const bool measured =
          std::any_of(y.begin(), y.end(), [](double value) { return !std::isnan(value); });
      if (N >= 2 && measured)
        records.push_back({name_, std::move(times), SampleMatrix(std::move(y), ny, N),
                           SampleMatrix(std::move(u), static_cast<Index>(nu), N)});
      else if (measured && left_out_ != nullptr)
        left_out_->push_back({name_, times.front(), times.back(), N});
      times = y = u = {};  // releases the memory, too
    };
    std::vector<double> row(static_cast<std::size_t>(ny));
    for (auto next = next_instant(); next; next = next_instant()) {
      const std::int64_t now = *next;
      std::fill(row.begin(), row.end(), std::nan(""));
      for (std::size_t k = 0; k < cursors_.size(); ++k)
        for (; is_left(cursors_[k]) && instant(cursors_[k]) == now; ++cursors_[k].next) {
          const double value = cursors_[k].series->values[cursors_[k].next];
          if (k < nu) {
            if (since[k] != std::numeric_limits<std::int64_t>::min() &&
                static_cast<double>(now - since[k]) > longest_hold_[k])
              finish();
            held[k] = value;
            since[k] = now;
          } else {
            double& slot = row[k - nu];
            if (!std::isnan(slot) && model_.dt > 0)
              throw InvalidInput(
                  name_,
                  fmt::format("two samples of '{}' at {:.6g} s fall into one period of {} s, "
                              "expected one because the model is discrete",
                              known_[k], start_ + static_cast<double>(now) * unit_, model_.dt));
            slot = value;
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
  std::vector<LeftOutRecord>* left_out_;
  double unit_;
  double start_ = 0;
  std::vector<std::string> known_;  ///< names: inputs, then outputs
  std::vector<const LogSeries*> of_signal_;
  std::vector<Cursor> cursors_;       ///< in the order of known_
  std::vector<double> longest_hold_;  ///< per input, in units of instants
};

}  // namespace

std::vector<FilterRecord> records_of_log(const FilterModel& model,
                                         const std::vector<ChannelUse>& uses,
                                         const std::string& name,
                                         const std::vector<ChannelUse>& truths,
                                         std::vector<LeftOutRecord>* left_out) {
  std::vector<FilterRecord> records = Builder(model, uses, name, left_out).build();
  internal::add_truths(model, truths, name, records);
  return records;
}

}  // namespace quadtune
