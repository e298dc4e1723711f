// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/log_signals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "estimation/own_log.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune {
namespace {

using internal::OwnSignal;
using internal::printable;

/// Groups that are known from the first rows; for a log of one table these are all groups.
std::vector<LogGroup> first_groups(const std::string& path, const LogOptions& options) {
  const std::unique_ptr<LogReader> reader = open_log(path, options);
  LogBlock block;
  (void)reader->next(block);
  return reader->groups();
}

bool is_input(const FilterModel& model, const std::string& signal) {
  return std::any_of(model.inputs.begin(), model.inputs.end(),
                     [&](const Signal& input) { return input.name == signal; });
}

/// Combines several series of one table, at the times at which all of them have a value.
LogSeries combined(const OwnSignal& signal, const std::vector<const LogSeries*>& of) {
  LogSeries result{signal.from, signal.unit, true, {}, {}};
  std::vector<std::size_t> next(of.size(), 0);
  std::vector<double> values(of.size());
  for (std::size_t k = 0; k < of[0]->time.size(); ++k) {
    const double t = of[0]->time[k];
    bool all = true;
    for (std::size_t i = 0; i < of.size(); ++i) {
      while (next[i] < of[i]->time.size() && of[i]->time[next[i]] < t) ++next[i];
      all = all && next[i] < of[i]->time.size() && of[i]->time[next[i]] == t;
      if (all) values[i] = of[i]->values[next[i]];
    }
    if (!all) continue;
    const double value = signal.value(values);
    if (!std::isfinite(value)) continue;
    result.time.push_back(t);
    result.values.push_back(value);
  }
  return result;
}

FedSignals read_own_log(const std::string& path, const FilterModel& model,
                        const std::vector<Signal>& signals, const std::vector<LogGroup>& groups,
                        const LogOptions& options) {
  const bool z_up = internal::has_z_up(model);
  std::vector<std::pair<std::string, OwnSignal>> chosen;
  std::vector<std::string> channels;
  for (const Signal& signal : signals) {
    const std::vector<OwnSignal> own = internal::own_signals(signal, z_up);
    const OwnSignal* there = internal::first_that_is_there(own, groups);
    if (there == nullptr) {
      if (!is_input(model, signal.name)) continue;
      throw InvalidInput(path,
                         fmt::format("this flight log has no channel for the input '{}' of the "
                                     "model '{}', expected a channel mapped to it{}",
                                     signal.name, model.name,
                                     own.empty() ? "" : ", or a vehicle with such a sensor"));
    }
    chosen.emplace_back(signal.name, *there);
    for (const std::string& channel : there->channels)
      if (std::find(channels.begin(), channels.end(), channel) == channels.end())
        channels.push_back(channel);
  }
  const auto is_output = [&](const std::string& signal) { return !is_input(model, signal); };
  const bool asked = std::any_of(signals.begin(), signals.end(),
                                 [&](const Signal& signal) { return is_output(signal.name); });
  const auto refuse = [&] {
    std::vector<std::string> outputs;
    for (const Signal& signal : signals)
      if (is_output(signal.name)) outputs.push_back(signal.name);
    throw InvalidInput(path,
                       fmt::format("this flight log has no channel for {} of the model '{}', "
                                   "expected --map {}=CHANNEL",
                                   internal::joined(outputs, ", "), model.name, outputs.front()));
  };
  if (asked && std::none_of(chosen.begin(), chosen.end(),
                            [&](const auto& one) { return is_output(one.first); }))
    refuse();
  LogChannels log = read_log_channels(path, channels, options);
  FedSignals result{{}, log.condition, log.epoch_s};
  for (const auto& [name, own] : chosen) {
    std::vector<const LogSeries*> of;
    for (const std::string& channel : own.channels)
      of.push_back(&log.series[static_cast<std::size_t>(
          std::find(channels.begin(), channels.end(), channel) - channels.begin())]);
    LogSeries series = combined(own, of);
    // Omit a sensor that never provided a sample.
    if (series.values.empty() && !is_input(model, name)) continue;
    result.signals.push_back({{name, std::move(series)}, own.from});
  }
  if (asked && std::none_of(result.signals.begin(), result.signals.end(),
                            [&](const FedSignal& fed) { return is_output(fed.use.signal); }))
    refuse();
  return result;
}

/// Rejects a channel whose name equals that of the signal only by chance.
void require_meant(const std::string& path, const FilterModel& model, const Signal& signal,
                   const LogSeries& series, const std::vector<LogGroup>& groups) {
  for (const LogGroup& group : groups)
    for (const LogChannel& channel : group.channels)
      if (full_name(group, channel) == series.name &&
          internal::may_be_anything(signal, channel, group))
        throw InvalidInput(
            path,
            fmt::format("'{}' of the model '{}' can be any quantity, and the channel '{}' "
                        "{}may be a different one, expected --map {}=CHANNEL to select the channel",
                        signal.name, model.name, printable(series.name),
                        channel.unit.empty() ? "" : fmt::format("[{}] ", printable(channel.unit)),
                        signal.name));
}

/// True values that differ in a world where z points up: y and z of vectors, and the attitude.
constexpr std::array<const char*, 11> kTurned = {"y",  "z",  "vy",   "vz",    "qw", "qx",
                                                 "qy", "qz", "roll", "pitch", "yaw"};

}  // namespace

void require_same_world(const std::string& path, const FilterModel& model, const std::string& state,
                        const std::vector<LogGroup>& groups) {
  if (!internal::has_z_up(model) || !internal::is_own_log(groups) ||
      std::find(kTurned.begin(), kTurned.end(), state) == kTurned.end())
    return;
  throw InvalidInput(
      path,
      fmt::format("the truth for '{}' is from this flight log, in whose world z points down, but "
                  "in the world of the model '{}' z points up, expected a model with gravity "
                  "along +z, such as inertial-ned",
                  state, model.name));
}

FedSignals read_signals_by_name(const std::string& path, const FilterModel& model,
                                const std::vector<Signal>& signals, const LogOptions& options) {
  const std::vector<LogGroup> groups = first_groups(path, options);
  if (internal::is_own_log(groups)) return read_own_log(path, model, signals, groups, options);
  std::vector<std::string> names;
  names.reserve(signals.size());
  for (const Signal& signal : signals) names.push_back(signal.name);
  LogChannels log = read_log_channels(path, names, options);
  FedSignals result{{}, log.condition, log.epoch_s};
  for (std::size_t i = 0; i < signals.size(); ++i) {
    require_meant(path, model, signals[i], log.series[i], log.groups);
    std::string from = log.series[i].name;
    result.signals.push_back({{names[i], std::move(log.series[i])}, std::move(from)});
  }
  return result;
}

}  // namespace quadtune
