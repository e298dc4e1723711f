// SPDX-License-Identifier: Apache-2.0
#include "quadtune/logs/log_channels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "logs/log_titles.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune {
namespace {

using internal::printable;

// A requested channel.
struct Wanted {
  std::size_t channel;  // index in its group
  std::size_t series;   // index in the result
};

class Collector {
 public:
  Collector(std::vector<std::string> names, std::size_t required, std::string origin)
      : names_(std::move(names)),
        required_(required),
        origin_(std::move(origin)),
        found_(names_.size()) {
    result_.series.resize(names_.size());
  }

  void take_groups(const std::vector<LogGroup>& groups) {
    for (; wanted_.size() < groups.size();) {
      const LogGroup& group = groups[wanted_.size()];
      std::vector<Wanted>& wanted = wanted_.emplace_back();
      for (std::size_t k = 0; k < group.channels.size(); ++k)
        for (std::size_t i = 0; i < names_.size(); ++i) match(group, k, i, wanted);
    }
  }

  void take(const LogBlock& block, std::size_t columns) {
    rows_.resize(wanted_.size());
    for (const Wanted& wanted : wanted_[block.group]) {
      LogSeries& series = result_.series[wanted.series];
      for (std::size_t i = 0; i < block.rows(); ++i) {
        const double value = block.values[i * columns + wanted.channel];
        if (std::isnan(value)) continue;
        series.time.push_back(series.timed ? block.time[i]
                                           : static_cast<double>(rows_[block.group] + i));
        series.values.push_back(value);
      }
    }
    rows_[block.group] += block.rows();
  }

  LogChannels result(const std::vector<LogGroup>& groups) {
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (found_[i].empty() && i < required_) refuse_unknown(i, groups);
      if (found_[i].size() > 1)
        throw InvalidInput(
            origin_,
            fmt::format("'{}' is the name of several channels, expected one of "
                        "{} and {}",
                        printable(names_[i]), printable(found_[i][0]), printable(found_[i][1])));
    }
    return std::move(result_);
  }

 private:
  static bool is_number_of(const LogChannel& channel, const std::string& name) {
    return channel.column > 0 && name == std::to_string(channel.column);
  }

  // A full name takes precedence over a short name found before.
  void match(const LogGroup& group, std::size_t channel, std::size_t i,
             std::vector<Wanted>& wanted) {
    const LogChannel& candidate = group.channels[channel];
    const std::string full = full_name(group, candidate);
    const bool is_full = full == names_[i];
    if (!is_full && candidate.name != names_[i] && !is_number_of(candidate, names_[i])) return;
    if (!is_full && !found_[i].empty() && found_[i][0] == names_[i]) return;
    if (is_full) found_[i].clear();
    found_[i].push_back(full);
    if (found_[i].size() > 1) return;
    for (std::vector<Wanted>& others : wanted_)
      std::erase_if(others, [&](const Wanted& other) { return other.series == i; });
    result_.series[i] = {full, candidate.unit, group.timed, {}, {}};
    wanted.push_back({channel, i});
  }

  /// @param first  index of the first name that the log does not have
  [[noreturn]] void refuse_unknown(std::size_t first, const std::vector<LogGroup>& groups) const {
    constexpr std::size_t kListed = 12;
    const std::string& name = names_[first];
    std::string others;
    for (std::size_t i = first + 1; i < required_; ++i)
      if (found_[i].empty()) others += fmt::format(", '{}'", printable(names_[i]));
    std::vector<std::string> known;
    for (const LogGroup& group : groups)
      for (const LogChannel& channel : group.channels) {
        known.push_back(full_name(group, channel));
        if (!group.name.empty()) known.push_back(channel.name);
      }
    std::string hint = others.empty() ? internal::did_you_mean(name, known) : "";
    if (hint.empty() && known.size() <= kListed) {
      hint = ", expected one of";
      for (const std::string& one : known) hint += ' ' + printable(one);
    }
    if (name.find_first_not_of("0123456789") == std::string::npos)
      hint += "; a number counts the columns from 1 and cannot select the column of the times";
    throw UnknownChannel(origin_, fmt::format("has no channel{} '{}'{}{}",
                                              others.empty() ? "" : "s", printable(name), others,
                                              hint.empty() ? "; 'quadtune log' lists them" : hint));
  }

  std::vector<std::string> names_;
  std::size_t required_;  // number of names that are required
  std::string origin_;
  std::vector<std::vector<std::string>> found_;  // full names, by requested name
  std::vector<std::vector<Wanted>> wanted_;      // by group
  std::vector<std::uint64_t> rows_;              // number of rows so far, by group
  LogChannels result_;
};

}  // namespace

LogChannels read_log_channels(const std::string& path, const std::vector<std::string>& names,
                              const LogOptions& options, const std::vector<std::string>& optional) {
  const std::unique_ptr<LogReader> reader = open_log(path, options);
  std::vector<std::string> all = names;
  all.insert(all.end(), optional.begin(), optional.end());
  Collector collector(std::move(all), names.size(), path);
  LogBlock block;
  while (reader->next(block)) {
    collector.take_groups(reader->groups());
    collector.take(block, reader->groups()[block.group].channels.size());
  }
  collector.take_groups(reader->groups());
  LogChannels result = collector.result(reader->groups());
  result.condition = reader->condition();
  if (!result.condition.unclear_time.empty())
    throw InvalidInput(path, result.condition.unclear_time);
  result.epoch_s = reader->epoch_s();
  result.groups = reader->groups();
  return result;
}

LogSeries interpolated(const LogSeries& series, const Samples& times) {
  constexpr double kMax = 10;  // median steps
  LogSeries result{series.name, series.unit, series.timed, {}, {}};
  const Samples& t = series.time;
  if (t.empty()) return result;
  std::vector<double> steps;
  for (std::size_t i = 1; i < t.size(); ++i) steps.push_back(t[i] - t[i - 1]);
  double longest = 0;
  if (!steps.empty()) {
    const auto middle = steps.begin() + std::ssize(steps) / 2;
    std::nth_element(steps.begin(), middle, steps.end());
    longest = kMax * *middle;
  }
  std::size_t after = 0;
  for (const double time : times) {
    while (after < t.size() && t[after] < time) ++after;
    if (after == t.size()) break;
    const bool exact = t[after] == time;
    if (!exact && (after == 0 || t[after] - t[after - 1] > longest)) continue;
    const double share = exact ? 1 : (time - t[after - 1]) / (t[after] - t[after - 1]);
    const double before = exact ? 0 : series.values[after - 1];
    result.time.push_back(time);
    result.values.push_back(exact ? series.values[after]
                                  : before + share * (series.values[after] - before));
  }
  return result;
}

void require_usable(const LogSeries& series, const std::string& where, std::size_t min) {
  if (!series.timed)
    throw InvalidInput(where, fmt::format("'{}' has no time, expected a time column or a rate",
                                          printable(series.name)));
  if (series.values.empty())
    throw InvalidInput(where, fmt::format("'{}' has no samples, expected at least one: no row "
                                          "of it holds a number",
                                          printable(series.name)));
  if (series.values.size() < min)
    throw InvalidInput(where,
                       fmt::format("'{}' has {}, expected {} or more", printable(series.name),
                                   internal::counted(series.values.size(), "sample"), min));
  const auto step = std::adjacent_find(series.time.begin(), series.time.end(),
                                       [](double a, double b) { return !(a < b); });
  if (step != series.time.end())
    throw InvalidInput(
        where,
        fmt::format("the time of '{}' does not increase: sample {} is at {} s, the one "
                    "before at {} s, expected increasing times",
                    printable(series.name), step - series.time.begin() + 2, *(step + 1), *step));
}

void require_unit(const LogSeries& series, const std::string& unit, const std::string& where) {
  if (series.unit.empty() || internal::common_unit(series.unit) == internal::common_unit(unit))
    return;
  throw InvalidInput(where, fmt::format("'{}' is in {}, expected {}", printable(series.name),
                                        printable(series.unit), unit));
}

}  // namespace quadtune
