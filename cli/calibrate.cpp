// SPDX-License-Identifier: Apache-2.0
/// quadtune calibrate imu: estimates scale, cross-axis errors and biases of inertial sensors from
/// logs.
#include <optional>

#include "arguments/log_arguments.hpp"
#include "arguments/matrix_arguments.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/exports/imu_calibration_file.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/workbench/logs/imu_calibration.hpp"
#include "report/logs/logs.hpp"

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

/// No value: the usual names; empty for "none".
std::optional<std::vector<std::string>> axes(const std::string& given) {
  if (given.empty()) return std::nullopt;
  return given == kNone ? std::vector<std::string>() : word_list(given);
}

ImuChannels channels_of(const Options& options) {
  ImuChannels channels;
  channels.accelerometer = axes(options.accelerometer);
  channels.gyroscope = axes(options.gyroscope);
  channels.magnetometer = axes(options.magnetometer);
  if (!options.temperature.empty())
    channels.temperature = options.temperature == kNone ? "" : options.temperature;
  channels.temperature_scale = options.temperature_scale.value_or(1);
  return channels;
}

CalibratedImu calibrated(const CommandLine& line, const Options& options, const Context& context) {
  ImuLogOptions imu;
  imu.note = notes_of(context);
  imu.calibration.gravity = options.gravity.value_or(imu.calibration.gravity);
  imu.calibration.field = options.field.value_or(imu.calibration.field);
  if (options.simulate) {
    if (!options.logs.empty()) refuse("--simulate", "--simulate cannot be combined with --log");
    line.refuse_given(
        {"--accelerometer", "--gyroscope", "--magnetometer", "--temperature", "--temperature-scale",
         "--format", "--columns", "--rate", "--time", "--time-unit"},
        "describes a log, expected --log instead of --simulate");
    imu.made_up = context.seed;
    return calibrate_from_logs(imu);
  }
  if (options.logs.empty())
    refuse("--log", "--log is missing, expected a log in which the sensor rests in many poses");
  imu.logs = options.logs;
  imu.channels = channels_of(options);
  imu.reading = sensor_log_options(options.sensors);
  return calibrate_from_logs(imu);
}

void run_calibrate(const CommandLine& line, const Options& options, Context& context) {
  if (options.what.empty()) refuse("WHAT", "the kind of sensor is missing, expected imu");
  if (options.what != "imu")
    refuse("WHAT", "unknown sensor '{}'; expected: quadtune calibrate imu{}", options.what,
           internal::did_you_mean(options.what, {"imu"}));
  std::optional<ImuCalibrationFile> base;
  if (!options.base.empty()) base = read_imu_calibration(options.base);
  const CalibratedImu imu = calibrated(line, options, context);
  if (!options.file.empty()) {
    const ImuCalibrationFile file = calibration_file(imu.found, base);
    context.write(options.file, imu_calibration_text(file));
  }
  context.print([&] { return to_json(imu, options.file); },
                [&] { return to_text(imu, options.file); });
}

void add_options(CommandLine& line, Options& options) {
  line.add_option("WHAT", options.what, "imu");
  line.add_list("--log FILE", options.logs,
                "log of any format that `quadtune log` reads; repeat the option for several");
  line.add_option("--accelerometer LIST", options.accelerometer,
                  "its three channels, by name, or by number from 1 in a text; default ax,ay,az; "
                  "of another file: CHANNEL@FILE");
  line.add_option("--gyroscope LIST", options.gyroscope,
                  "as --accelerometer; default gx,gy,gz; none: no gyroscope");
  line.add_option("--magnetometer LIST", options.magnetometer,
                  "as --accelerometer; default mx,my,mz; none: no magnetometer");
  line.add_option("--temperature COLUMN", options.temperature,
                  "column of the temperature; default temperature; none: no temperature");
  line.add_positive("--temperature-scale X", options.temperature_scale,
                    "degrees Celsius per unit of that column, e.g. 0.1; default 1");
  add_sensor_log_options(line, options.sensors);
  line.add_positive("--gravity G", options.gravity,
                    "gravity where the log was recorded [m/s^2]; default 9.80665");
  line.add_positive("--field B", options.field,
                    "norm of the field in the unit of the result; default 1");
  line.add_option("--base FILE", options.base,
                  "imu_calib.txt whose numbers are kept for sensors that the logs do not contain");
  line.add_flag("--simulate", options.simulate,
                "a simulated sensor, by the seed, instead of a log");
  line.add_option("-o FILE", options.file, "imu_calib.txt to write, completely or not at all");
}

}  // namespace

Verb calibrate_verb() {
  return {"calibrate", "imu --log FILE... [-o imu_calib.txt]",
          "calibrate inertial sensors from logs with many poses",
          "quadtune calibrate imu --simulate -o out/imu_calib.txt",
          with_options(add_options, run_calibrate)};
}

}  // namespace quadtune::cli
