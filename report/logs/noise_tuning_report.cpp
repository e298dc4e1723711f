// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/logs/tuned_noise.hpp"
#include "report/logs/logs.hpp"
#include "report/text/print.hpp"
#include "report/text/rows.hpp"

namespace quadtune::report {
namespace {

using Eigen::Index;
using internal::Json;

std::string names_of(const TunedLog& log) {
  std::string names;
  for (const TunedFile& file : log.files) names += (names.empty() ? "" : " with ") + file.path;
  return names;
}

Json checks_to_json(const Consistency& consistency, const std::string& name) {
  Json checks = Json::array();
  for (const ConsistencyCheck& c : consistency.checks) {
    if (c.name != name) continue;
    checks.push_back({{"output", c.output},
                      {"value", c.value},
                      {"low", c.low},
                      {"high", c.high},
                      {"p", c.p},
                      {"verdict", to_string(c.verdict)}});
  }
  return checks;
}

std::string parameter_table(const TunedNoise& tuned) {
  Cells rows = {{"parameter", "before", "found", "from", "to", "unit"}};
  for (std::size_t i = 0; i < tuned.tuning.fit.parameters.size(); ++i) {
    const FittedParameter& p = tuned.tuning.fit.parameters[i];
    std::string about = p.unit;
    if (p.verdict != ParameterVerdict::seen)
      about += fmt::format("{}({})", about.empty() ? "" : " ", to_string(p.verdict));
    rows.push_back({p.name, figure(tuned.model.parameters[i].start, ".4g"), figure(p.value, ".4g"),
                    figure(p.low, ".4g"), figure(p.high, ".4g"), about});
  }
  return aligned(rows, "<>>>><");
}

std::string innovation_table(const NoiseTuning& tuning) {
  Cells rows = {
      {"output", "samples", "size before", "after", "mean", "corr.", "at lag", "kurtosis", ""}};
  for (std::size_t i = 0; i < tuning.after.outputs.size(); ++i) {
    const InnovationStatistics& s = tuning.after.outputs[i];
    if (s.samples == 0) {
      rows.push_back({s.output, "0", "-", "-", "-", "-", "-", "-", "not measured"});
      continue;
    }
    Index worst = 0;
    for (Index lag = 0; lag < s.autocorrelation.size(); ++lag)
      if (std::abs(s.autocorrelation(lag)) > std::abs(s.autocorrelation(worst))) worst = lag;
    rows.push_back(
        {s.output, fmt::format("{}", s.samples),
         i < tuning.before.outputs.size() ? figure(tuning.before.outputs[i].size, ".3g") : "-",
         figure(s.size, ".3g"), figure(s.mean, ".2g"), figure(s.autocorrelation(worst), ".2g"),
         fmt::format("{}", worst + 1), figure(s.kurtosis, ".2g"), ""});
  }
  return aligned(rows, "<>>>>>>><");
}

Json autocovariance_json(const AutocovarianceFit& als) {
  Json json;
  json["samples"] = als.samples;
  json["dt"] = als.innovation.dt;
  json["lags"] = als.innovation.of.size() - 1;
  json["gains"] = als.passes;
  json["misfit"] = als.misfit;
  json["degrees"] = als.degrees;
  return json;
}

std::string held_out(const HoldOut& holdout) {
  if (holdout.innovations == 0) return "nothing";
  return fmt::format("{} innovations, log-likelihood per innovation {} before, {} after",
                     holdout.innovations, figure(holdout.before, ".5g"),
                     figure(holdout.after, ".5g"));
}

std::string log_line(const TunedLog& log) {
  return fmt::format(
      "{}: {} instants, {:.6g} s{}", names_of(log), log.samples(), log.seconds(),
      log.records.size() > 1 ? fmt::format(", in {} stretches", log.records.size()) : "");
}

/// "height: sonar [m]"; with the file if the flight has several logs.
std::string channel_line(const TunedLog& log, const TunedChannel& channel) {
  return fmt::format("{}: {}{}", channel.signal, channel.channel,
                     log.files.size() > 1 ? " in " + channel.file : "");
}

/// One channel per line.
std::string channel_lines(const TunedLog& log) {
  std::vector<std::string> lines;
  for (const TunedChannel& channel : log.channels) lines.push_back(channel_line(log, channel));
  return internal::joined(lines, "\n");
}

std::string refused_line(const RefusedCount& count) {
  return fmt::format("{}: {} of {}", count.output, count.refused, count.measured);
}

Json parameters_json(const NoiseAgreement& agreement, const NoiseFit& fit) {
  Json rows = Json::array();
  for (std::size_t i = 0; i < agreement.parameters.size(); ++i) {
    const ParameterAgreement& p = agreement.parameters[i];
    if (fit.parameters[i].verdict == ParameterVerdict::fixed) continue;
    rows.push_back({{"name", p.other.name},
                    {"value", p.other.value},
                    {"low", p.other.low},
                    {"high", p.other.high},
                    {"verdict", to_string(p.other.verdict)},
                    {"factor", p.factor},
                    {"standard_deviations", p.deviations},
                    {"disagrees", p.disagrees}});
  }
  return rows;
}

Json agreement_json(const NoiseAgreement& agreement, const NoiseFit& fit) {
  Json json = {{"method", to_string(agreement.other)}};
  if (agreement.not_compared.empty())
    json["parameters"] = parameters_json(agreement, fit);
  else
    json["not_compared"] = agreement.not_compared;
  return json;
}

/// The estimates of the other method, and their differences from this one.
std::string agreement_table(const NoiseAgreement& agreement, const NoiseFit& fit) {
  if (!agreement.not_compared.empty())
    return fmt::format("not compared with {}: {}", to_string(agreement.other),
                       agreement.not_compared);
  return table(parameters_json(agreement, fit), {{"name", "by " + to_string(agreement.other)},
                                                 {"value", "found", "", ".4g"},
                                                 {"low", "from", "", ".4g"},
                                                 {"high", "to", "", ".4g"},
                                                 {"factor", "factor", "", ".3g"},
                                                 {"standard_deviations", "std. dev.", "", ".3g"},
                                                 {.key = "disagrees", .yes = "disagrees"}});
}

/// Shows radians in degrees as well.
std::string error_figure(double value, const std::string& unit) {
  if (unit != "rad") return fmt::format("{} {}", figure(value, ".4g"), unit);
  return fmt::format("{} rad = {} deg", figure(value, ".4g"), figure(degrees(value), ".4g"));
}

bool some_held_out(const NoiseTuning& tuning) {
  return std::any_of(tuning.accuracy.begin(), tuning.accuracy.end(),
                     [](const StateAccuracy& state) { return state.held_out; });
}

std::string accuracy_table(const NoiseTuning& tuning) {
  Cells rows = {{"rms error", "samples", "before", "after", "change", ""}};
  for (const StateAccuracy& state : tuning.accuracy)
    rows.push_back(
        {state.state, fmt::format("{}", state.samples), error_figure(state.before, state.unit),
         error_figure(state.after, state.unit),
         state.before > 0 ? fmt::format("{:+.1f} %", 100 * (state.after / state.before - 1)) : "-",
         state.held_out || !some_held_out(tuning) ? "" : "fitted part"});
  return aligned(rows, "<>>>><") + (some_held_out(tuning) ? "\non the part that was held out"
                                                          : "\non the part that was fitted");
}

Json accuracy_to_json(const NoiseTuning& tuning) {
  Json json;
  json["held_out"] = some_held_out(tuning);
  json["states"] = Json::array();
  for (const StateAccuracy& state : tuning.accuracy)
    json["states"].push_back({{"name", state.state},
                              {"unit", state.unit},
                              {"samples", state.samples},
                              {"held_out", state.held_out},
                              {"before", state.before},
                              {"after", state.after},
                              {"p", state.p}});
  return json;
}

std::string fit_line(const NoiseTuning& tuning) {
  const NoiseFit& fit = tuning.fit;
  const std::string rounds =
      tuning.rounds > 1 ? fmt::format("; the last of {} fits", tuning.rounds) : "";
  if (fit.status == NoiseFitStatus::interrupted || fit.status == NoiseFitStatus::out_of_time)
    return fmt::format("{} after {} evaluations{}: the best so far", to_string(fit.status),
                       fit.evaluations, rounds);
  if (!tuning.autocovariances)
    return fmt::format("{} after {} evaluations; {} of {} searches agree{}", to_string(fit.status),
                       fit.evaluations, fit.agreeing, fit.starts, rounds);
  const AutocovarianceFit& als = *tuning.autocovariances;
  return fmt::format(
      "{} by autocovariances: {:.0f} samples every {:.6g} s, lags to {}, {} gains{}\n"
      "misfit {} of {} degrees of freedom",
      to_string(als.status), als.samples, als.innovation.dt, als.innovation.of.size() - 1,
      als.passes, rounds, figure(als.misfit, ".4g"), als.degrees);
}

std::string left_out_lines(const std::vector<LeftOutRecord>& records) {
  std::string lines;
  for (const LeftOutRecord& record : records)
    lines += fmt::format("{}{}: {:.6g} to {:.6g} s, {} instant{} of measurements between two gaps",
                         lines.empty() ? "" : "\n", record.name, record.from, record.to,
                         record.measurements, record.measurements == 1 ? "" : "s");
  return lines;
}

std::string likelihood_line(const NoiseFit& fit) {
  return fmt::format("log-likelihood {} before, {} after", figure(fit.before.value, ".8g"),
                     figure(fit.after.value, ".8g"));
}

Json files_to_json(const TunedLog& log) {
  Json files = Json::array();
  for (const TunedFile& file : log.files)
    files.push_back({{"file", file.path}, {"sha256", file.sha256}});
  return files;
}

Json channels_to_json(const TunedLog& log) {
  Json channels = Json::array();
  for (const TunedChannel& channel : log.channels)
    channels.push_back(
        {{"signal", channel.signal}, {"channel", channel.channel}, {"file", channel.file}});
  return channels;
}

void add_covariances(const TunedNoise& tuned, Json& json) {
  const NoiseFit& fit = tuned.tuning.fit;
  json["Q"] = internal::matrix_to_json(covariance(tuned.model.Q, fit.theta), "Q");
  for (const FilterSensor& sensor : tuned.model.sensors)
    json["R"][sensor.name] = internal::matrix_to_json(covariance(sensor.R, fit.theta), "R");
  for (const FittedParameter& p : fit.parameters) {
    json["parameters"].push_back({{"name", p.name},
                                  {"unit", p.unit},
                                  {"value", p.value},
                                  {"low", p.low},
                                  {"high", p.high},
                                  {"verdict", to_string(p.verdict)}});
    json["standard_errors"][p.name] = p.standard_error;
    json["identifiable"].push_back(p.verdict == ParameterVerdict::seen ||
                                   p.verdict == ParameterVerdict::at_zero);
  }
}

void add_innovations(const NoiseTuning& tuning, Json& json) {
  json["nis"] = {{"before", checks_to_json(tuning.before, "size")},
                 {"after", checks_to_json(tuning.after, "size")}};
  json["whiteness"] = checks_to_json(tuning.after, "whiteness");
  json["mean"] = checks_to_json(tuning.after, "mean");
  json["errors"] = checks_to_json(tuning.after, "error");
  json["normality"] = checks_to_json(tuning.after, "normality");
  json["refused"] = Json::array();
  for (const RefusedCount& count : tuning.refused)
    json["refused"].push_back(
        {{"output", count.output}, {"refused", count.refused}, {"measured", count.measured}});
}

}  // namespace

std::vector<std::pair<std::string, std::string>> facts_of(const TunedNoise& tuned) {
  const NoiseFit& fit = tuned.tuning.fit;
  std::vector<std::pair<std::string, std::string>> facts;
  for (const TunedLog& log : tuned.logs) {
    facts.emplace_back("log", log_line(log));
    for (const TunedFile& file : log.files) facts.emplace_back("sha256", file.sha256);
    for (const TunedChannel& channel : log.channels)
      facts.emplace_back("channel", channel_line(log, channel));
    for (const std::string& warning : log.warnings) facts.emplace_back("warning", warning);
  }
  if (!tuned.tuning.left_out.empty())
    facts.emplace_back("left out", left_out_lines(tuned.tuning.left_out));
  facts.emplace_back("fit", fit_line(tuned.tuning));
  facts.emplace_back("likelihood", likelihood_line(fit));
  for (const RefusedCount& count : tuned.tuning.refused)
    facts.emplace_back("refused", refused_line(count));
  facts.emplace_back("held out", held_out(tuned.tuning.holdout));
  for (const StateAccuracy& state : tuned.tuning.accuracy)
    facts.emplace_back(
        state.held_out ? "rms error, held out" : "rms error",
        fmt::format("{}: {} before, {} after", state.state, error_figure(state.before, state.unit),
                    error_figure(state.after, state.unit)));
  if (tuned.tuning.agreement && tuned.tuning.agreement->not_compared.empty())
    for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
      const ParameterAgreement& p = tuned.tuning.agreement->parameters[i];
      if (!std::isfinite(p.factor)) continue;
      facts.emplace_back("by " + to_string(tuned.tuning.agreement->other),
                         fmt::format("{}: {} ({} to {}), a factor of {}, {} standard deviations",
                                     p.other.name, figure(p.other.value, ".4g"),
                                     figure(p.other.low, ".4g"), figure(p.other.high, ".4g"),
                                     figure(p.factor, ".3g"), figure(p.deviations, ".3g")));
    }
  return facts;
}

Json to_json(const TunedNoise& tuned) {
  const NoiseTuning& tuning = tuned.tuning;
  const NoiseFit& fit = tuning.fit;
  Json json;
  json["model"] = tuned.model.name;
  json["method"] = tuning.autocovariances ? "als" : "ml";
  if (tuning.autocovariances)
    json["autocovariances"] = autocovariance_json(*tuning.autocovariances);
  json["status"] = to_string(fit.status);
  for (const TunedLog& log : tuned.logs)
    json["logs"].push_back({{"files", files_to_json(log)},
                            {"channels", channels_to_json(log)},
                            {"samples", log.samples()},
                            {"duration_s", log.seconds()},
                            {"records", log.records.size()},
                            {"warnings", log.warnings}});
  add_covariances(tuned, json);
  json["unseen"] = fit.unseen;
  json["log_likelihood"] = {{"before", fit.before.value}, {"after", fit.after.value}};
  json["evaluations"] = fit.evaluations;
  add_innovations(tuning, json);
  json["rounds"] = tuning.rounds;
  json["left_out"] = Json::array();
  for (const LeftOutRecord& record : tuning.left_out)
    json["left_out"].push_back({{"record", record.name},
                                {"from_s", record.from},
                                {"to_s", record.to},
                                {"measurements", record.measurements}});
  json["holdout"] = {{"innovations", tuning.holdout.innovations},
                     {"before", tuning.holdout.before},
                     {"after", tuning.holdout.after}};
  json["accuracy"] = accuracy_to_json(tuning);
  if (tuning.agreement) json["agreement"] = agreement_json(*tuning.agreement, fit);
  json["warnings"] = tuning.warnings;
  json["gate"] = {{"verdict", to_string(tuning.verdict)}, {"reasons", tuning.reasons}};
  return json;
}

std::string to_text(const TunedNoise& tuned) {
  const NoiseFit& fit = tuned.tuning.fit;
  std::string logs;
  for (const TunedLog& log : tuned.logs) logs += (logs.empty() ? "" : "\n") + log_line(log);
  std::string text =
      section("model", fmt::format("{}: {}", tuned.model.name, tuned.model.description)) +
      section("logs", logs);
  std::string channels;
  for (const TunedLog& log : tuned.logs)
    if (const std::string lines = channel_lines(log); channels.find(lines) == std::string::npos)
      channels += (channels.empty() ? "" : "\n") + lines;
  text += section("channels", channels);
  if (!tuned.tuning.left_out.empty())
    text += section("left out", left_out_lines(tuned.tuning.left_out));
  text += section("fit", fit_line(tuned.tuning));
  text += section("noise", parameter_table(tuned));
  if (!fit.unseen.empty()) text += section("not determined", internal::joined(fit.unseen, "\n"));
  text += section("likelihood", likelihood_line(fit));
  if (!tuned.tuning.after.outputs.empty())
    text += section("innovations", innovation_table(tuned.tuning));
  std::string errors;
  for (const ConsistencyCheck& c : tuned.tuning.after.checks)
    if (c.name == "error")
      errors += fmt::format("{}{}: squared error {} times its variance, consistent {} to {}",
                            errors.empty() ? "" : "\n", c.output, figure(c.value, ".3g"),
                            figure(c.low, ".3g"), figure(c.high, ".3g"));
  if (!errors.empty()) text += section("errors", errors);
  std::vector<std::string> refused;
  for (const RefusedCount& count : tuned.tuning.refused) refused.push_back(refused_line(count));
  if (!refused.empty()) text += section("refused", internal::joined(refused, "\n"));
  text += section("held out", held_out(tuned.tuning.holdout));
  if (!tuned.tuning.accuracy.empty()) text += section("accuracy", accuracy_table(tuned.tuning));
  if (tuned.tuning.agreement)
    text += section("compared", agreement_table(*tuned.tuning.agreement, fit));
  if (!tuned.tuning.warnings.empty())
    text += section("warning", internal::joined(tuned.tuning.warnings, "\n"));
  std::string verdict = to_string(tuned.tuning.verdict);
  for (const std::string& reason : tuned.tuning.reasons) verdict += "\n" + reason;
  return text + section("verdict", verdict);
}

}  // namespace quadtune::report
