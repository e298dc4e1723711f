// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "quadtune/estimation/model_needs.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/logs/log_survey.hpp"
#include "quadtune/workbench/logs/log_notes.hpp"
#include "report/logs/logs.hpp"
#include "report/text/print.hpp"
#include "report/text/rows.hpp"

namespace quadtune::report {
namespace {

using internal::Json;

std::string counted(std::uint64_t count, const std::string& one, const std::string& many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

void add_timing(const LogTiming& timing, Json& json) {
  json["rate_hz"] = timing.rate_hz;
  json["gaps"] = timing.gaps;
  json["longest_gap_s"] = timing.longest_gap_s;
  json["duplicates"] = timing.duplicates;
  json["backwards"] = timing.backwards;
  json["forwards"] = timing.forwards;
}

std::vector<std::string> oddities(const LogTiming& timing) {
  std::vector<std::string> parts;
  if (timing.gaps > 0)
    parts.push_back(fmt::format("{}, the longest {:.4g} s", counted(timing.gaps, "gap", "gaps"),
                                timing.longest_gap_s));
  if (timing.duplicates > 0)
    parts.push_back(counted(timing.duplicates, "duplicate time", "duplicate times"));
  if (timing.backwards > 0)
    parts.push_back(counted(timing.backwards, "step back", "steps back") + " in time");
  if (timing.forwards > 0) parts.push_back(counted(timing.forwards, "jump", "jumps") + " forward");
  return parts;
}

std::string group_line(const LogGroupSurvey& group) {
  std::vector<std::string> parts = {counted(group.rows, "row", "rows")};
  if (!group.group.timed) {
    parts.emplace_back("no time");
  } else if (group.rows > 0) {
    if (!std::isnan(group.timing.rate_hz))
      parts[0] += fmt::format(" at {:.5g} Hz", group.timing.rate_hz);
    parts[0] +=
        fmt::format(" from {:.6g} s, {:.6g} s long", group.timing.first_s, group.timing.duration_s);
    for (std::string& part : oddities(group.timing)) parts.push_back(std::move(part));
  }
  return internal::joined(parts, "; ");
}

std::string remarks(const LogChannelSurvey& channel, const LogGroupSurvey& group) {
  std::vector<std::string> parts;
  if (channel.samples == 0 && group.rows > 0) return "never has a value";
  if (channel.constant) parts.emplace_back("constant");
  if (channel.saturated > 0)
    parts.push_back(
        fmt::format("saturated? {} in a row at the minimum or maximum", channel.saturated));
  // Anomalies that the line of the group lists are not repeated.
  if (channel.nan > 0) {
    parts.push_back(fmt::format("{} without a value", channel.nan));
    for (std::string& part : oddities(channel.timing)) parts.push_back(std::move(part));
  }
  return internal::joined(parts, ", ");
}

std::string channel_table(const LogSurvey& survey, std::size_t group) {
  Cells rows = {{"channel", "unit", "samples", "[Hz]", "min", "mean", "max", "std", ""}};
  for (const LogChannelSurvey& one : survey.channels) {
    if (one.group != group) continue;
    rows.push_back({one.channel.name, one.channel.unit, fmt::format("{}", one.samples),
                    figure(one.timing.rate_hz, ".5g"), figure(one.min, ".5g"),
                    figure(one.mean, ".5g"), figure(one.max, ".5g"), figure(one.std, ".5g"),
                    remarks(one, survey.groups[group])});
  }
  return rows.size() > 1 ? aligned(rows, "<<>>>>>><") : "no channels";
}

Json needs_json(const ModelNeeds& needs) {
  Json json = {{"name", needs.model},
               {"feeds", needs.feeds},
               {"uses", Json::object()},
               {"missing", Json::array()}};
  for (const auto& [signal, channel] : needs.uses) json["uses"][signal] = channel;
  for (const MissingSignal& one : needs.missing)
    json["missing"].push_back({{"name", one.signal.name},
                               {"unit", one.signal.unit},
                               {"sensor", one.sensor.empty() ? Json(nullptr) : Json(one.sensor)},
                               {"why", one.why},
                               {"candidates", one.candidates}});
  return json;
}

std::string format_summary(const std::string& format) {
  for (const LogFormat& one : log_formats())
    if (one.name == format) return fmt::format("{}: {}", one.name, one.summary);
  return format;
}

}  // namespace

Json to_json(const LogSurvey& survey, const std::vector<ModelNeeds>& models,
             const std::string& file) {
  Json json;
  json["file"] = file;
  json["format"] = survey.format;
  json["duration_s"] = survey.duration_s;
  json["epoch_s"] = survey.epoch_s;
  json["whole"] = survey.condition.whole();
  json["torn"] = survey.condition.torn.empty() ? Json(nullptr) : Json(survey.condition.torn);
  json["skipped"] = survey.condition.skipped;
  json["dropouts"] = survey.condition.dropouts;
  json["dropout_s"] = survey.condition.dropout_s;
  json["warnings"] = log_warnings(survey.condition);
  json["groups"] = Json::array();
  for (const LogGroupSurvey& group : survey.groups) {
    Json entry;
    entry["name"] = group.group.name;
    entry["rows"] = group.rows;
    entry["timed"] = group.group.timed;
    entry["first_s"] = group.timing.first_s;
    entry["duration_s"] = group.timing.duration_s;
    add_timing(group.timing, entry);
    json["groups"].push_back(std::move(entry));
  }
  json["channels"] = Json::array();
  for (const LogChannelSurvey& one : survey.channels) {
    Json entry;
    entry["name"] = full_name(survey.groups[one.group].group, one.channel);
    entry["unit"] = one.channel.unit;
    entry["samples"] = one.samples;
    entry["nan"] = one.nan;
    add_timing(one.timing, entry);
    entry["min"] = one.min;
    entry["max"] = one.max;
    entry["mean"] = one.mean;
    entry["std"] = one.std;
    entry["constant"] = one.constant;
    entry["saturated"] = one.saturated;
    json["channels"].push_back(std::move(entry));
  }
  json["models"] = Json::array();
  for (const ModelNeeds& needs : models) json["models"].push_back(needs_json(needs));
  return json;
}

std::string to_text(const LogSurvey& survey, const std::vector<ModelNeeds>& models,
                    const std::string& file) {
  std::string text = section("log", file) + section("format", format_summary(survey.format));
  if (survey.duration_s > 0) {
    std::string time = fmt::format("{:.6g} s", survey.duration_s);
    if (survey.epoch_s != 0) time += fmt::format("; times count from {} s", survey.epoch_s);
    text += section("duration", time);
  }
  for (std::size_t i = 0; i < survey.groups.size(); ++i) {
    const LogGroupSurvey& group = survey.groups[i];
    const std::string line = group_line(group);
    text += "\n";
    text += group.group.name.empty() ? section("rows", line)
                                     : section("group", group.group.name + ": " + line);
    text += section("", channel_table(survey, i));
  }
  std::string lines;
  for (const ModelNeeds& needs : models) lines += (lines.empty() ? "" : "\n") + to_text(needs);
  return text + "\n" + section("models", lines);
}

}  // namespace quadtune::report
