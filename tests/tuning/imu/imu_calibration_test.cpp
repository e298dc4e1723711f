// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/imu_calibration.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/tuning/simulated_imu.hpp"
#include "sanitized.hpp"

namespace quadtune {
namespace {

using Eigen::Vector3d;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::MatrixNear;
using testing::MatrixRelativelyNear;
using ::testing::ThrowsMessage;

/// A short log for repeated tests.
SimulatedImuOptions short_log(std::uint64_t seed) {
  return {.seed = seed, .poses = 30, .rate = 50, .still = 1.5, .start = 2, .turn = 0.8};
}

/// Biases at the reference temperature of the true values.
Vector3d bias_at(const SensorCalibration& sensor, double temperature) {
  return sensor.b - sensor.d * (temperature - sensor.t0);
}

TEST(FindStill, FindsThePosesOfALog) {
  const SimulatedImu made = simulate_imu();
  const StationaryDetection still = find_stationary(made.log);
  ASSERT_EQ(still.poses.size(), 36U);
  EXPECT_EQ(still.poses.front().begin, 0U);
  EXPECT_LE(still.poses.front().end, 600U);
  for (std::size_t i = 1; i < still.poses.size(); ++i) {
    const double start = 6 + 1.5 + 4.5 * static_cast<double>(i - 1);  // of the i-th pose [s]
    EXPECT_GE(static_cast<double>(still.poses[i].begin), 100 * start);
    EXPECT_LE(static_cast<double>(still.poses[i].end), 100 * (start + 3));
    EXPECT_GE(still.poses[i].end - still.poses[i].begin, 200U);
  }
  // The noise of 1.5 and 1.2 counts, and a sixth of a count of rounding.
  EXPECT_NEAR(still.accelerometer_noise, 1.5, 0.2);
  EXPECT_NEAR(still.gyroscope_noise, 1.2, 0.15);
  EXPECT_NEAR(still.accelerometer_threshold, 2 * std::sqrt(3.0) * still.accelerometer_noise, 1e-12);
}

// A steady turn about the vertical has no variance in either sensor, but the gyroscope measures it.
TEST(FindStill, ExcludesASteadyTurn) {
  SimulatedImu made = simulate_imu({.poses = 12});
  made.log.gyroscope.middleCols(1000, 400).row(2).array() += 200;
  made.log.accelerometer.middleCols(1000, 400).colwise() = Vector3d(0, 0, 260);
  for (const StationaryPose& pose : find_stationary(made.log).poses)
    EXPECT_TRUE(pose.end <= 1000 || pose.begin >= 1400) << pose.begin << " … " << pose.end;
}

TEST(FindStill, RejectsInvalidLogs) {
  ImuLog log = simulate_imu({.poses = 2}).log;
  log.name = "a.txt";
  log.t(7) = log.t(6);
  EXPECT_THAT(
      [&] { (void)find_stationary(log); },
      ThrowsMessage<InvalidInput>(HasSubstr(
          "a.txt: the time of sample 8 is 0.06 s after 0.06 s; expected increasing times")));
  log = simulate_imu({.poses = 2}).log;
  log.magnetometer(1, 20) = std::nan("");
  EXPECT_THAT(
      [&] { (void)find_stationary(log); },
      ThrowsMessage<InvalidInput>(HasSubstr("sample 21 of the magnetometer is not finite")));
  log.magnetometer.resize(3, 5);
  EXPECT_THAT([&] { (void)find_stationary(log); },
              ThrowsMessage<InvalidInput>(HasSubstr("the magnetometer has 5 samples; expected")));
  log.accelerometer.resize(3, 0);
  EXPECT_THAT([&] { (void)find_stationary(log); },
              ThrowsMessage<InvalidInput>(HasSubstr("has no accelerometer; it is required")));
  log = simulate_imu({.poses = 2}).log;
  log.t *= 1e-20;
  EXPECT_THAT(
      [&] { (void)find_stationary(log); },
      ThrowsMessage<InvalidInput>(HasSubstr("ten windows of 0.25 s at 1e-22 s per sample")));
  EXPECT_THAT([&] { (void)find_stationary(simulate_imu({.poses = 2}).log, {.factor = 1}); },
              ThrowsMessage<InvalidInput>(HasSubstr("a factor greater than 1")));
}

TEST(StartUpOffset, IsTheMeanOfTheFirst512Samples) {
  const SimulatedImu made = simulate_imu({.poses = 12});
  const StartUpOffset start = start_up_offset(made.log, find_stationary(made.log));
  EXPECT_TRUE(start.still);
  EXPECT_THAT(start.offset, MatrixNear(made.log.gyroscope.leftCols(512).rowwise().mean(), 1e-12));
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(start.offset(i), made.gyroscope.b(i), 5 * start.error(i));
  EXPECT_NEAR(start.error(0), 1.2 / std::sqrt(512), 0.03);
  const SimulatedImu moving = simulate_imu({.poses = 12, .start = 3});
  EXPECT_FALSE(start_up_offset(moving.log, find_stationary(moving.log)).still);
}

// Without noise, only rounding separates the result from the true values.
TEST(CalibrateImu, RecoversAKnownSensor) {
  const SimulatedImu made = simulate_imu({.noise = 0.3});
  const ImuCalibration c = calibrate_imu({made.log});
  ASSERT_TRUE(c.accelerometer.solved()) << c.accelerometer.culprit;
  ASSERT_TRUE(c.gyroscope.solved()) << c.gyroscope.culprit;
  ASSERT_TRUE(c.magnetometer.solved()) << c.magnetometer.culprit;
  EXPECT_THAT(c.accelerometer.M, MatrixRelativelyNear(made.accelerometer.M, 5e-4));
  EXPECT_THAT(c.accelerometer.b, MatrixNear(made.accelerometer.b, 0.05));
  EXPECT_THAT(c.gyroscope.M, MatrixRelativelyNear(made.gyroscope.M, 5e-4));
  EXPECT_THAT(c.gyroscope.b, MatrixNear(made.gyroscope.b, 0.05));
  EXPECT_THAT(c.magnetometer.M, MatrixRelativelyNear(made.magnetometer.M, 5e-4));
  EXPECT_GT(c.accelerometer.residual_before, 0.1);
  EXPECT_LT(c.accelerometer.residual_after, 0.002);
  EXPECT_GT(c.gyroscope.residual_before, 0.01);
  EXPECT_LT(c.gyroscope.residual_after, 5e-4);
  for (const SensorCalibration* sensor : {&c.accelerometer, &c.gyroscope, &c.magnetometer}) {
    EXPECT_THAT(sensor->T * sensor->K.cwiseInverse().asDiagonal(), MatrixNear(sensor->M, 1e-15));
    EXPECT_THAT(sensor->T.diagonal(), MatrixNear(Vector3d::Ones(), 1e-15));
  }
  EXPECT_EQ(c.accelerometer.T(1, 0), 0);
  EXPECT_EQ(c.accelerometer.T(2, 0), 0);
  EXPECT_EQ(c.accelerometer.T(2, 1), 0);
  // Level, it measures gravity along z.
  EXPECT_THAT(c.accelerometer.apply(c.poses.front().accelerometer, 0),
              MatrixNear(Vector3d(0, 0, 9.80665), 0.02));
}

// A gyroscope whose axes all have the opposite sign.
TEST(CalibrateImu, FindsAGyroscopeThatCountsBackwards) {
  SimulatedImu made = simulate_imu();
  made.log.gyroscope *= -1;
  const ImuCalibration c = calibrate_imu({made.log});
  ASSERT_TRUE(c.gyroscope.solved()) << c.gyroscope.culprit;
  EXPECT_THAT(c.gyroscope.M, MatrixRelativelyNear(-made.gyroscope.M, 1e-3));
}

TEST(CalibrateImu, FitsTemperatureWhereTheLogSpansIt) {
  const SimulatedImu made = simulate_imu({.warming = 12});
  const ImuCalibration c = calibrate_imu({made.log});
  ASSERT_TRUE(c.accelerometer.solved() && c.gyroscope.solved());
  EXPECT_TRUE(c.accelerometer.with_temperature);
  EXPECT_NEAR(c.accelerometer.d(2), made.accelerometer.d(2), 5 * c.accelerometer.d_error(2));
  EXPECT_NEAR(c.accelerometer.d(2), -0.6, 0.05);
  EXPECT_EQ(c.accelerometer.d(0), 0);
  EXPECT_THAT(c.gyroscope.d, MatrixNear(made.gyroscope.d, 0.03));
  EXPECT_THAT(bias_at(c.gyroscope, made.t0), MatrixNear(made.gyroscope.b, 0.1));
  EXPECT_THAT(c.gyroscope.M, MatrixRelativelyNear(made.gyroscope.M, 1e-3));
  const ImuCalibration cold = calibrate_imu({simulate_imu({.warming = 3}).log});
  EXPECT_FALSE(cold.accelerometer.with_temperature);
  EXPECT_EQ(cold.gyroscope.d, Vector3d(Vector3d::Zero()));
}

struct Count {
  int inside = 0, all = 0;
  void add(double value, double error, double quantile, double truth) {
    ++all;
    if (std::abs(value - truth) <= quantile * error) ++inside;
  }
};

void add_all(Count& count, const SensorCalibration& found, const SimulatedSensor& truth,
             double t0) {
  for (int i = 0; i < 3; ++i) {
    count.add(bias_at(found, t0)(i), found.b_error(i), found.quantile, truth.b(i));
    for (int j = 0; j < 3; ++j)
      if (found.M_error(i, j) > 0)
        count.add(found.M(i, j), found.M_error(i, j), found.quantile, truth.M(i, j));
  }
}

/// The share of 95 % intervals that contain the true value. The parameters of one log are not
/// independent, so the spread is computed over logs: at worst all intervals of a log are right or
/// wrong together; here half of that is assumed.
void expect_imu_coverage(const Count& count, int logs, const char* what) {
  const double share = double(count.inside) / count.all;
  const double spread = std::sqrt(0.95 * 0.05 / logs);
  EXPECT_NEAR(share, 0.95, 1.5 * spread) << what;
  ::testing::Test::RecordProperty(what, std::to_string(share));
}

TEST(CalibrateImu, NinetyFivePercentOfIntervalsContainTheTrueValue) {
  constexpr int kLogs = testing::kSanitized ? 25 : 100;
  Count accelerometer, gyroscope, magnetometer;
  for (int i = 0; i < kLogs; ++i) {
    const SimulatedImu made =
        simulate_imu(short_log(std::uint64_t{100} + static_cast<std::uint64_t>(i)));
    const ImuCalibration c = calibrate_imu({made.log});
    ASSERT_TRUE(c.accelerometer.solved()) << i << " " << c.accelerometer.culprit;
    ASSERT_TRUE(c.gyroscope.solved()) << i << " " << c.gyroscope.culprit;
    ASSERT_TRUE(c.magnetometer.solved()) << i << " " << c.magnetometer.culprit;
    add_all(accelerometer, c.accelerometer, made.accelerometer, made.t0);
    add_all(gyroscope, c.gyroscope, made.gyroscope, made.t0);
    add_all(magnetometer, c.magnetometer, made.magnetometer, made.t0);
  }
  expect_imu_coverage(accelerometer, kLogs, "accelerometer");
  expect_imu_coverage(gyroscope, kLogs, "gyroscope");
  expect_imu_coverage(magnetometer, kLogs, "magnetometer");
}

// A pose in which it touched something that vibrated, and a turn with missing samples.
TEST(CalibrateImu, LeavesOutOutliers) {
  SimulatedImu made = simulate_imu();
  const StationaryPose pose = find_stationary(made.log).poses[20];
  const auto begin = static_cast<Eigen::Index>(pose.begin),
             length = static_cast<Eigen::Index>(pose.end - pose.begin);
  made.log.accelerometer.middleCols(begin, length) *= 1.03;
  const StationaryPose before = find_stationary(made.log).poses[8];
  made.log.gyroscope.middleCols(static_cast<Eigen::Index>(before.end) + 60, 15).setZero();
  const ImuCalibration c = calibrate_imu({made.log});
  ASSERT_TRUE(c.accelerometer.solved() && c.gyroscope.solved());
  EXPECT_THAT(c.accelerometer.refused, ElementsAre(20));
  EXPECT_THAT(c.gyroscope.refused, ElementsAre(8, 19, 20));  // and the turns to and from pose 20
  EXPECT_THAT(c.accelerometer.M, MatrixRelativelyNear(made.accelerometer.M, 1e-3));
  EXPECT_THAT(c.gyroscope.M, MatrixRelativelyNear(made.gyroscope.M, 1e-3));
}

TEST(CalibrateImu, NamesThePosesToAddToTooFew) {
  const SensorCalibration c = calibrate_imu({simulate_imu({.poses = 5}).log}).accelerometer;
  EXPECT_EQ(c.status, CalibrationStatus::not_observable);
  EXPECT_THAT(c.culprit, HasSubstr("5 poses, expected at least 10"));
  EXPECT_THAT(c.missing, Contains("x up"));
  EXPECT_THAT(c.missing, Contains("x down"));
  EXPECT_TRUE(c.M.hasNaN() && c.b.hasNaN());
}

// A log that is never stationary for long.
TEST(CalibrateImu, NamesThePosesToAddToNone) {
  const ImuCalibration c =
      calibrate_imu({simulate_imu({.poses = 20}).log}, {.still = {.shortest = 50}});
  EXPECT_TRUE(c.poses.empty());
  for (const SensorCalibration* sensor : {&c.accelerometer, &c.magnetometer}) {
    EXPECT_EQ(sensor->status, CalibrationStatus::not_observable);
    EXPECT_THAT(sensor->culprit, HasSubstr("0 poses, expected at least 10"));
    EXPECT_THAT(sensor->missing, Contains("x up"));
    EXPECT_TRUE(sensor->M.hasNaN() && sensor->refused.empty());
  }
  EXPECT_EQ(c.gyroscope.status, CalibrationStatus::not_observable);
}

// Rotated about the vertical only, all poses are equal.
TEST(CalibrateImu, NamesThePosesThatAreMissing) {
  const ImuCalibration c = calibrate_imu({simulate_imu({.upright = true}).log});
  EXPECT_EQ(c.accelerometer.status, CalibrationStatus::not_observable);
  for (const char* unseen : {"scale x", "scale y", "bias x", "bias y"})
    EXPECT_THAT(c.accelerometer.unseen, Contains(unseen));
  for (const char* missing : {"x up", "x down", "y up", "y down"})
    EXPECT_THAT(c.accelerometer.missing, Contains(missing));
  EXPECT_FALSE(c.gyroscope.solved());
  EXPECT_THAT(c.gyroscope.culprit, HasSubstr("the accelerometer is not calibrated"));
}

// Gravity turns in the plane of y and z only: nothing is known about x.
TEST(CalibrateImu, NamesTheAxisThatNeverPointsUp) {
  SimulatedImuOptions options;
  options.poses = 5;  // turns about x
  SimulatedImu made = simulate_imu(options);
  ImuLog& log = made.log;
  const Eigen::Index n = log.t.size();
  ImuLog longer = log;
  longer.t.resize(4 * n);
  longer.accelerometer.resize(3, 4 * n);
  longer.gyroscope.resize(3, 0);
  longer.magnetometer.resize(3, 0);
  longer.temperature.resize(0);
  const Eigen::Matrix3d inverse = made.accelerometer.M.inverse();
  for (int k = 0; k < 4; ++k) {  // the same, started at other angles
    const Eigen::Matrix3d turn = inverse *
                                 Eigen::AngleAxisd(0.35 * k, Vector3d::UnitX()).toRotationMatrix() *
                                 made.accelerometer.M;
    longer.t.segment(k * n, n) = log.t.array() + k * (log.t(n - 1) + 0.01);
    longer.accelerometer.middleCols(k * n, n) =
        (turn * (log.accelerometer.colwise() - made.accelerometer.b)).colwise() +
        made.accelerometer.b;
  }
  const SensorCalibration c = calibrate_imu({longer}).accelerometer;
  EXPECT_EQ(c.status, CalibrationStatus::not_observable);
  EXPECT_THAT(c.unseen, Contains("scale x"));
  EXPECT_THAT(c.missing, Contains("x up"));
  EXPECT_THAT(c.missing, Contains("x down"));
}

// Enough poses, but the log is cut where the sensor was turned about z.
TEST(CalibrateImu, NamesTheTurnsThatAreMissing) {
  const SimulatedImu made = simulate_imu();
  const std::vector<StationaryPose> poses = find_stationary(made.log).poses;
  std::vector<ImuLog> logs;
  const auto cut = [&](std::size_t from, std::size_t to) {
    const auto begin = static_cast<Eigen::Index>(from),
               length = static_cast<Eigen::Index>(to - from);
    ImuLog log;
    log.name = "part";
    log.t = made.log.t.segment(begin, length);
    log.accelerometer = made.log.accelerometer.middleCols(begin, length);
    log.gyroscope = made.log.gyroscope.middleCols(begin, length);
    logs.push_back(log);
  };
  cut(0, poses[8].end);                             // turns about x and y
  for (std::size_t i = 9; i < poses.size(); ++i) {  // poses alone, long enough for windows
    cut(poses[i].begin, poses[i].end);
  }
  ImuCalibrationOptions options;
  options.still.window = 0.2;
  const SensorCalibration c = calibrate_imu(logs, options).gyroscope;
  EXPECT_EQ(c.status, CalibrationStatus::not_observable) << c.culprit;
  EXPECT_THAT(c.unseen, Contains("scale z"));
  EXPECT_THAT(c.missing, ElementsAre("a turn about z with z level"));
}

// Channels in another order than those of the accelerometer: a matrix that swaps them back fits the
// turns, but its diagonal, whose inverse is K, is 0.
TEST(CalibrateImu, RejectsChannelsInAnotherOrder) {
  for (const auto& [a, b] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)}) {
    for (const bool gyroscope : {true, false}) {
      SimulatedImu made = simulate_imu();
      auto& sensor = gyroscope ? made.log.gyroscope : made.log.accelerometer;
      sensor.row(a).swap(sensor.row(b));
      const SensorCalibration c = calibrate_imu({made.log}).gyroscope;
      EXPECT_EQ(c.status, CalibrationStatus::no_match) << a << b << gyroscope;
      EXPECT_THAT(c.culprit, HasSubstr(" of the accelerometer")) << a << b << gyroscope;
    }
  }
}

TEST(CalibrateImu, CombinesSeveralLogs) {
  const SimulatedImu made = simulate_imu();
  const Eigen::Index half = 7000;
  ImuLog first = made.log, second = made.log;
  const auto take = [&](ImuLog& log, Eigen::Index begin, Eigen::Index length) {
    log.t = made.log.t.segment(begin, length);
    log.temperature = made.log.temperature.segment(begin, length);
    log.accelerometer = made.log.accelerometer.middleCols(begin, length);
    log.gyroscope = made.log.gyroscope.middleCols(begin, length);
    log.magnetometer = made.log.magnetometer.middleCols(begin, length);
  };
  take(first, 0, half);
  take(second, half, made.log.t.size() - half);
  const ImuCalibration c = calibrate_imu({first, second});
  ASSERT_TRUE(c.accelerometer.solved() && c.gyroscope.solved());
  EXPECT_THAT(c.accelerometer.M, MatrixRelativelyNear(made.accelerometer.M, 1e-3));
  second.gyroscope.resize(3, 0);
  EXPECT_THAT(
      [&] {
        (void)calibrate_imu({first, second});
      },
      ThrowsMessage<InvalidInput>(HasSubstr("does not have a gyroscope; expected")));
  EXPECT_THAT([&] { (void)calibrate_imu({}); },
              ThrowsMessage<InvalidInput>(HasSubstr("there is no log; expected at least one")));
}

TEST(SimulatedImu, IsTheSameForTheSameSeed) {
  EXPECT_EQ(simulate_imu({.seed = 4}).log.gyroscope, simulate_imu({.seed = 4}).log.gyroscope);
  EXPECT_NE(simulate_imu({.seed = 4}).log.gyroscope, simulate_imu({.seed = 5}).log.gyroscope);
  EXPECT_THAT([] { (void)simulate_imu({.poses = 1}); },
              ThrowsMessage<InvalidInput>(HasSubstr("expected at least two poses")));
}

}  // namespace
}  // namespace quadtune
