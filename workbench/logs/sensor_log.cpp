// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/logs/sensor_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <map>
#include <utility>

#include "quadtune/errors.hpp"
#include "quadtune/exports/file_set.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/workbench/logs/channel_place.hpp"
#include "quadtune/workbench/logs/missing_option.hpp"

namespace quadtune {
namespace {

void require_timed(const LogSeries& series, const std::string& file) {
  if (series.name.empty()) return;
  if (!series.timed)
    throw MissingOption("rate",
                        fmt::format("no sample rate; expected --rate HZ or --time COLUMN: {} "
                                    "has no time column in s, ms, us or ns",
                                    file));
  require_usable(series, file);
}

}  // namespace

std::string log_name(const std::string& path) { return path == "-" ? "standard input" : path; }

void require_different_logs(const std::vector<std::string>& paths) {
  if (paths.size() < 2) return;
  std::map<std::string, std::string> first_with;
  for (const std::string& path : paths) {
    const auto [other, added] = first_with.emplace(sha256_of_file(path), path);
    if (added) continue;
    const std::string shown = internal::printable(path);
    throw OptionError(
        "log", other->second == path
                   ? fmt::format("log lists {} twice, expected each log once, because its samples "
                                 "would count twice",
                                 shown)
                   : fmt::format("log: {} and {} have the same content, expected different logs, "
                                 "because samples would count twice",
                                 internal::printable(other->second), shown));
  }
}

SensorLog read_sensors(const std::string& path, const std::vector<std::string>& names,
                       const std::vector<std::string>& optional, LogOptions options,
                       const LogNote& note) {
  std::vector<ChannelPlace> places;
  std::vector<std::string> files;
  places.reserve(names.size());
  for (const std::string& name : names) places.push_back(channel_place(name, path));
  if (!optional.empty()) files.push_back(path);
  for (const ChannelPlace& place : places)
    if (std::find(files.begin(), files.end(), place.file) == files.end())
      files.push_back(place.file);
  SensorLog result;
  result.series.resize(names.size());
  for (const std::string& file : files) {
    std::vector<std::string> here;
    for (const ChannelPlace& place : places)
      if (place.file == file) here.push_back(place.channel);
    LogChannels log =
        read_channels(file, here, options, file == path ? optional : std::vector<std::string>{});
    options.epoch_s = log.epoch_s;  // common epoch: that of the first file
    for (const LogSeries& series : log.series) require_timed(series, log_name(file));
    auto next = log.series.begin();
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (places[i].file != file) continue;
      result.series[i] = std::move(*next++);
      if (file != path) result.series[i].name += '@' + file;
    }
    std::move(next, log.series.end(), std::back_inserter(result.series));
    for (std::string& line : noted_log_warnings(log.condition, log_name(file), note))
      result.warnings.push_back(std::move(line));
  }
  return result;
}

JoinedSeries join(const std::vector<const LogSeries*>& series, const std::string& where) {
  const Samples& first = series.front()->time;
  std::vector<std::size_t> at(series.size(), 0), rows;
  for (std::size_t i = 0; i < first.size(); ++i) {
    bool all = true;
    for (std::size_t k = 0; k < series.size(); ++k) {
      const Samples& time = series[k]->time;
      while (at[k] < time.size() && time[at[k]] < first[i]) ++at[k];
      all = all && at[k] < time.size() && time[at[k]] == first[i];
    }
    if (all) rows.insert(rows.end(), at.begin(), at.end());
  }
  const std::size_t count = rows.size() / series.size();
  if (2 * count < first.size()) {
    const auto other = std::max_element(series.begin(), series.end(), [&](auto* a, auto* b) {
      return std::llabs(std::ssize(a->time) - std::ssize(first)) <
             std::llabs(std::ssize(b->time) - std::ssize(first));
    });
    throw InvalidInput(
        where,
        fmt::format("only {} of {} samples of '{}' coincide with samples of all other channels "
                    "('{}' has {} samples), expected sensors with common sample times",
                    count, first.size(), internal::printable(series.front()->name),
                    internal::printable((*other)->name), (*other)->time.size()));
  }
  JoinedSeries result;
  result.t.resize(static_cast<Eigen::Index>(count));
  result.values.resize(std::ssize(series), static_cast<Eigen::Index>(count));
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < series.size(); ++k) {
      const std::size_t row = rows[i * series.size() + k];
      result.t(static_cast<Eigen::Index>(i)) = series[k]->time[row];
      result.values(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) =
          series[k]->values[row];
    }
  return result;
}

double even_period(const LogSeries& series, const std::string& where) {
  const Samples& t = series.time;
  Samples steps(t.size() - 1);
  for (std::size_t i = 0; i < steps.size(); ++i) steps[i] = t[i + 1] - t[i];
  Samples sorted = steps;
  const auto middle = sorted.begin() + std::ssize(sorted) / 2;
  std::nth_element(sorted.begin(), middle, sorted.end());
  for (std::size_t i = 0; i < steps.size(); ++i)
    if (steps[i] >= 1.5 * *middle)
      throw InvalidInput(
          where,
          fmt::format("'{}' has a gap: sample {}, at {:.9g} s, is {:.6g} s after the previous "
                      "one, expected {:.6g} s (the median), because an average across "
                      "the gap would span more time",
                      internal::printable(series.name), i + 2, t[i + 1], steps[i], *middle));
  return (t.back() - t.front()) / static_cast<double>(t.size() - 1);
}

}  // namespace quadtune
