// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/logs/imu_calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <utility>

#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/workbench/logs/channel_place.hpp"
#include "quadtune/workbench/logs/missing_option.hpp"
#include "quadtune/workbench/logs/sensor_log.hpp"

namespace quadtune {
namespace {

using ChannelNames = std::vector<std::string>;

/// Collects the channels to read from a log, some of which are optional.
class SensorWishes {
 public:
  /// @param given  names that the log must have; none: the default names if the log has all of them
  void add(const std::optional<ChannelNames>& given, const ChannelNames& usual) {
    wishes_.push_back({given.value_or(usual), !given, {}, 0});
    ChannelNames& into = given ? required_ : optional_;
    const ChannelNames& names = wishes_.back().names;
    wishes_.back().first = into.size();
    into.insert(into.end(), names.begin(), names.end());
  }

  void read(const std::string& path, const ImuLogOptions& options) {
    SensorLog log = read_sensors(path, required_, optional_, options.reading, options.note);
    series_ = std::move(log.series);
    warnings_ = std::move(log.warnings);
    const std::vector<const LogSeries*> present = present_series();
    if (present.empty()) return;
    // Sensors from another file have their own times.
    for (std::size_t i = 0; i < required_.size(); ++i)
      if (&series_[i] != present.front() && channel_place(required_[i], path).file != path)
        series_[i] = interpolated(series_[i], present.front()->time);
    joined_ = join(present, log_name(path));
    const auto max = std::max_element(present.begin(), present.end(), [](auto* a, auto* b) {
      return a->time.size() < b->time.size();
    });
    if (options.note && joined_.t.size() < std::ssize((*max)->time))
      options.note(
          fmt::format("warning: {} of {} samples of '{}' in {} have no sample of another channel "
                      "at the same time and are ignored",
                      std::ssize((*max)->time) - joined_.t.size(), (*max)->time.size(),
                      internal::printable((*max)->name), log_name(path)));
  }

  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
  [[nodiscard]] const Eigen::VectorXd& t() const { return joined_.t; }
  /// (0 × n) where it is absent.
  [[nodiscard]] Eigen::MatrixXd values(std::size_t wish) const {
    return joined_.values(wishes_[wish].rows, Eigen::all);
  }
  [[nodiscard]] bool has(std::size_t wish) const { return !wishes_[wish].rows.empty(); }

 private:
  struct Wish {
    ChannelNames names;
    bool usual;
    std::vector<Eigen::Index> rows;  ///< in the joined values
    std::size_t first;               ///< index among the required or the optional names
  };

  /// The series of the sensors that have all channels; stores the rows of each wish.
  std::vector<const LogSeries*> present_series() {
    std::vector<const LogSeries*> present;
    for (Wish& wish : wishes_) {
      const std::size_t first = wish.first + (wish.usual ? required_.size() : 0);
      const auto begin = series_.begin() + static_cast<std::ptrdiff_t>(first);
      const auto end = begin + std::ssize(wish.names);
      if (std::any_of(begin, end, [](const LogSeries& one) { return one.name.empty(); })) continue;
      for (auto it = begin; it != end; ++it) {
        wish.rows.push_back(std::ssize(present));
        present.push_back(&*it);
      }
    }
    return present;
  }

  std::vector<Wish> wishes_;
  ChannelNames required_, optional_;
  std::vector<LogSeries> series_;
  std::vector<std::string> warnings_;
  JoinedSeries joined_;
};

void require_three(const std::optional<ChannelNames>& names, const char* sensor,
                   const char* expected = "3 (x,y,z) or none") {
  if (names && !names->empty() && names->size() != 3)
    throw OptionError(sensor, fmt::format("{} lists {}, expected {}", sensor,
                                          internal::counted(names->size(), "column"), expected));
}

/// Each channel belongs to one axis of one sensor.
void require_distinct(const ImuChannels& channels) {
  const ChannelNames usual = {"ax", "ay", "az"};
  const ChannelNames none;
  const std::pair<const char*, const ChannelNames&> sensors[] = {
      {"accelerometer", channels.accelerometer ? *channels.accelerometer : usual},
      {"gyroscope", channels.gyroscope ? *channels.gyroscope : none},
      {"magnetometer", channels.magnetometer ? *channels.magnetometer : none}};
  std::map<std::string, std::string> owners;  // of the channels that are listed
  for (const auto& [sensor, names] : sensors)
    for (const std::string& name : names) {
      const auto [owner, added] = owners.emplace(name, sensor);
      if (added) continue;
      const std::string shown = internal::printable(name);
      throw OptionError(
          sensor, owner->second == sensor
                      ? fmt::format("{} lists '{}' twice, expected three channels", sensor, shown)
                      : fmt::format("{} lists '{}', a channel of the {}, expected others", sensor,
                                    shown, owner->second));
    }
}

ImuLog read_log(const std::string& path, const ImuLogOptions& options,
                std::vector<std::string>& warnings) {
  const ImuChannels& channels = options.channels;
  SensorWishes wishes;
  wishes.add(channels.accelerometer, {"ax", "ay", "az"});
  wishes.add(channels.gyroscope, {"gx", "gy", "gz"});
  wishes.add(channels.magnetometer, {"mx", "my", "mz"});
  std::optional<ChannelNames> temperature;
  if (channels.temperature) temperature.emplace();
  if (channels.temperature && !channels.temperature->empty())
    temperature->push_back(*channels.temperature);
  wishes.add(temperature, {"temperature"});
  wishes.read(path, options);
  warnings.insert(warnings.end(), wishes.warnings().begin(), wishes.warnings().end());
  ImuLog log;
  log.name = log_name(path);
  if (!wishes.has(0))
    throw MissingOption("accelerometer",
                        fmt::format("{} has no columns ax, ay, az; expected --accelerometer X,Y,Z "
                                    "with column names or numbers",
                                    log.name));
  log.t = wishes.t();
  log.accelerometer = wishes.values(0);
  if (wishes.has(1)) log.gyroscope = wishes.values(1);
  if (wishes.has(2)) log.magnetometer = wishes.values(2);
  if (wishes.has(3))
    log.temperature = wishes.values(3).row(0).transpose() * channels.temperature_scale;
  return log;
}

void require_solved(const SensorCalibration& sensor, const char* name, const std::string& log) {
  if (sensor.solved() || sensor.status == CalibrationStatus::not_run) return;
  throw NoSolution(
      fmt::format("calibrate: {} {}: {}", name, to_string(sensor.status), sensor.culprit), log);
}

}  // namespace

CalibratedImu calibrate_from_logs(const ImuLogOptions& options) {
  const std::optional<ChannelNames>& accelerometer = options.channels.accelerometer;
  if (accelerometer && accelerometer->empty())
    throw OptionError("accelerometer",
                      "accelerometer is 'none', expected three channels, because every calibration "
                      "requires the accelerometer");
  require_three(accelerometer, "accelerometer", "3 (x,y,z)");
  require_three(options.channels.gyroscope, "gyroscope");
  require_three(options.channels.magnetometer, "magnetometer");
  require_distinct(options.channels);
  CalibratedImu result;
  result.options = options.calibration;
  if (options.made_up) {
    result.truth = simulate_imu({.seed = *options.made_up, .warming = 8});
    result.logs = {result.truth->log};
  } else {
    for (const std::string& path : options.logs)
      result.logs.push_back(read_log(path, options, result.warnings));
    require_different_logs(options.logs);
  }
  result.found = calibrate_imu(result.logs, options.calibration);
  // From the equator to a pole, and up to 5 km above the sea.
  if (!(options.calibration.gravity > 9.76 && options.calibration.gravity < 9.84)) {
    result.warnings.push_back(
        fmt::format("gravity is {} m/s^2, expected 9.76 to 9.84, the range on Earth, because the "
                    "scales are proportional to it",
                    options.calibration.gravity));
    if (options.note) options.note("warning: " + result.warnings.back());
  }
  if (const SensorCalibration& gyroscope = result.found.gyroscope;
      gyroscope.solved() && (gyroscope.K.array() < 0).all()) {
    result.warnings.emplace_back(
        "all three scales of the gyroscope are negative: the channels of both sensors may be "
        "listed "
        "in the order of a left-handed frame, for example y,x,z");
    if (options.note) options.note("warning: " + result.warnings.back());
  }
  const std::string where = options.made_up ? "--simulate" : options.logs.front();
  require_solved(result.found.accelerometer, "accelerometer", where);
  require_solved(result.found.gyroscope, "gyroscope", where);
  require_solved(result.found.magnetometer, "magnetometer", where);
  return result;
}

ImuCalibrationFile calibration_file(const ImuCalibration& found,
                                    const std::optional<ImuCalibrationFile>& base) {
  ImuCalibrationFile file = base.value_or(ImuCalibrationFile());
  const auto take = [&](const SensorCalibration& sensor, ImuCalibrationFile::Sensor& into,
                        const char* name) {
    if (sensor.solved()) {
      into.M = sensor.M;
      into.b = sensor.b;
    } else if (!base) {
      throw MissingOption(
          "base", fmt::format("the logs have no {}; expected --base FILE, the imu_calib.txt that "
                              "provides its numbers, because -o writes those of all three sensors",
                              name));
    }
  };
  take(found.accelerometer, file.accelerometer, "accelerometer");
  take(found.gyroscope, file.gyroscope, "gyroscope");
  take(found.magnetometer, file.magnetometer, "magnetometer");
  const SensorCalibration& a = found.accelerometer;
  const SensorCalibration& g = found.gyroscope;
  // Temperature terms of another calibration do not apply to new biases.
  file.accelerometer_z_coefficient = a.d(2);
  file.accelerometer_t0 = a.t0;
  if (g.solved()) {
    file.gyroscope_coefficient = g.d;
    file.gyroscope_constant.setZero();
    file.gyroscope_t0 = g.t0;
  }
  file.with_temperature = file.with_temperature || a.with_temperature || g.with_temperature;
  return file;
}

}  // namespace quadtune
