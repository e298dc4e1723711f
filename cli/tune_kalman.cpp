// SPDX-License-Identifier: Apache-2.0
/// quadtune tune kalman: noise covariances from logs, with a verdict.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <ostream>
#include <set>

#include "arguments/log_arguments.hpp"
#include "arguments/read_number.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/estimation/log_signals.hpp"
#include "quadtune/estimation/record_of_log.hpp"
#include "quadtune/estimation/rigid_body_filter.hpp"
#include "quadtune/exports/file_set.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "report/logs/log_report.hpp"
#include "report/logs/tune_report.hpp"
#include "report/logs/tune_story.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string model, file, report, method = "ml";
  std::vector<std::string> logs, maps, truths, fixed, starts_at;
  LogArguments log;
  double holdout = 0.2;
  double gate = 0, student = 0;
  std::optional<double> budget;
  std::uint64_t starts = 3;
  bool profile = false, force = false;
};

[[noreturn]] void refuse(const char* option, const std::string& why) {
  throw UsageError(fmt::format("quadtune tune: {}", why), option);
}

NoiseMethod noise_method(const std::string& name) {
  if (name == "ml") return NoiseMethod::likelihood;
  if (name == "als") return NoiseMethod::autocovariances;
  refuse("--method",
         fmt::format("--method: '{}' came, expected ml or als", internal::printable(name)));
}

/// NAME=WORD.
std::pair<std::string, std::string> named_word(const std::string& text, const char* option,
                                               const char* name, const char* word) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    refuse(option, fmt::format("{}: '{}' came, expected {}={}", option, internal::printable(text),
                               name, word));
  return {text.substr(0, equals), text.substr(equals + 1)};
}

FilterModel model_of(const Options& options) {
  if (options.model.empty())
    refuse("--model", "--model is missing, expected a filter model's name or file");
  FilterModel model = load_filter_model(options.model);
  for (const std::string& name : options.fixed)
    model.parameters[static_cast<std::size_t>(parameter_index(model, name, "--fix"))].fixed = true;
  for (const std::string& text : options.starts_at) {
    const auto [name, word] = named_word(text, "--start", "NAME", "NUMBER");
    double value = 0;
    if (!read_number(word, value))
      refuse("--start", fmt::format("--start: '{}' came for {}, expected a number",
                                    internal::printable(word), name));
    model.parameters[static_cast<std::size_t>(parameter_index(model, name, "--start"))].start =
        value;
  }
  for (FilterSensor& sensor : model.sensors) {
    if (options.gate != 0) sensor.gate = options.gate;
    if (options.student != 0) sensor.student = options.student;
  }
  validate(model, options.gate != 0 || options.student != 0 ? "--gate, --student" : "--start");
  return model;
}

/// Which channel feeds which input or output: as --map says. Of the others an input is fed by the
/// channel of its name; so are the outputs, where --map names none of them.
struct Mapping {
  std::vector<std::pair<std::string, std::string>> named;
  std::vector<Signal> by_name;
};

Mapping mapping(const Options& options, const FilterModel& model) {
  Mapping map;
  map.named.reserve(options.maps.size());
  for (const std::string& text : options.maps)
    map.named.push_back(named_word(text, "--map", "NAME", "CHANNEL"));
  const auto mapped = [&map](const Signal& signal) {
    return std::any_of(map.named.begin(), map.named.end(),
                       [&](const auto& pair) { return pair.first == signal.name; });
  };
  std::vector<Signal> outputs;
  std::copy_if(model.inputs.begin(), model.inputs.end(), std::back_inserter(map.by_name),
               [&](const Signal& input) { return !mapped(input); });
  for (const FilterSensor& sensor : model.sensors)
    outputs.insert(outputs.end(), sensor.outputs.begin(), sensor.outputs.end());
  if (std::none_of(outputs.begin(), outputs.end(), mapped))
    map.by_name.insert(map.by_name.end(), outputs.begin(), outputs.end());
  return map;
}

/// Entries of θ that a covariance depends on.
std::set<int> parameters_of(const CovarianceModel& covariance) {
  std::set<int> result;
  for (const ScaledCovariance& term : covariance.scaled) result.insert(term.parameter);
  for (const FullCovariance& term : covariance.full) {
    const auto n = static_cast<int>(term.entries.size());
    for (int i = 0; i < n * (n + 1) / 2; ++i) result.insert(term.first_parameter + i);
  }
  return result;
}

/// What no channel measures stays as it is, and that is said.
void leave_unmeasured(FilterModel& model, const std::vector<TunedLog>& logs, Context& context) {
  const auto measured = [&](const FilterSensor& sensor) {
    return std::any_of(sensor.outputs.begin(), sensor.outputs.end(), [&](const Signal& output) {
      return std::any_of(logs.begin(), logs.end(), [&](const TunedLog& log) {
        return std::any_of(log.channels.begin(), log.channels.end(),
                           [&](const TunedChannel& use) { return use.signal == output.name; });
      });
    });
  };
  std::set<int> known = parameters_of(model.Q);
  for (const FilterSensor& sensor : model.sensors)
    if (measured(sensor)) known.merge(parameters_of(sensor.R));
  for (const FilterSensor& sensor : model.sensors)
    for (const int i : parameters_of(sensor.R)) {
      NoiseParameter& p = model.parameters[static_cast<std::size_t>(i)];
      if (p.fixed || known.contains(i)) continue;
      p.fixed = true;
      context.note(
          fmt::format("tune: {} stays as it is: no measurements of {}", p.name, sensor.name));
    }
}

/// Channels of one file, their times after `epoch_s` of the first file read.
/// @param states  for each place the state that it is a truth for; empty for a measurement
/// @return  what its reader warns of
std::vector<std::string> read_file(const std::string& file, const FilterModel& model,
                                   const std::vector<ChannelPlace>& places,
                                   const std::vector<std::string>& states,
                                   const LogOptions& log_options,
                                   std::optional<std::int64_t>& epoch_s,
                                   std::vector<ChannelUse>& uses, const Context& context) {
  std::vector<std::string> channels;
  for (const ChannelPlace& place : places)
    if (place.file == file) channels.push_back(place.channel);
  LogChannels log = read_channels(file, channels, log_options);
  if (!epoch_s) epoch_s = log.epoch_s;
  const auto offset = static_cast<double>(log.epoch_s - *epoch_s);
  std::size_t next = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i].file != file) continue;
    if (!states[i].empty()) require_same_world(file, model, states[i], log.groups);
    uses[i].series = std::move(log.series[next++]);
    for (double& t : uses[i].series.time) t += offset;
  }
  return tell_log_warnings(log.condition, file, "tune", context);
}

std::string with_unit(const std::string& channel, const std::string& unit) {
  return unit.empty() ? channel : fmt::format("{} [{}]", channel, unit);
}

TunedLog read_log(const std::string& path, const FilterModel& model, const Options& options,
                  const Mapping& map, std::vector<LeftOutRecord>& left_out, Context& context) {
  const LogOptions log_options = cli::log_options(options.log, "tune");
  std::vector<ChannelPlace> places;
  std::vector<ChannelUse> uses;
  std::vector<std::string> files, states;
  auto all = map.named;
  for (const std::string& text : options.truths)
    all.push_back(named_word(text, "--truth", "STATE", "CHANNEL"));
  for (const auto& [signal, word] : all) {
    states.push_back(places.size() < map.named.size() ? "" : signal);
    places.push_back(channel_place(word, path));
    uses.push_back({signal, {}});
    if (std::find(files.begin(), files.end(), places.back().file) == files.end())
      files.push_back(places.back().file);
  }
  TunedLog result;
  std::optional<std::int64_t> epoch_s;
  std::vector<ChannelUse> fed;
  if (!map.by_name.empty()) {
    FedSignals log = [&] {
      try {
        return read_signals_by_name(path, model, map.by_name, log_options);
      } catch (const UnknownChannel& lacking) {
        throw lacks_channel(lacking);
      }
    }();
    if (std::find(files.begin(), files.end(), path) == files.end()) {
      result.warnings = tell_log_warnings(log.condition, path, "tune", context);
      files.insert(files.begin(), path);
    }
    epoch_s = log.epoch_s;
    for (FedSignal& signal : log.signals) {
      result.channels.push_back(
          {signal.use.signal, with_unit(signal.from, signal.use.series.unit), path});
      fed.push_back(std::move(signal.use));
    }
  }
  for (const std::string& file : files) {
    if (std::any_of(places.begin(), places.end(),
                    [&](const ChannelPlace& place) { return place.file == file; }))
      for (std::string& line :
           read_file(file, model, places, states, log_options, epoch_s, uses, context))
        result.warnings.push_back(std::move(line));
    result.files.push_back({file, sha256_of_file(file)});
  }
  const std::size_t truths = map.named.size();
  for (std::size_t i = 0; i < uses.size(); ++i)
    result.channels.push_back({(i < truths ? "" : "truth of ") + uses[i].signal,
                               with_unit(uses[i].series.name, uses[i].series.unit),
                               places[i].file});
  const auto first_truth = uses.begin() + static_cast<std::ptrdiff_t>(truths);
  fed.insert(fed.end(), std::make_move_iterator(uses.begin()),
             std::make_move_iterator(first_truth));
  result.records = records_of_log(model, fed, path, {first_truth, uses.end()}, &left_out);
  return result;
}

/// One line that is written over while the search goes on; on a terminal only.
class Progress {
 public:
  explicit Progress(const Context& context)
      : shown_(!context.quiet && !context.json && isatty(STDERR_FILENO) != 0),
        err_(context.err),
        begin_(Clock::now()),
        next_(begin_) {}
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress() {
    if (drawn_) err_ << "\r\033[K" << std::flush;
  }

  void show(int round, int evaluations, double best) {
    const Clock::time_point now = Clock::now();
    if (!shown_ || now < next_) return;
    next_ = now + std::chrono::milliseconds(100);
    err_ << fmt::format(
                "\r\033[Ktune: fit {}, {} evaluations, best log-likelihood {:.8g}, {:.0f} s", round,
                evaluations, best, std::chrono::duration<double>(now - begin_).count())
         << std::flush;
    drawn_ = true;
  }

 private:
  using Clock = std::chrono::steady_clock;
  bool shown_, drawn_ = false;
  std::ostream& err_;
  Clock::time_point begin_, next_;
};

NoiseTuning tuned(const FilterModel& model, const std::vector<FilterRecord>& records,
                  const Options& options, const Context& context) {
  Progress progress(context);
  NoiseTuningOptions settings;
  settings.method = noise_method(options.method);
  settings.holdout = options.holdout;
  if (options.budget) settings.seconds = *options.budget;
  settings.progress = [&](int round, int evaluations, double best) {
    progress.show(round, evaluations, best);
  };
  settings.fit.starts = static_cast<int>(std::min<std::uint64_t>(options.starts, 1000));
  settings.fit.seed = context.seed;
  settings.fit.profile = options.profile;
  settings.fit.threads = context.threads;
  settings.fit.interrupted = interrupted;
  settings.keep_records = !options.report.empty();
  return model.linear() ? tune_noise(model, records, settings)
                        : tune_noise(*nonlinear_filter(model, records, interrupted), settings);
}

void run(const Options& options, Context& context) {
  FilterModel model = model_of(options);
  (void)noise_method(options.method);  // refused before a long log is read
  if (!options.report.empty() && !options.report.ends_with(".html"))
    refuse("--report", fmt::format("--report is '{}', expected a name that ends in .html",
                                   internal::printable(options.report)));
  if (!options.report.empty() && options.report == options.file)
    refuse("--report", "--report and -o are one file, expected two");
  if (options.logs.empty()) refuse("--log", "--log is missing, expected a log of the sensors");
  if (!(options.holdout >= 0 && options.holdout <= 0.9))
    refuse("--holdout", fmt::format("--holdout is {}, expected 0 to 0.9", options.holdout));
  for (const std::string& path : options.logs)
    if (path == "-")
      refuse("--log", "--log is -, expected a file because it is read twice, once for its hash");
  const Mapping map = mapping(options, model);
  std::vector<TunedLog> logs;
  std::vector<LeftOutRecord> left_out;
  for (const std::string& path : options.logs)
    logs.push_back(read_log(path, model, options, map, left_out, context));
  leave_unmeasured(model, logs, context);
  std::vector<FilterRecord> joined;
  if (logs.size() > 1)  // one log's may be long: no second copy
    for (const TunedLog& log : logs)
      joined.insert(joined.end(), log.records.begin(), log.records.end());
  const std::vector<FilterRecord>& records = logs.size() > 1 ? joined : logs.front().records;
  std::optional<KeepsTheBest> keeps_the_best(std::in_place);
  NoiseTuning tuning = tuned(model, records, options, context);
  tuning.left_out.insert(tuning.left_out.begin(), left_out.begin(), left_out.end());
  if (tuning.fit.status == NoiseFitStatus::not_computed)
    throw NoSolution("tune: " + tuning.fit.culprit, options.model);
  const TuneReport report{model, logs, tuning};
  const bool passed = tuning.verdict == CheckVerdict::pass;
  // After an interrupt what was found is still told and written: that is little work.
  const bool ended = tuning.fit.status == NoiseFitStatus::interrupted || interrupted();
  const std::function<bool()> stop = ended ? nullptr : std::function<bool()>(interrupted);
  // First, so that a file that cannot be written does not take a long search with it.
  context.out << (context.json ? internal::readable(to_json(report)) + "\n" : to_text(report))
              << std::flush;
  context.answered = true;
  if (!options.file.empty() && (passed || options.force)) {
    write_file(options.file, tuned_file(report, context.command), stop);
    context.written.push_back(options.file);
  }
  keeps_the_best.reset();  // what was found is told: the page may be given up at any time
  if (!options.report.empty() && !ended) {
    write_file(options.report, html(page_of(report, options.holdout, context.seed, context.threads,
                                            context.command, interrupted)));
    context.written.push_back(options.report);
  }
  if (ended) throw Interrupted();
  if (!passed) throw AnswerIsNo("tune: " + tuning.reasons.front());
}

void add_options(CommandLine& line, Options& options) {
  line.add_option("--model", options.model, "a built-in filter model, or a file")
      ->type_name("NAME|FILE");
  const auto many = [&line](const char* name, std::vector<std::string>& into,
                            const char* description, const char* type) {
    line.add_list(name, into, description)->type_name(type);
  };
  many("--log", options.logs, "a log; several: repeat the option", "FILE");
  many("--map", options.maps,
       "the channel of an input or measurement that is called otherwise, of another log of "
       "the same flight as CHANNEL@FILE",
       "NAME=CHANNEL");
  many("--truth", options.truths,
       "the channel of what a state truly was, or of the attitude as qw qx qy qz: the filter's "
       "errors are judged by it and told in its units",
       "STATE=CHANNEL");
  line.add_option("--method", options.method,
                  "ml: most likely; als: least squares of the innovations' autocovariances; ml")
      ->type_name("ml|als");
  many("--fix", options.fixed, "leave a parameter as it is", "NAME");
  many("--start", options.starts_at, "the variance that the search begins with", "NAME=NUMBER");
  add_log_options(line, options.log);
  line.add_number("--holdout", options.holdout,
                  "share of each log, its end, that is kept for the verdict; 0.2")
      ->type_name("SHARE");
  line.add_number("--gate", options.gate,
                  "refuse measurements whose squared innovation is more variances than this")
      ->type_name("LIMIT");
  line.add_number("--student", options.student,
                  "degrees of freedom of measurement errors with long tails")
      ->type_name("NU");
  line.add_count("--starts", options.starts, 1, "searches from different starts; 3")
      ->type_name("N");
  line.add_positive("--budget", options.budget,
                    "seconds after which the search ends with the best it has; no end")
      ->type_name("S");
  line.add_flag("--profile", options.profile,
                "intervals by the likelihood's profile, not by its curvature");
  line.add_option("-o", options.file, "the tuned model, where the verdict is pass")
      ->type_name("FILE");
  line.add_option("--report", options.report, "write a page to look at: a .html file")
      ->type_name("FILE");
  line.add_flag("--force", options.force, "write it whatever the verdict; it says so");
}

}  // namespace

Verb tune_kalman_verb() {
  return {"tune kalman", "--model NAME|FILE --log FILE... [--map NAME=CHANNEL]...",
          "find a filter's noise covariances from logs, with a verdict",
          "quadtune tune kalman --model altitude --log docs/examples/bobbing.csv",
          [](CommandLine& line) -> Action {
            auto options = std::make_shared<Options>();
            add_options(line, *options);
            return [options](Context& context) { run(*options, context); };
          }};
}

}  // namespace quadtune::cli
