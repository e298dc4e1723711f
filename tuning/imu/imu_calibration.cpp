// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/imu_calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "imu/norm_calibration.hpp"
#include "imu/turn_calibration.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Index = Eigen::Index;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

void check_logs(const std::vector<ImuLog>& logs, const ImuCalibrationOptions& options) {
  if (logs.empty()) throw InvalidInput("calibrate_imu", "there is no log; expected at least one");
  for (const auto& [name, value] : {std::pair{"gravity", options.gravity},
                                    {"field", options.field},
                                    {"least_temperature_span", options.min_temperature_span},
                                    {"greatest_error", options.max_error}})
    if (!(value > 0) || !std::isfinite(value))
      throw InvalidInput("calibrate_imu",
                         fmt::format("{} is {}, expected a positive finite number", name, value));
}

/// Returns whether the logs have the sensor; throws if only some of them do.
bool every_log_has(const std::vector<ImuLog>& logs, const char* sensor,
                   Index (*samples)(const ImuLog&)) {
  const bool first = samples(logs.front()) > 0;
  for (const ImuLog& log : logs)
    if ((samples(log) > 0) != first)
      throw InvalidInput(
          log.name, fmt::format("{} a {}; expected {} {}", first ? "does not have" : "has", sensor,
                                first ? "one, as in" : "none, as in", logs.front().name));
  return first;
}

NormProblem norm_problem(const std::vector<StationaryPose>& poses,
                         Eigen::Vector3d StationaryPose::*means, double norm,
                         const ImuCalibrationOptions& options) {
  NormProblem problem;
  problem.raw.resize(3, std::ssize(poses));
  problem.temperature.resize(std::ssize(poses));
  for (Index i = 0; i < problem.raw.cols(); ++i) {
    problem.raw.col(i) = poses[static_cast<std::size_t>(i)].*means;
    problem.temperature(i) = poses[static_cast<std::size_t>(i)].temperature;
  }
  problem.norm = norm;
  problem.max_error = options.max_error;
  return problem;
}

/// The stretches between consecutive poses of one log.
std::vector<Turn> turns_between(const std::vector<ImuLog>& logs,
                                const std::vector<StationaryDetection>& still) {
  constexpr double kMax = 60;  // [s]; a longer integral is too inaccurate
  std::vector<Turn> turns;
  std::size_t first = 0;
  for (std::size_t k = 0; k < logs.size(); ++k) {
    const std::vector<StationaryPose>& poses = still[k].poses;
    for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
      const Turn turn{&logs[k], first + i, poses[i].end, poses[i + 1].begin};
      const double length =
          logs[k].t(static_cast<Index>(turn.end) - 1) - logs[k].t(static_cast<Index>(turn.begin));
      if (turn.end > turn.begin + 2 && length < kMax) turns.push_back(turn);
    }
    first += poses.size();
  }
  return turns;
}

}  // namespace

const char* to_string(CalibrationStatus status) {
  switch (status) {
    case CalibrationStatus::not_run:
      return "no such sensor";
    case CalibrationStatus::solved:
      return "solved";
    case CalibrationStatus::not_observable:
      return "not observable";
    case CalibrationStatus::no_match:
      break;
  }
  return "no match";
}

SensorCalibration::SensorCalibration() {
  for (Eigen::Matrix3d* matrix : {&T, &M, &M_error}) matrix->setConstant(kNaN);
  for (Eigen::Vector3d* vector : {&K, &b, &b_error}) vector->setConstant(kNaN);
}

ImuCalibration calibrate_imu(const std::vector<ImuLog>& logs,
                             const ImuCalibrationOptions& options) {
  check_logs(logs, options);
  const bool gyroscope =
      every_log_has(logs, "gyroscope", [](const ImuLog& log) { return log.gyroscope.cols(); });
  const bool magnetometer = every_log_has(
      logs, "magnetometer", [](const ImuLog& log) { return log.magnetometer.cols(); });
  const bool temperature =
      every_log_has(logs, "temperature", [](const ImuLog& log) { return log.temperature.size(); });
  ImuCalibration result;
  double noise = 0;
  for (const ImuLog& log : logs) {
    result.still.push_back(find_stationary(log, options.still));
    const StationaryDetection& still = result.still.back();
    result.poses.insert(result.poses.end(), still.poses.begin(), still.poses.end());
    noise = std::max(noise, still.gyroscope_noise);
  }
  NormProblem problem =
      norm_problem(result.poses, &StationaryPose::accelerometer, options.gravity, options);
  problem.with_temperature = temperature && !result.poses.empty() &&
                             problem.temperature.maxCoeff() - problem.temperature.minCoeff() >=
                                 options.min_temperature_span;
  const NormSolution accelerometer = norm_calibration(problem);
  result.accelerometer = accelerometer.calibration;

  if (magnetometer)
    result.magnetometer = norm_calibration(norm_problem(result.poses, &StationaryPose::magnetometer,
                                                        options.field, options))
                              .calibration;
  if (!gyroscope) return result;
  if (!accelerometer.calibration.solved()) {
    result.gyroscope.status = CalibrationStatus::not_observable;
    result.gyroscope.culprit = "gravity is unknown because the accelerometer is not calibrated";
    return result;
  }
  result.gyroscope =
      turn_calibration({result.poses, turns_between(logs, result.still), accelerometer, noise,
                        problem.with_temperature, options.max_error});
  return result;
}

}  // namespace quadtune
