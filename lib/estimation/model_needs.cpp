// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/model_needs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "estimation/own_log.hpp"
#include "logs/log_titles.hpp"
#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/internal/joined.hpp"

namespace quadtune {
namespace {

using internal::common_unit;

/// Maximum number of names in a message.
constexpr std::size_t kMaxCandidates = 6;
constexpr std::size_t kMaxListed = 6;

std::string name_in(const LogSurvey& log, const LogChannelSurvey& channel) {
  return full_name(log.groups[channel.group].group, channel.channel);
}

/// Why a channel cannot be used at all; empty if it can.
std::string fault_of(const LogChannelSurvey& channel, const LogSurvey& log) {
  const LogTiming& timing = channel.timing;
  if (!log.groups[channel.group].group.timed) return "has no time; use --rate HZ for a text";
  if (channel.samples < 2) return channel.samples == 0 ? "has no values" : "has only one sample";
  if (timing.duplicates + timing.backwards > 0)
    return "has times that do not increase; use --rate HZ for a text";
  return "";
}

bool unit_agrees(const std::string& a, const std::string& b) {
  return a.empty() || b.empty() || common_unit(a) == common_unit(b);
}

/// The channels of that name: the one with this full name, or else all channels that have the name
/// within their groups.
std::vector<const LogChannelSurvey*> channels_named(const std::string& name, const LogSurvey& log) {
  std::vector<const LogChannelSurvey*> found;
  for (const LogChannelSurvey& channel : log.channels) {
    if (name_in(log, channel) == name) return {&channel};
    if (channel.channel.name == name) found.push_back(&channel);
  }
  return found;
}

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// Whether one of the names contains the other, or both begin with the same three letters. Single
/// letters are part of too many names to be significant.
bool alike(const std::string& signal, const std::string& channel) {
  const std::string a = lower(signal), b = lower(channel);
  if (a.size() < 2 || b.size() < 2) return a == b;
  return a.find(b) != std::string::npos || b.find(a) != std::string::npos ||
         (a.size() >= 3 && b.substr(0, 3) == a.substr(0, 3));
}

std::vector<std::string> candidates_for(const Signal& signal, const LogSurvey& log) {
  std::vector<std::string> near, others;
  for (const LogChannelSurvey& channel : log.channels) {
    if (!fault_of(channel, log).empty() || channel.constant) continue;
    const std::string& unit = channel.channel.unit;
    const bool same_unit = !unit.empty() && common_unit(unit) == common_unit(signal.unit);
    const bool like = alike(signal.name, channel.channel.name);
    if (like && unit_agrees(signal.unit, unit))
      near.push_back(name_in(log, channel));
    else if (same_unit)
      others.push_back(name_in(log, channel));
  }
  near.insert(near.end(), others.begin(), others.end());
  if (near.size() > kMaxCandidates) near.resize(kMaxCandidates);
  return near;
}

/// Determines the channel that feeds each signal, or what is missing.
class Matcher {
 public:
  Matcher(const LogSurvey& log, bool z_up, ModelNeeds& needs)
      : log_(log), z_up_(z_up), needs_(needs) {
    for (const LogGroupSurvey& group : log.groups) groups_.push_back(group.group);
    own_ = needs.own_log = internal::is_own_log(groups_);
  }

  bool match(const Signal& signal, const std::string& sensor) {
    if (own_) return match_own(signal, sensor);
    const std::vector<const LogChannelSurvey*> found = channels_named(signal.name, log_);
    MissingSignal missing{signal, sensor, "", {}};
    if (found.size() > 1) {
      for (const LogChannelSurvey* channel : found)
        missing.candidates.push_back(name_in(log_, *channel));
      missing.why = "is in several groups of the log";
    } else if (found.size() == 1) {
      missing.why = fault_of(*found[0], log_);
      const std::string& unit = found[0]->channel.unit;
      if (missing.why.empty() && !unit_agrees(signal.unit, unit))
        missing.why = fmt::format("is in {}, expected {}", unit, signal.unit);
      if (missing.why.empty() &&
          internal::may_be_anything(signal, found[0]->channel, groups_[found[0]->group])) {
        missing.why = "can be any quantity";
        missing.candidates = {name_in(log_, *found[0])};
      }
      if (missing.why.empty()) {
        needs_.uses.push_back({signal.name, name_in(log_, *found[0])});
        return true;
      }
    }
    if (missing.candidates.empty()) missing.candidates = candidates_for(signal, log_);
    needs_.missing.push_back(std::move(missing));
    return false;
  }

 private:
  /// Matches by the names of the vehicle's sensors in flight logs of quadtune.
  bool match_own(const Signal& signal, const std::string& sensor) {
    const std::vector<internal::OwnSignal> own = internal::own_signals(signal, z_up_);
    const internal::OwnSignal* there = internal::first_that_is_there(own, groups_);
    const bool measured =
        there != nullptr &&
        std::all_of(there->channels.begin(), there->channels.end(), [&](const std::string& name) {
          const std::vector<const LogChannelSurvey*> found = channels_named(name, log_);
          return found.size() == 1 && fault_of(*found[0], log_).empty();
        });
    if (measured)
      needs_.uses.push_back({signal.name, there->from});
    else
      needs_.missing.push_back({signal, sensor, "", candidates_for(signal, log_)});
    return measured;
  }

  const LogSurvey& log_;
  bool z_up_;
  ModelNeeds& needs_;
  std::vector<LogGroup> groups_;
  bool own_ = false;
};

std::string with_unit(const Signal& signal) {
  return signal.unit.empty() ? signal.name : fmt::format("{} [{}]", signal.name, signal.unit);
}

/// "az [m/s2], height [m] (is in cm, expected m)", with the sensor's name if signals of several
/// sensors are missing.
std::string list_of(const ModelNeeds& needs) {
  const std::string& last = needs.missing.back().sensor;
  const bool several = std::any_of(
      needs.missing.begin(), needs.missing.end(),
      [&](const MissingSignal& one) { return !one.sensor.empty() && one.sensor != last; });
  std::vector<std::string> items;
  for (const MissingSignal& one : needs.missing) {
    std::string item = with_unit(one.signal);
    if (several && !one.sensor.empty()) item += " (sensor " + one.sensor + ")";
    if (!one.why.empty()) item += fmt::format(" ({})", one.why);
    items.push_back(std::move(item));
  }
  if (items.size() > kMaxListed) {
    const std::size_t more = items.size() - kMaxListed;
    items.resize(kMaxListed);
    items.push_back(fmt::format("{} more", more));
  }
  return fmt::format("{}", internal::joined(items, ", "));
}

}  // namespace

ModelSignals signals_of(const FilterModel& model) {
  ModelSignals signals{model.name, model.inputs, {}, internal::has_z_up(model)};
  for (const FilterSensor& sensor : model.sensors)
    signals.sensors.push_back({sensor.name, sensor.outputs});
  return signals;
}

std::vector<ModelSignals> signals_of_built_in_models() {
  std::vector<ModelSignals> result;
  for (const FilterModelTitle& title : built_in_filter_models())
    result.push_back(signals_of(load_filter_model(title.name)));
  return result;
}

ModelNeeds model_needs(const ModelSignals& model, const LogSurvey& log) {
  ModelNeeds needs;
  needs.model = model.name;
  Matcher matcher(log, model.z_up, needs);
  bool inputs = true;
  for (const Signal& input : model.inputs) inputs = matcher.match(input, "") && inputs;
  bool measured = false;
  for (const ModelSignals::Sensor& sensor : model.sensors) {
    bool whole = true;
    for (const Signal& output : sensor.outputs) whole = matcher.match(output, sensor.name) && whole;
    measured = measured || whole;
  }
  needs.feeds = inputs && measured;
  return needs;
}

std::string to_text(const ModelNeeds& needs) {
  if (needs.feeds) {
    std::vector<std::string> channels;
    for (const auto& use : needs.uses) channels.push_back(use.second);
    std::string text = fmt::format("{}: fed by {}", needs.model, internal::joined(channels, ", "));
    return needs.missing.empty()
               ? text
               : text + (needs.own_log ? "; " : "; --map the measurements that are there, ") +
                     "without " + list_of(needs);
  }
  std::string text = fmt::format("{}: needs {}; use --map {}=CHANNEL if {} named differently",
                                 needs.model, list_of(needs), needs.missing.front().signal.name,
                                 needs.missing.size() == 1 ? "it is" : "one of them is");
  for (std::size_t i = 0; i < std::min(needs.missing.size(), kMaxListed); ++i) {
    const MissingSignal& one = needs.missing[i];
    if (!one.candidates.empty())
      text +=
          fmt::format("\n  {} may be {}", one.signal.name, internal::joined(one.candidates, ", "));
  }
  return text;
}

}  // namespace quadtune
