// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/imu_calibration_file.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <random>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"
#include "shared_data.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;
using testing::MatrixNear;
using testing::TemporaryDirectory;
using ::testing::ThrowsMessage;

ImuCalibrationFile random_calibration(unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> even(-1, 1);
  const auto vector = [&] { return Vector3d(even(random), even(random), even(random)); };
  ImuCalibrationFile c;
  for (ImuCalibrationFile::Sensor* sensor : {&c.accelerometer, &c.gyroscope, &c.magnetometer}) {
    for (int i = 0; i < 3; ++i) sensor->M.row(i) = vector() / 30;
    sensor->b = 50 * vector();
  }
  c.accelerometer_z_coefficient = even(random);
  c.accelerometer_t0 = 20 * even(random);
  c.gyroscope_coefficient = vector();
  c.gyroscope_constant = vector();
  c.gyroscope_t0 = 20 * even(random);
  return c;
}

/// `count` numbers, the three matrices the identity.
std::string numbers(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += (i % 12) % 4 == 0 && i % 12 < 9 ? "1\n" : "0\n";
  return text;
}

TEST(ImuCalibrationFile, ReadsBackToTheSameNumbers) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const ImuCalibrationFile c = random_calibration(seed);
    const std::string text = imu_calibration_text(c);
    const ImuCalibrationFile back = parse_imu_calibration(text, "f");
    EXPECT_EQ(back.accelerometer.M, c.accelerometer.M);
    EXPECT_EQ(back.gyroscope.b, c.gyroscope.b);
    EXPECT_EQ(back.magnetometer.M, c.magnetometer.M);
    EXPECT_EQ(back.gyroscope_constant, c.gyroscope_constant);
    EXPECT_EQ(back.gyroscope_t0, c.gyroscope_t0);
    EXPECT_EQ(imu_calibration_text(back), text);
  }
}

// By position: accelerometer 1…12, gyroscope 13…24, magnetometer 25…36, then the temperatures.
TEST(ImuCalibrationFile, TakesNumbersByTheirPlace) {
  std::string text;
  for (int i = 1; i <= 45; ++i)
    text += std::to_string(i * i % 47) + (i % 7 == 0 ? "\r\n" : "\t");  // any white space
  const ImuCalibrationFile c = parse_imu_calibration(text, "f");
  const auto at = [](int i) { return double(i * i % 47); };
  EXPECT_EQ(c.accelerometer.M(0, 1), at(2));
  EXPECT_EQ(c.accelerometer.M(1, 0), at(4));
  EXPECT_EQ(c.accelerometer.b(2), at(12));
  EXPECT_EQ(c.gyroscope.M(0, 0), at(13));
  EXPECT_EQ(c.magnetometer.b(2), at(36));
  EXPECT_EQ(c.accelerometer_z_coefficient, at(37));
  EXPECT_EQ(c.accelerometer_t0, at(38));
  EXPECT_EQ(c.gyroscope_coefficient, Vector3d(at(39), at(40), at(41)));
  EXPECT_EQ(c.gyroscope_constant, Vector3d(at(42), at(43), at(44)));
  EXPECT_EQ(c.gyroscope_t0, at(45));
}

TEST(ImuCalibrationFile, KnowsTheOlderFileOf36Numbers) {
  ImuCalibrationFile c = random_calibration(3);
  c.with_temperature = false;
  const ImuCalibrationFile back = parse_imu_calibration(imu_calibration_text(c), "f");
  EXPECT_FALSE(back.with_temperature);
  EXPECT_EQ(back.magnetometer.b, c.magnetometer.b);
  EXPECT_EQ(back.gyroscope_t0, 0);
}

TEST(ImuCalibrationFile, RefusesOtherCountsByLine) {
  for (const int count : {0, 1, 35, 37, 44})
    EXPECT_THAT([&] { (void)parse_imu_calibration(numbers(count), "c.txt"); },
                ThrowsMessage<InvalidInput>(
                    HasSubstr("c.txt:" + std::to_string(std::max(count, 1)) + ": ends after " +
                              std::to_string(count) + " numbers, expected 36")));
  EXPECT_THAT([] { (void)parse_imu_calibration(numbers(46), "c.txt"); },
              ThrowsMessage<InvalidInput>(
                  HasSubstr("c.txt:46: has 46 or more numbers; expected 36 or 45")));
}

TEST(ImuCalibrationFile, RefusesWhatTheFlightProgramWouldMisread) {
  const auto with = [](const std::string& word) {
    std::string text = numbers(45);
    return text.replace(4, 1, word);  // the third number
  };
  for (const char* word : {"nan", "inf", "x", "1e999", "0x1"})
    EXPECT_THAT([&] { (void)parse_imu_calibration(with(word), "c.txt"); },
                ThrowsMessage<InvalidInput>(HasSubstr("c.txt:3: '")));
  EXPECT_THAT([&] { (void)parse_imu_calibration(with("0,5"), "c.txt"); },
              ThrowsMessage<InvalidInput>(HasSubstr("c.txt:3: '0,5' has a comma")));
  std::string flat = numbers(45);
  flat[0] = '0';
  EXPECT_THAT([&] { (void)parse_imu_calibration(flat, "c.txt"); },
              ThrowsMessage<InvalidInput>(HasSubstr("the accelerometer's matrix is singular")));
  ImuCalibrationFile c = random_calibration(1);
  c.gyroscope.b(1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT([&] { (void)imu_calibration_text(c); },
              ThrowsMessage<InvalidInput>(HasSubstr("the gyroscope's calibration is nan")));
}

// Every prefix of a file is rejected or is a valid older file.
TEST(ImuCalibrationFile, RefusesTornFiles) {
  const std::string text = imu_calibration_text(random_calibration(5));
  for (std::size_t length = 0; length + 30 < text.size(); ++length) try {
      EXPECT_FALSE(parse_imu_calibration(text.substr(0, length), "f").with_temperature) << length;
    } catch (const InvalidInput& error) {
      EXPECT_THAT(error.what(), ::testing::StartsWith("f:"));
    }
}

TEST(ImuCalibrationFile, ReadsThePublishedFile) {
  QUADTUNE_REQUIRE_DATA(data);
  const ImuCalibrationFile c = read_imu_calibration((data / "uquad" / "imu_calib.txt").string());
  EXPECT_TRUE(c.with_temperature);
  EXPECT_NEAR(c.accelerometer.M(0, 0), 0.0373731, 1e-6);
  EXPECT_NEAR(c.gyroscope.b(0), -25.381918771483, 1e-12);
  EXPECT_EQ(c.magnetometer.M(1, 0), 0);
  EXPECT_NEAR(c.gyroscope_t0, 27.9869547673702, 1e-12);
  // A stationary vehicle measures gravity: the first frame of the log in the same folder.
  const Vector3d felt = c.accelerometer.M * (Vector3d(1, 1, 208) - c.accelerometer.b);
  EXPECT_NEAR(felt.norm(), 9.81, 0.3);
  const ImuCalibrationFile back = parse_imu_calibration(imu_calibration_text(c), "f");
  EXPECT_EQ(back.magnetometer.M, c.magnetometer.M);
}

TEST(ImuCalibrationFile, SaysThatAFileIsNotThere) {
  EXPECT_THROW((void)read_imu_calibration("/nowhere/imu_calib.txt"), FileError);
}

}  // namespace
}  // namespace quadtune
