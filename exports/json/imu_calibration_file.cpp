// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/imu_calibration_file.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "export_text.hpp"
#include "quadtune/errors.hpp"
#include "uquad/uquad_numbers.hpp"

namespace quadtune {
namespace {

constexpr std::size_t kOlder = 36, kAll = 45;

std::string number(double value, const char* name) {
  if (!std::isfinite(value))
    throw InvalidInput("imu_calib.txt",
                       fmt::format("{} is {}, expected a finite number", name, value));
  return fmt::format("{:24.16e}", value);
}

std::string sensor_text(const ImuCalibrationFile::Sensor& sensor, const char* name) {
  std::string text;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) text += number(sensor.M(i, j), name);
    text += '\n';
  }
  for (int i = 0; i < 3; ++i) text += number(sensor.b(i), name) + '\n';
  return text + '\n';
}

/// Consumes numbers in sequence.
class Numbers {
 public:
  explicit Numbers(std::vector<double> values) : values_(std::move(values)) {}
  double next() { return values_[at_++]; }
  Eigen::Vector3d vector() {
    Eigen::Vector3d v;
    for (double& entry : v) entry = next();
    return v;
  }
  ImuCalibrationFile::Sensor sensor(const std::string& origin, const char* name) {
    ImuCalibrationFile::Sensor sensor;
    for (int i = 0; i < 3; ++i) sensor.M.row(i) = vector().transpose();
    sensor.b = vector();
    const double size = sensor.M.norm();
    if (!(std::abs((sensor.M / size).determinant()) > 1e-9))
      throw InvalidInput(
          origin, fmt::format("the {}'s matrix is singular; expected an invertible matrix, because "
                              "an axis would be lost",
                              name));
    return sensor;
  }

 private:
  std::vector<double> values_;
  std::size_t at_ = 0;
};

}  // namespace

std::string imu_calibration_text(const ImuCalibrationFile& c) {
  std::string text = sensor_text(c.accelerometer, "the accelerometer's calibration") +
                     sensor_text(c.gyroscope, "the gyroscope's calibration") +
                     sensor_text(c.magnetometer, "the magnetometer's calibration");
  if (!c.with_temperature) {
    text.pop_back();  // no blank line at the end
    return text;
  }
  constexpr const char* kName = "a temperature term";
  text += number(c.accelerometer_z_coefficient, kName) + number(c.accelerometer_t0, kName) + "\n\n";
  for (const Eigen::Vector3d& terms : {c.gyroscope_coefficient, c.gyroscope_constant}) {
    for (int i = 0; i < 3; ++i) text += number(terms(i), kName);
    text += '\n';
  }
  return text + number(c.gyroscope_t0, kName) + '\n';
}

ImuCalibrationFile parse_imu_calibration(const std::string& text, const std::string& origin) {
  std::vector<double> values;
  int line = 0, last = 1;
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    const std::string where = fmt::format("{}:{}", origin, ++line);
    for (const double value : exports::numbers_of_line(text.substr(start, end - start), where)) {
      values.push_back(value);
      last = line;
      if (values.size() > kAll)
        throw InvalidInput(where,
                           fmt::format("has {} or more numbers; expected 36 or 45", values.size()));
    }
    start = end + 1;
  }
  if (values.size() != kOlder && values.size() != kAll)
    throw InvalidInput(
        fmt::format("{}:{}", origin, last),
        fmt::format(
            "ends after {} numbers, expected 36 (three sensors, matrix and bias each) or 45 "
            "(with temperature), because the flight program reads them by position",
            values.size()));
  ImuCalibrationFile result;
  result.with_temperature = values.size() == kAll;
  Numbers numbers(std::move(values));
  result.accelerometer = numbers.sensor(origin, "accelerometer");
  result.gyroscope = numbers.sensor(origin, "gyroscope");
  result.magnetometer = numbers.sensor(origin, "magnetometer");
  if (!result.with_temperature) return result;
  result.accelerometer_z_coefficient = numbers.next();
  result.accelerometer_t0 = numbers.next();
  result.gyroscope_coefficient = numbers.vector();
  result.gyroscope_constant = numbers.vector();
  result.gyroscope_t0 = numbers.next();
  return result;
}

ImuCalibrationFile read_imu_calibration(const std::string& path) {
  return parse_imu_calibration(exports::export_text(path), path);
}

}  // namespace quadtune
