// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/logs/imu_calibration.hpp"
#include "report/logs/logs.hpp"
#include "report/text/print.hpp"
#include "report/text/rows.hpp"

namespace quadtune::report {
namespace {

using internal::Json;
using internal::matrix_to_json;
using internal::vector_to_json;

constexpr double kDegreesPerRadian = 180 / std::numbers::pi;

/// One sensor with its units.
struct Sensor {
  const char* name;
  const char* unit;           ///< unit of the calibrated value
  const char* residual;       ///< name of the residual
  const char* residual_unit;  ///< unit of the residual
  double residual_factor;     ///< factor from the library's unit
  const SensorCalibration& found;
  const SimulatedSensor* truth;
};

std::vector<Sensor> sensors_of(const CalibratedImu& imu) {
  const ImuCalibration& c = imu.found;
  std::vector<Sensor> sensors = {{"accelerometer", "m/s^2", "norm minus gravity", "m/s^2", 1,
                                  c.accelerometer,
                                  imu.truth ? &imu.truth->accelerometer : nullptr}};
  if (c.gyroscope.solved())
    sensors.push_back({"gyroscope", "rad/s", "rotated gravity minus measured gravity", "deg",
                       kDegreesPerRadian, c.gyroscope,
                       imu.truth ? &imu.truth->gyroscope : nullptr});
  if (c.magnetometer.solved())
    sensors.push_back({"magnetometer", "field", "norm minus the field", "field", 1, c.magnetometer,
                       imu.truth ? &imu.truth->magnetometer : nullptr});
  return sensors;
}

/// The digits of a value that its interval supports, and one more.
std::string with_interval(double value, double half) {
  if (!(half > 0)) return fmt::format("{:.6g}", value);
  const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(half))), 0, 12);
  return fmt::format("{:.{}f} +- {:.{}f}", value, decimals, half, decimals);
}

/// T, K and b of each axis, with the half width of its 95 % interval.
std::string axes_table(const Sensor& sensor) {
  const SensorCalibration& c = sensor.found;
  const double q = c.quantile;
  Cells cells = {{"", "T: x", "y", "z", "K [raw per " + std::string(sensor.unit) + "]", "b [raw]"}};
  for (int i = 0; i < 3; ++i) {
    cells.push_back({std::string(1, "xyz"[i])});
    for (int j = 0; j < 3; ++j)  // T_ij = M_ij K_jj; the error of K is that of the diagonal
      cells.back().push_back(
          i == j ? "1" : with_interval(c.T(i, j), q * c.M_error(i, j) * std::abs(c.K(j))));
    cells.back().push_back(with_interval(c.K(i), q * c.M_error(i, i) * c.K(i) * c.K(i)));
    cells.back().push_back(with_interval(c.b(i), q * c.b_error(i)));
  }
  return aligned(cells);
}

std::string temperature_text(const SensorCalibration& c) {
  std::vector<std::string> axes;
  for (int i = 0; i < 3; ++i)
    if (c.d_error(i) > 0)
      axes.push_back(
          fmt::format("{} {}", "xyz"[i], with_interval(c.d(i), c.quantile * c.d_error(i))));
  return fmt::format("temperature {} raw/degC, times (temperature - {:.2f} degC), added to raw - b",
                     internal::joined(axes, ", "), c.t0);
}

/// How many parameters of the simulated sensor lie in their intervals.
std::string truth_text(const Sensor& sensor, double t0) {
  const SensorCalibration& c = sensor.found;
  int inside = 0, all = 0;
  const auto count = [&](double value, double error, double truth) {
    if (!(error > 0)) return;
    ++all;
    if (std::abs(value - truth) <= c.quantile * error) ++inside;
  };
  const Eigen::Vector3d b = c.b - c.d * (t0 - c.t0);
  for (int i = 0; i < 3; ++i) {
    count(b(i), c.b_error(i), sensor.truth->b(i));
    count(c.d(i), c.d_error(i), sensor.truth->d(i));
    for (int j = 0; j < 3; ++j) count(c.M(i, j), c.M_error(i, j), sensor.truth->M(i, j));
  }
  return fmt::format("{} of {} parameters of the simulated sensor lie in their 95 % intervals",
                     inside, all);
}

std::string sensor_text(const Sensor& sensor, const CalibratedImu& imu) {
  const SensorCalibration& c = sensor.found;
  const bool turns = &c == &imu.found.gyroscope;
  std::string text = axes_table(sensor);
  if (c.with_temperature) text += "\n" + temperature_text(c);
  text += fmt::format("\n{}: {:.3g} {} before, {:.3g} after (rms of {} {})", sensor.residual,
                      sensor.residual_factor * c.residual_before, sensor.residual_unit,
                      sensor.residual_factor * c.residual_after, c.used, turns ? "turns" : "poses");
  if (!c.refused.empty()) {
    std::vector<std::size_t> numbers;
    for (const std::size_t i : c.refused) numbers.push_back(i + 1);
    text += fmt::format("\nrejected as outliers: {} {}", turns ? "turns" : "poses",
                        fmt::join(numbers, ", "));
  }
  if (sensor.truth) text += "\n" + truth_text(sensor, imu.truth->t0);
  return text;
}

Json sensor_json(const SensorCalibration& c) {
  Json json = {{"T", matrix_to_json(c.T, "T")},
               {"K", vector_to_json(c.K, "K")},
               {"b", vector_to_json(c.b, "b")},
               {"M", matrix_to_json(c.M, "M")},
               {"M_error", matrix_to_json(c.M_error, "M_error")},
               {"b_error", vector_to_json(c.b_error, "b_error")},
               {"quantile", c.quantile}};
  if (c.with_temperature)
    json["temperature"] = {{"d", vector_to_json(c.d, "d")},
                           {"d_error", vector_to_json(c.d_error, "d_error")},
                           {"t0", c.t0}};
  json["used"] = c.used;
  json["refused"] = c.refused;
  return json;
}

std::string log_text(const CalibratedImu& imu, std::size_t i) {
  const ImuLog& log = imu.logs[i];
  const StationaryDetection& still = imu.found.still[i];
  const double length = log.t(log.t.size() - 1) - log.t(0);
  std::string text = fmt::format(
      "{}: {} samples over {:.4g} s, {} stationary poses\nstationary if the standard deviation "
      "within {:.2g} s is at most {:.3g} raw",
      log.name, log.t.size(), length, still.poses.size(), imu.options.still.window,
      still.accelerometer_threshold);
  if (log.gyroscope.cols() > 0)
    text += fmt::format(" (gyroscope {:.3g})", still.gyroscope_threshold);
  text += fmt::format(", {:.3g} times that of the quietest tenth of the log",
                      std::sqrt(imu.options.still.factor));
  if (log.gyroscope.cols() < StartUpOffset::kSamples) return text;
  const StartUpOffset start = start_up_offset(log, still);
  text += fmt::format("\ngyroscope's first {} samples: {:.3f} {:.3f} {:.3f} raw, +- {:.3f}",
                      StartUpOffset::kSamples, start.offset(0), start.offset(1), start.offset(2),
                      2 * start.error.maxCoeff());
  if (!start.still) text += ", NOT STATIONARY";
  return text;
}

}  // namespace

Json to_json(const CalibratedImu& imu, const std::string& file) {
  Json json;
  Json before, after;
  for (const Sensor& sensor : sensors_of(imu)) {
    json[sensor.name] = sensor_json(sensor.found);
    before[sensor.name] = sensor.found.residual_before;
    after[sensor.name] = sensor.found.residual_after;
  }
  json["residual"] = {{"before", before}, {"after", after}};
  json["poses"] = imu.found.poses.size();
  json["still"] = Json::array();
  for (std::size_t i = 0; i < imu.logs.size(); ++i) {
    const StationaryDetection& still = imu.found.still[i];
    Json entry = {{"log", imu.logs[i].name},
                  {"poses", still.poses.size()},
                  {"accelerometer_threshold", still.accelerometer_threshold},
                  {"gyroscope_threshold", still.gyroscope_threshold}};
    if (imu.logs[i].gyroscope.cols() >= StartUpOffset::kSamples) {
      const StartUpOffset start = start_up_offset(imu.logs[i], still);
      entry["start_up_offset"] = {{"offset", vector_to_json(start.offset, "offset")},
                                  {"error", vector_to_json(start.error, "error")},
                                  {"still", start.still}};
    }
    json["still"].push_back(entry);
  }
  if (!file.empty()) json["file"] = file;
  json["warnings"] = imu.warnings;
  return json;
}

std::string to_text(const CalibratedImu& imu, const std::string& file) {
  std::string text;
  for (std::size_t i = 0; i < imu.logs.size(); ++i) text += section("log", log_text(imu, i));
  text += "T K^-1 (raw - b), +- half of the 95 % interval\n";
  for (const Sensor& sensor : sensors_of(imu))
    text += fmt::format("{}\n{}", sensor.name, section("", sensor_text(sensor, imu)));
  if (!file.empty()) text += section("written", file);
  return text;
}

}  // namespace quadtune::report
