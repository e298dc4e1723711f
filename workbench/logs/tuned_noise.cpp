// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/logs/tuned_noise.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune {
namespace {

/// Maximum length of a command or path that is repeated in a tuned file.
constexpr std::size_t kCommentLength = 4096;

std::string figure(double value) {
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : "-";
}

/// Whether a variance of 0 is the most likely, and the logs bound it. The file contains the bound: a
/// filter without process noise ignores its measurements after some time.
bool bounded_at_zero(const FittedParameter& p) {
  return p.verdict == ParameterVerdict::at_zero && p.high > 0 && std::isfinite(p.high);
}

}  // namespace

TunedNoise tune_noise(NoiseLogs logs, const NoiseTuningOptions& options) {
  std::vector<FilterRecord> joined;
  if (logs.logs.size() > 1)  // a single log may be long; it is not copied
    for (const TunedLog& log : logs.logs)
      joined.insert(joined.end(), log.records.begin(), log.records.end());
  const std::vector<FilterRecord>& records =
      logs.logs.size() > 1 ? joined : logs.logs.front().records;
  NoiseTuning tuning =
      logs.model.linear()
          ? tune_noise(logs.model, records, options)
          : tune_noise(*nonlinear_filter(logs.model, records, options.fit.interrupted), options);
  tuning.left_out.insert(tuning.left_out.begin(), logs.left_out.begin(), logs.left_out.end());
  return {std::move(logs.model), std::move(logs.logs), std::move(tuning)};
}

std::string tuned_model_file(const TunedNoise& tuned, const std::string& command) {
  std::vector<std::string> comments = {"By " + internal::printable(command, kCommentLength)};
  for (const TunedLog& log : tuned.logs)
    for (const TunedFile& file : log.files)
      comments.push_back(fmt::format("log {} sha256 {}",
                                     internal::printable(file.path, kCommentLength), file.sha256));
  for (const TunedLog& log : tuned.logs) {
    for (const std::string& warning : log.warnings)
      comments.push_back("warning: " + internal::printable(warning, kCommentLength));
    for (const TunedChannel& channel : log.channels)
      comments.push_back(fmt::format("{}: {} of {}", channel.signal,
                                     internal::printable(channel.channel, kCommentLength),
                                     internal::printable(channel.file, kCommentLength)));
  }
  for (const FittedParameter& p : tuned.tuning.fit.parameters)
    comments.push_back(fmt::format("{}: {} ({} to {}), {}{}", p.name, figure(p.value),
                                   figure(p.low), figure(p.high), to_string(p.verdict),
                                   bounded_at_zero(p) ? "; the upper bound is used" : ""));
  comments.push_back(fmt::format("verdict: {}", to_string(tuned.tuning.verdict)));
  for (const std::string& reason : tuned.tuning.reasons) comments.push_back("  " + reason);
  for (const std::string& warning : tuned.tuning.warnings)
    comments.push_back("warning: " + warning);
  FilterModel model = with_noise(tuned.model, tuned.tuning.fit.theta);
  for (const FittedParameter& p : tuned.tuning.fit.parameters)
    for (NoiseParameter& parameter : model.parameters) {
      if (parameter.name != p.name || !parameter.logarithmic) continue;
      if (bounded_at_zero(p)) parameter.start = p.high;
      if (p.low > 0 && p.low < p.high && std::isfinite(p.high))
        parameter.interval = {p.low, p.high};
    }
  model.verdict = to_string(tuned.tuning.verdict);
  return text_of_filter_model(model, comments);
}

}  // namespace quadtune
