// SPDX-License-Identifier: Apache-2.0
/// quadtune calibrate imu: scale, cross-axis and bias of inertial sensors from logs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <optional>
#include <ostream>

#include "calibration_report.hpp"
#include "log_columns.hpp"
#include "matrix_arguments.hpp"
#include "number_arguments.hpp"
#include "program.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/imu_calibration_file.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/tuning/made_up_imu.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string what;
  std::vector<std::string> logs;
  std::string accelerometer, gyroscope, magnetometer, temperature;
  LogTime time;
  std::optional<double> rate, temperature_scale, gravity, field;
  std::string base, file;
  bool simulate = false;
};

constexpr const char* kNone = "none";

[[noreturn]] void refuse(const char* option, const std::string& why) {
  throw UsageError(fmt::format("quadtune calibrate: {}", why), option);
}

/// Three columns: those of the option, else those of the usual names where the log has them.
Eigen::Matrix3Xd read_sensor(const LogColumns& log, const std::string& given,
                             const std::vector<std::string>& usual, const char* option) {
  if (given == kNone) return {};
  std::vector<std::string> columns = word_list(given);
  if (given.empty()) {
    for (const std::string& name : usual)
      if (!log.has(name)) return {};
    columns = usual;
  }
  if (columns.size() != 3)
    refuse(option,
           fmt::format("{} lists {} columns, expected 3 (x,y,z) or none", option, columns.size()));
  Eigen::Matrix3Xd values;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Eigen::VectorXd axis = log.column(columns[static_cast<std::size_t>(i)], option).values;
    values.resize(3, std::max(values.cols(), axis.size()));  // on the first axis alone it changes
    values.row(i) = axis.transpose();
  }
  return values;
}

ImuLog read_log(const std::string& path, const Options& options, Context& context) {
  const LogColumns columns(path, context.in);
  ImuLog log;
  log.name = columns.file();
  log.accelerometer =
      read_sensor(columns, options.accelerometer, {"ax", "ay", "az"}, "--accelerometer");
  if (log.accelerometer.cols() == 0)
    refuse("--accelerometer", fmt::format("{} has no columns ax, ay, az, expected --accelerometer "
                                          "X,Y,Z with names or numbers of columns",
                                          columns.file()));
  log.gyroscope = read_sensor(columns, options.gyroscope, {"gx", "gy", "gz"}, "--gyroscope");
  log.magnetometer =
      read_sensor(columns, options.magnetometer, {"mx", "my", "mz"}, "--magnetometer");
  const bool usual = options.temperature.empty() && columns.has("temperature");
  if (usual || (!options.temperature.empty() && options.temperature != kNone))
    log.temperature =
        columns.column(usual ? "temperature" : options.temperature, "--temperature").values *
        options.temperature_scale.value_or(1);
  LogTime time = options.time;
  time.rate = options.rate.value_or(0);
  if (time.column.empty() && time.rate == 0 && columns.has("t")) time.column = "t";
  log.t = read_time(columns, time, log.accelerometer.cols(), "calibrate");
  return log;
}

/// Of the sensors that the log does not have, the numbers of --base stay.
ImuCalibrationFile file_of(const ImuCalibration& found, const Options& options) {
  ImuCalibrationFile file;
  if (!options.base.empty()) file = read_imu_calibration(options.base);
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

std::vector<ImuLog> read_logs(const Options& options, Context& context, MadeUpImu& truth) {
  if (options.simulate) {
    if (!options.logs.empty())
      refuse("--simulate", "--simulate came with --log, expected one of them");
    truth = make_up_imu({.seed = context.seed, .warming = 8});
    return {truth.log};
  }
  if (options.logs.empty())
    refuse("--log", "--log is missing, expected a log in which the sensor stands in many poses");
  std::vector<ImuLog> logs;
  for (const std::string& path : options.logs) logs.push_back(read_log(path, options, context));
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
  MadeUpImu made;
  const std::vector<ImuLog> logs = read_logs(options, context, made);
  ImuCalibrationOptions settings;
  settings.gravity = options.gravity.value_or(settings.gravity);
  settings.field = options.field.value_or(settings.field);
  const ImuCalibration found = calibrate_imu(logs, settings);
  const std::string where = options.logs.empty() ? "--simulate" : options.logs.front();
  require_solved(found.accelerometer, "accelerometer", where);
  require_solved(found.gyroscope, "gyroscope", where);
  require_solved(found.magnetometer, "magnetometer", where);
  if (!options.file.empty()) {
    write_file(options.file, imu_calibration_text(file_of(found, options)));
    context.written.push_back(options.file);
  }
  print_calibration({logs, settings, found, options.simulate ? &made : nullptr, options.file},
                    context);
}

}  // namespace

Verb calibrate_verb() {
  return {
      "calibrate", "imu --log FILE... [-o imu_calib.txt]",
      "calibrate inertial sensors from logs of many poses",
      "quadtune calibrate imu --simulate -o out/imu_calib.txt", [](CLI::App& app) -> Action {
        auto options = std::make_shared<Options>();
        app.add_option("WHAT", options->what, "imu");
        app.add_option("--log", options->logs,
                       "text log, one row a sample; several: repeat the option")
            ->type_name("FILE")
            ->take_all()
            ->expected(1)
            ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
        app.add_option("--accelerometer", options->accelerometer,
                       "its three columns, by name or number from 1; ax,ay,az")
            ->type_name("LIST");
        app.add_option("--gyroscope", options->gyroscope, "likewise; gx,gy,gz, or none")
            ->type_name("LIST");
        app.add_option("--magnetometer", options->magnetometer, "likewise; mx,my,mz, or none")
            ->type_name("LIST");
        app.add_option("--temperature", options->temperature, "its column; temperature, or none")
            ->type_name("COLUMN");
        add_positive(app, "--temperature-scale", options->temperature_scale,
                     "degrees Celsius a unit of that column, e.g. 0.1; 1")
            ->type_name("X");
        add_positive(app, "--rate", options->rate, "samples a second [Hz]")->type_name("HZ");
        app.add_option("--time", options->time.column, "column of times instead of a rate; t")
            ->type_name("COLUMN");
        app.add_option("--time-unit", options->time.unit, "s, ms, us or ns; the header's, else s")
            ->type_name("U");
        add_positive(app, "--gravity", options->gravity, "where the log was taken [m/s^2]; 9.80665")
            ->type_name("G");
        add_positive(app, "--field", options->field, "norm that the magnetometer is to have; 1")
            ->type_name("B");
        app.add_option("--base", options->base,
                       "imu_calib.txt whose numbers stay for a sensor that the logs do not have")
            ->type_name("FILE");
        app.add_flag("--simulate", options->simulate,
                     "a made-up sensor of the seed instead of a log");
        app.add_option("-o", options->file, "imu_calib.txt to write, whole or not at all")
            ->type_name("FILE");
        return [options](Context& context) { run(*options, context); };
      }};
}

}  // namespace quadtune::cli
