// SPDX-License-Identifier: Apache-2.0
#include "report/logs/tune_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/text_file.hpp"
#include "report/text/print.hpp"

namespace quadtune::report {
namespace {

using Eigen::Index;
using internal::finite_or_null;
using internal::Json;

/// Longest command or path that a tuned file repeats whole.
constexpr std::size_t kCommentLength = 4096;

std::string figure(double value, int digits = 4) {
  return std::isfinite(value) ? fmt::format("{:.{}g}", value, digits) : "-";
}

Index samples_of(const TunedLog& log) {
  Index count = 0;
  for (const FilterRecord& record : log.records) count += record.samples();
  return count;
}

std::string names_of(const TunedLog& log) {
  std::string names;
  for (const TunedFile& file : log.files) names += (names.empty() ? "" : " with ") + file.path;
  return names;
}

double seconds_of(const TunedLog& log) {
  double sum = 0;
  for (const FilterRecord& record : log.records) sum += record.time.back() - record.time.front();
  return sum;
}

Json checks_to_json(const Consistency& consistency, const std::string& name) {
  Json checks = Json::array();
  for (const ConsistencyCheck& c : consistency.checks) {
    if (c.name != name) continue;
    Json json;
    json["output"] = c.output;
    json["value"] = finite_or_null(c.value);
    json["low"] = finite_or_null(c.low);
    json["high"] = finite_or_null(c.high);
    json["p"] = finite_or_null(c.p);
    json["verdict"] = to_string(c.verdict);
    checks.push_back(std::move(json));
  }
  return checks;
}

/// Columns under their titles, the first and the last to the left.
std::string aligned(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths(rows.front().size(), 0);
  for (const auto& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const bool left = i == 0 || i + 1 == row.size();
      line += (i > 0 ? "  " : "") + (left ? fmt::format("{:<{}}", row[i], widths[i])
                                          : fmt::format("{:>{}}", row[i], widths[i]));
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += (text.empty() ? "" : "\n") + line;
  }
  return text;
}

std::string parameter_table(const TuneReport& report) {
  std::vector<std::vector<std::string>> rows = {
      {"parameter", "before", "found", "from", "to", "unit"}};
  for (std::size_t i = 0; i < report.tuning.fit.parameters.size(); ++i) {
    const FittedParameter& p = report.tuning.fit.parameters[i];
    std::string about = p.unit;
    if (p.verdict != ParameterVerdict::seen)
      about += fmt::format("{}({})", about.empty() ? "" : " ", to_string(p.verdict));
    rows.push_back({p.name, figure(report.model.parameters[i].start), figure(p.value),
                    figure(p.low), figure(p.high), about});
  }
  return aligned(rows);
}

std::string innovation_table(const NoiseTuning& tuning) {
  std::vector<std::vector<std::string>> rows = {
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
         i < tuning.before.outputs.size() ? figure(tuning.before.outputs[i].size, 3) : "-",
         figure(s.size, 3), figure(s.mean, 2), figure(s.autocorrelation(worst), 2),
         fmt::format("{}", worst + 1), figure(s.kurtosis, 2), ""});
  }
  return aligned(rows);
}

Json to_json(const AutocovarianceFit& als) {
  Json json;
  json["samples"] = als.samples;
  json["dt"] = als.innovation.dt;
  json["lags"] = als.innovation.of.size() - 1;
  json["gains"] = als.passes;
  json["misfit"] = finite_or_null(als.misfit);
  json["degrees"] = als.degrees;
  return json;
}

std::string held_out(const HoldOut& holdout) {
  if (holdout.innovations == 0) return "nothing";
  return fmt::format("{} innovations, log-likelihood of each {} before, {} after",
                     holdout.innovations, figure(holdout.before, 5), figure(holdout.after, 5));
}

std::string log_line(const TunedLog& log) {
  return fmt::format(
      "{}: {} instants, {:.6g} s{}", names_of(log), samples_of(log), seconds_of(log),
      log.records.size() > 1 ? fmt::format(", in {} stretches", log.records.size()) : "");
}

/// "height: sonar [m]", one a line; a channel of another log of the flight with its file.
std::string channel_lines(const TunedLog& log) {
  std::string lines;
  for (const TunedChannel& channel : log.channels)
    lines += fmt::format("{}{}: {}{}", lines.empty() ? "" : "\n", channel.signal, channel.channel,
                         log.files.size() > 1 ? " of " + channel.file : "");
  return lines;
}

Json to_json(const NoiseAgreement& agreement, const NoiseFit& fit) {
  Json json;
  json["method"] = to_string(agreement.other);
  if (!agreement.not_compared.empty()) {
    json["not_compared"] = agreement.not_compared;
    return json;
  }
  json["parameters"] = Json::array();
  for (std::size_t i = 0; i < agreement.parameters.size(); ++i) {
    const ParameterAgreement& p = agreement.parameters[i];
    if (fit.parameters[i].verdict == ParameterVerdict::fixed) continue;
    json["parameters"].push_back({{"name", p.other.name},
                                  {"value", finite_or_null(p.other.value)},
                                  {"low", finite_or_null(p.other.low)},
                                  {"high", finite_or_null(p.other.high)},
                                  {"verdict", to_string(p.other.verdict)},
                                  {"factor", finite_or_null(p.factor)},
                                  {"standard_deviations", finite_or_null(p.deviations)},
                                  {"disagrees", p.disagrees}});
  }
  return json;
}

/// What the other method finds, beside how far that is from what was found.
std::string agreement_table(const NoiseAgreement& agreement, const NoiseFit& fit) {
  if (!agreement.not_compared.empty())
    return fmt::format("not with {}: {}", to_string(agreement.other), agreement.not_compared);
  std::vector<std::vector<std::string>> rows = {
      {"by " + to_string(agreement.other), "found", "from", "to", "factor", "std. dev.", ""}};
  for (std::size_t i = 0; i < agreement.parameters.size(); ++i) {
    const ParameterAgreement& p = agreement.parameters[i];
    if (fit.parameters[i].verdict == ParameterVerdict::fixed) continue;
    rows.push_back({p.other.name, figure(p.other.value), figure(p.other.low), figure(p.other.high),
                    figure(p.factor, 3), figure(p.deviations, 3), p.disagrees ? "disagrees" : ""});
  }
  return aligned(rows);
}

/// Radians also in degrees.
std::string error_figure(double value, const std::string& unit) {
  if (unit != "rad") return fmt::format("{} {}", figure(value, 4), unit);
  return fmt::format("{} rad = {} deg", figure(value, 4), figure(degrees(value), 4));
}

bool some_held_out(const NoiseTuning& tuning) {
  return std::any_of(tuning.accuracy.begin(), tuning.accuracy.end(),
                     [](const StateAccuracy& state) { return state.held_out; });
}

std::string accuracy_table(const NoiseTuning& tuning) {
  std::vector<std::vector<std::string>> rows = {
      {"rms error", "samples", "before", "after", "change", ""}};
  for (const StateAccuracy& state : tuning.accuracy)
    rows.push_back(
        {state.state, fmt::format("{}", state.samples), error_figure(state.before, state.unit),
         error_figure(state.after, state.unit),
         state.before > 0 ? fmt::format("{:+.1f} %", 100 * (state.after / state.before - 1)) : "-",
         state.held_out || !some_held_out(tuning) ? "" : "fitted part"});
  return aligned(rows) +
         (some_held_out(tuning) ? "\non the stretch held out" : "\non the part that was fitted");
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
                              {"before", finite_or_null(state.before)},
                              {"after", finite_or_null(state.after)},
                              {"p", finite_or_null(state.p)}});
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
    return fmt::format("{} after {} evaluations; {} of {} searches end there{}",
                       to_string(fit.status), fit.evaluations, fit.agreeing, fit.starts, rounds);
  const AutocovarianceFit& als = *tuning.autocovariances;
  return fmt::format(
      "{} by autocovariances: {:.0f} samples every {:.6g} s, lags to {}, {} gains{}\n"
      "misfit {} of {} degrees of freedom",
      to_string(als.status), als.samples, als.innovation.dt, als.innovation.of.size() - 1,
      als.passes, rounds, figure(als.misfit), als.degrees);
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
  return fmt::format("log {} before, {} after", figure(fit.before.value, 8),
                     figure(fit.after.value, 8));
}

}  // namespace

namespace {

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

}  // namespace

std::vector<std::pair<std::string, std::string>> facts_of(const TuneReport& report) {
  const NoiseFit& fit = report.tuning.fit;
  std::vector<std::pair<std::string, std::string>> facts;
  for (const TunedLog& log : report.logs) {
    facts.emplace_back("log", log_line(log));
    for (const TunedFile& file : log.files) facts.emplace_back("sha256", file.sha256);
    for (const TunedChannel& channel : log.channels)
      facts.emplace_back("channel", fmt::format("{}: {}{}", channel.signal, channel.channel,
                                                log.files.size() > 1 ? " of " + channel.file : ""));
    for (const std::string& warning : log.warnings) facts.emplace_back("warning", warning);
  }
  if (!report.tuning.left_out.empty())
    facts.emplace_back("left out", left_out_lines(report.tuning.left_out));
  facts.emplace_back("fit", fit_line(report.tuning));
  facts.emplace_back("likelihood", likelihood_line(fit));
  for (const RefusedCount& count : report.tuning.refused)
    facts.emplace_back("refused",
                       fmt::format("{}: {} of {}", count.output, count.refused, count.measured));
  facts.emplace_back("held out", held_out(report.tuning.holdout));
  for (const StateAccuracy& state : report.tuning.accuracy)
    facts.emplace_back(
        state.held_out ? "rms error, held out" : "rms error",
        fmt::format("{}: {} before, {} after", state.state, error_figure(state.before, state.unit),
                    error_figure(state.after, state.unit)));
  if (report.tuning.agreement && report.tuning.agreement->not_compared.empty())
    for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
      const ParameterAgreement& p = report.tuning.agreement->parameters[i];
      if (!std::isfinite(p.factor)) continue;
      facts.emplace_back(
          "by " + to_string(report.tuning.agreement->other),
          fmt::format("{}: {} ({} to {}), a factor of {}, {} standard deviations", p.other.name,
                      figure(p.other.value), figure(p.other.low), figure(p.other.high),
                      figure(p.factor, 3), figure(p.deviations, 3)));
    }
  return facts;
}

Json to_json(const TuneReport& report) {
  const NoiseTuning& tuning = report.tuning;
  const NoiseFit& fit = tuning.fit;
  Json json;
  json["model"] = report.model.name;
  json["method"] = tuning.autocovariances ? "als" : "ml";
  if (tuning.autocovariances) json["autocovariances"] = to_json(*tuning.autocovariances);
  json["status"] = to_string(fit.status);
  for (const TunedLog& log : report.logs)
    json["logs"].push_back({{"files", files_to_json(log)},
                            {"channels", channels_to_json(log)},
                            {"samples", samples_of(log)},
                            {"duration_s", seconds_of(log)},
                            {"records", log.records.size()},
                            {"warnings", log.warnings}});
  json["Q"] = internal::matrix_to_json(covariance(report.model.Q, fit.theta), "Q");
  for (const FilterSensor& sensor : report.model.sensors)
    json["R"][sensor.name] = internal::matrix_to_json(covariance(sensor.R, fit.theta), "R");
  for (const FittedParameter& p : fit.parameters) {
    json["parameters"].push_back({{"name", p.name},
                                  {"unit", p.unit},
                                  {"value", finite_or_null(p.value)},
                                  {"low", finite_or_null(p.low)},
                                  {"high", finite_or_null(p.high)},
                                  {"verdict", to_string(p.verdict)}});
    json["standard_errors"][p.name] = finite_or_null(p.standard_error);
    json["identifiable"].push_back(p.verdict == ParameterVerdict::seen ||
                                   p.verdict == ParameterVerdict::at_zero);
  }
  json["unseen"] = fit.unseen;
  json["log_likelihood"] = {{"before", finite_or_null(fit.before.value)},
                            {"after", finite_or_null(fit.after.value)}};
  json["evaluations"] = fit.evaluations;
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
  json["rounds"] = tuning.rounds;
  json["left_out"] = Json::array();
  for (const LeftOutRecord& record : tuning.left_out)
    json["left_out"].push_back({{"record", record.name},
                                {"from_s", record.from},
                                {"to_s", record.to},
                                {"measurements", record.measurements}});
  json["holdout"] = {{"innovations", tuning.holdout.innovations},
                     {"before", finite_or_null(tuning.holdout.before)},
                     {"after", finite_or_null(tuning.holdout.after)}};
  json["accuracy"] = accuracy_to_json(tuning);
  if (tuning.agreement) json["agreement"] = to_json(*tuning.agreement, fit);
  json["warnings"] = tuning.warnings;
  json["gate"] = {{"verdict", to_string(tuning.verdict)}, {"reasons", tuning.reasons}};
  return json;
}

std::string to_text(const TuneReport& report) {
  const NoiseFit& fit = report.tuning.fit;
  std::string logs;
  for (const TunedLog& log : report.logs) logs += (logs.empty() ? "" : "\n") + log_line(log);
  std::string text =
      section("model", fmt::format("{}: {}", report.model.name, report.model.description)) +
      section("logs", logs);
  std::string channels;
  for (const TunedLog& log : report.logs)
    if (const std::string lines = channel_lines(log); channels.find(lines) == std::string::npos)
      channels += (channels.empty() ? "" : "\n") + lines;
  text += section("channels", channels);
  if (!report.tuning.left_out.empty())
    text += section("left out", left_out_lines(report.tuning.left_out));
  text += section("fit", fit_line(report.tuning));
  text += section("noise", parameter_table(report));
  if (!fit.unseen.empty())
    text += section("not seen", fmt::format("{}", internal::joined(fit.unseen, "\n")));
  text += section("likelihood", likelihood_line(fit));
  if (!report.tuning.after.outputs.empty())
    text += section("innovations", innovation_table(report.tuning));
  std::string errors;
  for (const ConsistencyCheck& c : report.tuning.after.checks)
    if (c.name == "error")
      errors += fmt::format("{}{}: squared error {} times its variance, consistent {} to {}",
                            errors.empty() ? "" : "\n", c.output, figure(c.value, 3),
                            figure(c.low, 3), figure(c.high, 3));
  if (!errors.empty()) text += section("errors", errors);
  std::string refused;
  for (const RefusedCount& count : report.tuning.refused)
    refused += fmt::format("{}{}: {} of {}", refused.empty() ? "" : "\n", count.output,
                           count.refused, count.measured);
  if (!refused.empty()) text += section("refused", refused);
  text += section("held out", held_out(report.tuning.holdout));
  if (!report.tuning.accuracy.empty()) text += section("accuracy", accuracy_table(report.tuning));
  if (report.tuning.agreement)
    text += section("compared", agreement_table(*report.tuning.agreement, fit));
  if (!report.tuning.warnings.empty())
    text += section("warning", fmt::format("{}", internal::joined(report.tuning.warnings, "\n")));
  std::string verdict = to_string(report.tuning.verdict);
  for (const std::string& reason : report.tuning.reasons) verdict += "\n" + reason;
  return text + section("verdict", verdict);
}

std::string tuned_file(const TuneReport& report, const std::string& command) {
  std::vector<std::string> comments = {"By " + internal::printable(command, kCommentLength)};
  for (const TunedLog& log : report.logs)
    for (const TunedFile& file : log.files)
      comments.push_back(fmt::format("log {} sha256 {}",
                                     internal::printable(file.path, kCommentLength), file.sha256));
  for (const TunedLog& log : report.logs) {
    for (const std::string& warning : log.warnings)
      comments.push_back("warning: " + internal::printable(warning, kCommentLength));
    for (const TunedChannel& channel : log.channels)
      comments.push_back(fmt::format("{}: {} of {}", channel.signal,
                                     internal::printable(channel.channel, kCommentLength),
                                     internal::printable(channel.file, kCommentLength)));
  }
  for (const FittedParameter& p : report.tuning.fit.parameters)
    comments.push_back(fmt::format("{}: {} ({} to {}), {}", p.name, figure(p.value, 6),
                                   figure(p.low, 6), figure(p.high, 6), to_string(p.verdict)));
  comments.push_back(fmt::format("verdict: {}", to_string(report.tuning.verdict)));
  for (const std::string& reason : report.tuning.reasons) comments.push_back("  " + reason);
  for (const std::string& warning : report.tuning.warnings)
    comments.push_back("warning: " + warning);
  FilterModel tuned = with_noise(report.model, report.tuning.fit.theta);
  for (const FittedParameter& p : report.tuning.fit.parameters)
    for (NoiseParameter& parameter : tuned.parameters)
      if (parameter.name == p.name && parameter.logarithmic && p.low > 0 && p.low < p.high &&
          std::isfinite(p.high))
        parameter.interval = {p.low, p.high};
  tuned.verdict = to_string(report.tuning.verdict);
  return text_of_filter_model(tuned, comments);
}

}  // namespace quadtune::report
