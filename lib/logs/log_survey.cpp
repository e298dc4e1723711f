// SPDX-License-Identifier: Apache-2.0
#include "quadtune/logs/log_survey.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include "logs/interval_statistics.hpp"

namespace quadtune {
namespace {

using internal::IntervalStatistics;

constexpr std::uint64_t kMinRun = 20;  // minimum number of equal samples that may be a limit
constexpr double kMinMoving = 0.25;    // fraction of the other samples

// The longest run at an extreme value, and the number of samples at that value.
struct Extreme {
  double value = 0;
  std::uint64_t run = 0;
  std::uint64_t longest = 0;
  std::uint64_t samples = 0;

  // The run started with the log: the signal was at rest rather than at a limit
  bool from_start = false;

  void start(double x, bool first) { *this = {x, 1, first ? 0U : 1U, 1, first}; }
  void take(double x) {
    if (x != value) {
      run = 0;
      from_start = false;
      return;
    }
    ++samples;
    ++run;
    if (!from_start) longest = std::max(longest, run);
  }
};

class ChannelStatistics {
 public:
  void take(double x) {
    if (samples_++ == 0) {
      low_.start(x, true);
      high_.start(x, true);
      mean_ = previous_ = x;
      return;
    }
    changes_ += x != previous_ ? 1 : 0;
    previous_ = x;
    x < low_.value ? low_.start(x, false) : low_.take(x);
    x > high_.value ? high_.start(x, false) : high_.take(x);
    // Welford: M += (x - old mean)(x - new mean)
    const double error = x - mean_;
    mean_ += error / static_cast<double>(samples_);
    moment_ += error * (x - mean_);
  }

  [[nodiscard]] std::uint64_t samples() const { return samples_; }

  void describe(LogChannelSurvey& survey) const {
    survey.samples = samples_;
    if (samples_ == 0) return;
    survey.min = low_.value;
    survey.max = high_.value;
    survey.mean = mean_;
    if (samples_ < 2) return;
    survey.std = std::sqrt(moment_ / static_cast<double>(samples_ - 1));
    survey.constant = changes_ == 0;
    const std::uint64_t run = std::max(low_.longest, high_.longest);
    const auto others =
        static_cast<double>(samples_ - std::min(samples_, low_.samples + high_.samples));
    if (run >= kMinRun && others > 0 && static_cast<double>(changes_) >= kMinMoving * others)
      survey.saturated = run;
  }

 private:
  std::uint64_t samples_ = 0;
  std::uint64_t changes_ = 0;
  double previous_ = 0;
  double mean_ = 0;
  double moment_ = 0;
  Extreme low_;
  Extreme high_;
};

struct Channel {
  ChannelStatistics statistics;
  std::unique_ptr<IntervalStatistics> own_times;  // only after its first missing value
};

struct Group {
  std::uint64_t rows = 0;
  IntervalStatistics times;
  std::vector<Channel> channels;
};

void take_row(double time, bool timed, const double* values, Group& group) {
  for (std::size_t k = 0; k < group.channels.size(); ++k) {
    Channel& channel = group.channels[k];
    if (std::isnan(values[k])) {
      if (timed && !channel.own_times)
        channel.own_times = std::make_unique<IntervalStatistics>(group.times);
      continue;
    }
    channel.statistics.take(values[k]);
    if (channel.own_times) channel.own_times->take(time);
  }
  if (timed) group.times.take(time);
  ++group.rows;
}

}  // namespace

LogSurvey survey_log(LogReader& reader) {
  std::vector<Group> groups;
  LogBlock block;
  while (reader.next(block)) {
    while (groups.size() < reader.groups().size()) {
      groups.emplace_back();
      groups.back().channels.resize(reader.groups()[groups.size() - 1].channels.size());
    }
    Group& group = groups[block.group];
    const bool timed = reader.groups()[block.group].timed;
    for (std::size_t i = 0; i < block.rows(); ++i)
      take_row(block.time[i], timed, block.values.data() + i * group.channels.size(), group);
  }
  groups.resize(reader.groups().size());
  LogSurvey survey;
  survey.format = reader.format();
  survey.epoch_s = reader.epoch_s();
  survey.condition = reader.condition();
  double first = std::numeric_limits<double>::infinity();
  double last = -first;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    Group& group = groups[i];
    const LogGroup& description = reader.groups()[i];
    group.channels.resize(description.channels.size());
    survey.groups.push_back({description, group.rows, group.times.timing()});
    first = std::min(first, group.times.min());
    last = std::max(last, group.times.max());
    for (std::size_t k = 0; k < group.channels.size(); ++k) {
      const Channel& channel = group.channels[k];
      LogChannelSurvey entry;
      entry.group = i;
      entry.channel = description.channels[k];
      entry.timing = (channel.own_times ? *channel.own_times : group.times).timing();
      channel.statistics.describe(entry);
      entry.nan = group.rows - entry.samples;
      survey.channels.push_back(std::move(entry));
    }
  }
  if (last > first) survey.duration_s = last - first;
  return survey;
}

}  // namespace quadtune
