// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/logs/noise_logs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <optional>
#include <set>

#include "quadtune/estimation/log_signals.hpp"
#include "quadtune/estimation/record_of_log.hpp"
#include "quadtune/exports/file_set.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/workbench/logs/channel_place.hpp"
#include "quadtune/workbench/logs/sensor_log.hpp"

namespace quadtune {
namespace {

/// Signals that use the channels with their own names.
std::vector<Signal> fed_by_name(const FilterModel& model, const std::vector<NamedChannel>& named) {
  const auto is_named = [&](const Signal& signal) {
    return std::any_of(named.begin(), named.end(),
                       [&](const NamedChannel& one) { return one.first == signal.name; });
  };
  std::vector<Signal> by_name, outputs;
  std::copy_if(model.inputs.begin(), model.inputs.end(), std::back_inserter(by_name),
               [&](const Signal& input) { return !is_named(input); });
  for (const FilterSensor& sensor : model.sensors)
    outputs.insert(outputs.end(), sensor.outputs.begin(), sensor.outputs.end());
  if (std::none_of(outputs.begin(), outputs.end(), is_named))
    by_name.insert(by_name.end(), outputs.begin(), outputs.end());
  return by_name;
}

std::string with_unit(const std::string& channel, const std::string& unit) {
  return unit.empty() ? channel : fmt::format("{} [{}]", channel, unit);
}

/// Reads the log of one flight.
class FlightReader {
 public:
  FlightReader(const std::string& path, const FilterModel& model, const NoiseLogOptions& options)
      : path_(path), model_(model), options_(options) {
    std::vector<std::string> known;
    for (const Signal& input : model.inputs) known.push_back(input.name);
    for (const FilterSensor& sensor : model.sensors)
      for (const Signal& output : sensor.outputs) known.push_back(output.name);
    for (const NamedChannel& one : options.channels) {
      if (std::find(known.begin(), known.end(), one.first) == known.end())
        throw OptionError(
            "map",
            fmt::format("map: the model '{}' has no input or measurement '{}', expected {}{}",
                        model.name, internal::printable(one.first), internal::joined(known, " or "),
                        internal::did_you_mean(one.first, known)));
      add(one, Kind::measured);
    }
    for (const NamedChannel& one : options.truths) add(one, Kind::truth);
  }

  TunedLog read(const std::vector<Signal>& by_name, std::vector<LeftOutRecord>& left_out) {
    if (!by_name.empty()) read_by_name(by_name);
    for (const std::string& file : files_) {
      if (std::any_of(uses_.begin(), uses_.end(),
                      [&](const Use& use) { return use.place.file == file; }))
        read_file(file);
      result_.files.push_back({file, sha256_of_file(file)});
    }
    std::vector<ChannelUse> truths;
    for (Use& use : uses_) {
      const LogSeries& series = use.channel.series;
      result_.channels.push_back({(use.kind == Kind::truth ? "truth of " : "") + use.channel.signal,
                                  with_unit(series.name, series.unit), use.place.file});
      (use.kind == Kind::truth ? truths : fed_).push_back(std::move(use.channel));
    }
    result_.records = records_of_log(model_, fed_, path_, truths, &left_out);
    return std::move(result_);
  }

 private:
  enum class Kind { measured, truth };

  /// A channel with its location and its use.
  struct Use {
    ChannelPlace place;
    Kind kind;
    ChannelUse channel;
  };

  void add(const NamedChannel& one, Kind kind) {
    uses_.push_back({channel_place(one.second, path_), kind, {one.first, {}}});
    const std::string& file = uses_.back().place.file;
    if (std::find(files_.begin(), files_.end(), file) == files_.end()) files_.push_back(file);
  }

  void read_by_name(const std::vector<Signal>& signals) {
    FedSignals log = [&] {
      try {
        return read_signals_by_name(path_, model_, signals, options_.reading);
      } catch (const UnknownChannel& lacking) {
        throw InvalidInput(lacking.where(), lacking.problem() +
                                                "; --map NAME=CHANNEL selects another channel, and "
                                                "CHANNEL@FILE one of another log");
      }
    }();
    if (std::find(files_.begin(), files_.end(), path_) == files_.end()) {
      result_.warnings = noted_log_warnings(log.condition, path_, options_.note);
      files_.insert(files_.begin(), path_);
    }
    epoch_s_ = log.epoch_s;
    for (FedSignal& signal : log.signals) {
      result_.channels.push_back(
          {signal.use.signal, with_unit(signal.from, signal.use.series.unit), path_});
      fed_.push_back(std::move(signal.use));
    }
  }

  /// Reads the named channels of one file; its times have the epoch of the first file.
  void read_file(const std::string& file) {
    std::vector<std::string> channels;
    for (const Use& use : uses_)
      if (use.place.file == file) channels.push_back(use.place.channel);
    LogChannels log = read_channels(file, channels, options_.reading);
    if (!epoch_s_) epoch_s_ = log.epoch_s;
    const auto offset = static_cast<double>(log.epoch_s - *epoch_s_);
    auto next = log.series.begin();
    for (Use& use : uses_) {
      if (use.place.file != file) continue;
      if (use.kind == Kind::truth) require_same_world(file, model_, use.channel.signal, log.groups);
      use.channel.series = std::move(*next++);
      for (double& t : use.channel.series.time) t += offset;
    }
    for (std::string& line : noted_log_warnings(log.condition, file, options_.note))
      result_.warnings.push_back(std::move(line));
  }

  const std::string& path_;
  const FilterModel& model_;
  const NoiseLogOptions& options_;
  std::vector<Use> uses_;
  std::vector<std::string> files_;
  std::optional<std::int64_t> epoch_s_;
  std::vector<ChannelUse> fed_;
  TunedLog result_;
};

/// Entries of θ on which a covariance depends.
std::set<int> parameters_of(const CovarianceModel& covariance) {
  std::set<int> result;
  for (const ScaledCovariance& term : covariance.scaled) result.insert(term.parameter);
  for (const FullCovariance& term : covariance.full) {
    const auto n = static_cast<int>(term.entries.size());
    for (int i = 0; i < n * (n + 1) / 2; ++i) result.insert(term.first_parameter + i);
  }
  return result;
}

bool is_measured(const FilterSensor& sensor, const std::vector<TunedLog>& logs) {
  return std::any_of(sensor.outputs.begin(), sensor.outputs.end(), [&](const Signal& output) {
    return std::any_of(logs.begin(), logs.end(), [&](const TunedLog& log) {
      return std::any_of(log.channels.begin(), log.channels.end(),
                         [&](const TunedChannel& use) { return use.signal == output.name; });
    });
  });
}

/// Fixes the parameters of sensors that no channel measures, and reports them.
void leave_unmeasured(FilterModel& model, const std::vector<TunedLog>& logs, const LogNote& note) {
  std::set<int> known = parameters_of(model.Q);
  for (const FilterSensor& sensor : model.sensors)
    if (is_measured(sensor, logs)) known.merge(parameters_of(sensor.R));
  for (const FilterSensor& sensor : model.sensors)
    for (const int i : parameters_of(sensor.R)) {
      NoiseParameter& p = model.parameters[static_cast<std::size_t>(i)];
      if (p.fixed || known.contains(i)) continue;
      p.fixed = true;
      if (note)
        note(
            fmt::format("{} is not changed: there are no measurements of {}", p.name, sensor.name));
    }
}

}  // namespace

Eigen::Index TunedLog::samples() const {
  Eigen::Index count = 0;
  for (const FilterRecord& record : records) count += record.samples();
  return count;
}

double TunedLog::seconds() const {
  double sum = 0;
  for (const FilterRecord& record : records) sum += record.time.back() - record.time.front();
  return sum;
}

NoiseLogs read_noise_logs(FilterModel model, const NoiseLogOptions& options) {
  NoiseLogs result;
  const std::vector<Signal> by_name = fed_by_name(model, options.channels);
  for (const std::string& path : options.logs)
    result.logs.push_back(FlightReader(path, model, options).read(by_name, result.left_out));
  require_different_logs(options.logs);
  leave_unmeasured(model, result.logs, options.note);
  result.model = std::move(model);
  return result;
}

}  // namespace quadtune
