// SPDX-License-Identifier: Apache-2.0
/// quadtune calibrate imu: scale, cross-axis and bias of inertial sensors from logs.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <ostream>

#include "arguments/matrix_arguments.hpp"
#include "arguments/sensor_log.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/imu_calibration_file.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/tuning/made_up_imu.hpp"
#include "report/logs/calibration_report.hpp"
#include "quadtune/internal/json.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string what;
  std::vector<std::string> logs;
  std::string accelerometer, gyroscope, magnetometer, temperature;
  SensorLogArguments sensors;
  std::optional<double> temperature_scale, gravity, field;
  std::string base, file;
  bool simulate = false;
};

constexpr const char* kNone = "none";

[[noreturn]] void refuse(const char* option, const std::string& why) {
  throw UsageError(fmt::format("quadtune calibrate: {}", why), option);
}

/// Three names: those of the option, or the usual ones; none at all for "none".
std::vector<std::string> axes(const std::string& given, const std::vector<std::string>& usual,
                              const char* option) {
  if (given == kNone) return {};
  std::vector<std::string> names = given.empty() ? usual : word_list(given);
  if (names.size() != 3)
    refuse(option,
           fmt::format("{} lists {} columns, expected 3 (x,y,z) or none", option, names.size()));
  return names;
}

/// Asks a log for sensors, of which some need not be there.
class SensorWishes {
 public:
  /// @param usual  names that nobody gave: the sensor is absent where the log does not have all
  void add(const std::vector<std::string>& names, bool usual) {
    wishes_.push_back({names, usual, {}, 0});
    std::vector<std::string>& into = usual ? optional_ : required_;
    wishes_.back().first = into.size();
    into.insert(into.end(), names.begin(), names.end());
  }

  void read(const std::string& path, const Options& options, Context& context) {
    SensorLog log = read_sensors(path, required_, optional_, options.sensors, "calibrate", context);
    series_ = std::move(log.series);
    warnings_ = std::move(log.warnings);
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
    if (present.empty()) return;
    // Sensors of another file have times of their own.
    for (std::size_t i = 0; i < required_.size(); ++i)
      if (&series_[i] != present.front() && channel_place(required_[i], path).file != path)
        series_[i] = interpolated(series_[i], present.front()->time);
    joined_ = join(present, log_name(path));
    const auto most = std::max_element(present.begin(), present.end(), [](auto* a, auto* b) {
      return a->time.size() < b->time.size();
    });
    if (joined_.t.size() < std::ssize((*most)->time))
      context.note(fmt::format(
          "calibrate: warning: {} of {} samples of '{}' in {} lack one of another channel and are "
          "left out",
          std::ssize((*most)->time) - joined_.t.size(), (*most)->time.size(),
          internal::printable((*most)->name), log_name(path)));
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
    std::vector<std::string> names;
    bool usual;
    std::vector<Eigen::Index> rows;  ///< of the joined values
    std::size_t first;               ///< among the required or the optional names
  };
  std::vector<Wish> wishes_;
  std::vector<std::string> required_, optional_;
  std::vector<LogSeries> series_;
  std::vector<std::string> warnings_;
  JoinedSeries joined_;
};

ImuLog read_log(const std::string& path, const Options& options, Context& context,
                std::vector<std::string>& warnings) {
  SensorWishes wishes;
  wishes.add(axes(options.accelerometer, {"ax", "ay", "az"}, "--accelerometer"),
             options.accelerometer.empty());
  wishes.add(axes(options.gyroscope, {"gx", "gy", "gz"}, "--gyroscope"), options.gyroscope.empty());
  wishes.add(axes(options.magnetometer, {"mx", "my", "mz"}, "--magnetometer"),
             options.magnetometer.empty());
  const std::string& temperature = options.temperature;
  if (temperature != kNone)
    wishes.add({temperature.empty() ? "temperature" : temperature}, temperature.empty());
  wishes.read(path, options, context);
  warnings.insert(warnings.end(), wishes.warnings().begin(), wishes.warnings().end());
  ImuLog log;
  log.name = log_name(path);
  if (!wishes.has(0))
    refuse("--accelerometer", fmt::format("{} has no columns ax, ay, az, expected --accelerometer "
                                          "X,Y,Z with names or numbers of columns",
                                          log.name));
  log.t = wishes.t();
  log.accelerometer = wishes.values(0);
  if (wishes.has(1)) log.gyroscope = wishes.values(1);
  if (wishes.has(2)) log.magnetometer = wishes.values(2);
  if (temperature != kNone && wishes.has(3))
    log.temperature = wishes.values(3).row(0).transpose() * options.temperature_scale.value_or(1);
  return log;
}

/// Of the sensors that the log does not have, the numbers of --base stay.
/// @param base  what was read of --base, or the identity
ImuCalibrationFile file_of(const ImuCalibration& found, const ImuCalibrationFile& base,
                           const Options& options) {
  ImuCalibrationFile file = base;
  const auto take = [&](const SensorCalibration& sensor, ImuCalibrationFile::Sensor& into,
                        const char* name) {
    if (sensor.solved()) {
      into.M = sensor.M;
      into.b = sensor.b;
    } else if (options.base.empty()) {
      refuse("--base", fmt::format("the logs have no {}, expected --base FILE, the imu_calib.txt "
                                   "whose numbers of it stay, because -o writes those of all three",
                                   name));
    }
  };
  take(found.accelerometer, file.accelerometer, "accelerometer");
  take(found.gyroscope, file.gyroscope, "gyroscope");
  take(found.magnetometer, file.magnetometer, "magnetometer");
  const SensorCalibration& a = found.accelerometer;
  const SensorCalibration& g = found.gyroscope;
  // Terms of another calibration do not belong to new biases.
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

std::vector<ImuLog> read_logs(const Options& options, Context& context, MadeUpImu& truth,
                              std::vector<std::string>& warnings) {
  if (options.simulate) {
    if (!options.logs.empty())
      refuse("--simulate", "--simulate came with --log, expected one of them");
    truth = make_up_imu({.seed = context.seed, .warming = 8});
    return {truth.log};
  }
  if (options.logs.empty())
    refuse("--log", "--log is missing, expected a log in which the sensor stands in many poses");
  std::vector<ImuLog> logs;
  for (const std::string& path : options.logs)
    logs.push_back(read_log(path, options, context, warnings));
  return logs;
}

void require_solved(const SensorCalibration& sensor, const char* name, const std::string& log) {
  if (sensor.solved() || sensor.status == CalibrationStatus::not_run) return;
  throw NoSolution(
      fmt::format("calibrate: {} {}: {}", name, to_string(sensor.status), sensor.culprit), log);
}

void run(const Options& options, Context& context) {
  if (options.what != "imu")
    refuse("WHAT", fmt::format("'{}' came, expected: quadtune calibrate imu{}", options.what,
                               internal::did_you_mean(options.what, {"imu"})));
  ImuCalibrationFile base;
  if (!options.base.empty()) base = read_imu_calibration(options.base);
  MadeUpImu made;
  std::vector<std::string> warnings;
  const std::vector<ImuLog> logs = read_logs(options, context, made, warnings);
  ImuCalibrationOptions settings;
  settings.gravity = options.gravity.value_or(settings.gravity);
  settings.field = options.field.value_or(settings.field);
  const ImuCalibration found = calibrate_imu(logs, settings);
  const std::string where = options.logs.empty() ? "--simulate" : options.logs.front();
  require_solved(found.accelerometer, "accelerometer", where);
  require_solved(found.gyroscope, "gyroscope", where);
  require_solved(found.magnetometer, "magnetometer", where);
  if (!options.file.empty()) {
    write_file(options.file, imu_calibration_text(file_of(found, base, options)));
    context.written.push_back(options.file);
  }
  const CalibrationReport report{logs,         settings, found, options.simulate ? &made : nullptr,
                                 options.file, warnings};
  context.out << (context.json ? internal::readable(to_json(report)) + "\n" : to_text(report));
}

}  // namespace

Verb calibrate_verb() {
  return {
      "calibrate", "imu --log FILE... [-o imu_calib.txt]",
      "calibrate inertial sensors from logs of many poses",
      "quadtune calibrate imu --simulate -o out/imu_calib.txt", [](CommandLine& line) -> Action {
        auto options = std::make_shared<Options>();
        line.add_option("WHAT", options->what, "imu");
        line.add_list("--log", options->logs,
                      "a log of any format that quadtune log reads; several: repeat the option")
            ->type_name("FILE");
        line.add_option("--accelerometer", options->accelerometer,
                        "its three channels, by name, or by number from 1 of a text; ax,ay,az; of "
                        "another file as CHANNEL@FILE")
            ->type_name("LIST");
        line.add_option("--gyroscope", options->gyroscope, "likewise; gx,gy,gz, or none")
            ->type_name("LIST");
        line.add_option("--magnetometer", options->magnetometer, "likewise; mx,my,mz, or none")
            ->type_name("LIST");
        line.add_option("--temperature", options->temperature, "its column; temperature, or none")
            ->type_name("COLUMN");
        line.add_positive("--temperature-scale", options->temperature_scale,
                          "degrees Celsius a unit of that column, e.g. 0.1; 1")
            ->type_name("X");
        add_sensor_log_options(line, options->sensors);
        line.add_positive("--gravity", options->gravity, "where the log was taken [m/s^2]; 9.80665")
            ->type_name("G");
        line.add_positive("--field", options->field, "norm that the magnetometer is to have; 1")
            ->type_name("B");
        line.add_option("--base", options->base,
                        "imu_calib.txt whose numbers stay for a sensor that the logs do not have")
            ->type_name("FILE");
        line.add_flag("--simulate", options->simulate,
                      "a made-up sensor of the seed instead of a log");
        line.add_option("-o", options->file, "imu_calib.txt to write, whole or not at all")
            ->type_name("FILE");
        return [options](Context& context) { run(*options, context); };
      }};
}

}  // namespace quadtune::cli
