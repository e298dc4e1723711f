// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/simulated_imu.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "quadtune/errors.hpp"
#include "quadtune/simulation/random.hpp"

namespace quadtune {
namespace {

using Eigen::Vector3d;

/// Noise of one sample on each axis [counts], and the streams of its random numbers.
constexpr double kAccelerometerNoise = 1.5, kGyroscopeNoise = 1.2, kMagnetometerNoise = 1.0;
enum Stream : std::uint32_t {
  kTruth = 0,
  kTurns = 1,
  kAccelerometer = 2,
  kGyroscope = 4,
  kMagnetometer = 6
};

struct MadeUpTurn {
  Vector3d axis;  ///< of the body
  double angle;   ///< [rad]
};

class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) { source_.seed = seed; }
  /// Uniform in (-1, 1).
  double even(Stream stream) {
    return 2 * lane(random_uniform(source_, stream, index_++).first, 0) - 1;
  }
  Vector3d normal(std::uint32_t stream, std::uint64_t index) const {
    const auto two = random_normal(source_, stream, index);
    const auto third = random_normal(source_, stream + 1, index);
    return {lane(two.first, 0), lane(two.second, 0), lane(third.first, 0)};
  }

 private:
  RandomSource<1> source_;
  std::uint64_t index_ = 0;
};

/// Quarter turns that point each axis up and down and rotate about each one while it is level.
std::vector<MadeUpTurn> turns_of(const SimulatedImuOptions& options, Numbers& numbers) {
  constexpr double kQuarter = std::numbers::pi / 2;
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  std::vector<MadeUpTurn> turns;
  const auto count = static_cast<std::size_t>(options.poses - 1);
  if (!options.upright) {
    for (int i = 0; i < 4; ++i) turns.push_back({x, kQuarter});
    for (int i = 0; i < 4; ++i) turns.push_back({y, kQuarter});
    turns.push_back({x, kQuarter});
    for (int i = 0; i < 4; ++i) turns.push_back({z, i % 2 == 0 ? kQuarter : 0.5 * kQuarter});
    if (turns.size() > count) turns.resize(count);
  }
  while (turns.size() < count) {
    Vector3d axis(numbers.even(kTurns), numbers.even(kTurns), numbers.even(kTurns));
    if (options.upright) axis = z;
    const double angle = kQuarter * (1 + 0.5 * numbers.even(kTurns));
    if (axis.norm() > 0.1) turns.push_back({axis.normalized(), angle});
  }
  return turns;
}

SimulatedSensor sensor(double scale, double bias, double cross, bool triangular, Numbers& numbers) {
  SimulatedSensor result;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const double part = i == j ? 1 + 0.05 * numbers.even(kTruth) : cross * numbers.even(kTruth);
      result.M(i, j) = triangular && i > j ? 0 : scale * part;
    }
  for (int i = 0; i < 3; ++i) result.b(i) = bias * numbers.even(kTruth);
  return result;
}

Vector3d raw(const SimulatedSensor& sensor, const Eigen::Matrix3d& inverse, const Vector3d& truth,
             double warmth, const Vector3d& noise) {
  return (inverse * truth + sensor.b - sensor.d * warmth + noise).array().round();
}

void check_made_up(const SimulatedImuOptions& o) {
  if (o.poses < 2 || !(o.rate > 0) || !(o.still > 0) || !(o.start > 0) || !(o.turn > 0) ||
      !(o.noise >= 0) || !(o.rate * (o.start + o.poses * (o.still + o.turn)) < 1e8))
    throw InvalidInput("make_up_imu",
                       fmt::format("{} poses of {} s, turns of {} s at {} Hz; expected at least "
                                   "two poses and positive lengths of at most 1e8 samples together",
                                   o.poses, o.still, o.turn, o.rate));
}

}  // namespace

SimulatedImu simulate_imu(const SimulatedImuOptions& options) {
  check_made_up(options);
  Numbers numbers(options.seed);
  SimulatedImu result;
  result.accelerometer = sensor(0.0375, 25, 0.01, true, numbers);    // m/s² per count
  result.gyroscope = sensor(0.00125, 25, 0.02, false, numbers);      // rad/s per count
  result.magnetometer = sensor(1.0 / 240, 60, 0.03, true, numbers);  // share of the field per count
  result.accelerometer.d = {0, 0, -0.6};                             // counts per °C
  result.gyroscope.d = {-0.36, 1.4, -0.9};
  if (options.warming == 0) result.accelerometer.d = result.gyroscope.d = Vector3d::Zero();
  const std::vector<MadeUpTurn> turns = turns_of(options, numbers);

  const double length = options.start + double(turns.size()) * (options.turn + options.still);
  const auto samples = static_cast<Eigen::Index>(length * options.rate);
  ImuLog& log = result.log;
  log.name = fmt::format("simulated with seed {}", options.seed);
  log.t.resize(samples);
  log.accelerometer.resize(3, samples);
  if (options.gyroscope) log.gyroscope.resize(3, samples);
  if (options.magnetometer) log.magnetometer.resize(3, samples);
  log.temperature.resize(samples);

  const Eigen::Matrix3d to_acc = result.accelerometer.M.inverse();
  const Eigen::Matrix3d to_gyro = result.gyroscope.M.inverse();
  const Eigen::Matrix3d to_mag = result.magnetometer.M.inverse();
  const Vector3d up(0, 0, result.gravity);
  const Vector3d field = Vector3d(0.4, 0.1, -0.9).normalized();
  Eigen::Quaterniond pose = Eigen::Quaterniond::Identity();  // body to world, world up
  std::size_t done = 0;
  double turn_start = options.start;
  for (Eigen::Index i = 0; i < samples; ++i) {
    const double t = double(i) / options.rate;
    while (done < turns.size() && t >= turn_start + options.turn) {
      pose = pose * Eigen::AngleAxisd(turns[done].angle, turns[done].axis);
      turn_start += options.turn + options.still;
      ++done;
    }
    Eigen::Quaterniond now = pose;
    Vector3d rate = Vector3d::Zero();
    if (done < turns.size() && t > turn_start) {  // angle (s - sin 2πs / 2π), s from 0 to 1
      const double s = (t - turn_start) / options.turn, phase = 2 * std::numbers::pi * s;
      now = pose *
            Eigen::AngleAxisd(turns[done].angle * (s - std::sin(phase) / (2 * std::numbers::pi)),
                              turns[done].axis);
      rate = turns[done].axis * turns[done].angle * (1 - std::cos(phase)) / options.turn;
    }
    const double warmth = options.warming * (t / length - 0.5);
    const auto at = static_cast<std::uint64_t>(i);
    const auto noise = [&](Stream stream, double size) -> Vector3d {
      return options.noise * size * numbers.normal(stream, at);
    };
    const Eigen::Quaterniond to_body = now.conjugate();
    log.t(i) = t;
    log.temperature(i) = result.t0 + warmth;
    log.accelerometer.col(i) = raw(result.accelerometer, to_acc, to_body * up, warmth,
                                   noise(kAccelerometer, kAccelerometerNoise));
    if (options.gyroscope)
      log.gyroscope.col(i) =
          raw(result.gyroscope, to_gyro, rate, warmth, noise(kGyroscope, kGyroscopeNoise));
    if (options.magnetometer)
      log.magnetometer.col(i) = raw(result.magnetometer, to_mag, to_body * field, warmth,
                                    noise(kMagnetometer, kMagnetometerNoise));
  }
  return result;
}

SimulatedGyroscope simulate_gyroscope(std::uint64_t seed) {
  constexpr double kLength = 1800, kBias = 0.01;  // [s], [rad/s]
  constexpr std::uint32_t kRecord = 8;            // a separate stream
  SimulatedGyroscope result;
  RandomSource<1> source;
  source.seed = seed;
  const double dt = 1 / result.sample_rate;
  result.rate.resize(static_cast<Eigen::Index>(kLength * result.sample_rate));
  double walk = kBias;
  for (Eigen::Index i = 0; i < result.rate.size(); ++i) {
    const auto two = random_normal(source, kRecord, static_cast<std::uint64_t>(i));
    result.rate(i) = walk + result.noise_density / std::sqrt(dt) * lane(two.first, 0);
    walk += result.random_walk * std::sqrt(dt) * lane(two.second, 0);
  }
  return result;
}

}  // namespace quadtune
