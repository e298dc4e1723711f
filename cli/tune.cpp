// SPDX-License-Identifier: Apache-2.0
/// quadtune tune kalman: noise covariances from logs, with a verdict.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <optional>
#include <ostream>

#include "log_arguments.hpp"
#include "number_arguments.hpp"
#include "program.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/estimation/record_of_log.hpp"
#include "quadtune/exports/file_set.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/logs/flight_log.hpp"
#include "tune_report.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string what, model, file;
  std::vector<std::string> logs, maps, fixed, starts_at;
  LogArguments log;
  double holdout = 0.2;
  std::uint64_t starts = 3;
  bool profile = false, force = false;
};

[[noreturn]] void refuse(const char* option, const std::string& why) {
  throw UsageError(fmt::format("quadtune tune: {}", why), option);
}

/// NAME=WORD.
std::pair<std::string, std::string> named_word(const std::string& text, const char* option,
                                               const char* what) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    refuse(option,
           fmt::format("{}: '{}' came, expected NAME={}", option, internal::printable(text), what));
  return {text.substr(0, equals), text.substr(equals + 1)};
}

FilterModel model_of(const Options& options) {
  if (options.model.empty())
    refuse("--model", "--model is missing, expected a filter model's name or file");
  FilterModel model = load_filter_model(options.model);
  for (const std::string& name : options.fixed)
    model.parameters[static_cast<std::size_t>(parameter_index(model, name, "--fix"))].fixed = true;
  for (const std::string& text : options.starts_at) {
    const auto [name, word] = named_word(text, "--start", "NUMBER");
    double value = 0;
    if (!read_number(word, value))
      refuse("--start", fmt::format("--start: '{}' came for {}, expected a number",
                                    internal::printable(word), name));
    model.parameters[static_cast<std::size_t>(parameter_index(model, name, "--start"))].start =
        value;
  }
  validate(model, "--start");
  return model;
}

/// Which channel feeds which input or output: as --map says, else the channel of the same name.
std::vector<std::pair<std::string, std::string>> mapping(const Options& options,
                                                         const FilterModel& model) {
  std::vector<std::pair<std::string, std::string>> map;
  map.reserve(options.maps.size());
  for (const std::string& text : options.maps) map.push_back(named_word(text, "--map", "CHANNEL"));
  if (!map.empty()) return map;
  for (const Signal& input : model.inputs) map.push_back({input.name, input.name});
  for (const FilterSensor& sensor : model.sensors)
    for (const Signal& output : sensor.outputs) map.push_back({output.name, output.name});
  return map;
}

TunedLog read_log(const std::string& path, const FilterModel& model, const Options& options,
                  const std::vector<std::pair<std::string, std::string>>& map, Context& context) {
  std::vector<std::string> channels;
  channels.reserve(map.size());
  for (const auto& [signal, channel] : map) channels.push_back(channel);
  const LogChannels log = read_log_channels(path, channels, log_options(options.log, "tune"));
  if (!log.condition.whole())
    context.note(
        fmt::format("tune: warning: {} is not whole: {}", path,
                    log.condition.torn.empty() ? log.condition.first_skipped : log.condition.torn));
  std::vector<ChannelUse> uses;
  uses.reserve(map.size());
  for (std::size_t i = 0; i < map.size(); ++i) uses.push_back({map[i].first, log.series[i]});
  return {path, sha256(internal::read_text_file(path, kLogLimit)),
          records_of_log(model, uses, path)};
}

void run(const Options& options, Context& context) {
  if (options.what != "kalman")
    refuse("WHAT", fmt::format("'{}' came, expected: quadtune tune kalman{}",
                               internal::printable(options.what),
                               internal::did_you_mean(options.what, {"kalman"})));
  const FilterModel model = model_of(options);
  if (options.logs.empty()) refuse("--log", "--log is missing, expected a log of the sensors");
  if (!(options.holdout >= 0 && options.holdout <= 0.9))
    refuse("--holdout", fmt::format("--holdout is {}, expected 0 to 0.9", options.holdout));
  for (const std::string& path : options.logs)
    if (path == "-")
      refuse("--log", "--log is -, expected a file because it is read twice, once for its hash");
  const auto map = mapping(options, model);
  std::vector<TunedLog> logs;
  std::vector<FilterRecord> records;
  for (const std::string& path : options.logs) {
    logs.push_back(read_log(path, model, options, map, context));
    records.insert(records.end(), logs.back().records.begin(), logs.back().records.end());
  }
  NoiseTuningOptions settings;
  settings.holdout = options.holdout;
  settings.fit.starts = static_cast<int>(std::min<std::uint64_t>(options.starts, 1000));
  settings.fit.seed = context.seed;
  settings.fit.profile = options.profile;
  settings.fit.interrupted = [] { return interrupted(); };
  const NoiseTuning tuning = tune_noise(model, records, settings);
  if (tuning.fit.status == NoiseFitStatus::interrupted) throw Interrupted();
  if (tuning.fit.status == NoiseFitStatus::not_computed)
    throw NoSolution("tune: " + tuning.fit.culprit, options.model);
  const TuneReport report{model, logs, tuning};
  const bool passed = tuning.verdict == CheckVerdict::pass;
  if (!options.file.empty() && (passed || options.force)) {
    write_file(options.file, tuned_file(report, context.command));
    context.written.push_back(options.file);
  }
  context.out << (context.json ? internal::readable(to_json(report)) + "\n" : to_text(report));
  if (!passed) throw AnswerIsNo("tune: " + tuning.reasons.front());
}

}  // namespace

Verb tune_verb() {
  return {"tune", "kalman --model NAME|FILE --log FILE... [--map NAME=CHANNEL]...",
          "find a filter's noise covariances from logs, with a verdict",
          "quadtune tune kalman --model altitude --log docs/examples/bobbing.csv",
          [](CLI::App& app) -> Action {
            auto options = std::make_shared<Options>();
            app.add_option("WHAT", options->what, "kalman");
            app.add_option(
                   "--model", options->model,
                   "local-level, constant-velocity, altitude, velocity-xy, attitude, or a file")
                ->type_name("NAME|FILE");
            const auto many = [&app](const char* name, std::vector<std::string>& into,
                                     const char* description, const char* type) {
              app.add_option(name, into, description)
                  ->type_name(type)
                  ->take_all()
                  ->expected(1)
                  ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
            };
            many("--log", options->logs, "a log; several: repeat the option", "FILE");
            many("--map", options->maps,
                 "the channel of an input or measurement; without any, channels of the same names",
                 "NAME=CHANNEL");
            many("--fix", options->fixed, "leave a parameter as it is", "NAME");
            many("--start", options->starts_at, "the variance that the search begins with",
                 "NAME=NUMBER");
            add_log_options(app, options->log);
            add_number(app, "--holdout", options->holdout,
                       "share of each log, its end, that is kept for the verdict; 0.2")
                ->type_name("SHARE");
            add_count(app, "--starts", options->starts, 1, "searches from different starts; 3")
                ->type_name("N");
            app.add_flag("--profile", options->profile,
                         "intervals by the likelihood's profile, not by its curvature");
            app.add_option("-o", options->file, "the tuned model, where the verdict is pass")
                ->type_name("FILE");
            app.add_flag("--force", options->force, "write it whatever the verdict; it says so");
            return [options](Context& context) { run(*options, context); };
          }};
}

}  // namespace quadtune::cli
